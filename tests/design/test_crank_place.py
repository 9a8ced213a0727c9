"""Where the sync zone of a crank is put: a peak is that of the whole cycle."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from camwright.design.feasible.feasibility import is_feasible, least_limit
from camwright.design.optimise import solve
from camwright.design.place import can_be_carried, place_sync
from camwright.design.place_cost import cost_at, place_for
from camwright.profiles.cut import Cut
from camwright.profiles.limits import Limits
from camwright.profiles.machines import CrankSlider
from camwright.profiles.motor import MotorCurve
from camwright.profiles.objective import CommandObjective
from camwright.profiles.task import Task
from camwright.validation.motion import measure_motion

CRANK = CrankSlider(0.15, 0.6, 0.0, 0.5, 20.0, 5.0)
# a long sync zone: the crank turns much faster at its ends than in its middle
LONG = Cut(0.9, 1.0, 0.2, 0.04, 0.1, 1e-4)
LIMITS = Limits(60.0, 2000.0, 400000.0)


def peak(placed: CrankSlider, cut: Cut, objective: CommandObjective) -> float:
    """Peak of the whole cycle that is optimal at a place."""
    motion = measure_motion(solve(Task(placed, cut, LIMITS), objective).profile, Task(placed, cut, LIMITS))
    value = motion.peak_acceleration if objective == "peak_acceleration" else motion.peak_jerk
    assert value is not None
    return value


@pytest.mark.parametrize("objective", ["peak_acceleration", "peak_jerk"])
@pytest.mark.parametrize("cut", [LONG, replace(LONG, length=2.0)])
def test_no_other_place_has_a_lower_peak_of_the_whole_cycle(objective: CommandObjective, cut: Cut) -> None:
    found = place_for(Task(CRANK, cut, LIMITS), objective).task.machine
    best = peak(found, cut, objective)
    least, greatest = CRANK.place_range(cut)
    for angle in np.linspace(least, greatest, 8)[1:-1]:
        there = replace(CRANK, sync_at=float(angle))
        if is_feasible(Task(there, cut, LIMITS)):
            assert peak(there, cut, objective) >= best * (1 - 1e-5)


@pytest.mark.parametrize("objective", ["peak_acceleration", "peak_jerk"])
def test_a_peak_s_place_is_found_to_a_ten_thousandth_of_the_peak(objective: CommandObjective) -> None:
    """Where the peak of the zone meets that of the return there is a corner: a wrong place costs in proportion to how far off it is."""
    task = Task(CRANK, replace(LONG, length=2.0), LIMITS)
    found = place_for(task, objective)
    assert found.cost == cost_at(found.task, objective)
    least, greatest = CRANK.place_range(task.cut)
    near = found.task.machine.place + (greatest - least) * np.linspace(-2e-3, 2e-3, 21)
    over_all = np.linspace(least, greatest, 62)[1:-1]
    for angle in np.concatenate([near, over_all]):
        assert cost_at(task.placed_at(float(angle)), objective) >= found.cost * (1 - 1e-5)


def test_local_minima_of_the_place_are_counted_once_each() -> None:
    """Of places that cost the same one counts; the deepest is found wherever it lies."""
    task = Task(CRANK, LONG, LIMITS)
    least, greatest = CRANK.place_range(task.cut)
    wells = [(0.3, 1.0), (0.52, 0.5), (0.8, 0.9)]

    def cost(placed: Task) -> float:
        share = (placed.machine.place - least) / (greatest - least)
        return min(min(2.0, depth + 30 * abs(share - at)) for at, depth in wells)

    found = place_sync(task, cost, 41, 1e-5)
    assert found is not None
    assert found.valleys == 4  # three wells, and the flat that the range begins with
    assert found.task.machine.place == pytest.approx(least + 0.52 * (greatest - least), abs=2e-5)


def test_the_sync_zone_can_have_the_higher_peak() -> None:
    """Far from the middle of the stroke it has, so the return alone would mislead."""
    cut = replace(LONG, length=2.0)
    placed = place_for(Task(CRANK, cut, LIMITS), "peak_acceleration").task.machine
    sync = placed.sync_profile(cut)
    in_sync = sync.peak(2) * cut.line_speed**2
    assert least_limit(Task(placed, cut, LIMITS), "acceleration") >= in_sync * (1 - 1e-5)
    middle = replace(placed, sync_at=placed.sync_at + 0.15)
    sync = middle.sync_profile(cut)
    there = sync.peak(2) * cut.line_speed**2
    assert there > in_sync


def test_where_no_place_will_do_it_is_the_one_where_least_is_missing() -> None:
    cut = replace(LONG, line_speed=6.0)
    placed = place_for(Task(CRANK, cut, LIMITS), "rms_acceleration").task.machine
    assert not math.isnan(placed.sync_at)
    assert not is_feasible(Task(placed, cut, LIMITS))


def test_a_motor_too_weak_for_its_rectangles_is_placed_by_torque() -> None:
    weak = replace(LIMITS, motor=MotorCurve(((0.0, 1.0), (400.0, 1.0))))
    weaker = replace(LIMITS, motor=MotorCurve(((0.0, 0.5), (400.0, 0.5))))
    places = [place_for(Task(CRANK, LONG, limits), "rms_torque").task.machine.sync_at for limits in (weak, weaker)]
    assert places[0] == pytest.approx(places[1], abs=1e-12)


def test_places_whose_sync_zone_is_too_abrupt_are_passed_over() -> None:
    """A zone over much of the stroke begins beside a dead centre at the ends of its range: no reason to refuse the job."""
    crank = CrankSlider(crank=0.29256403348543125, rod=0.6160338419486354)
    cut = Cut(2.62, 0.4, 0.38817596318564507, 0.07, 0.3, 7e-3)
    least, greatest = crank.place_range(cut)
    beside = Task(crank, cut, LIMITS).placed_at(least + 0.01 * (greatest - least))
    assert not can_be_carried(beside)
    for objective in ("rms_jerk", "peak_jerk"):
        assert solve(Task(crank, cut, LIMITS), objective).machine.placed
