"""Ways out that are told: each is written into the job and must then be designed and pass."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from shaped_job import JOB

from camwright.cli.main import main
from camwright.jobs.job import BUNDLED_JOB, Job, parse_job
from camwright.jobs.toml_text import toml_text
from camwright.profiles.errors import InfeasibleError
from camwright.stored.save import design_files
from camwright.studies import remedies as module
from camwright.studies.axis_study import solve_job
from camwright.studies.design import optimise
from camwright.studies.remedies import Remedy, _Trial, remedies, solve_or_advise
from camwright.studies.speed_band import job_band
from camwright.validation.report import judge

PAPER = BUNDLED_JOB.read_text(encoding="utf-8")
LAZY = PAPER.replace("120 rad/s", "10 rad/s").replace("35 1/s", "3 1/s")
FAST = """
name = "fast"
[machine]
kind = "rotary_knife"
circumference = "400 mm"
[cut]
length = "900 mm"
line_speed = "170 m/min"
sync_zone = "200 mm"
shear_zone = "20 mm"
shear_zone_at = "90 mm"
sync_tolerance = "0.1 mm"
[limits]
speed = "200 m/min"
acceleration = "30 m/s^2"
jerk = "3000 m/s^3"
[servo]
bandwidth = "120 rad/s"
damping = 0.7
position_gain = "35 1/s"
sample_time = "4 ms"
velocity_feedforward = 1.0
[objective]
minimise = "peak_acceleration"
servo_aware = true
[output]
origin = "cut"
"""


def changed(text: str, change: str, value: object, unit: str) -> str:
    """Write a change into a job as a user would."""
    data: dict[str, Any] = tomllib.loads(text)
    homes = {
        "minimise": "objective",
        "servo_aware": "objective",
        "command": "objective",
        "acceleration": "limits",
        "lead_time": "servo",
    }
    table = data.setdefault(homes.get(change, "cut"), {})
    table[change] = f"{value} {unit}" if unit else value
    if change == "command":
        table["servo_aware"] = True
    return toml_text(data)


def passes(text: str) -> bool:
    job = parse_job(text, "job.toml")
    solution = solve_job(job)
    task = job.task.with_machine(solution.machine)
    return judge(solution.profile, task, job.servo, servo_aware=job.servo_aware).passed


def found(text: str) -> tuple[Remedy, ...]:
    job = parse_job(text, "job.toml")
    profile = solve_job(job).profile
    report = judge(profile, job.task, job.servo)
    return remedies(job, report, job_band(profile, job, report))


@pytest.mark.parametrize("text", [LAZY, PAPER.replace("0.1 mm", "0.002 mm")], ids=["lazy servo", "narrow tolerance"])
def test_each_way_out_of_a_failed_check_passes(text: str) -> None:
    assert not passes(text)
    ways = found(text)
    assert {"line_speed", "sync_tolerance"} <= {way.change for way in ways}
    for way in ways:
        assert passes(changed(text, way.change, way.value, way.unit)), way


def test_a_servo_that_lags_is_told_the_lead_time_that_makes_up_for_it() -> None:
    """A delay that is led by as much is none."""
    late = PAPER.replace("velocity_feedforward = 1.0", 'velocity_feedforward = 1.0\ndead_time = "4 ms"')
    way = next(way for way in found(late) if way.change == "lead_time")
    assert way.words == '[servo] lead_time = "4 ms"'
    assert passes(late.replace('dead_time = "4 ms"', 'dead_time = "4 ms"\nlead_time = "4 ms"'))


@pytest.mark.slow
def test_a_refused_axis_that_lags_is_told_it_too() -> None:
    """A command cannot make up for a delay that grows with the speed, over a band of line speeds."""
    late = PAPER.replace("velocity_feedforward = 1.0", 'velocity_feedforward = 1.0\ndead_time = "4 ms"')
    aware = late.replace("[objective]", "[objective]\nservo_aware = true")
    with pytest.raises(
        InfeasibleError, match=r'What works, each alone, designed and checked: \[servo\] lead_time = "4 ms"'
    ):
        solve_or_advise(parse_job(aware, "late.toml"))


def test_a_job_that_passes_needs_no_way_out() -> None:
    assert found(PAPER) == ()


def test_without_designs_nothing_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "MOST", 0)
    assert found(LAZY) == ()


@pytest.mark.slow
def test_each_suggestion_of_an_infeasible_job_is_designed_and_passes() -> None:
    job = parse_job(FAST, "fast.toml")
    with pytest.raises(InfeasibleError, match="designed and checked") as caught:
        solve_or_advise(job)
    assert caught.value.suggestions
    for each in caught.value.suggestions:
        value = "shaped" if each.change == "command" else each.value
        assert passes(changed(FAST, each.change, value, each.unit)), each


SLOW_AXIS = """
name = "slow axis"
[machine]
kind = "linear_carriage"
stroke = "670 mm"
mass = "28 kg"
travel_per_turn = "45 mm"
[cut]
length = "975 mm"
line_speed = "14.1 m/min"
sync_zone = "660 mm"
shear_zone = "132 mm"
sync_tolerance = "1 mm"
[limits]
speed = "50 m/min"
acceleration = "6 m/s^2"
jerk = "7.7 m/s^3"
[servo]
bandwidth = "30 rad/s"
damping = 0.988
position_gain = "2.71 1/s"
sample_time = "15.8 ms"
velocity_feedforward = 0.844
[objective]
minimise = "peak_jerk"
"""
"""Possible from 2.3 m/min down by its jerk, in tolerance only far below."""


def test_a_line_speed_far_below_what_the_limits_allow_is_found_where_the_axis_needs_it() -> None:
    job = parse_job(SLOW_AXIS, "job")
    with pytest.raises(InfeasibleError) as caught:
        solve_or_advise(job)
    (slower,) = [each.value for each in caught.value.suggestions if each.change == "line_speed"]
    assert 0.5 < slower < 1.2
    there = replace(job, cut=replace(job.cut, line_speed=slower / 60.0))
    solution = solve_job(there)
    assert judge(solution.profile, there.task.with_machine(solution.machine), there.servo).passed


def test_a_change_that_even_the_stand_in_fails_is_not_designed(monkeypatch: pytest.MonkeyPatch) -> None:
    """A job of the motor takes seconds a design, its stand-in hundredths."""
    text = SLOW_AXIS.replace("peak_jerk", "energy").replace('"7.7 m/s^3"', '"200 m/s^3"')
    designed: list[float] = []

    def counted(job: Job) -> bool:
        designed.append(job.cut.line_speed)
        return True

    monkeypatch.setattr("camwright.studies.remedies._passes", counted)
    trial = _Trial(parse_job(text, "job"))
    assert not trial.works(Remedy("line_speed", 12.0, "m/min"))
    assert designed == []
    assert trial.works(Remedy("line_speed", 0.8, "m/min"))
    assert len(designed) == 1


def test_a_job_that_can_be_designed_is_designed() -> None:
    job = parse_job(PAPER, "paper.toml")
    assert solve_or_advise(job).minimised == optimise(job).solution.minimised


@pytest.mark.parametrize(
    ("remedy", "line"),
    [
        (Remedy("line_speed", 63.2, "m/min"), '[cut] line_speed = "63.2 m/min"'),
        (Remedy("servo_aware", True, ""), "[objective] servo_aware = true"),
        (Remedy("command", "shaped", ""), '[objective] servo_aware = true, command = "shaped"'),
        (Remedy("minimise", "rms_jerk", ""), '[objective] minimise = "rms_jerk"'),
    ],
)
def test_a_remedy_is_told_as_it_is_written(remedy: Remedy, line: str) -> None:
    assert remedy.words == line


@pytest.mark.parametrize(
    ("text", "code", "last"),
    [
        (PAPER, 0, r"paper-600: passed every check at 80 m/min"),
        (LAZY, 1, r"paper-600: FAILED: crossing, settling, shear_zone_error, minimum_cut_length"),
    ],
    ids=["passed", "failed"],
)
def test_the_last_line_is_the_verdict(
    text: str, code: int, last: str, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("job.toml").write_text(text, encoding="utf-8")
    assert main(["design", "job.toml", "--no-figures"]) == code
    lines = capsys.readouterr().out.rstrip().splitlines()
    assert re.fullmatch(last, lines[-1].strip())
    advice: Callable[[str], bool] = lambda line: line.startswith("  [")  # noqa: E731
    assert any(map(advice, lines)) is bool(code)


BAND = (
    JOB.replace('"300 mm"', '"260 mm"').replace('"0.1 mm"', '"0.02 mm"').replace('"sync_error"', '"rms_acceleration"')
)
"""Too short for its tolerance over its line speeds."""


@pytest.mark.slow
def test_a_band_that_no_command_keeps_is_told_its_least_tolerance_and_the_part_that_one_keeps() -> None:
    job = parse_job(BAND, "band")
    with pytest.raises(InfeasibleError, match=r"One is held to it from \d.* m/min to 80 m/min\. What works") as refused:
        solve_or_advise(job)
    error = refused.value
    assert error.covered.part is not None
    assert error.covered.part[0] < error.covered.part[1] == pytest.approx(job.cut.line_speed)
    assert {each.change for each in error.suggestions} >= {"sync_tolerance", "line_speeds", "line_speed"}
    assert '[objective] line_speeds = ["' in str(error)
    if error.covered.family is not None:  # each band is held by a cam of its own
        assert f"A family of {len(error.covered.family)} cams covers its line speeds" in str(error)
    low = next(each.value for each in error.suggestions if each.change == "line_speeds")
    told = BAND.replace('"shaped"', f'"shaped"\nline_speeds = ["{low:.15g} m/min", "100 %"]')
    narrow = parse_job(told, "band")
    solution = solve_job(narrow, suggest=False)
    assert judge(solution.profile, narrow.task, narrow.servo, servo_aware=True, slowest=narrow.slowest).passed
    # less than the tolerance that is told as the least is refused, a little more is kept
    least = job.cut.sync_tolerance + (error.excess or 0.0) * 1e-3
    for factor, holds in ((0.98, False), (1.02, True)):
        other = parse_job(BAND.replace("0.02 mm", f"{factor * least * 1e3:.6f} mm"), "band")
        if holds:
            solve_job(other, suggest=False)
        else:
            with pytest.raises(InfeasibleError):
                solve_job(other, suggest=False)


def test_a_lower_line_speed_takes_the_ends_of_the_line_speeds_with_it() -> None:
    """Line speeds that are written by number end at the old line speed: they must end at the new one, or the job is refused."""
    text = Path("examples/short-cut.toml").read_text(encoding="utf-8")
    job = parse_job(text.replace('"290 mm"', '"250 mm"').replace("[servo.tolerance]", "[servo.tolerance]\n#"), "job")
    trial = module._Trial(job)
    found = list(trial.first(iter([module.Remedy("line_speed", 40.0, "m/min")])))
    assert [each.words for each in found] == [
        '[cut] line_speed = "40 m/min", [objective] line_speeds = ["8 m/min", "100 %"]'
    ]


@pytest.mark.slow
def test_a_servo_of_the_ranges_that_fails_at_the_line_speed_fails_the_job(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The design keeps everything with its own servo; its band ends below the job's speed, and no verdict may say that it passed."""
    text = PAPER.replace('length = "600 mm"', 'length = "420 mm"').replace('"0.1 mm"', '"0.03 mm"')
    file = tmp_path / "job.toml"
    file.write_text(f'{text}\n[servo.tolerance]\nbandwidth = "30 %"\nposition_gain = "20 %"\n', encoding="utf-8")
    result = optimise(parse_job(file.read_text(encoding="utf-8"), "job.toml"))
    assert result.report.passed
    assert not result.band.holds(result.job.cut.line_speed)
    assert (result.passed, result.failed) == (False, ["servo_tolerance"])
    ways = remedies(result.job, result.report, result.band)
    assert "line_speed" in {way.change for way in ways}
    (tmp_path / "cam.csv").write_text(design_files(result)["cam.csv"], encoding="utf-8")
    assert main(["validate", str(tmp_path / "cam.csv"), "--job", str(file)]) == 1
    assert "1 check failed: servo_tolerance" in capsys.readouterr().out
