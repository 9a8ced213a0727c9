"""How far a machine goes with its axis in tolerance: every edge against designs on both sides of it."""

from __future__ import annotations

from dataclasses import replace

import pytest

from camwright.answers.limits import limits_answer
from camwright.design.feasible.extremes import extremes
from camwright.jobs.job import Job, load_job
from camwright.profiles.errors import InfeasibleError
from camwright.studies.axis_study import solve_job
from camwright.studies.limits import limits
from camwright.studies.reach import ACCURACY, reach
from camwright.validation.report import judge


def passes(job: Job) -> bool:
    """Whether a design of the job passes every check."""
    try:
        solution = solve_job(job, suggest=False)
    except InfeasibleError:
        return False
    task = job.task.with_machine(solution.machine)
    return judge(solution.profile, task, job.servo, servo_aware=job.servo_aware).passed


@pytest.mark.parametrize("name", ["paper-600", "cross-cutter", "flying-saw", "thick-product"])
def test_inside_the_edges_designs_pass_and_beyond_they_fail(name: str) -> None:
    job = load_job(f"examples/{name}.toml")
    found = reach(job, extremes(job.task))
    speed, length = found.max_line_speed, found.min_cut_length
    assert speed is not None
    assert length is not None
    for factor, right in ((1 - 2 * ACCURACY, True), (1 + 2 * ACCURACY, False)):
        assert passes(replace(job, cut=replace(job.cut, line_speed=speed * factor))) == right
        assert passes(replace(job, cut=replace(job.cut, length=length / factor))) == right


def test_the_paper_runs_faster_with_a_perfect_axis_than_in_tolerance() -> None:
    """At 118 m/min `design` fails, though the limits let the knife go 138 m/min."""
    found = limits_answer(limits(load_job()))
    speeds = found["highest_line_speed_m_per_s"]
    assert (
        60 * speeds["perfect_axis"]
        == pytest.approx(138.2, abs=0.1)
        == pytest.approx(found["max_line_speed_m_per_min"], abs=0.1)
    )
    assert 116 < 60 * speeds["axis_in_tolerance"] < 118
    assert found["axis_in_tolerance_binding"]["line_speed"] == "settling"
    assert found["shortest_cut_mm"]["perfect_axis"] == found["min_cut_length_mm"]


def test_no_tolerance_no_reach() -> None:
    job = load_job()
    job = replace(job, cut=replace(job.cut, sync_tolerance=1e-9), servo=replace(job.servo, velocity_feedforward=0.0))
    found = reach(job, extremes(job.task))
    assert found.max_line_speed is None
    assert found.min_cut_length is None
    assert found.line_speed_binding in ("settling", "crossing", "shear_zone_error")
