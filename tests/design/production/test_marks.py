"""Corrections by a redesign: the paper's numbers, the closed form without jerk and speed, designs at the ends."""

import math
from dataclasses import replace

import pytest

from camwright.design.feasible.feasibility import is_feasible
from camwright.design.optimise import solve
from camwright.design.production.marks import designed_ends, designs, redesigned
from camwright.jobs.examples import example
from camwright.jobs.job import load_job
from camwright.profiles.errors import InfeasibleError
from camwright.profiles.limits import Limits
from camwright.profiles.line import Line
from camwright.profiles.machines import RotaryKnife
from camwright.profiles.mark_range import MarkRange
from camwright.profiles.motor import MotorCurve
from camwright.profiles.task import Task

PAPER = load_job().task


@pytest.mark.parametrize(("length", "earliest"), [(0.6, -263.38), (0.45, -113.38), (0.35, -13.38), (0.337, -0.377)])
def test_the_machine_of_the_paper(length: float, earliest: float) -> None:
    found = redesigned(PAPER.with_length(length))
    assert found.earliest * 1e3 == pytest.approx(earliest, abs=5e-3 if length > 0.34 else 5e-4)
    assert found.latest is None


def test_without_limits_of_jerk_and_speed_it_is_a_closed_form() -> None:
    free = PAPER.with_limits(Limits(1e3, 30.0, 1e12))
    v, height = PAPER.cut.line_speed, PAPER.height
    k = 30.0 / (4 * v**2)
    length = (-1 + math.sqrt(1 + 4 * k * height)) / (2 * k) + PAPER.cut.sync_zone
    assert length * 1e3 == pytest.approx(329.38, abs=5e-3)
    assert redesigned(free).earliest == pytest.approx(length - PAPER.cut.length, abs=1e-6)


@pytest.mark.parametrize("length", [0.6, 0.45, 0.35, 0.337])
def test_the_correction_designs_and_a_hundredth_more_does_not(length: float) -> None:
    task = PAPER.with_length(length)
    end = redesigned(task).earliest
    cam = solve(task.with_length(length + end * (1 - 1e-9)), "peak_acceleration").profile
    v = task.cut.line_speed
    assert cam.peak(2) * v**2 <= 30.0 * (1 + 1e-9)
    assert cam.peak(3) * v**3 <= 3000.0 * (1 + 1e-9)
    with pytest.raises(InfeasibleError):
        solve(task.with_length(length + 1.01 * end), "peak_acceleration")


def test_a_slave_that_cannot_stand_has_a_longest_length() -> None:
    """At 150 m/min the knife cannot stop between two cuts: 450 mm it does, a length without end it does not."""
    task = PAPER.at_speed(150 / 60).with_length(0.45)
    found = redesigned(task)
    assert found.latest is not None
    assert found.latest > 0
    solve(task.with_length(0.45 + found.latest * (1 - 1e-9)), "peak_acceleration")
    with pytest.raises(InfeasibleError):
        solve(task.with_length(0.45 + 1.01 * found.latest), "peak_acceleration")


@pytest.mark.parametrize("name", ["flying-saw", "thick-product", "cross-cutter"])
def test_other_machines_design_at_both_ends(name: str) -> None:
    task = load_job(example(name).path).task
    found = redesigned(task)
    assert found.latest is None
    solve(task.with_length(task.cut.length + found.earliest * (1 - 1e-7)), "peak_acceleration")
    with pytest.raises(InfeasibleError):
        solve(task.with_length(task.cut.length + 1.01 * found.earliest), "peak_acceleration")


def test_a_knife_that_may_run_backwards_waits_for_any_mark() -> None:
    task = PAPER.with_limits(replace(PAPER.limits, reversal=True)).at_speed(150 / 60).with_length(0.45)
    assert redesigned(task).latest is None


def test_a_cut_that_cannot_be_done_is_refused() -> None:
    with pytest.raises(InfeasibleError):
        redesigned(PAPER.with_length(0.3))


def test_slower_lines_bear_more() -> None:
    ends = [
        redesigned(Task(PAPER.machine, replace(PAPER.cut, line_speed=v), PAPER.limits)).earliest
        for v in (0.4, 0.8, 1.2)
    ]
    assert ends == sorted(ends)


def test_on_a_line_that_ramps_the_ends_are_sure_and_found_by_designs() -> None:
    """Sure ends design; the designed end lies between them and those of a steady line, and a hundredth more does not design."""
    task = PAPER.with_line(Line(1.0, 2.0, 10.0))
    sure, found, steady = redesigned(task).earliest, designed_ends(task).earliest, redesigned(PAPER).earliest
    assert steady < found < sure < 0.9 * steady
    assert designs(task, sure)
    assert designs(task, found)
    assert not designs(task, 1.01 * found)
    assert designed_ends(PAPER) == redesigned(PAPER)


def test_a_line_that_the_zone_does_not_bear_leaves_no_correction() -> None:
    assert redesigned(PAPER.with_line(Line(50.0))) == MarkRange(0.0, 0.0)


def test_no_length_below_the_sync_zone_is_tried() -> None:
    assert not designs(PAPER, -0.5)


def test_with_a_motors_curve_the_end_is_found_by_designs() -> None:
    knife = RotaryKnife(0.4, drum_inertia=0.05)
    curve = MotorCurve(((0.0, 60.0), (20 * math.pi, 20.0)))
    task = Task(knife, PAPER.cut, replace(PAPER.limits, motor=curve))
    sure, found = redesigned(task).earliest, designed_ends(task).earliest
    assert redesigned(PAPER).earliest <= found <= sure
    assert designs(task, found)
    assert not designs(task, 1.01 * found)


BETWEEN = Task(
    RotaryKnife(0.4, drum_inertia=0.05),
    PAPER.cut,
    replace(PAPER.limits, motor=MotorCurve(((0.0, 10.5), (20 * math.pi, 3.5)))),
)
"""A motion keeps this motor's curve, though none lies in one of its rectangles."""


def test_a_job_that_no_rectangle_of_the_motors_curve_allows_is_not_refused() -> None:
    assert not is_feasible(BETWEEN)
    assert designs(BETWEEN, 0.0)
    assert redesigned(BETWEEN) == MarkRange(0.0, 0.0)
    with pytest.raises(InfeasibleError, match="jerk"):
        redesigned(BETWEEN.with_limits(replace(BETWEEN.limits, jerk=1.0)))


@pytest.mark.slow
def test_both_ends_of_such_a_job_are_found_by_designs() -> None:
    found = designed_ends(BETWEEN)
    assert found.earliest < 0.0
    assert found.latest is None
    assert designs(BETWEEN, found.earliest)
    assert not designs(BETWEEN, 1.01 * found.earliest)
