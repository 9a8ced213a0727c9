"""Lower bounds for every machine: reached by designs where they are known, and named "none" where they are not."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camwright.design.optimise import solve
from camwright.profiles.cut import Cut
from camwright.profiles.errors import InputError
from camwright.profiles.limits import Limits
from camwright.profiles.machines import (
    CrankSlider,
    LinearCarriage,
    Machine,
    RotaryKnife,
)
from camwright.profiles.objective import MOTION_OBJECTIVES, CommandObjective
from camwright.profiles.returns import baseline
from camwright.profiles.task import Task
from camwright.validation.bounds.optimality import lower_bound
from camwright.validation.motor import measure_motor

CUT = Cut(0.6, 80 / 60, 0.2, 0.04, 0.16, 1e-4, sync_ratio=1.05)
LIMITS = Limits(200 / 60, 60.0, 6000.0)
WIDE = LinearCarriage(5.0, mass=30.0, travel_per_turn=0.04)
KNIFE = RotaryKnife(0.4, gear_ratio=3.0, drum_inertia=0.02)


@pytest.mark.parametrize("machine", [KNIFE, WIDE], ids=["knife", "carriage"])
@pytest.mark.parametrize("objective", ["peak_acceleration", "rms_acceleration", "peak_jerk", "rms_jerk"])
def test_designs_reach_the_bound_with_over_speed(machine: Machine, objective: str) -> None:
    found = solve(Task(machine, CUT, LIMITS), objective)
    bound = lower_bound(found.profile, Task(machine, CUT, LIMITS), objective)
    assert bound.value <= found.minimised * (1 + 1e-9)
    assert bound.value == pytest.approx(found.minimised, rel=1e-3)


def test_the_bound_knows_the_stroke() -> None:
    narrow, limits = replace(WIDE, stroke=0.25), Limits(200 / 60, 200.0, 60_000.0)
    found = solve(Task(narrow, CUT, limits), "rms_acceleration")
    bound = lower_bound(found.profile, Task(narrow, CUT, limits), "rms_acceleration")
    assert 0.999 * found.minimised < bound.value <= found.minimised * (1 + 1e-9)
    free = lower_bound(found.profile, Task(WIDE, CUT, limits), "rms_acceleration")
    assert free.value < 0.98 * bound.value


@pytest.mark.parametrize("objective", ["peak_acceleration", "rms_acceleration", "peak_jerk"])
@pytest.mark.parametrize("length", [3.4, 4.5, 7.0])
def test_a_long_cut_is_as_good_as_braking_within_the_stroke_allows(objective: CommandObjective, length: float) -> None:
    saw = LinearCarriage(1.2)
    cut, limits = Cut(length, 0.5, 0.7, 0.4, 0.2, 2e-4), Limits(100 / 60, 6.0, 200.0)
    found = solve(Task(saw, cut, limits), objective)
    bound = lower_bound(found.profile, Task(saw, cut, limits), objective)
    assert bound.value <= found.minimised * (1 + 1e-9)
    if length == 7.0:  # there is time to spare: braking is all that counts
        square = objective == "rms_acceleration"
        known = "weak duality, multipliers by an interior point" if square else "closed form, braking within the stroke"
        assert bound.method == known
        assert bound.value == pytest.approx(found.minimised, rel=1e-3 if square else 2e-9)


@pytest.mark.parametrize(
    ("stroke", "length", "zone"),
    [(1.2, 0.3, 0.1), (3.0, 0.3, 0.2), (3.0, 1.0, 0.95), (5.0, 0.2, 0.15), (0.32, 0.6, 0.3)],
)
@pytest.mark.parametrize("objective", ["peak_acceleration", "rms_acceleration", "peak_jerk"])
def test_a_wide_stroke_raises_no_bound_above_a_design(
    stroke: float, length: float, zone: float, objective: CommandObjective
) -> None:
    saw, cut = LinearCarriage(stroke), Cut(length, 0.5, zone, 0.2 * zone, 0.8 * zone, 1e-3)
    limits = Limits(100.0, 1e5, 1e8)
    found = solve(Task(saw, cut, limits), objective)
    bound = lower_bound(found.profile, Task(saw, cut, limits), objective)
    assert bound.value <= found.minimised * (1 + 1e-9)
    assert bound.value >= 0.9 * found.minimised


def test_no_room_to_turn_round_in_has_no_bound_below_infinity() -> None:
    # such a job has no design; a cycle of a longer stroke may still be held against it
    saw, cut, limits = LinearCarriage(1.2), Cut(3.0, 0.5, 0.7, 0.4, 0.2, 2e-4), Limits(100 / 60, 6.0, 200.0)
    found = solve(Task(saw, cut, limits), "peak_acceleration")
    assert (
        lower_bound(found.profile, Task(replace(saw, stroke=0.7), cut, limits), "peak_acceleration").value == math.inf
    )


@settings(deadline=None, max_examples=8)
@given(st.floats(0.0, 5.0), st.floats(0.3, 1.5), st.sampled_from(["carriage", "knife"]))
def test_no_baseline_has_less_torque_than_the_bound(friction: float, length: float, kind: str) -> None:
    machine = replace(KNIFE, drum_friction=friction) if kind == "knife" else WIDE
    cut = replace(CUT, length=length)
    open_limits = Limits(100.0, 1e5, 1e8, reversal=True)
    for name in ("poly_3_4_5", "cycloid", "double_s"):
        cycle = baseline(name, Task(machine, cut, LIMITS))
        motor = measure_motor(cycle, Task(machine, cut, LIMITS))
        assert motor.rms_torque >= lower_bound(cycle, Task(machine, cut, open_limits), "rms_torque").value * (1 - 1e-9)
        for objective in ("peak_torque", "energy"):
            bound = lower_bound(cycle, Task(machine, cut, open_limits), objective)
            assert getattr(motor, objective) >= bound.value * (1 - 1e-9)


@pytest.mark.parametrize("objective", ["rms_torque", "peak_torque"])
def test_least_torque_without_friction_reaches_the_bound(objective: str) -> None:
    found = solve(Task(KNIFE, CUT, LIMITS), objective)
    value = getattr(measure_motor(found.profile, Task(KNIFE, CUT, LIMITS)), objective)
    assert lower_bound(found.profile, Task(KNIFE, CUT, LIMITS), objective).value == pytest.approx(value, rel=1e-3)


@pytest.mark.parametrize(
    "machine",
    [CrankSlider(0.15, 0.6, 0.0, 0.5, 20.0, sync_at=1.5), replace(KNIFE, sync="horizontal", circumference=0.8)],
    ids=["crank", "horizontal"],
)
@pytest.mark.parametrize("objective", MOTION_OBJECTIVES)
def test_no_motion_goes_below_its_bound_where_the_ratio_changes_in_sync(machine: Machine, objective: str) -> None:
    task = Task(machine, CUT, Limits(100.0, 1e5, 1e8))
    found = solve(task, objective)
    bound = lower_bound(found.profile, task, objective)
    assert bound.value <= found.minimised * (1 + 1e-9)
    assert bound.value > 0.998 * found.minimised
    if objective.startswith("peak"):
        assert bound.method in ("peak of the sync zone", "closed form, from end to end of the sync zone")
        assert bound.value == pytest.approx(found.minimised, rel=1e-5)


def test_weightless_machines_have_no_bound_and_unknown_objectives_are_refused() -> None:
    cycle = baseline("poly_3_4_5", Task(KNIFE, CUT, LIMITS))
    assert lower_bound(cycle, Task(replace(KNIFE, drum_inertia=0.0), CUT, LIMITS), "rms_torque").method == "none"
    with pytest.raises(InputError, match=r"no objective 'haste'; the objectives are peak_acceleration, "):
        lower_bound(cycle, Task(KNIFE, CUT, LIMITS), "haste")
