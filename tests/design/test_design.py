"""The optimal cycle of a rotary knife: closed forms, HiGHS as an independent road, random jobs, degenerate jobs."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise
from typing import Any, get_args

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import linprog
from scipy.sparse import csr_array, eye_array, hstack, vstack

from camwright.design.optimise import Solution, solve
from camwright.design.returns.ipopt import SolveStatus
from camwright.profiles.closed_forms.reach import (
    fastest,
    least_acceleration,
    least_jerk,
    shortest_return_length,
)
from camwright.profiles.cut import Cut
from camwright.profiles.errors import InfeasibleError
from camwright.profiles.limits import Limits
from camwright.profiles.machines import RotaryKnife
from camwright.profiles.objective import MotionObjective
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.returns import BASELINES, baseline
from camwright.profiles.task import Task

FREE = Limits(math.inf, math.inf, math.inf)
"""Nothing here asks for limits."""

OBJECTIVES: tuple[MotionObjective, ...] = get_args(MotionObjective)
Job = tuple[RotaryKnife, Cut, Limits, MotionObjective]

PAPER = (RotaryKnife(0.4), Cut(0.6, 80 / 60, 0.2, 0.04, 0.16, 1e-4), Limits(200 / 60, 30.0, 3000.0))

# A motion of height D over the line in the time T, all in one: the slave has to make up 0.2 m in 1 s.
D, T = 0.2, 1.0
LOOSE = Limits(speed=1e3, acceleration=1e9, jerk=1e12)


def correction(
    objective: MotionObjective, jerk: float = math.inf, speed: float = math.inf, acceleration: float = math.inf
) -> float:
    """Optimal objective of the motion of height D in time T, in units of D/T² or D/T³, its limits in such units too."""
    limits = Limits(min(1.0 + speed * D / T, 1e3), min(acceleration * D / T**2, 1e9), min(jerk * D / T**3, 1e12))
    result = solve(Task(RotaryKnife(1.5 + D), Cut(1.5, 1.0, 0.5, 0.0, 0.0, 1e-4), limits), objective)
    assert result.status is SolveStatus.OPTIMAL
    return result.minimised / (D / T ** order_of(objective))


def order_of(objective: str) -> int:
    """Order of the derivative over time that an objective measures."""
    return 2 if objective.endswith("acceleration") else 3


def worst_excess(profile: CamProfile, cut: Cut, limits: Limits) -> float:
    """Largest share by which a whole cycle exceeds a limit, over time."""
    v = cut.line_speed
    low, high = profile.extrema(1)
    peaks = [max(-least.value, greatest.value) for least, greatest in (profile.extrema(2), profile.extrema(3))]
    return max(
        v * high.value / limits.speed - 1,
        ((-limits.speed if limits.reversal else 0.0) - v * low.value) / limits.speed,
        v**2 * peaks[0] / limits.acceleration - 1,
        v**3 * peaks[1] / limits.jerk - 1,
    )


def check_cycle(result: Solution, machine: RotaryKnife, cut: Cut, limits: Limits) -> None:
    """Check what every design promises, at every point of the cycle."""
    profile = result.profile
    assert worst_excess(profile, cut, limits) <= 1e-9
    assert (profile.start, profile.end) == (0.0, cut.length)
    assert float(profile(0.0)) == 0.0
    assert profile.advance == pytest.approx(machine.pitch, rel=1e-12)
    assert np.abs(profile.jumps(0)).max() <= 1e-12 * machine.pitch
    assert np.abs(profile.jumps(1)).max() <= 1e-9
    slope = limits.acceleration / cut.line_speed**2
    assert np.abs(profile.jumps(2)).max() <= 1e-9 * slope
    for start, end in cut.sync_parts:
        low, high = profile.restrict(start, end).extrema(1)
        assert abs(low.value - 1.0) <= 1e-12 or low.at in (start, end)  # the side of the return at the zone's ends
        inside = np.linspace(start, end, 52)[1:-1]
        assert np.abs(profile(inside, 1) - 1.0).max() <= 1e-12
        assert not profile(inside, 2).any()
        assert high.value <= 1.0 + 1e-9
    order = order_of(result.objective_name)
    back = profile.restrict(cut.return_start, cut.return_start + cut.return_zone)
    measured = math.sqrt(back.mean_square(order)) if result.objective_name.startswith("rms") else profile.peak(order)
    assert result.minimised == pytest.approx(measured * cut.line_speed**order, rel=1e-9, abs=1e-300)


# -- closed forms ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("jerk", [32.01, 33, 36, 40, 50, 64, 100, 200, 500, 1e3, 3e3, 1e4, 3e4, 1e5])
def test_peak_acceleration_under_a_jerk_limit(jerk: float) -> None:
    """``D = A T²/4 - A² T/(2 J)``."""
    a = correction("peak_acceleration", jerk)
    expected = 4 * 2 / (1 + math.sqrt(1 - 32 / jerk))
    assert a == pytest.approx(expected, rel=1e-6)
    assert a / 4 - a**2 / (2 * jerk) == pytest.approx(1.0, rel=1e-6)


@pytest.mark.parametrize("jerk", [33, 100, 1e5, math.inf])
def test_peak_jerk_is_32(jerk: float) -> None:
    assert correction("peak_jerk", jerk) == pytest.approx(32.0, rel=1e-6)


@pytest.mark.parametrize("jerk", [60.0, 100.0, 1e5, math.inf])
def test_rms_jerk_is_that_of_the_quintic(jerk: float) -> None:
    assert correction("rms_jerk", jerk) == pytest.approx(math.sqrt(720), rel=1e-6)


@pytest.mark.parametrize(("objective", "least"), [("peak_acceleration", 4.0), ("rms_acceleration", math.sqrt(12))])
def test_least_acceleration_is_approached_from_above(objective: MotionObjective, least: float) -> None:
    values = [correction(objective, jerk) for jerk in (50.0, 200.0, 1e3, 1e4, 1e5)]
    assert all(before > after for before, after in pairwise(values))
    assert values[-1] > least
    assert values[-1] == pytest.approx(least, rel=1e-3)


def test_least_rms_acceleration_at_the_least_jerk_is_that_of_the_only_motion() -> None:
    """At ``J = 32 D/T³`` four ramps of equal length are all there is: mean square ``8² / 3``."""
    assert correction("rms_acceleration", 32.0 * (1 + 1e-9)) == pytest.approx(8 / math.sqrt(3), rel=1e-4)


@pytest.mark.parametrize("speed", [1.05, 1.2, 1.5, 1.9])
def test_peaks_under_a_speed_limit(speed: float) -> None:
    """Ramp to full speed and cruise: ``T - D/V = V/A + A/J``, ``T - D/V = 2 sqrt(V/J)``."""
    ramp = 1 - 1 / speed
    jerk = 1.5 * 4 * speed / ramp**2
    a = correction("peak_acceleration", jerk, speed)
    assert speed / a + a / jerk == pytest.approx(ramp, rel=1e-6)
    assert correction("peak_jerk", 10 * jerk, speed) == pytest.approx(4 * speed / ramp**2, rel=1e-6)


def test_the_paper_job() -> None:
    machine, cut, limits = PAPER
    result = solve(Task(machine, cut, limits), "peak_acceleration")
    check_cycle(result, machine, cut, limits)
    assert result.minimised == pytest.approx(least_acceleration(0.2, 0.3, 80 / 60, 3000.0), rel=1e-8)
    assert result.profile.pieces <= 8
    assert result.profile.degree <= 3


# -- an independent road: linear programmes by HiGHS on a fine grid ----------------------------------------------------------


def grid_matrices(count: int) -> tuple[csr_array, csr_array]:
    """Ratio and position at the nodes of a uniform grid from the accelerations there, by the exact integrals of straight lines."""
    h = 1.0 / count
    lower = csr_array(np.tril(np.ones((count + 1, count)), -1))
    left, right = eye_array(count, count + 1), eye_array(count, count + 1, k=1)
    ratio = lower @ (h / 2 * (left + right))
    position = lower @ (h * eye_array(count, count + 1) @ ratio + h**2 / 6 * (2 * left + right))
    return csr_array(ratio), csr_array(position)


def by_highs(
    objective: str, speed: float, acceleration: float, jerk: float, least: float, gradient: Any = None, count: int = 400
) -> float:
    """Least peak, or least value of a linear functional of the acceleration, of the motion from rest to rest."""
    ratio, position = grid_matrices(count)
    n = count + 1
    steps = (eye_array(count, n, k=1) - eye_array(count, n)) * count
    bound = csr_array(np.ones((n, 1)))
    none = csr_array((n, 1))
    rows, right = [], []

    def add(matrix: Any, limit: float, with_bound: bool) -> None:
        column = -bound[: matrix.shape[0]] if with_bound else none[: matrix.shape[0]]
        rows.append(hstack([matrix, column]))
        right.append(np.full(matrix.shape[0], 0.0 if with_bound else limit))

    add(ratio, speed, False)
    add(-ratio, -least, False)
    for sign in (1, -1):
        add(sign * eye_array(n), acceleration, objective == "peak_acceleration")
        add(sign * steps, jerk, objective == "peak_jerk")
    ends = vstack([hstack([ratio[[-1]], none[:1]]), hstack([position[[-1]], none[:1]])])
    cost = np.append(np.zeros(n) if gradient is None else gradient, 1.0 if gradient is None else 0.0)
    answer = linprog(
        cost,
        A_ub=vstack(rows),
        b_ub=np.concatenate(right),
        A_eq=ends,
        b_eq=[0.0, 1.0],
        bounds=[(0, 0), *[(-acceleration, acceleration)] * (n - 2), (0, 0), (0, None)],
        method="highs",
    )
    assert answer.status == 0
    return float(answer.fun)


# speed, acceleration and jerk in units of D/T, D/T² and D/T³: which limits are active differs
CASES = [(1.3, 30.0, 120.0), (1.6, 8.0, 100.0), (1.25, 20.0, 400.0), (1.9, 5.0, 300.0), (5.0, 4.6, 400.0)]


@pytest.mark.parametrize(("speed", "acceleration", "jerk"), CASES)
@pytest.mark.parametrize("objective", ["peak_acceleration", "peak_jerk"])
def test_peaks_are_those_of_highs(objective: MotionObjective, speed: float, acceleration: float, jerk: float) -> None:
    found = correction(objective, jerk, speed, acceleration)
    grid = by_highs(objective, speed, acceleration, jerk, -T / D)
    assert found <= grid * (1 + 1e-7)  # a motion on the grid is one of many, so a little above the best
    assert found == pytest.approx(grid, rel=1e-3)


@pytest.mark.parametrize(("speed", "acceleration", "jerk"), CASES)
@pytest.mark.parametrize("objective", ["rms_acceleration", "rms_jerk"])
def test_root_mean_squares_lie_on_their_tangent(
    objective: MotionObjective, speed: float, acceleration: float, jerk: float
) -> None:
    """No motion is better to first order: a convex objective that is least along its tangent is least."""
    machine, cut = RotaryKnife(1.5 + D), Cut(1.5, 1.0, 0.5, 0.0, 0.0, 1e-4)
    limits = Limits(1 + speed * D, acceleration * D, jerk * D)
    result = solve(Task(machine, cut, limits), objective)
    check_cycle(result, machine, cut, limits)
    order, count = order_of(objective), 400
    motion = result.back.add_line(-1.0).scale(slave=1 / D)
    # integral of the derivative times a broken line: of the hat functions, or of the steps between the nodes, by Gauss points
    node, weight = np.polynomial.legendre.leggauss(8)
    x = (np.arange(count)[:, None] + 0.5 * (node + 1)) / count
    values = motion(x, order) * weight / 2 / count
    gradient = np.zeros(count + 1)
    if order == 2:
        gradient[:-1] += (values * (1 - 0.5 * (node + 1))).sum(axis=1)
        gradient[1:] += (values * 0.5 * (node + 1)).sum(axis=1)
    else:
        gradient[:-1] -= values.sum(axis=1) * count
        gradient[1:] += values.sum(axis=1) * count
    square = motion.mean_square(order)
    tangent = 2 * by_highs(objective, speed, acceleration, jerk, -T / D, gradient) - square
    assert tangent >= square * (1 - 2e-3)


def test_grid_matrices_integrate_exactly() -> None:
    """The programme above on a motion whose integrals are known: constant jerk."""
    ratio, position = grid_matrices(40)
    x = np.linspace(0, 1, 41)
    assert np.abs(ratio @ x - x**2 / 2).max() <= 1e-14
    assert np.abs(position @ x - x**3 / 6).max() <= 1e-14


# -- random jobs -----------------------------------------------------------------------------------------------------------


@st.composite
def jobs(draw: st.DrawFn) -> Job:
    """Draw a job in terms of what its motion needs: limits from a little below what is possible to far above."""
    circumference = math.exp(draw(st.floats(math.log(0.1), math.log(2.0))))
    length = circumference * math.exp(draw(st.floats(-math.log(3), math.log(3))))
    sync = min(length, circumference) * draw(st.floats(0.02, 0.9))
    line_speed = math.exp(draw(st.floats(math.log(0.05), math.log(5.0))))
    origin = draw(st.sampled_from(["return", "cut"]))
    cut = Cut(length, line_speed, sync, 0.0, 0.0, 1e-4, origin)
    time = cut.return_zone / line_speed
    distance = max(abs(circumference - length), 1e-3 * length)
    ahead = 2 * distance / time if length < circumference else 0.0
    limits = Limits(
        speed=line_speed * (1 + draw(st.floats(0.0, 0.5))) + ahead * draw(st.floats(0.5, 1.5)),
        acceleration=4 * distance / time**2 * math.exp(draw(st.floats(-0.05, math.log(100)))),
        jerk=32 * distance / time**3 * math.exp(draw(st.floats(-0.1, math.log(1e4)))),
        reversal=draw(st.booleans()),
    )
    return RotaryKnife(circumference), cut, limits, draw(st.sampled_from(OBJECTIVES))


def changed(cut: Cut, limits: Limits, change: str, value: float) -> tuple[Cut, Limits]:
    """Take up a suggestion, in the units that it is made in."""
    if change == "line_speed":
        return replace(cut, line_speed=value / 60), limits
    if change == "length":
        return replace(cut, length=value / 1e3), limits
    if change == "reversal":
        return cut, replace(limits, reversal=True)
    return cut, replace(limits, **{change: value / 60 if change == "speed" else value})


def check_suggestions(error: InfeasibleError, job: Job) -> None:
    """Take every suggestion at its word."""
    machine, cut, limits, objective = job
    assert error.suggestions
    for suggestion in error.suggestions:
        other_cut, other_limits = changed(cut, limits, suggestion.change, suggestion.value)
        check_cycle(solve(Task(machine, other_cut, other_limits), objective), machine, other_cut, other_limits)


# Laws without a jump of the acceleration, which a limit of the jerk asks for.
SMOOTH_LAWS = [name for name in BASELINES if name not in ("linear_return", "parabolic", "cubic", "velocity_trapezoid")]


def check_against_baselines(result: Solution, job: Job) -> None:
    """No law that keeps the limits too is better."""
    machine, cut, limits, objective = job
    order = order_of(objective)
    for name in SMOOTH_LAWS:
        profile = baseline(name, Task(machine, cut, FREE))
        if worst_excess(profile, cut, limits) > 0:
            continue
        back = profile.restrict(cut.return_start, cut.return_start + cut.return_zone)
        value = math.sqrt(back.mean_square(order)) if objective.startswith("rms") else profile.peak(order)
        assert result.minimised <= value * cut.line_speed**order * (1 + 1e-7)


def check_tightening(result: Solution, job: Job, tightened: str, factor: float) -> None:
    """Check that a tighter limit never improves the objective."""
    machine, cut, limits, objective = job
    harder = replace(limits, **{tightened: factor * getattr(limits, tightened)})
    try:
        tighter = solve(Task(machine, cut, harder), objective)
    except InfeasibleError:
        return
    check_cycle(tighter, machine, cut, harder)
    assert tighter.minimised >= result.minimised * (1 - 1e-7)


limit_names = st.sampled_from(["speed", "acceleration", "jerk"])


@settings(max_examples=60)
@given(jobs())
def test_random_jobs(job: Job) -> None:
    machine, cut, limits, objective = job
    try:
        result = solve(Task(machine, cut, limits), objective)
    except InfeasibleError as error:
        suggestions = error.suggestions
    else:
        assert result.status is SolveStatus.OPTIMAL
        check_cycle(result, machine, cut, limits)
        check_against_baselines(result, job)
        return
    assert suggestions


def check_job(job: Job, tightened: str, factor: float) -> None:
    machine, cut, limits, objective = job
    try:
        result = solve(Task(machine, cut, limits), objective)
    except InfeasibleError as error:
        check_suggestions(error, job)
        return
    assert result.status is SolveStatus.OPTIMAL
    check_cycle(result, machine, cut, limits)
    check_against_baselines(result, job)
    check_tightening(result, job, tightened, factor)


@settings(
    max_examples=12
)  # the least RMS jerk at the edge of what is possible takes seconds a job: left to the slow test
@given(jobs().filter(lambda job: job[3] != "rms_jerk"), limit_names, st.floats(0.7, 1.0))
def test_tightening_and_suggestions(job: Job, tightened: str, factor: float) -> None:
    check_job(job, tightened, factor)


@pytest.mark.slow
@settings(max_examples=500)
@given(jobs(), limit_names, st.floats(0.7, 1.0))
def test_many_random_jobs(job: Job, tightened: str, factor: float) -> None:
    check_job(job, tightened, factor)


# Jobs that once were not solved to the optimum: the motion touches a limit in a point, or keeps to it for less than an interval of
# the grid. Limits of the scaled motion (least and greatest velocity, acceleration, jerk), and the RMS jerk that a quadratic
# programme (Clarabel) on a fine grid comes down to.
TOUCHING = [
    ((3.3, 3.02, 4.778759, 83.255654), 29.3645),
    ((0.9625, 2.217, 4.434154, 1194.102), 34.0629),
    ((1.0, 1.742218, 287.7, 67.537688), 27.8280),
    ((2.3, 12.26, 5.903551, 45.355781), 27.0118),
    pytest.param((0.33, 1.119894, 390.6, 401.601019), 165.7274, marks=pytest.mark.slow),
    ((3.0, 2.0, 4.32, 121.5), 40.2064),
    pytest.param((0.208, 1.321135, 34.752107, 89.682199), 60.4980, marks=pytest.mark.slow),
    ((3.98, 2.502820, 6.126175, 44.221260), 27.0652),
    pytest.param((3.6, 1.869163, 11.893454, 40.13258), 27.8951, marks=pytest.mark.slow),
    ((0.21, 1.321135, 40.353079, 136.069985), 49.0997),
]


@pytest.mark.parametrize(("scaled", "by_clarabel"), TOUCHING)
def test_limits_that_are_only_touched(scaled: tuple[float, float, float, float], by_clarabel: float) -> None:
    _, speed, acceleration, jerk = scaled
    found = correction("rms_jerk", jerk, speed, acceleration)
    assert found <= by_clarabel
    assert found == pytest.approx(by_clarabel, rel=5e-4)


# -- degenerate jobs -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("objective", OBJECTIVES)
@pytest.mark.parametrize("origin", ["return", "cut"])
def test_cut_as_long_as_the_circumference_is_a_straight_line(objective: MotionObjective, origin: str) -> None:
    cut = Cut(0.4, 1.0, 0.1, 0.0, 0.0, 1e-4, origin)  # type: ignore[arg-type]
    result = solve(Task(RotaryKnife(0.4), cut, Limits(1.0, 1e-3, 1e-3)), objective)
    assert result.minimised == pytest.approx(0.0, abs=1e-12)
    x = np.linspace(0, 0.4, 101)
    assert np.abs(result.profile(x) - x).max() <= 1e-15


@pytest.mark.parametrize("objective", OBJECTIVES)
@pytest.mark.parametrize("off", [1e-3, -1e-3, 1e-6, -1e-6, 1e-9, -1e-9, 1e-12])
def test_cut_just_off_the_circumference(objective: MotionObjective, off: float) -> None:
    machine, cut, limits = RotaryKnife(0.4), Cut(0.4 + off, 1.0, 0.1, 0.0, 0.0, 1e-4), Limits(2.0, 10.0, 1e4)
    result = solve(Task(machine, cut, limits), objective)
    check_cycle(result, machine, cut, limits)
    unit = abs(machine.pitch - cut.length) / (cut.return_zone / cut.line_speed) ** order_of(objective)
    least = {"peak_acceleration": 4, "rms_acceleration": math.sqrt(12), "peak_jerk": 32, "rms_jerk": math.sqrt(720)}
    assert result.minimised == pytest.approx(least[objective] * unit, rel=2e-3)


SHARES = [1.0, 1.0 + 1e-12, 1.0 + 1e-10, 1.0 + 1e-8, 1.0 + 1e-6, 1.0 + 1e-4]


@pytest.mark.parametrize(
    ("objective", "share"),
    [
        pytest.param(name, share, marks=pytest.mark.slow if name == "rms_jerk" and share > 1 + 1e-9 else ())
        for name in OBJECTIVES
        for share in SHARES
    ],
)
def test_shortest_possible_return(objective: MotionObjective, share: float) -> None:
    """The return zone as short as the limits allow, then a little longer; found by Ruckig to the last digits in test_reach."""
    machine, limits, v, sync = RotaryKnife(0.4), Limits(3.0, 80.0, 4e3), 1.2, 0.1
    shortest = shortest_return_length(0.3, 3.0 / v, 80.0 / v**2, 4e3 / v**3)
    cut = Cut(shortest * share + sync, v, sync, 0.0, 0.0, 1e-4)
    result = solve(Task(machine, cut, limits), objective)
    check_cycle(result, machine, cut, limits)
    with pytest.raises(InfeasibleError):
        solve(Task(machine, replace(cut, length=shortest * (1 - 1e-6) + sync), limits), objective)
    if share == 1.0:
        rest = 0.3 - shortest
        assert fastest(rest, 3.0 - v, 80.0, 4e3).time == pytest.approx(cut.return_zone / v, rel=1e-6)
        assert result.minimised <= {"a": 80.0, "j": 4e3}["a" if order_of(objective) == 2 else "j"] * (1 + 1e-9)


@pytest.mark.parametrize("objective", OBJECTIVES)
def test_very_long_cuts_with_reversal(objective: MotionObjective) -> None:
    """With reversal the knife swings back and the objective is the free one; without it the knife stands still for a while."""
    machine, cut = RotaryKnife(0.4), Cut(2.0, 1.0, 0.2, 0.0, 0.0, 1e-4)
    swinging = Limits(3.0, 100.0, 1e6, reversal=True)
    free = solve(Task(machine, cut, swinging), objective)
    check_cycle(free, machine, cut, swinging)
    assert free.profile.extrema(1)[0].value < -0.05
    unit = 1.6 / 1.8 ** order_of(objective)
    least = {"peak_acceleration": 4, "rms_acceleration": math.sqrt(12), "peak_jerk": 32, "rms_jerk": math.sqrt(720)}
    assert free.minimised == pytest.approx(least[objective] * unit, rel=1e-3)

    standing = replace(swinging, reversal=False)
    result = solve(Task(machine, cut, standing), objective)
    check_cycle(result, machine, cut, standing)
    assert result.minimised > free.minimised
    ratio = result.profile(np.linspace(0.0, 1.8, 1001), 1)
    assert (np.abs(ratio) <= 1e-8).sum() > 100


@pytest.mark.parametrize("objective", OBJECTIVES)
@pytest.mark.parametrize("jerk", [1e6, 1e9, 1e12])
def test_huge_jerk_limits(objective: MotionObjective, jerk: float) -> None:
    machine, cut, _ = PAPER
    limits = Limits(200 / 60, 30.0, jerk)
    result = solve(Task(machine, cut, limits), objective)
    check_cycle(result, machine, cut, limits)
    least = {"peak_acceleration": 4, "rms_acceleration": math.sqrt(12), "peak_jerk": 32, "rms_jerk": math.sqrt(720)}
    unit = 0.2 / 0.3 ** order_of(objective)
    if objective == "rms_jerk":  # the quintic is within the other limits
        assert result.minimised == pytest.approx(least[objective] * unit, rel=1e-6)
    else:
        assert least[objective] * unit * (1 - 1e-9) <= result.minimised <= least[objective] * unit * (1 + 1e-3)


@pytest.mark.parametrize("objective", OBJECTIVES)
def test_the_origin_only_moves_the_cycle(objective: MotionObjective) -> None:
    machine, cut, limits = PAPER
    from_return = solve(Task(machine, cut, limits), objective)
    from_cut = solve(Task(machine, replace(cut, origin="cut"), limits), objective)
    assert from_cut.minimised == from_return.minimised
    x = np.linspace(0.0, 0.6, 601)
    moved = from_return.profile(x + 0.5, outside="repeat") - float(from_return.profile(0.5))
    assert np.abs(from_cut.profile(x) - moved).max() <= 1e-13


def test_same_job_same_bits() -> None:
    first, second = (solve(Task(*PAPER), "rms_jerk").profile for _ in range(2))
    assert first.to_dict() == second.to_dict()


@pytest.mark.parametrize("v", [0.01, 0.1, 1.0, 10.0])
@pytest.mark.parametrize("objective", OBJECTIVES)
def test_objective_scales_with_the_line_speed(objective: MotionObjective, v: float) -> None:
    """The same cam at another line speed: limits and objective go with v, v² and v³."""
    cut = Cut(0.6, v, 0.2, 0.0, 0.0, 1e-4)
    result = solve(Task(RotaryKnife(0.4), cut, Limits(2.5 * v, 17 * v**2, 1265 * v**3)), objective)
    unit = solve(Task(RotaryKnife(0.4), replace(cut, line_speed=1.0), Limits(2.5, 17, 1265)), objective)
    assert result.minimised == pytest.approx(unit.minimised * v ** order_of(objective), rel=1e-7)


def test_least_jerk_is_the_closed_form() -> None:
    machine, cut, limits = PAPER
    result = solve(Task(machine, cut, limits), "peak_jerk")
    assert result.minimised == pytest.approx(least_jerk(0.2, 0.3, 80 / 60, 30.0), rel=1e-7)


def test_the_only_motion_of_least_peak_jerk_is_left_as_it_is() -> None:
    cut = Cut(0.5, 0.5, 0.09, 0.01, 0.05, 2e-4)
    task = Task(RotaryKnife(0.8, blades=2, sync="horizontal"), cut, Limits(200 / 60, 60.0, 5000.0))
    back = solve(task, "peak_jerk").back
    jerk = back(back.breaks[:-1], 3)
    assert back.pieces == 3
    assert jerk == pytest.approx(abs(jerk[1]) * np.array([-1.0, 1.0, -1.0]), rel=1e-8)


@pytest.mark.parametrize("status", SolveStatus)
def test_every_status_has_advice(status: SolveStatus) -> None:
    assert status.advice


@pytest.mark.parametrize("objective", get_args(MotionObjective))
def test_a_knife_that_turns_at_the_line_speed_costs_nothing_not_even_a_sign(objective: MotionObjective) -> None:
    even = Task(RotaryKnife(0.4), Cut(0.4, 1.0, 0.1, 0.04, 0.06, 1e-4), Limits(2.0, 30.0, 3000.0))
    cost = solve(even, objective).minimised
    assert cost == pytest.approx(0.0, abs=1e-9)
    assert math.copysign(1.0, cost) == 1.0
