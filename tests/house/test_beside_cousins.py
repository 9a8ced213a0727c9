"""The jobs of the comparison with another version are jobs, each another one, and their files say what they are to say."""

from __future__ import annotations

import tomllib
from pathlib import Path
from types import ModuleType

import pytest

from camwright.jobs.job import Job, parse_job

ROOT = Path(__file__).parents[2]
EXAMPLE = """# a job
name = "it"

[cut]
length = "900 mm"   # long

[servo]
gain = 1

[servo.tolerance]
gain = "5 %"

[output]
points = 3
"""


@pytest.fixture
def script(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.syspath_prepend(str(ROOT / "benchmarks"))
    import beside_cousins

    return beside_cousins


def test_cousins_are_jobs_that_differ(script: ModuleType) -> None:
    jobs: list[Job] = []
    for cousin in script.COUSINS:
        example = (ROOT / "examples" / f"{cousin.of}.toml").read_text(encoding="utf-8")
        job = parse_job(script.written(example, cousin.changes), cousin.name)
        assert job not in jobs  # of the same numbers are equal, whatever their files
        jobs.append(job)
    assert len({cousin.name for cousin in script.COUSINS}) == len(jobs)


def test_values_are_changed_where_they_stand(script: ModuleType) -> None:
    changes = {"cut.length": '"700 mm"', "servo.gain": "2", "cut.speed": '"3 m/min"', "servo.tolerance.delay": '"1 %"'}
    said = tomllib.loads(script.written(EXAMPLE, changes))
    assert said == {
        "name": "it",
        "cut": {"length": "700 mm", "speed": "3 m/min"},
        "servo": {"gain": 2, "tolerance": {"gain": "5 %", "delay": "1 %"}},
        "output": {"points": 3},
    }


def test_keys_and_tables_are_taken_away(script: ModuleType) -> None:
    said = tomllib.loads(script.written(EXAMPLE, {"[servo.tolerance]": None, "cut.length": None}))
    assert said == {"name": "it", "cut": {}, "servo": {"gain": 1}, "output": {"points": 3}}


def test_a_table_that_is_not_there_is_refused(script: ModuleType) -> None:
    with pytest.raises(SystemExit, match=r"line.speed = 3 did not go into the job file"):
        script.written(EXAMPLE, {"line.speed": "3"})
