"""From a job to a servo-aware design: the reference figures, robustness, and what is refused with a way out that works."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import lru_cache

import numpy as np
import pytest

from camwright.design.optimise import Solution, solve
from camwright.design.optimise_axis import solve_axis
from camwright.design.servo_aware.command_basis import Command
from camwright.profiles.cut import Cut
from camwright.profiles.errors import InfeasibleError, InputError
from camwright.profiles.limits import Limits
from camwright.profiles.machines import CrankSlider, LinearCarriage, RotaryKnife
from camwright.profiles.motor import MotorCurve
from camwright.profiles.servo import Servo
from camwright.profiles.servo_tolerance import ServoTolerance
from camwright.profiles.task import Task
from camwright.validation.motor import greatest_load
from camwright.validation.servo.monte_carlo import shear_zone_errors
from camwright.validation.servo.response import servo_response

# the case A: a knife of 400 mm at 80 m/min with the servo of S1
KNIFE = RotaryKnife(0.4)
PAPER = Servo(120.0, 0.7, 35.0, 0.004, 1.0)
CUT = Cut(0.6, 80 / 60, 0.2, 0.04, 0.16, 1e-4)
LIMITS = Limits(200 / 60, 100.0, 20_000.0)
RANGES = ServoTolerance((108.0, 132.0), (0.63, 0.77), (33.25, 36.75), (0.004, 0.004), (0.0, 0.0))


def peak_acceleration(solution: Solution, cut: Cut) -> float:
    return solution.profile.peak(2) * cut.line_speed**2


@pytest.mark.parametrize(("command", "dearer"), [("shaped", 0.5), ("in_sync", 1.3)])
def test_a_micrometre_at_600_mm_and_what_it_costs(command: Command, dearer: float) -> None:
    cut = replace(CUT, shaped=command == "shaped")
    solution = solve_axis(Task(KNIFE, cut, LIMITS), "sync_error", command, (PAPER,))
    assert servo_response(solution.profile, Task(KNIFE, cut, LIMITS), PAPER).shear_zone_error <= 1e-6
    blind = solve(Task(KNIFE, CUT, LIMITS), "peak_acceleration")
    # a command that need not be in sync all over its sync zone is even softer than the servo-blind one: asked for is 1.05
    assert peak_acceleration(solution, cut) <= dearer * peak_acceleration(blind, CUT)


@lru_cache(maxsize=4)
def robust(length: float) -> tuple[Solution, Cut]:
    cut = replace(CUT, length=length, sync_zone=0.12, shear_zone_at=0.08, shaped=True)
    servos = (PAPER, *RANGES.vertices(PAPER))
    return solve_axis(Task(KNIFE, cut, LIMITS), "sync_error", "shaped", servos, RANGES.between(PAPER)), cut


@pytest.mark.parametrize(("length", "worst"), [(0.213, 1.3e-3), (0.267, 0.15e-3), (0.320, 0.02e-3)])
def test_the_worst_corner_of_the_servos_ranges(length: float, worst: float) -> None:
    solution, cut = robust(length)
    assert solution.axis is not None
    assert solution.axis.error <= worst
    corners = shear_zone_errors(solution.profile, Task(KNIFE, cut, LIMITS), (PAPER, *RANGES.vertices(PAPER)))
    assert np.array(solution.axis.errors) == pytest.approx(corners, abs=1e-9)


@pytest.mark.parametrize("length", [0.213, 0.267, 0.320])
def test_servos_drawn_from_the_ranges_are_hardly_worse_than_its_corners(length: float) -> None:
    solution, cut = robust(length)
    assert solution.axis is not None
    drawn = shear_zone_errors(solution.profile, Task(KNIFE, cut, LIMITS), RANGES.draw(PAPER, 3000, 20160))
    assert drawn.max() <= 1.1 * solution.axis.error


def test_a_nominal_design_is_far_worse_at_the_corners_than_a_robust_one() -> None:
    solution, cut = robust(0.213)
    nominal = solve_axis(Task(KNIFE, cut, LIMITS), "sync_error", "shaped", (PAPER,))
    corners = RANGES.vertices(PAPER)
    assert shear_zone_errors(nominal.profile, Task(KNIFE, cut, LIMITS), (PAPER,)).max() < 2e-6
    worst = shear_zone_errors(nominal.profile, Task(KNIFE, cut, LIMITS), corners).max()
    assert worst > 2 * shear_zone_errors(solution.profile, Task(KNIFE, cut, LIMITS), corners).max()


@pytest.mark.parametrize("command", ["in_sync", "shaped"])
def test_both_origins_are_one_design(command: Command) -> None:
    cut = replace(CUT, length=0.45, shaped=command == "shaped")
    one, other = (
        solve_axis(Task(KNIFE, replace(cut, origin=origin), LIMITS), "peak_acceleration", command, (PAPER,))
        for origin in ("return", "cut")
    )
    from_cut = replace(cut, origin="cut")
    at = np.linspace(0.0, cut.length, 40)
    shift = cut.return_zone + 0.5 * cut.sync_zone  # master zero of one, on the other
    first = one.profile(at + shift, outside="repeat") + Task(KNIFE, cut, LIMITS).slave_zero(one.profile)
    second = other.profile(at) + Task(KNIFE, from_cut, LIMITS).slave_zero(other.profile)
    assert first - second == pytest.approx(np.full(40, KNIFE.pitch), abs=1e-12)


INFEASIBLE: dict[str, tuple[Cut, Command]] = {
    "position": (replace(CUT, length=0.25, sync_zone=0.08, shear_zone_at=0.04), "in_sync"),
    "shaped": (
        replace(CUT, length=0.203, sync_zone=0.1, shear_zone_at=0.06, sync_tolerance=1e-5, shaped=True),
        "shaped",
    ),
    "one command only": (replace(CUT, length=0.24, sync_zone=0.1, shear_zone_at=0.06), "in_sync"),
}
UNITS = {"sync_tolerance": 1e-3, "line_speed": 1 / 60, "length": 1e-3}


@pytest.mark.parametrize("name", INFEASIBLE)
def test_a_tolerance_that_no_command_keeps_is_refused_with_ways_out_that_work(name: str) -> None:
    cut, command = INFEASIBLE[name]
    with pytest.raises(InfeasibleError, match="twice the tolerance over the shear zone") as refused:
        solve_axis(Task(KNIFE, cut, LIMITS), "peak_acceleration", command, (PAPER,))
    error = refused.value
    assert error.excess is not None
    assert error.unit == "mm"
    assert error.binding == ("axis_ratio" if "the ratio binds" in str(error) else "sync_tolerance")
    assert f"sync tolerance = {cut.sync_tolerance:g} m" in str(error)
    only = (
        name == "one command only"
    )  # its axis breaks a limit whatever the tolerance, so no other tolerance alone would do
    assert {each.change for each in error.suggestions} == {"line_speed", "length"} | (
        set() if only else {"sync_tolerance"}
    )
    for each in error.suggestions:
        assert f"{each.change} {each.value:.6g} {each.unit}" in str(error)
        values = {name: getattr(cut, name) for name in UNITS} | {each.change: each.value * UNITS[each.change]}
        changed = replace(
            cut, length=values["length"], line_speed=values["line_speed"], sync_tolerance=values["sync_tolerance"]
        )
        found = solve_axis(Task(KNIFE, changed, LIMITS), "peak_acceleration", command, (PAPER,))
        assert (
            servo_response(found.profile, Task(KNIFE, changed, LIMITS), PAPER).shear_zone_error
            <= changed.sync_tolerance
        )
    if only:
        return
    wider = next(each for each in error.suggestions if each.change == "sync_tolerance")
    assert cut.sync_tolerance * 1e3 + error.excess <= wider.value * (1 + 5e-3)  # the axis keeps its limits there, too
    least = replace(cut, sync_tolerance=0.98 * (cut.sync_tolerance + error.excess * 1e-3))
    with pytest.raises(InfeasibleError):
        solve_axis(Task(KNIFE, least, LIMITS), "peak_acceleration", command, (PAPER,), suggest=False)


def test_the_sync_error_alone_is_made_least_whatever_the_tolerance() -> None:
    cut, command = INFEASIBLE["one command only"]
    solution = solve_axis(Task(KNIFE, cut, LIMITS), "sync_error", command, (PAPER,))
    # the limits leave one motion between the sync zones, that of the servo-blind design
    assert solution.minimised == pytest.approx(
        servo_response(solution.profile, Task(KNIFE, cut, LIMITS), PAPER).shear_zone_error, abs=1e-9
    )
    assert peak_acceleration(solution, cut) == pytest.approx(LIMITS.acceleration, rel=1e-6)
    assert solution.axis is not None
    assert not solution.axis.axis_limits


def test_without_suggestions_none_are_looked_for() -> None:
    cut, command = INFEASIBLE["position"]
    with pytest.raises(InfeasibleError) as refused:
        solve_axis(Task(KNIFE, cut, LIMITS), "peak_acceleration", command, (PAPER,), suggest=False)
    assert refused.value.suggestions == ()
    assert "what works" not in str(refused.value)


@pytest.mark.parametrize("command", ["in_sync", "shaped"])
def test_a_motion_beyond_the_limits_is_the_servo_blind_refusal(command: Command) -> None:
    cut = replace(CUT, length=0.15, sync_zone=0.08, shear_zone_at=0.04, shaped=command == "shaped")
    with pytest.raises(InfeasibleError, match="no motion returns the slave in time"):
        solve_axis(Task(KNIFE, cut, LIMITS), "peak_acceleration", command, (PAPER,))


def test_the_torque_of_a_carriage_without_friction_is_its_acceleration() -> None:
    carriage = LinearCarriage(0.7, mass=100.0, travel_per_turn=0.04)
    cut = replace(CUT, length=1.2, line_speed=0.7, sync_zone=0.25, shear_zone_at=0.2)
    limits = Limits(3.0, 30.0, 2000.0)
    torque, acceleration = (
        solve_axis(Task(carriage, cut, limits), objective, "in_sync", (PAPER,))
        for objective in ("rms_torque", "rms_acceleration")
    )
    assert torque.minimised == pytest.approx(acceleration.minimised, rel=1e-9)
    assert torque.objective_name == "rms_torque"


def test_a_motors_curve_is_kept() -> None:
    knife = RotaryKnife(0.4, gear_ratio=5.0, drum_inertia=0.05)
    cut = replace(CUT, length=0.5, shaped=True)
    free = solve_axis(Task(knife, cut, LIMITS), "peak_jerk", "shaped", (PAPER,))
    torque = peak_acceleration(free, cut) * 0.05 / knife.radius / 5.0
    curve = MotorCurve(((0.0, 0.8 * torque), (300.0, 0.8 * torque)))
    held = solve_axis(Task(knife, cut, replace(LIMITS, motor=curve)), "peak_jerk", "shaped", (PAPER,))
    load, available = greatest_load(held.profile, Task(knife, cut, LIMITS), curve)
    assert abs(load.value) <= available * (1 + 1e-9)
    assert held.minimised >= free.minimised * (1 - 1e-6)


def test_a_crank_that_is_free_is_placed_for_its_axis() -> None:
    """Where it is placed without a servo costs a quarter more at least; no place beside the one found is better by a hundredth."""
    crank = CrankSlider(0.15, 0.6, 0.0)
    cut = replace(CUT, length=0.9, line_speed=0.5, sync_zone=0.15, shear_zone_at=0.1, sync_tolerance=2e-4, shaped=True)
    free, servo = Task(crank, cut, Limits(31.0, 400.0, 20_000.0)), Servo(200.0, 0.7, 60.0, 0.004, 1.0)
    found = solve_axis(free, "peak_acceleration", "shaped", (servo,))
    placed, blind = free.with_machine(found.machine), solve(free, "peak_acceleration").machine
    steps = math.radians(3.0) * np.array([-2, -1, 1, 2])
    tasks = [free.with_machine(blind), *(free.placed_at(placed.machine.place + step) for step in steps.tolist())]
    there, *beside = [solve_axis(task, "peak_acceleration", "shaped", (servo,)).minimised for task in tasks]
    assert found.minimised < min(0.8 * there, 1.01 * min(beside))
    assert servo_response(found.profile, placed, servo).shear_zone_error <= cut.sync_tolerance


def test_an_unstable_servo_is_refused() -> None:
    with pytest.raises(InputError, match=r"the servo is unstable, its largest pole .* it is stable below"):
        solve_axis(Task(KNIFE, CUT, LIMITS), "sync_error", "shaped", (replace(PAPER, position_gain=200.0),))


def test_under_a_motors_curve_the_blind_optimum_is_taken_where_its_axis_will_do() -> None:
    curve = MotorCurve(
        (
            (0.0, 0.007177160213055003),
            (29.140931787413056, 0.0065790635286337535),
            (75.76642264727394, 0.00179429005326375),
        )
    )
    knife = RotaryKnife(0.6491686649467264, blades=3, gear_ratio=9.46768294319795, drum_inertia=0.0017478657475046672)
    zone = 0.04450268185512818
    cut = Cut(0.4355208673051194, 0.6360150674652206, zone, 0.2 * zone, 0.8 * zone, 0.02 * zone, "cut")
    limits = Limits(1.908045202395662, 10.04167043281933, 452.6442649083416, True, curve)
    time = zone / cut.line_speed
    servo = Servo(200.0 / time, 0.8, 40.0 / time, time / 1000, velocity_feedforward=1.0)
    blind = solve(Task(knife, cut, limits), "rms_jerk")
    found = solve_axis(Task(knife, cut, limits), "rms_jerk", "in_sync", (servo,))
    assert found.axis is not None
    assert found.axis.error <= cut.sync_tolerance
    assert found.minimised == pytest.approx(blind.minimised, rel=1e-9)


def test_what_no_motion_can_do_is_answered_with_changes_that_the_axis_keeps_too() -> None:
    """A motion alone would be there at 138 m/min; the axis is in the tolerance from 120 m/min down."""
    cut = Cut(0.9, 170 / 60, 0.2, 0.02, 0.09, 1e-4)
    task = Task(KNIFE, cut, Limits(200 / 60, 30.0, 3000.0))
    with pytest.raises(InfeasibleError) as refused:
        solve_axis(task, "peak_acceleration", "in_sync", (PAPER,))
    speeds = [each.value / 60 for each in refused.value.suggestions if each.change == "line_speed"]
    assert len(speeds) == 1
    assert speeds[0] < 138 / 60
    slower = solve_axis(task.at_speed(speeds[0]), "peak_acceleration", "in_sync", (PAPER,), suggest=False)
    assert slower.axis is not None
    assert slower.axis.error <= cut.sync_tolerance


def test_a_ratio_that_no_command_keeps_is_named_where_the_error_alone_is_kept() -> None:
    cut = Cut(0.215, 1.2, 0.15, 0.045, 0.105, 1.5e-4, shaped=True)
    task = Task(RotaryKnife(0.52), cut, Limits(3.6, 110.0, 22000.0))
    servo = Servo(140.0, 0.8, 40.0, 0.002, 1.0)
    with pytest.raises(InfeasibleError, match="the ratio binds") as refused:
        solve_axis(task, "peak_acceleration", "shaped", (servo,), suggest=False)
    assert refused.value.binding == "axis_ratio"
    alone = solve_axis(task, "sync_error", "shaped", (servo,), suggest=False)
    error = servo_response(alone.profile, task, servo).shear_zone_error
    assert error <= cut.sync_tolerance
    assert f"the error alone is held to {error:.2g}"[:-2] in str(refused.value)
