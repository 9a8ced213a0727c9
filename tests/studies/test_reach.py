"""How far a machine goes with its axis in tolerance: every edge against designs on both sides of it."""

from __future__ import annotations

from dataclasses import replace

import pytest

from camwright.answers.limits import limits_answer
from camwright.design.feasible.extremes import extremes
from camwright.jobs.job import Job, load_job
from camwright.profiles.cut import Cut
from camwright.profiles.errors import InfeasibleError
from camwright.profiles.limits import Limits
from camwright.profiles.machines import RotaryKnife
from camwright.profiles.servo import Servo
from camwright.studies.axis_study import solve_job
from camwright.studies.limits import limits
from camwright.studies.reach import ACCURACY, binding_of, reach
from camwright.validation.report import judge


def passes(job: Job) -> bool:
    """Whether a design of the job passes every check."""
    try:
        solution = solve_job(job, suggest=False)
    except InfeasibleError:
        return False
    task = job.task.with_machine(solution.machine)
    return judge(solution.profile, task, job.servo, servo_aware=job.servo_aware, slowest=job.slowest).passed


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


@pytest.mark.slow
@pytest.mark.parametrize(("acceleration", "length"), [(1.0, 0.6), (2.5, 0.45)])
def test_on_a_ramping_line_designs_pass_inside_the_edges_and_fail_beyond(acceleration: float, length: float) -> None:
    job = load_job("examples/ramping-line.toml")
    job = replace(job, cut=replace(job.cut, length=length), line=replace(job.line, acceleration=acceleration))
    found = reach(job, extremes(job.task))
    speed, shortest = found.max_line_speed, found.min_cut_length
    assert speed is not None
    assert shortest is not None
    for factor, right in ((1.0, True), (1.002, False)):
        assert passes(replace(job, cut=replace(job.cut, line_speed=speed * factor))) == right
        assert passes(replace(job, cut=replace(job.cut, length=shortest / factor))) == right


SHAPED = replace(
    load_job(),
    machine=RotaryKnife(0.52),
    cut=Cut(0.45, 1.2, 0.15, 0.045, 0.105, 1.5e-4, shaped=True),
    limits=Limits(3.6, 110.0, 22000.0),
    servo=Servo(140.0, 0.8, 40.0, 0.002, 1.0),
    servo_aware=True,
    slowest=1.0,
)
"""A shaped command, which need not be in sync in all of the sync zone: it goes further than what a command in sync can."""


@pytest.mark.slow
def test_a_shaped_command_ends_where_the_axis_breaks_its_own_limits() -> None:
    far = extremes(SHAPED.task)
    found = reach(SHAPED, far)
    assert found.line_speed_binding == found.cut_length_binding == "axis_speed"
    assert found.max_line_speed is not None
    assert found.min_cut_length is not None
    assert far.min_cut_length is not None
    assert found.min_cut_length < 0.8 * far.min_cut_length
    for factor, right in ((0.992, True), (1.008, False)):
        assert passes(replace(SHAPED, cut=replace(SHAPED.cut, line_speed=found.max_line_speed * factor))) == right
        assert passes(replace(SHAPED, cut=replace(SHAPED.cut, length=found.min_cut_length / factor))) == right


@pytest.mark.slow
def test_a_band_of_line_speeds_counts_as_it_does_for_a_design() -> None:
    job = load_job("examples/short-cut.toml")
    found = reach(job, extremes(job.task))
    assert found.max_line_speed is not None
    assert found.min_cut_length is not None
    for factor, right in ((1.0, True), (1.008, False)):
        assert passes(replace(job, cut=replace(job.cut, line_speed=found.max_line_speed * factor))) == right
        assert passes(replace(job, cut=replace(job.cut, length=found.min_cut_length / factor))) == right


@pytest.mark.parametrize(
    ("length", "binding"), [(0.2, "sync_tolerance"), (0.215, "axis_ratio"), (0.225, "axis_speed"), (0.17, "speed")]
)
def test_what_binds_beyond_the_edge_is_named(length: float, binding: str) -> None:
    assert binding_of(SHAPED, SHAPED.task.with_length(length)) == binding


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
