"""Comparisons: ranked by the job's objective, what breaks a limit marked and last, and readable at 80 columns."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from rich.console import Console, RenderableType

from camwright.cli.compare import compare_answer
from camwright.cli.views.checks import checks_view
from camwright.cli.views.profiles import profiles_view
from camwright.jobs.job import Job, load_job, parse_job
from camwright.profiles.objective import ObjectiveName
from camwright.profiles.servo_tolerance import ServoTolerance
from camwright.studies.axis_study import solve_job
from camwright.studies.comparison import Comparison, compare
from camwright.studies.design import optimise
from camwright.validation.check import Check
from camwright.validation.report import judge

EXAMPLES = Path(__file__).parents[2] / "examples"
PAPER = load_job()


def compared(job: Job) -> Comparison:
    return compare(job, solve_job(job).profile)


def text_of(view: RenderableType, width: int) -> str:
    console = Console(width=width, highlight=False)
    with console.capture() as captured:
        console.print(view)
    return captured.get()


@pytest.mark.parametrize("objective", ["peak_acceleration", "rms_acceleration", "peak_jerk"])
def test_profiles_are_ranked_by_the_objective_and_what_breaks_a_limit_is_last(objective: ObjectiveName) -> None:
    job = parse_job(PAPER.text.replace("peak_acceleration", objective), "job.toml")
    rows = compared(job).rows
    assert [row.within_limits for row in rows] == sorted((row.within_limits for row in rows), reverse=True)
    kept = [row.value(objective) for row in rows if row.within_limits]
    assert kept == sorted(kept, key=lambda value: value or 0.0)
    assert rows[0].name == "optimised"
    broken = {row.name for row in rows if not row.within_limits}
    assert {"parabolic", "linear_return"} <= broken  # their jerk is unbounded
    answer = compare_answer(compared(job), [])
    assert answer["sorted_by"] == objective
    assert {name for name, row in answer["profiles"].items() if not row["within_limits"]} == broken


def test_a_limit_that_a_baseline_exceeds_marks_it() -> None:
    tight = replace(PAPER, limits=replace(PAPER.limits, acceleration=12.0))
    found = {row.name: row.within_limits for row in compared(tight).rows}
    assert found["acceleration_trapezoid"]  # 11.85 m/s²
    assert not found["modified_sine"]  # 12.28
    assert not found["cycloid"]


def test_the_worst_servo_stands_beside_the_error_where_the_job_has_ranges() -> None:
    assert all(row.worst_error is None for row in compared(PAPER).rows)
    servo = PAPER.servo
    ranges = ServoTolerance((100.0, 140.0), (servo.damping,) * 2, (30.0, 40.0), (servo.sample_time,) * 2, (0.0, 0.0))
    job = replace(PAPER, servo_tolerance=ranges)
    comparison = compared(job)
    for row in comparison.rows:
        assert row.worst_error is not None
        assert row.worst_error >= row.response.shear_zone_error * (1 - 1e-9)
        assert row.value("sync_error") == row.worst_error
    shown = text_of(profiles_view(comparison), 80)
    assert "worst servo" in shown
    beyond = {row.name for row in comparison.rows if (row.worst_error or 0.0) > job.cut.sync_tolerance}
    assert beyond
    assert "‡ beyond the sync tolerance of 0.1 mm" in shown
    assert shown.count(" ‡ │") == len(beyond) + sum(
        row.response.shear_zone_error > job.cut.sync_tolerance for row in comparison.rows
    )


@pytest.mark.parametrize("width", [80, 100, 160])
def test_every_name_and_number_can_be_read(width: int) -> None:
    comparison = compared(PAPER)
    shown = text_of(profiles_view(comparison), width)
    assert "Profiles, by peak acceleration" in shown
    assert "…" not in shown
    for row in comparison.rows:
        assert f"{row.name} {'' if row.within_limits else '†'}" in shown
    report = judge(comparison["optimised"].profile, PAPER.task, PAPER.servo)
    shown = text_of(checks_view(report.checks, PAPER.units), width)
    assert "…" not in shown
    assert all(f"{check.name} " in shown for check in report.checks)
    assert max(map(len, shown.splitlines())) <= width


def test_what_passed_just_beyond_its_limit_is_marked() -> None:
    kept = Check("axis_speed", True, 3.3337, 3.3333, "m/s", None, "S1")
    shown = text_of(checks_view([kept], PAPER.units), 80)
    assert "3.3337 *" in shown
    assert "* beyond the limit by no more than" in shown
    for plain in (replace(kept, value=3.3), replace(kept, passed=False), replace(kept, value=33.0)):
        assert "*" not in text_of(checks_view([plain], PAPER.units), 80)


def test_a_proof_measures_nothing_that_it_does_not_need(monkeypatch: pytest.MonkeyPatch) -> None:
    def asked(*_: object) -> None:
        raise AssertionError("measured before it was asked for")

    for name in ("camwright.studies.design.compare", "camwright.studies.design.cut_lengths"):
        monkeypatch.setattr(name, asked)
    for name in ("servo_sweep", "length_errors"):
        monkeypatch.setattr(f"camwright.validation.report.{name}", asked)
    for job in (PAPER, load_job(EXAMPLES / "flying-saw.toml")):
        result = optimise(job)
        assert result.passed
        assert result.gap is not None
        for whole, part in ((result, "comparison"), (result, "lengths"), (result.report, "sweep")):
            with pytest.raises(AssertionError, match="before it was asked for"):
                getattr(whole, part)
