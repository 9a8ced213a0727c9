"""Designs for a band of line speeds, judged by the validation at each line speed by itself."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from camwright.design.optimise import Solution
from camwright.design.optimise_axis import solve_axis, widest
from camwright.design.servo_aware.axis_problem import AxisProblem
from camwright.design.servo_aware.command_basis import Command
from camwright.design.servo_aware.programme import AxisProgramme
from camwright.profiles.cut import Cut
from camwright.profiles.errors import InfeasibleError
from camwright.profiles.limits import Limits
from camwright.profiles.machines import CrankSlider, LinearCarriage, Machine, RotaryKnife
from camwright.profiles.objective import ObjectiveName
from camwright.profiles.servo import Servo
from camwright.profiles.servo_tolerance import ServoTolerance
from camwright.profiles.task import Task
from camwright.validation.servo.axis_motion import ALLOWANCE, axis_peaks
from camwright.validation.servo.line_speeds import line_speed_errors
from camwright.validation.servo.response import servo_response

PAPER = Servo(120.0, 0.7, 35.0, 0.004, 1.0)
KNIFE = RotaryKnife(0.4)
LIMITS = Limits(200 / 60, 100.0, 20_000.0)
CUT = Cut(0.3, 80 / 60, 0.12, 0.04, 0.08, 1e-4, shaped=True)
BAND = tuple(np.linspace(1.0, 0.1, 41).tolist())
MANY = np.linspace(8.0, 80.0, 200) / 60


def designed(length: float, objective: ObjectiveName = "sync_error") -> tuple[Task, Solution]:
    """Design a shaped command of the published knife and servo for 8 to 80 m/min."""
    task = Task(KNIFE, replace(CUT, length=length), LIMITS)
    return task, solve_axis(task, objective, "shaped", (PAPER,), shares=BAND)


@pytest.mark.parametrize(
    ("length", "most"),
    [
        (0.300, 0.0035e-3),
        pytest.param(0.290, 0.009e-3, marks=pytest.mark.slow),
        pytest.param(0.280, 0.027e-3, marks=pytest.mark.slow),
        (0.272, 0.052e-3),
        pytest.param(0.266, 0.080e-3, marks=pytest.mark.slow),
    ],
)
def test_one_cam_is_in_sync_from_a_tenth_of_the_line_speed_up(length: float, most: float) -> None:
    task, solution = designed(length)
    assert line_speed_errors(solution.profile, task, [PAPER], MANY, 64).max() <= most
    assert solution.axis is not None
    assert solution.axis.axis_limits
    for share in (1.0, 0.9, 0.75, 0.5):
        peaks = axis_peaks(solution.profile, task.at_speed(share * CUT.line_speed).cut, PAPER)
        assert peaks.peak_speed <= LIMITS.speed * (1 + ALLOWANCE)
        assert peaks.peak_acceleration <= LIMITS.acceleration * (1 + ALLOWANCE)


def test_what_is_predicted_is_simulated_at_each_line_speed_by_itself() -> None:
    task, solution = designed(0.28)
    assert solution.axis is not None
    assert solution.axis.error == max(solution.axis.by_speed.values())
    assert set(solution.axis.shares) <= set(solution.axis.by_speed)
    assert len(solution.axis.shares) >= 5
    for share, predicted in solution.axis.by_speed.items():
        slower = task.at_speed(share * CUT.line_speed)
        assert servo_response(solution.profile, slower, PAPER).shear_zone_error == pytest.approx(predicted, abs=1e-9)


def test_designed_for_one_line_speed_it_is_off_at_the_others() -> None:
    task = Task(KNIFE, CUT, LIMITS)
    alone = solve_axis(task, "sync_error", "shaped", (PAPER,))
    assert alone.axis is not None
    assert tuple(alone.axis.by_speed) == alone.axis.shares == (1.0,)
    assert alone.axis.error < 1e-6
    assert line_speed_errors(alone.profile, task, [PAPER], MANY).max() > 2.5e-3


@pytest.mark.parametrize("objective", ["peak_acceleration", "rms_acceleration", "peak_jerk", "rms_jerk"])
def test_with_other_objectives_the_tolerance_holds_at_every_line_speed(objective: ObjectiveName) -> None:
    task, solution = designed(0.3, objective)
    assert line_speed_errors(solution.profile, task, [PAPER], MANY, 64).max() <= CUT.sync_tolerance * (1 + 1e-3)
    single = solve_axis(task, objective, "shaped", (PAPER,))
    assert solution.minimised > 1.5 * single.minimised  # what the band costs


@pytest.mark.parametrize("command", ["in_sync", "shaped"])
@pytest.mark.parametrize(
    ("machine", "cut", "limits"),
    [
        (KNIFE, replace(CUT, length=0.42, shaped=False), LIMITS),
        (
            RotaryKnife(0.8, blades=2, sync="horizontal"),
            replace(CUT, length=0.7, sync_zone=0.1, shear_zone_at=0.06, shaped=False, sync_tolerance=1e-3),
            LIMITS,
        ),
        (LinearCarriage(1.2, home=-0.4), replace(CUT, length=2.0, sync_zone=0.3, shaped=False), LIMITS),
        (
            CrankSlider(0.15, 0.6, 0.02, sync_at=1.7),
            replace(
                CUT, length=1.2, sync_zone=0.1, shear_zone_at=0.05, line_speed=0.6, shaped=False, sync_tolerance=5e-4
            ),
            Limits(40.0, 900.0, 60_000.0),
        ),
    ],
    ids=["tangential", "horizontal", "carriage", "crank"],
)
def test_every_machine_keeps_the_tolerance_over_the_band(
    machine: Machine, cut: Cut, limits: Limits, command: Command
) -> None:
    task = Task(machine, replace(cut, shaped=command == "shaped"), limits)
    solution = solve_axis(task, "rms_acceleration", command, (PAPER,), shares=BAND)
    speeds = np.linspace(0.1, 1.0, 60) * cut.line_speed
    found = line_speed_errors(solution.profile, task.with_machine(solution.machine), [PAPER], speeds, 32)
    assert found.max() <= cut.sync_tolerance * (1 + 1e-3)


@pytest.mark.slow
def test_ranges_of_the_servo_hold_at_their_corners_and_at_every_line_speed() -> None:
    ranges = ServoTolerance((108.0, 132.0), (0.63, 0.77), (33.25, 36.75), (0.004, 0.004), (0.0, 0.0))
    task = Task(KNIFE, replace(CUT, length=0.34), LIMITS)
    servos = (PAPER, *ranges.vertices(PAPER))
    solution = solve_axis(task, "sync_error", "shaped", servos, ranges.between(PAPER), BAND)
    assert solution.axis is not None
    found = line_speed_errors(solution.profile, task, servos, MANY)
    assert found.max() <= 1.02 * solution.axis.error
    nominal = solve_axis(task, "sync_error", "shaped", (PAPER,), shares=BAND)
    assert line_speed_errors(nominal.profile, task, servos, MANY).max() > 1.5 * found.max()


def test_a_band_that_no_command_keeps_is_infeasible() -> None:
    task = Task(KNIFE, replace(CUT, length=0.26, sync_tolerance=2e-5), LIMITS)
    solve_axis(task, "rms_acceleration", "shaped", (PAPER,), suggest=False)
    with pytest.raises(InfeasibleError):
        solve_axis(task, "rms_acceleration", "shaped", (PAPER,), shares=BAND, suggest=False)


@pytest.mark.slow
def test_a_refusal_says_for_which_part_of_the_band_there_is_a_cam() -> None:
    task = Task(KNIFE, replace(CUT, length=0.26, sync_tolerance=2e-5), LIMITS)
    with pytest.raises(InfeasibleError, match=r"what works.*: .*line_speeds from \d.* m/min") as refused:
        solve_axis(task, "rms_acceleration", "shaped", (PAPER,), shares=BAND)
    (part,) = [each for each in refused.value.suggestions if each.change == "line_speeds"]
    slowest = part.value / 60 / CUT.line_speed
    assert refused.value.covered.part == pytest.approx((slowest * CUT.line_speed, CUT.line_speed))
    assert 0.1 < slowest < 1.0
    narrow = tuple(share for share in BAND if share > slowest - 1e-9)
    solution = solve_axis(task, "rms_acceleration", "shaped", (PAPER,), shares=narrow, suggest=False)
    speeds = np.linspace(slowest, 1.0, 80) * CUT.line_speed
    assert line_speed_errors(solution.profile, task, [PAPER], speeds).max() <= task.cut.sync_tolerance * (1 + 1e-3)


@pytest.mark.parametrize("acceleration", [100.0, 300.0])
def test_prices_of_the_least_error_bound_the_peak_that_goes_with_it(acceleration: float) -> None:
    """No command within a hundredth of the least error has a lower peak than the prices say: that one is designed here."""
    task = Task(KNIFE, replace(CUT, length=0.272), replace(LIMITS, acceleration=acceleration))
    problem = AxisProblem(task, "shaped", (PAPER,), False, shares=(1.0, 0.8, 0.5, 0.2))
    programme = AxisProgramme(problem)
    assert programme.least_share_of_limit(2, 1e-2) == 0.0  # nothing is known yet
    found = programme.solve("sync_error", None)
    assert found is not None
    bound = programme.least_share_of_limit(2, 1e-2)
    softer = programme.solve("peak_acceleration", found[1] * (1.0 + 1e-2) / (1.0 - programme.margin))
    assert softer is not None
    share = softer[1] / problem.limits[2][1]
    assert bound <= share + 1e-6
    assert (bound > 0.95) == (acceleration == 100.0)


@pytest.mark.slow
def test_a_cut_that_has_many_best_commands_is_judged_in_the_end() -> None:
    """Nothing is missed at that one line speed, and thousands of vertices are equally good: HiGHS went round among them for minutes."""
    task = Task(KNIFE, replace(CUT, length=0.266, line_speed=34.1739 / 60), LIMITS)
    assert AxisProgramme(AxisProblem(task, "shaped", (PAPER,), True)).keeps()


def test_rectangles_within_others_are_left_out() -> None:
    """Every rectangle left out lies in one that is kept, and none that is kept lies in another."""
    sizes = [(2.7, 21.0), (2.7, 21.0), (2.7, 17.0), (1.0, 21.0), (1.5, 30.0), (3.0, 5.0)]
    rectangles = [replace(LIMITS, speed=speed, acceleration=acceleration) for speed, acceleration in sizes]
    kept = [(each.speed, each.acceleration) for each in widest(rectangles)]
    assert kept == [(3.0, 5.0), (2.7, 21.0), (1.5, 30.0)]
    assert all(any(a <= c and b <= d for c, d in kept) for a, b in sizes)
