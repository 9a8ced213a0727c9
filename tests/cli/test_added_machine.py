"""A machine added by the book, for good: its module, one line in `MACHINES`, a job, its words. Then every command works on it."""

from __future__ import annotations

import json
from dataclasses import fields, is_dataclass
from pathlib import Path

import numpy as np
import pytest

from camwright import load_job
from camwright.cli import book as book_command
from camwright.cli.main import main
from camwright.house.language import LANGUAGES
from camwright.jobs.keys import job_keys
from camwright.jobs.structure import job_schema
from camwright.profiles.machines import MACHINES
from camwright.profiles.objective import OBJECTIVES
from camwright.profiles.tables.targets import TARGETS
from camwright.recipes.catalogue import catalogue
from camwright.workbench.files import PAGE
from camwright.workbench.words import page_words
from tests.book.books import inline_crew
from tests.cli.added.pendulum_shear import PendulumShear

ROOT = Path(__file__).parents[2]
ADDED = Path(__file__).parent / "added"
JOB = ADDED / "pendulum-shear.toml"
LINES = {"twincat-cnc", "lenze", "technosoft", "trio"}


@pytest.fixture(autouse=True)
def added(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Add the machine: its line in `MACHINES`, its words in the catalogue."""
    monkeypatch.setitem(MACHINES, PendulumShear.kind, PendulumShear)
    words = json.loads((ADDED / "messages.json").read_text(encoding="utf-8"))
    for language in LANGUAGES:
        for key, text in words[language].items():
            monkeypatch.setitem(catalogue(language).messages, key, text)
    monkeypatch.chdir(tmp_path)


def answer(capsys: pytest.CaptureFixture[str], *arguments: str) -> dict[str, object]:
    assert main([*arguments, "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert isinstance(found, dict)
    return found


def job_with(tmp_path: Path, old: str, new: str) -> Path:
    text = JOB.read_text(encoding="utf-8")
    assert old in text
    file = tmp_path / "job.toml"
    file.write_text(text.replace(old, new), encoding="utf-8")
    return file


def test_check_reads_it_and_says_what_it_is_like(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", str(JOB)]) == 0
    assert "arm 800 mm, sync zone 200 mm" in capsys.readouterr().out
    assert load_job(JOB).machine == PendulumShear(0.8, 12.0, 20.0)


def test_its_keys_have_their_meaning(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["keys", "machine.arm"]) == 0
    assert "length of the arm" in " ".join(capsys.readouterr().out.split())


def test_its_lines_of_words_are_those_that_the_text_counts() -> None:
    messages, words = (
        json.loads((ADDED / f"{name}.json").read_text(encoding="utf-8")) for name in ("messages", "words")
    )
    for language in ("de", "zh"):
        own = json.loads((PAGE / "words" / f"{language}.json").read_text(encoding="utf-8"))
        keys = {key.path for key in job_keys() if key.machine in ("", PendulumShear.kind)}
        assert {f"meaning.{path}" for path in keys} - own.keys() == words[language].keys()
        assert {f"field.{path}" for path in keys} <= page_words(language).keys()
    counted = [sum(map(len, each.values())) for each in (messages, words)]
    text = " ".join((ROOT / "docs" / "extending.md").read_text(encoding="utf-8").split())
    assert f"{counted[0]} lines of messages, {counted[1]} of words" in text


def test_its_table_stands_in_the_schema() -> None:
    table = job_schema()["$defs"]["PendulumShearTable"]
    assert table["description"] == PendulumShear.summary
    assert table["required"] == ["kind", "arm"]
    assert table["properties"]["arm_inertia"]["default"] == "0 kg m^2"


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('arm = "800 mm"', 'arm = "80 mm"', "[machine] arm = 80 mm: too short for the sync zone; shorten [cut] sync_zone to 159.999 mm"),
        ('arm = "800 mm"\n', "", '[machine] arm: missing; add e.g. arm = "800 mm"'),
        ('arm = "800 mm"', "arm = 800", '[machine] arm = 800: a number without a unit; write e.g. "800 mm"'),
        ('arm_inertia = "12 kg m^2"', "", 'add e.g. arm_inertia = "0.05 kg m^2"'),
        ('speed = "200 m/min"', 'speed = "80 m/min"', "below the 80.6324 m/min at which the blade runs in the sync zone"),
    ],
)  # fmt: skip
def test_its_faults_are_told_like_those_of_others(
    old: str, new: str, message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["check", str(job_with(tmp_path, old, new))]) == 2
    assert message in capsys.readouterr().err


@pytest.mark.parametrize("objective", [name for name in OBJECTIVES if name != "sync_error"])
def test_it_is_designed_for_every_objective(objective: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    job = job_with(tmp_path, 'minimise = "rms_torque"', f'minimise = "{objective}"')
    found = answer(capsys, "design", str(job), "--out", "out", "--no-figures")
    assert found["passed"] is True
    assert main(["validate", "out/design.json", "--job", str(job), "--quiet"]) == 0


def test_it_is_designed_with_its_axis_in_mind(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    job = job_with(tmp_path, 'minimise = "rms_torque"', 'servo_aware = true\nminimise = "sync_error"')
    assert answer(capsys, "design", str(job), "--out", "out", "--no-figures")["passed"] is True


def test_every_other_command_works_on_it(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    job = str(JOB)
    assert answer(capsys, "design", job, "--out", "out")["passed"] is True
    assert Path("out/profile.svg").read_text(encoding="utf-8").count("blade y (mm)")
    compared = answer(capsys, "compare", job)
    assert {"optimised", "poly_3_4_5", "linear_return"} <= set(compared["profiles"])  # type: ignore[call-overload]
    assert answer(capsys, "limits", job)["job"] == "pendulum-shear"
    assert answer(capsys, "envelope", job, "--points", "2", "--out", "envelope")["points"]
    assert (
        main(["export", "out/design.json", "--to", "all", "--out", "tables", "--quiet"]) == 1
    )  # as with a flying saw:
    report = json.loads(Path("tables/report.json").read_text(encoding="utf-8"))
    assert set(report["refused"]) == {"kollmorgen-kas"}  # no cam that comes back
    assert set(report["targets"]) == set(TARGETS) - set(report["refused"])
    assert {
        name for name, entry in report["targets"].items() if not entry["passed"]
    } <= LINES  # straight lines between points
    table = next(Path("tables").glob("*_cam.csv"))
    assert main(["audit", str(table), "--job", job, "--quiet"]) == 0
    monkeypatch.setattr(book_command, "local_crew", lambda _: inline_crew())  # processes would not know the machine
    assert main(["book", job, "--length", "600:650:50", "--line-speed", "80", "--out", "book", "--quiet"]) == 0


@pytest.mark.parametrize("language", LANGUAGES)
def test_its_recipe_is_written_in_every_language(language: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["recipe", str(JOB), "--targets", "csv", "--language", language, "--out", "recipe", "--quiet"]) == 0
    html = next(Path("recipe").glob("*.html")).read_text(encoding="utf-8")
    assert catalogue(language)("before.direction.pendulum_shear") in html  # type: ignore[arg-type]
    assert catalogue(language)("machine.arm") in html  # type: ignore[arg-type]


def test_its_formulas_are_each_others_derivatives() -> None:
    shear, y, step = PendulumShear(0.8, 12.0, 20.0), np.linspace(-0.5, 0.5, 11), 1e-6
    assert is_dataclass(shear)
    assert [each.name for each in fields(shear)] == ["arm", "arm_inertia", "gear_ratio"]
    slope = (shear.tool(y + step) - shear.tool(y - step)) / (2 * step)
    assert slope == pytest.approx(shear.tool_ratio(y), abs=1e-9)
