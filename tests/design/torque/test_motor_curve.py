"""The motor's torque-speed curve, and designs that keep it."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camwright.design.feasible.feasibility import is_feasible
from camwright.design.optimise import solve
from camwright.design.returns.curve_limits import motor_limits
from camwright.design.torque.within_curve import keeps_curve, least_load, load
from camwright.profiles.cut import Cut
from camwright.profiles.errors import InfeasibleError, InputError
from camwright.profiles.limits import Limits
from camwright.profiles.machines import CrankSlider, RotaryKnife
from camwright.profiles.motor import MotorCurve
from camwright.profiles.objective import CommandObjective
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.task import Task
from camwright.validation.motor import measure_motor

KNIFE = RotaryKnife(0.4, gear_ratio=3.0, drum_inertia=0.05, drum_friction=0.4)
CUT = Cut(0.6, 80 / 60, 0.2, 0.04, 0.16, 1e-4)
LIMITS = Limits(200 / 60, 30.0, 3000.0)


def used(profile: CamProfile, machine: RotaryKnife | CrankSlider, cut: Cut) -> tuple[np.ndarray, np.ndarray]:
    """Naive twin: motor speed and torque at many places of the cycle."""
    x = np.linspace(profile.start, profile.end, 20001)
    y = Task(machine, cut, LIMITS).slave_at_start + profile(x)
    velocity = profile(x, 1) * cut.line_speed
    acceleration = profile(x, 2) * cut.line_speed**2
    force = (
        machine.inertia(y) * acceleration
        + 0.5 * machine.inertia_slope(y) * velocity**2
        + machine.friction * np.sign(velocity)
    )
    return velocity * machine.motor_ratio, force / machine.motor_ratio


@pytest.mark.parametrize(
    ("points", "message"),
    [
        (((0.0, 1.0),), "two points at least"),
        (((0.0, 1.0), (1.0, 2.0)), r"point 2: torque 2 N·m is above 1 N·m at a lower speed.*give at most 1 N·m"),
        (((0.0, 2.0), (0.0, 1.0)), r"point 2: speed 0 rad/s is not above 0 rad/s"),
        (((1.0, 2.0), (2.0, 1.0)), "begins at standstill; its first speed is 1 rad/s"),
        (((0.0, 1.0), (1.0, 0.0)), "point 2: torque 0 N·m is not positive"),
    ],
)
def test_a_curve_that_is_none_is_refused(points: tuple[tuple[float, float], ...], message: str) -> None:
    with pytest.raises(InputError, match=message):
        MotorCurve(points)


def test_torque_between_and_beyond_the_points() -> None:
    curve = MotorCurve(((0.0, 10.0), (100.0, 10.0), (200.0, 4.0)))
    assert curve.torque(np.array([0.0, -50.0, 150.0, 200.0, 200.1])).tolist() == [10.0, 10.0, 7.0, 4.0, 0.0]
    assert curve.top_speed == 200.0


@given(st.lists(st.tuples(st.floats(0.1, 100.0), st.floats(0.0, 10.0)), min_size=1, max_size=6), st.floats(0.5, 50.0))
def test_every_rectangle_lies_under_the_curve(steps: list[tuple[float, float]], last: float) -> None:
    speeds = np.concatenate([[0.0], np.cumsum([width for width, _ in steps])])
    torques = last + np.concatenate([np.cumsum([drop for _, drop in steps][::-1])[::-1], [0.0]])
    curve = MotorCurve(tuple(zip(speeds.tolist(), torques.tolist(), strict=True)))
    for speed, torque in curve.rectangles():
        below = np.linspace(0.0, speed, 50)
        assert (curve.torque(below) >= torque * (1 - 1e-12)).all()


@pytest.mark.parametrize("objective", ["peak_acceleration", "rms_torque", "peak_jerk"])
@pytest.mark.parametrize("torque", [20.0, 3.4])
def test_a_design_keeps_the_curve(objective: str, torque: float) -> None:
    curve = MotorCurve(((0.0, torque), (50.0, torque), (110.0, 0.4 * torque)))
    solution = solve(Task(KNIFE, CUT, replace(LIMITS, motor=curve)), objective)  # type: ignore[arg-type]
    speed, needed = used(solution.profile, KNIFE, CUT)
    assert (np.abs(needed) <= curve.torque(speed) * (1 + 1e-9)).all()


def test_a_crank_keeps_the_curve() -> None:
    crank = CrankSlider(0.15, 0.6, 0.0, 0.5, 20.0, 5.0)
    cut = Cut(0.9, 1.0, 0.1, 0.04, 0.06, 1e-4)
    curve = MotorCurve(((0.0, 12.0), (30.0, 12.0), (80.0, 6.0)))
    solution = solve(Task(crank, cut, Limits(30.0, 200.0, 20000.0, motor=curve)), "peak_acceleration")
    speed, needed = used(solution.profile, solution.machine, cut)  # type: ignore[arg-type]
    assert (np.abs(needed) <= curve.torque(speed) * (1 + 1e-9)).all()


def test_a_strong_motor_changes_nothing() -> None:
    plain = solve(Task(KNIFE, CUT, LIMITS), "peak_acceleration")
    strong = solve(Task(KNIFE, CUT, replace(LIMITS, motor=MotorCurve(((0.0, 1e3), (1e4, 1e3))))), "peak_acceleration")
    assert strong.minimised == pytest.approx(plain.minimised, rel=1e-9)


@pytest.mark.slow
def test_a_weak_motor_binds_and_the_suggestion_works() -> None:
    limits = replace(LIMITS, motor=MotorCurve(((0.0, 2.2), (110.0, 2.2))))
    with pytest.raises(InfeasibleError, match=r"motor binds") as caught:
        solve(Task(KNIFE, CUT, limits), "peak_acceleration")
    assert caught.value.binding == "motor"
    slower = next(s for s in caught.value.suggestions if s.change == "line_speed")
    assert (
        solve(Task(KNIFE, replace(CUT, line_speed=slower.value / 60), limits), "peak_acceleration").status.value
        == "optimal"
    )


CRANK = CrankSlider(0.15, 0.6, 0.0, 0.5, 20.0, 5.0, 1.75)
SHEAR = Cut(0.9, 1.0, 0.1, 0.04, 0.06, 1e-4)


@pytest.mark.parametrize("objective", ["rms_torque", "peak_acceleration"])
def test_a_crank_keeps_its_motors_curve_where_no_rectangle_does(objective: CommandObjective) -> None:
    """The curve falls: much torque at low speed, little at the speed of the quick return."""
    limits = Limits(40.0, 400.0, 40000.0, motor=MotorCurve(((0.0, 30.0), (40.0, 20.0), (80.0, 7.0), (150.0, 4.0))))
    cut = replace(SHEAR, length=0.5)
    assert not any(is_feasible(Task(CRANK, cut, each)) for each in motor_limits(CRANK, limits))
    found = solve(Task(CRANK, cut, limits), objective)
    speed, torque = used(found.profile, CRANK, cut)
    assert limits.motor is not None
    assert (np.abs(torque) <= limits.motor.torque(speed)).all()
    assert keeps_curve(found.profile, Task(CRANK, cut, LIMITS), limits.motor)
    without = solve(Task(CRANK, cut, replace(limits, motor=None)), objective)
    assert found.minimised >= without.minimised * (1 - 1e-3)
    load = least_load(Task(CRANK, cut, limits))
    assert load is not None
    assert load.value < 1.0


def test_the_least_load_is_below_that_of_every_other_optimum() -> None:
    limits = Limits(40.0, 400.0, 40000.0, motor=MotorCurve(((0.0, 18.0), (80.0, 12.0), (150.0, 4.0))))
    easiest = least_load(Task(CRANK, SHEAR, limits))
    assert easiest is not None
    assert limits.motor is not None
    for objective in ("rms_torque", "rms_acceleration"):
        other = solve(Task(CRANK, SHEAR, replace(limits, motor=None)), objective)
        assert easiest.value <= load(other.profile, Task(CRANK, SHEAR, LIMITS), limits.motor) * (1 + 1e-2)


def test_low_speeds_have_rectangles_where_the_torque_grows_with_the_speed() -> None:
    weak = Limits(40.0, 400.0, 40000.0, motor=MotorCurve(((0.0, 3.0), (150.0, 3.0))))
    speeds = [each.speed for each in motor_limits(CRANK, weak)]
    assert min(speeds) == pytest.approx(150.0 / 5.0 / 64)
    assert is_feasible(Task(CRANK, replace(SHEAR, line_speed=0.02), weak))


def test_a_motor_that_cannot_overcome_friction_leaves_no_limits() -> None:
    weak = replace(LIMITS, motor=MotorCurve(((0.0, 0.1), (200.0, 0.1))))
    assert motor_limits(KNIFE, weak) == ()


def test_an_open_place_on_the_crank_is_chosen_within_the_curve() -> None:
    limits = Limits(40.0, 400.0, 40000.0, motor=MotorCurve(((0.0, 30.0), (40.0, 20.0), (80.0, 7.0), (150.0, 4.0))))
    task = Task(replace(CRANK, sync_at=math.nan), SHEAR, limits)
    found = solve(task, "rms_torque")
    assert limits.motor is not None
    assert keeps_curve(found.profile, task.with_machine(found.machine), limits.motor)


@pytest.mark.slow
def test_a_knife_that_rubs_stands_within_its_motors_curve() -> None:
    """Friction helps to brake, so the slave may stand; within the best rectangle of the curve it could not, at 8 % more torque."""
    machine = RotaryKnife(
        0.37597742818698415,
        blades=2,
        gear_ratio=4.816549831264954,
        drum_inertia=0.007823201562921376,
        drum_friction=2.8043061463242696,
    )
    cut = Cut(1.3515559288961103, 2.3873120989214884, 0.036794373915357795, 0.0073588, 0.0294354, 0.0007358875, "cut")
    curve = MotorCurve(((0.0, 1.59138), (177.9028, 1.59138), (296.5047, 0.8762)))
    task = Task(machine, cut, Limits(4.4933, 603.4876, 7878.3152, reversal=True, motor=curve))
    solution = solve(task, "rms_torque")
    assert keeps_curve(solution.profile, task, curve)
    torque = measure_motor(solution.profile, task).rms_torque
    assert torque is not None
    assert torque <= 0.5735 * 1.005  # a multi-start programme of the benchmark's own
