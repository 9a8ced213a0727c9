"""Servo-aware programmes: each objective against an independent road, limits and tolerance by exact extrema, the reference figures."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import linprog

from camwright.design.optimise import solve
from camwright.design.optimise_axis import solve_axis
from camwright.design.servo_aware.axis_motion import design_axis
from camwright.design.servo_aware.axis_problem import AxisProblem
from camwright.design.servo_aware.axis_response import Axis
from camwright.design.servo_aware.command_basis import INTERVALS, Command, command_basis
from camwright.design.servo_aware.gathered_rows import LEAST_ERROR
from camwright.design.servo_aware.programme import (
    BAND_MARGIN,
    AxisProgramme,
)
from camwright.design.servo_aware.rows import RATIO
from camwright.profiles.cut import Cut
from camwright.profiles.errors import InfeasibleError
from camwright.profiles.limits import Limits
from camwright.profiles.machines import (
    CrankSlider,
    LinearCarriage,
    Machine,
    RotaryKnife,
)
from camwright.profiles.objective import ObjectiveName
from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.profiles.returns import assemble
from camwright.profiles.servo import Servo
from camwright.profiles.task import Task
from camwright.validation.report import judge
from camwright.validation.servo.response import servo_response

KNIFE = RotaryKnife(0.4)
PAPER = Servo(120.0, 0.7, 35.0, 0.004, 1.0)
CUT = Cut(0.45, 80 / 60, 0.15, 0.04, 0.11, 1e-4)
LIMITS = Limits(200 / 60, 100.0, 20_000.0)
COSTS: tuple[ObjectiveName, ...] = ("sync_error", "peak_acceleration", "rms_acceleration", "peak_jerk", "rms_jerk")
BOTH = pytest.mark.parametrize("command", ["in_sync", "shaped"])


def problem(command: Command, *, axis_limits: bool = False) -> AxisProblem:
    return AxisProblem(Task(KNIFE, CUT, LIMITS), command, (PAPER,), axis_limits)


def rows_of_its_own(command: Command, places: int, *, banded: bool) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Rows ``matrix @ z <= high`` made once at evenly spread places and times, and those of the sync error over the tolerance."""
    basis, axis = command_basis(Task(KNIFE, CUT, LIMITS), command), Axis(Task(KNIFE, CUT, LIMITS), PAPER)
    v = CUT.line_speed
    matrices, highs = [], []

    def between(matrix: FloatArray, constant: FloatArray, low: float, high: float) -> None:
        size = max(abs(low), abs(high))
        matrices.extend([matrix / size, -matrix / size])
        highs.extend([(high - constant) / size, (constant - low) / size])

    for order, low, high in (
        (1, 0.0, LIMITS.speed / v),
        (2, -100.0 / v**2, 100.0 / v**2),
        (3, -2e4 / v**3, 2e4 / v**3),
    ):
        between(*basis.differences[order], low, high)
    start, end = axis.shear_zone
    at, after = (part.ravel() for part in np.meshgrid(np.linspace(start, end, places), np.arange(16) * 0.004 / 16))
    if banded:
        matrix, constant = axis.rows(basis.rows, at, after)
        room = CUT.sync_tolerance * (1 - BAND_MARGIN)
        between(matrix, constant - axis.ideal(at)[0], -room, room)
        matrix, constant = axis.rows(basis.rows, at, after, 1)
        room *= RATIO / CUT.shear_zone
        between(matrix, constant - 1.0, -room, room)
    return np.vstack(matrices), np.concatenate(highs), at


@BOTH
@pytest.mark.parametrize(("cost", "order"), [("peak_acceleration", 2), ("peak_jerk", 3)])
def test_the_least_peak_is_that_of_scipy(command: Command, cost: ObjectiveName, order: int) -> None:
    found = design_axis(problem(command), cost)
    assert found is not None
    matrix, high, _ = rows_of_its_own(command, 9, banded=True)
    peak, constant = command_basis(Task(KNIFE, CUT, LIMITS), command).differences[order]
    ones = np.ones((len(peak), 1))
    bounded = np.hstack([matrix, np.zeros((len(matrix), 1))])
    goal = np.zeros(matrix.shape[1] + 1)
    goal[-1] = 1.0
    size = 100.0 / CUT.line_speed**order  # what the peak is counted in
    answer = linprog(
        goal,
        A_ub=np.vstack([bounded, np.hstack([peak / size, -ones]), np.hstack([-peak / size, -ones])]),
        b_ub=np.concatenate([high, -constant / size, constant / size]),
        bounds=[(None, None)] * len(goal),
        method="highs-ipm",
    )
    # its rows stand at other places than those of a design
    assert found.value == pytest.approx(answer.fun * size, rel=5e-3)


@BOTH
@pytest.mark.parametrize(("cost", "order"), [("rms_acceleration", 2), ("rms_jerk", 3)])
def test_the_least_mean_square_lies_on_its_own_tangent(command: Command, cost: ObjectiveName, order: int) -> None:
    # of a convex function f at the answer p: f >= f(p) + f'(p) (z - p), whose least value is a linear programme
    found = AxisProgramme(problem(command)).solve(cost, 1.0)
    assert found is not None
    at = found[0] * KNIFE.pitch
    basis = command_basis(Task(KNIFE, CUT, LIMITS), command)
    matrix, constant = basis.differences[order]
    values, widths = matrix @ at + constant, np.diff(basis.nodes) / basis.nodes[-1]
    if order == 3:
        square, slope = widths @ values**2, 2 * widths * values
    else:  # Simpson's rule, exact for the square of a straight line
        a, b = values[:-1], values[1:]
        square = widths @ (a**2 + (a + b) ** 2 + b**2) / 6
        slope = np.zeros(len(values))
        slope[:-1] += widths * (2 * a + b) / 3
        slope[1:] += widths * (a + 2 * b) / 3
    assert found[1] == pytest.approx(np.sqrt(square), rel=1e-9)
    rows, high, _ = rows_of_its_own(command, 9, banded=True)
    gradient = (slope @ matrix) / square
    least = linprog(gradient, A_ub=rows, b_ub=high, bounds=[(None, None)] * len(gradient), method="highs-ipm")
    assert gradient @ at - least.fun <= 0.02  # of the square: a hundredth of the root


@BOTH
def test_the_least_sync_error_is_that_of_scipy(command: Command) -> None:
    found = AxisProgramme(problem(command)).solve("sync_error", None)
    assert found is not None
    matrix, high, at = rows_of_its_own(command, 9, banded=False)
    basis, axis = command_basis(Task(KNIFE, CUT, LIMITS), command), Axis(Task(KNIFE, CUT, LIMITS), PAPER)
    error, constant = axis.rows(basis.rows, at, np.repeat(np.arange(16) * 0.004 / 16, 9))
    error, constant = error / CUT.sync_tolerance, (constant - axis.ideal(at)[0]) / CUT.sync_tolerance
    ones = np.ones((len(error), 1))
    answer = linprog(
        np.append(np.zeros(matrix.shape[1]), 1.0),
        A_ub=np.vstack(
            [np.hstack([matrix, np.zeros((len(matrix), 1))]), np.hstack([error, -ones]), np.hstack([-error, -ones])]
        ),
        b_ub=np.concatenate([high, -constant, constant]),
        bounds=[(None, None)] * (matrix.shape[1] + 1),
        method="highs-ipm",
    )
    assert found[1] == pytest.approx(answer.fun, rel=0.01, abs=2 * LEAST_ERROR)


def keeps_limits(profile: CamProfile, limits: Limits, v: float, *, back: bool) -> bool:
    """Whether the exact extrema of a command are within the limits to 1e-9 of them."""
    for order, limit in ((1, limits.speed), (2, limits.acceleration), (3, limits.jerk)):
        least, greatest = (each.value * v**order for each in profile.extrema(order))
        low = -limit if order > 1 or back else 0.0
        if greatest > limit * (1 + 1e-9) or least < low - 1e-9 * limit:
            return False
    return True


STIFF = Servo(600.0, 0.8, 150.0, 0.001, 1.0)
CASES: dict[str, tuple[Machine, Cut, Limits, Servo]] = {
    "tangential": (KNIFE, CUT, LIMITS, PAPER),
    "two blades, from the cut": (
        RotaryKnife(0.8, blades=2),
        replace(CUT, origin="cut", sync_ratio=1.02),
        LIMITS,
        PAPER,
    ),
    "horizontal": (
        RotaryKnife(0.8, blades=2, sync="horizontal"),
        replace(CUT, length=0.5, line_speed=0.4),
        LIMITS,
        STIFF,
    ),
    "carriage": (LinearCarriage(0.7), replace(CUT, length=1.2, line_speed=0.7), Limits(3.0, 30.0, 2000.0), PAPER),
    "crank": (
        CrankSlider(0.15, 0.6, 0.02, sync_at=1.4),
        replace(CUT, length=0.9, line_speed=0.5, sync_zone=0.15),
        Limits(31.0, 400.0, 20_000.0),
        STIFF,
    ),
}


@pytest.mark.parametrize("name", CASES)
@BOTH
@pytest.mark.parametrize("objective", ["sync_error", "peak_acceleration", "rms_jerk"])
def test_every_machine_keeps_limits_closure_and_tolerance(
    name: str, command: Command, objective: ObjectiveName
) -> None:
    machine, cut, limits, servo = CASES[name]
    cut = replace(cut, shaped=command == "shaped")
    solution = solve_axis(Task(machine, cut, limits), objective, command, (servo,))
    profile, axis = solution.profile, solution.axis
    assert axis is not None
    assert profile.advance == pytest.approx(machine.pitch, abs=1e-12)
    assert keeps_limits(profile, limits, cut.line_speed, back=machine.turns_back)
    simulated = servo_response(profile, Task(machine, cut, LIMITS), servo).shear_zone_error
    assert axis.errors[0] == pytest.approx(simulated, abs=1e-9)
    assert simulated <= cut.sync_tolerance
    report = judge(profile, Task(machine, cut, limits), servo, servo_aware=True)
    failed = {check.name for check in report.checks if not check.passed}
    assert failed <= (set() if axis.axis_limits else {"axis_speed", "axis_acceleration", "axis_reversal"})


@BOTH
def test_with_dead_time_and_lead_the_prediction_is_the_simulation(command: Command) -> None:
    servo = replace(PAPER, velocity_feedforward=0.95, dead_time=0.0043, lead_time=0.004)
    cut = replace(CUT, shaped=command == "shaped")
    solution = solve_axis(Task(KNIFE, cut, LIMITS), "sync_error", command, (servo,))
    assert solution.axis is not None
    simulated = servo_response(solution.profile, Task(KNIFE, cut, LIMITS), servo).shear_zone_error
    assert solution.axis.error == pytest.approx(simulated, abs=1e-9)
    if command == "shaped":  # makes up for what no command in sync can
        assert simulated < 1e-6


@settings(max_examples=8)
@given(
    st.floats(0.25, 1.2),
    st.floats(0.4, 2.0),
    st.floats(0.3, 0.7),
    st.floats(0.01, 0.08),
    st.floats(3e-5, 5e-4),
    st.sampled_from([0.001, 0.002, 0.004]),
    st.sampled_from(["in_sync", "shaped"]),
    st.sampled_from(COSTS),
)
def test_random_knife_jobs_end_in_a_design_that_holds_or_in_a_way_out(
    length: float,
    v: float,
    share: float,
    shear: float,
    tolerance: float,
    sample: float,
    command: Command,
    cost: ObjectiveName,
) -> None:
    zone = share * min(length, 0.4)
    cut = Cut(length, v, zone, min(shear, zone), zone - min(shear, zone), tolerance, shaped=command == "shaped")
    servo = replace(PAPER, sample_time=sample)
    try:
        solution = solve_axis(Task(KNIFE, cut, LIMITS), cost, command, (servo,), suggest=False)
    except InfeasibleError:
        return
    axis = solution.axis
    assert axis is not None
    assert keeps_limits(solution.profile, LIMITS, v, back=False)
    simulated = servo_response(solution.profile, Task(KNIFE, cut, LIMITS), servo).shear_zone_error
    assert axis.errors[0] == pytest.approx(simulated, abs=1e-9)
    if cost != "sync_error":
        assert simulated <= tolerance
    report = judge(solution.profile, Task(KNIFE, cut, LIMITS), servo, servo_aware=True)
    names = {check.name for check in report.checks if not check.passed}
    allowed = {"shear_zone_error"} if cost == "sync_error" else set()
    assert names <= (allowed if axis.axis_limits else allowed | {"axis_speed", "axis_acceleration", "axis_reversal"})


def test_the_peak_is_softened_and_smoothed_in_turn() -> None:
    gentle = AxisProgramme(problem("shaped")).solve("peak_acceleration", 1.0)
    motion = design_axis(problem("shaped"), "peak_acceleration")
    assert gentle is not None
    assert motion is not None
    v = CUT.line_speed
    raw = AxisProgramme(problem("shaped")).profile(gentle[0])

    def rms_jerk(profile: CamProfile) -> float:
        jerk = profile(0.5 * (profile.breaks[1:] + profile.breaks[:-1]), 3)
        return float(np.sqrt((jerk**2 * np.diff(profile.breaks)).sum() / profile.length)) * v**3

    assert rms_jerk(motion.profile) < rms_jerk(raw)
    peak = motion.profile.peak(2)
    assert peak <= motion.value * (1 + 2e-5)


def test_a_motion_of_even_speed_is_found_where_it_will_do() -> None:
    even = replace(CUT, length=0.4, shaped=True)  # the cut length is the pitch
    least: dict[ObjectiveName, float] = {"peak_acceleration": 1e-6, "peak_jerk": 1e-6, "rms_jerk": 1e-4 * LIMITS.jerk}
    for objective, rounding in least.items():
        solution = solve_axis(Task(KNIFE, even, LIMITS), objective, "shaped", (PAPER,))
        assert solution.minimised == pytest.approx(0.0, abs=rounding)
        assert float(solution.profile(0.2, 1)) == pytest.approx(1.0, abs=1e-4)


def test_the_limits_of_the_axis_are_given_up_only_for_the_tolerance() -> None:
    tight = replace(CUT, length=0.206, sync_zone=0.1, shear_zone_at=0.06, sync_tolerance=1e-5, shaped=True)
    given_up = solve_axis(Task(KNIFE, tight, LIMITS), "sync_error", "shaped", (PAPER,)).axis
    loose = solve_axis(Task(KNIFE, replace(tight, length=0.35), LIMITS), "sync_error", "shaped", (PAPER,)).axis
    assert given_up is not None
    assert loose is not None
    assert (given_up.axis_limits, loose.axis_limits) == (False, True)
    assert given_up.error < 1e-5
    held = AxisProgramme(AxisProblem(Task(KNIFE, tight, LIMITS), "shaped", (PAPER,), True))
    assert not held.reaches()
    assert INTERVALS["shaped"] == len(held.problem.basis.nodes) - 1


LONG = Cut(0.6, 80 / 60, 0.2, 0.04, 0.16, 1e-4)


def test_the_blind_optimum_is_taken_where_its_axis_keeps_to_everything() -> None:
    blind = solve(Task(KNIFE, LONG, LIMITS), "rms_acceleration")
    solution = solve_axis(Task(KNIFE, LONG, LIMITS), "rms_acceleration", "in_sync", (PAPER,))
    assert solution.axis is not None
    assert solution.axis.programmes == 0
    assert solution.status == blind.status
    assert solution.minimised == pytest.approx(blind.minimised, rel=1e-12)
    assert solution.axis.error <= LONG.sync_tolerance
    x = np.linspace(0.0, LONG.length, 400)
    np.testing.assert_allclose(solution.profile(x), blind.profile(x), atol=1e-12)


def test_rows_begin_where_the_blind_optimum_fails() -> None:
    # its axis swings back beyond standstill by a little, which it may not: one more programme, no more
    blind = solve(Task(KNIFE, LONG, LIMITS), "rms_jerk")
    programme = AxisProgramme(AxisProblem(Task(KNIFE, LONG, LIMITS), "in_sync", (PAPER,), True, blind.back))
    assert not programme.holds(assemble(blind.back, Task(KNIFE, LONG, LIMITS)))
    assert AxisProgramme(replace(programme.problem, axis_limits=False)).holds(
        assemble(blind.back, Task(KNIFE, LONG, LIMITS))
    )
    found = programme.solve("rms_jerk", 1.0)
    assert found is not None
    assert programme.solved == 1
    assert programme.holds(programme.profile(found[0]))


def test_limits_of_a_shaped_command_hold_though_their_rows_come_late() -> None:
    cut = replace(LONG, length=0.38, shaped=True)
    free = solve_axis(Task(KNIFE, cut, LIMITS), "rms_jerk", "shaped", (PAPER,))
    reached = free.profile.extrema(1)[1].value * cut.line_speed
    least = cut.line_speed * KNIFE.pitch / cut.length  # at even speed
    tight = replace(LIMITS, speed=0.5 * (reached + least))
    solution = solve_axis(Task(KNIFE, cut, tight), "rms_jerk", "shaped", (PAPER,))
    greatest = solution.profile.extrema(1)[1].value * cut.line_speed
    # the hull of its coefficients keeps the limit, which its peak comes near to
    assert tight.speed * (1 - 5e-3) <= greatest <= tight.speed * (1 + 1e-9)
    assert solution.minimised > free.minimised
