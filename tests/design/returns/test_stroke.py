"""The least peak of a slave that keeps to a stroke, and mean squares within it, against closed forms and linear programmes."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import linprog

from camwright.design.optimise import solve
from camwright.design.returns.grids import grid_objective
from camwright.design.returns.least_peaks import least_peak_motion
from camwright.design.returns.measures import kept
from camwright.design.returns.possible import spare
from camwright.design.returns.problem import return_problem
from camwright.design.returns.scaling import ScaledProblem, motion_scale, scale_problem
from camwright.design.returns.touching import touching_motions
from camwright.profiles.cut import Cut
from camwright.profiles.limits import Limits
from camwright.profiles.machines import LinearCarriage, RotaryKnife
from camwright.profiles.objective import MotionObjective
from camwright.profiles.polynomial.profile import FloatArray
from camwright.profiles.task import Task
from camwright.validation.bounds.optimality import lower_bound

SAW = LinearCarriage(stroke=1.2, home=0.0)
CUT = Cut(5.0, 0.8, 0.7, 0.4, 0.2, 2e-4)
ROOM = 0.25
"""What is left of the stroke on either side of the sync zone (m)."""

LIMITS = Limits(100 / 60, 6.0, 200.0)
LOOSE = Limits(100.0, 1e4, 1e7)
V = CUT.line_speed


def scaled(cut: Cut, limits: Limits, objective: MotionObjective = "peak_acceleration") -> ScaledProblem:
    problem = return_problem(Task(SAW, cut, limits), objective)
    return scale_problem(problem, motion_scale(problem))


def test_the_least_jerk_is_that_of_turning_round_in_the_room_there_is() -> None:
    # from line speed to standstill with jerk j alone: t = sqrt(2 v / j), v t 2 / 3 of way, so that j = 8 v³ / (9 way²)
    solution = solve(Task(SAW, CUT, LOOSE), "peak_jerk")
    assert solution.minimised == pytest.approx(8 * V**3 / (9 * ROOM**2), rel=1e-9)
    assert solution.status.name == "OPTIMAL"


def test_the_least_acceleration_is_that_of_braking_in_the_room_there_is() -> None:
    solution = solve(Task(SAW, CUT, LOOSE), "peak_acceleration")
    assert solution.minimised == pytest.approx(V**2 / (2 * ROOM), rel=1e-3)
    assert solution.minimised >= V**2 / (2 * ROOM)  # and never less: the jerk is limited
    place = solution.back.extrema(0)
    assert place[1].value == pytest.approx(ROOM, rel=1e-9)


def least_peak_by_linear_programme(problem: ScaledProblem, order: int, pieces: int = 240) -> float:
    """Least peak of the acceleration (2) or jerk (3), linear on even pieces; ratio and position are limited at the nodes."""
    h, n = 1.0 / pieces, pieces + 1
    to_v = np.tril(np.full((n, n), h)) - 0.5 * h * np.eye(n)
    to_v[:, 0] -= 0.5 * h
    to_v[0] = 0.0
    position = np.zeros((n, n))  # exact integrals of the broken line: h² (a/3 + b/6) on top of the ratio before
    for k in range(pieces):
        position[k + 1] = position[k] + h * to_v[k]
        position[k + 1, k] += h * h / 3
        position[k + 1, k + 1] += h * h / 6
    jerk = (np.eye(n)[1:] - np.eye(n)[:-1]) / h
    line = problem.drift * np.linspace(0.0, 1.0, n)
    peak = np.eye(n) if order == 2 else jerk
    rows, sides = [], []

    def at_most(matrix: FloatArray, bound: FloatArray, lift: float = 0.0) -> None:
        rows.append(np.hstack([matrix, -lift * np.ones((len(matrix), 1))]))
        sides.append(bound)

    for sign in (1.0, -1.0):
        at_most(sign * peak, np.zeros(len(peak)), 1.0)
        at_most(sign * np.eye(n), np.full(n, problem.greatest_slope))
        at_most(sign * jerk, np.full(pieces, problem.greatest_jerk))
    at_most(to_v, np.full(n, problem.greatest_ratio))
    at_most(-to_v, np.full(n, -problem.least_ratio))
    at_most(position, problem.greatest_position - line)
    at_most(-position, line - problem.least_position)
    ends = np.zeros((4, n + 1))
    ends[0, 0] = ends[1, n - 1] = 1.0
    ends[2, :n], ends[3, :n] = to_v[-1], position[-1]
    found = linprog(
        np.append(np.zeros(n), 1.0),
        A_ub=np.vstack(rows),
        b_ub=np.concatenate(sides),
        A_eq=ends,
        b_eq=[0.0, 0.0, problem.end_ratio, problem.height],
        bounds=[(None, None)] * (n + 1),
    )
    assert found.status == 0
    return float(found.fun)


@pytest.mark.parametrize(("length", "speed"), [(3.6, 1.3), (4.5, 0.5), (6.0, 1.5)])
@pytest.mark.parametrize(("objective", "order"), [("peak_acceleration", 2), ("peak_jerk", 3)])
def test_it_is_that_of_a_linear_programme(length: float, speed: float, objective: MotionObjective, order: int) -> None:
    problem = scaled(replace(CUT, length=length, line_speed=speed), LIMITS, objective)
    motion = least_peak_motion(problem)
    assert motion is not None
    found = motion.accelerations if order == 2 else np.diff(motion.accelerations) / np.maximum(motion.lengths, 1e-15)
    value = float(np.abs(found[np.abs(found) < 1e9]).max())
    # even pieces cannot switch where the optimum does, but look at the stroke at the nodes alone
    assert value == pytest.approx(least_peak_by_linear_programme(problem, order), rel=0.03)


@pytest.mark.parametrize("objective", ["rms_acceleration", "rms_jerk"])
def test_a_slower_line_asks_for_no_more_of_a_mean_square(objective: MotionObjective) -> None:
    # over the master the limits are the wider the slower the line, and nothing else changes
    values = []
    for speed in (1.5, 0.8, 0.33):
        cut = replace(CUT, length=6.0, line_speed=speed)
        order = 2 if objective == "rms_acceleration" else 3
        values.append(solve(Task(SAW, cut, LIMITS), objective).minimised / speed**order)
    assert values[1] <= values[0] * (1 + 3e-3)
    assert values[2] <= values[1] * (1 + 3e-3)


@pytest.mark.parametrize(
    ("stroke", "length", "touches"), [(7.0, 5.0, 0), (1.5, 5.0, 0), (1.5, 8.0, 2), (1.2, 5.0, 2), (1.2, 50.0, 2)]
)
def test_a_mean_square_that_touches_the_stroke_is_exact(stroke: float, length: float, touches: int) -> None:
    task = Task(LinearCarriage(stroke), replace(CUT, length=length), LOOSE)
    problem = return_problem(task, "rms_acceleration")
    scale = motion_scale(problem)
    scaled_problem = scale_problem(problem, scale)
    solution = solve(task, "rms_acceleration")
    motion = next(each for each in touching_motions(scaled_problem) if kept(each, scaled_problem) is not None)
    assert len(motion.lengths) == solution.back.pieces == 3 + touches
    assert solution.status.name == "OPTIMAL"
    bound = lower_bound(solution.profile, task, "rms_acceleration").value
    assert bound <= solution.minimised * (1 + 1e-9)
    assert solution.minimised <= bound * (1 + 1e-3)
    assert solution.minimised <= grid_objective(problem) * V**2  # which no motion on a grid is below
    back = solution.back
    for at in back.breaks[2:-2] if touches else ():  # the acceleration is continuous, and the slave turns at the touch
        assert float(back(at, 1)) == pytest.approx(0.0, abs=1e-9)
        assert float(back(at - 1e-12, 2)) == pytest.approx(float(back(at, 2)), abs=1e-4)


def test_a_mean_square_whose_limits_bind_is_no_touching_one() -> None:
    free = scaled(CUT, LOOSE, "rms_acceleration")
    *_, motion = touching_motions(free)
    assert kept(motion, free) is not None
    tight = replace(free, greatest_slope=0.95 * float(np.abs(motion.accelerations).max()))
    assert all(kept(motion, tight) is None for motion in touching_motions(tight))
    assert not list(touching_motions(scaled(CUT, LIMITS)))  # a peak


def test_without_a_stroke_or_a_peak_there_is_none() -> None:
    assert least_peak_motion(scaled(CUT, LIMITS, "rms_jerk")) is None
    free = replace(scaled(CUT, LIMITS), least_position=-np.inf, greatest_position=np.inf)
    assert least_peak_motion(free) is None


def test_limits_that_leave_no_motion_give_none() -> None:
    assert least_peak_motion(scaled(CUT, replace(LIMITS, acceleration=1.0))) is None


def test_a_way_back_without_a_forward_part_is_no_way_to_a_lower_peak() -> None:
    # between the turns the carriage may not go forward at all, which rounding of a velocity of 1e-17 must not forbid
    saw = LinearCarriage(0.17309405007867273)
    cut = Cut(0.704980846682741, 1.1821578129602466, 0.01793840619453351, 0.0035876812389, 0.01435072495563, 1e-3)
    limits = Limits(1.5628178544773472, 65.94676435257745, 1340.5896721788567)
    found = solve(Task(saw, cut, limits), "peak_jerk")
    bound = lower_bound(found.profile, Task(saw, cut, limits), "peak_jerk")
    assert found.status.name == "OPTIMAL"
    assert bound.value <= found.minimised <= 1.01 * bound.value


@pytest.mark.parametrize(("length", "speed"), [(0.25, 0.65), (0.5, 0.65), (0.7, 0.65), (0.7, 2.5)])
@pytest.mark.parametrize(("objective", "order"), [("peak_acceleration", 2), ("peak_jerk", 3)])
def test_between_ends_that_are_no_rests_it_is_that_of_a_grid(
    length: float, speed: float, objective: MotionObjective, order: int
) -> None:
    knife = RotaryKnife(0.8, blades=2, sync="horizontal")
    cut = Cut(length, speed, 0.0869, 0.01, 0.05, 2e-4)
    problem = return_problem(Task(knife, cut, Limits(200 / 60, 60.0, 5000.0)), objective)
    scale = motion_scale(problem)
    asked = scale_problem(problem, scale)
    motion = least_peak_motion(asked)
    assert motion is not None
    profile = kept(motion, asked)
    assert profile is not None  # it keeps every limit
    value = profile.peak(order)
    on_grid = grid_objective(problem) * problem.length**order / abs(scale)
    assert value <= on_grid * (1 + 1e-9)
    assert value >= 0.85 * on_grid
    lower = {"greatest_slope": 0.999 * value} if order == 2 else {"greatest_jerk": 0.999 * value}
    assert not math.isfinite(spare(replace(asked, **lower))) or spare(replace(asked, **lower)) < 0.0
