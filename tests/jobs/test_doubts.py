"""What `camwright check` doubts: numbers that hardly any machine has, and what is left out although it matters."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from camwright.cli.main import main
from camwright.jobs.doubts import doubts
from camwright.jobs.examples import examples
from camwright.jobs.job import BUNDLED_JOB, parse_job

PAPER = BUNDLED_JOB.read_text(encoding="utf-8")


@pytest.mark.parametrize("name", list(examples()))
def test_no_example_is_doubted(name: str) -> None:
    assert doubts(parse_job(examples()[name].text, name)).warnings == ()


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"circumference": "400 m"}, r"[machine] circumference = 400 m: above what machines have, 10 mm to 20000 mm"),
        ({"line_speed": "80 mm/min"}, r"[cut] line_speed = 80 mm/min: below what machines have, 1 m/min to 1500 m/min"),
        (
            {"bandwidth": "5 rad/s", "position_gain": "2 1/s"},
            r"[servo] bandwidth = 5 rad/s: below what machines have, 16 rad/s to 750 rad/s",
        ),
        ({"sample_time": "0.05 ms"}, r"[servo] sample_time = 0.05 ms: below what machines have, 0.1 ms to 20 ms"),
        ({"sync_tolerance": "10 mm"}, r"[cut] sync_tolerance = 10 mm: above what machines have"),
        ({"jerk": "3e9 m/s^3"}, r"[limits] jerk = 3e9 m/s^3: above what machines have"),
        ({"length": "2500 in"}, r"[cut] length = 2500 in: above what machines have, 0.19685 in to 1968.5 in"),
    ],
)
def test_a_slip_of_the_unit_is_doubted(changes: dict[str, str], told: str) -> None:
    text = PAPER
    for key, value in changes.items():
        text = re.sub(rf"(?m)^{key} = .*$", f'{key} = "{value}"', text, count=1)
    warnings = doubts(parse_job(text, "")).warnings
    assert any(each.startswith(told) for each in warnings), warnings
    assert all(each.endswith("is its unit the one that is meant?") for each in warnings)


def test_what_is_left_out_and_matters_is_listed() -> None:
    bare = re.sub(r"(?m)^(shear_zone|sync_tolerance) = .*$", "", PAPER)
    found = "\n".join(doubts(parse_job(bare, "")).missing)
    for key in (
        "[cut] shear_zone",
        "[cut] sync_tolerance: taken as 0.1 mm",
        "[machine] inertia or friction",
        "[servo] dead_time",
        "[line] acceleration, stop: taken as a line that keeps its speed",
    ):
        assert key in found
    full = PAPER.replace("[cut]", 'inertia = "0.05 kg m^2"\n\n[cut]', 1).replace(
        "[servo]", '[line]\nacceleration = "1 m/s^2"\n\n[servo]\ndead_time = "1 ms"', 1
    )
    assert doubts(parse_job(full, "")).missing == (
        "[limits] motor: no torque-speed curve, so torque is told but not limited",
    )


def test_a_doubt_is_no_fault(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "job.toml"
    file.write_text(PAPER.replace('"400 mm"', '"400 m"'), encoding="utf-8")
    assert main(["check", str(file), "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    (warning,) = answer["warnings"]
    assert "circumference = 400 m" in warning
    assert answer["missing"]
    assert main(["check", str(file)]) == 0
    said = capsys.readouterr().out
    assert "Warning: [machine] circumference" in said
    assert "Optional and not given:" in said
