"""Servo-aware designs that bear the ramps of their line."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from camwright.design.line.forms import greatest_form
from camwright.design.servo_aware.axis_problem import AxisProblem
from camwright.design.servo_aware.ramp_rows import RampRows
from camwright.jobs.job import Job, load_job
from camwright.profiles.errors import InfeasibleError
from camwright.profiles.line import STEADY, Line
from camwright.studies.axis_study import solve_job
from camwright.validation.production.line_ramp import line_ramp
from camwright.validation.report import judge

SHORT = Path(__file__).parents[3] / "examples" / "short-cut.toml"


def aware(line: Line, length: float = 0.35) -> Job:
    """Give the paper's job with its axis in tolerance, on a line."""
    job = load_job()
    return replace(job, servo_aware=True, slowest=0.1, cut=replace(job.cut, length=length), line=line)


@pytest.mark.parametrize("line", [Line(1.0, jerk=5.0), Line(0.5, 5.0, 50.0)])
def test_the_command_bears_the_ramp_and_the_axis_keeps_the_tolerance(line: Line) -> None:
    job = aware(line)
    solution, steady = solve_job(job), solve_job(replace(job, line=STEADY))
    allowed = line_ramp(solution.profile, job.task)
    assert allowed.speeding.value >= line.speeding
    assert allowed.braking.value >= line.braking
    assert line_ramp(steady.profile, job.task).ramp.value < 1e-3
    report = judge(solution.profile, job.task, job.servo, servo_aware=True, slowest=job.slowest)
    assert report.passed
    assert 1.0 < solution.minimised / steady.minimised < 1.012


@pytest.mark.slow
def test_a_shaped_command_bears_it_too() -> None:
    job = replace(load_job(SHORT), line=Line(1.0, 2.0, jerk=5.0))
    solution = solve_job(job)
    assert greatest_form(solution.profile, job.task) <= 1.0
    report = judge(solution.profile, job.task, job.servo, servo_aware=True, slowest=job.slowest)
    assert report.passed


def test_rows_stand_from_the_first_answer_that_breaks_them() -> None:
    job = aware(Line(5.0, jerk=50.0))
    problem = AxisProblem(job.task, "in_sync", (job.servo,), axis_limits=False)
    rows = RampRows(problem)
    still = 0.0 * problem.basis.matrix[0]
    assert not len(rows.rows()[0])
    profile = problem.basis.profile(still * problem.scale)
    assert rows.tighten(still, 2e-6) == (greatest_form(profile, job.task) > 1.0 - 1e-6)
    matrix, constant = rows.rows()
    assert len(matrix) == len(constant)
    assert not rows.tighten(still, 2e-6)
    assert not RampRows(AxisProblem(job.task.with_line(STEADY), "in_sync", (job.servo,), axis_limits=False)).tighten(
        still, 2e-6
    )


@pytest.mark.parametrize("shaped", [False, True])
def test_a_ramp_that_no_command_bears_is_refused_by_its_name(shaped: bool) -> None:
    job = aware(Line(35.0))
    job = replace(job, cut=replace(job.cut, shaped=shaped))
    with pytest.raises(
        InfeasibleError, match=r"while the line ramps: \[line\] acceleration = 35 m/s\^2 binds"
    ) as caught:
        solve_job(job)
    assert caught.value.binding == "line.acceleration"
