"""The fastest line over a list within its jerk: closed forms, a dense dynamic programme over speed and acceleration, what it must keep."""

from __future__ import annotations

import itertools
import math

import cvxpy
import numpy as np
import pytest

from camwright.design.production.line_plan import fastest_plan
from camwright.design.production.smooth_line import MOST_CHANGES, smooth_line
from camwright.profiles.errors import InputError
from camwright.profiles.line_run import LineRun
from camwright.profiles.polynomial.profile import FloatArray


def test_one_change_of_the_speed_is_a_double_s() -> None:
    """From 2 to 1 m/s with 1 m/s² and 2 m/s³: 1.5 s over 2.25 m, ending where the slow piece begins, on which the line keeps its speed."""
    run = smooth_line(np.array([4.0, 1.0]), np.array([2.0, 1.0]), 1.0, 2.0, np.array([False, True]))
    assert run.time == pytest.approx(1.75 / 2.0 + 1.5 + 1.0, rel=1e-4)
    mirrored = smooth_line(np.array([1.0, 4.0]), np.array([1.0, 2.0]), 1.0, 2.0, np.array([True, False]))
    assert mirrored.time == pytest.approx(run.time, rel=1e-6)


def test_a_jerk_without_limit_is_the_plan_without_one() -> None:
    lengths, highest = np.array([1.8, 0.9, 1.8]), np.array([80, 47.66, 80]) / 60
    assert smooth_line(lengths, highest, 1.0, 1e4).time == pytest.approx(
        fastest_plan(lengths, highest, 1.0).time, rel=1e-4
    )
    one = smooth_line(lengths, np.full(3, 1.2), 1.0, 5.0)
    assert one.time == pytest.approx(lengths.sum() / 1.2)


def test_a_line_that_may_dip_is_faster_than_one_that_keeps_slow_pieces_steady() -> None:
    lengths, highest = np.array([1.8, 0.9, 1.8]), np.array([80, 47.66, 80]) / 60
    steady = smooth_line(lengths, highest, 1.0, 5.0, np.array([False, True, False]))
    free = smooth_line(lengths, highest, 1.0, 5.0)
    assert free.time < 0.99 * steady.time
    inside = steady.when(np.linspace(1.8, 2.7, 50))
    assert np.ptp(steady.speed(inside)) <= 1e-9


def lists(count: int) -> list[tuple[FloatArray, FloatArray, float, float]]:
    draw = np.random.default_rng(5)
    found = []
    for _ in range(count):
        pieces = int(draw.integers(2, 7))
        lengths, highest = draw.uniform(0.2, 1.5, pieces), draw.uniform(0.4, 2.0, pieces)
        found.append((lengths, highest, float(draw.uniform(0.3, 3.0)), float(10 ** draw.uniform(0.0, 1.7))))
    return found


def require_kept(run: LineRun, lengths: FloatArray, highest: FloatArray, acceleration: float, jerk: float) -> None:
    """Look at a plan by differences of its material over time, and piece by piece."""
    joints = np.concatenate([[0.0], np.cumsum(lengths)])
    assert run.length == pytest.approx(joints[-1], rel=1e-12)
    assert (run.fastest_between(joints) <= highest * (1 + 1e-9)).all()
    assert run.hardest <= acceleration * (1 + 1e-9)
    t, step = np.linspace(0.0, run.time, 20_001), 1e-3
    x = [run.passed(t + k * step) for k in (-1.5, -0.5, 0.5, 1.5)]
    inside = (t > 2 * step) & (t < run.time - 2 * step)
    third = np.abs(x[3] - 3 * x[2] + 3 * x[1] - x[0]) / step**3
    assert third[inside].max() <= jerk * (1 + 1e-3) + 1e-3
    for k, (begin, end) in enumerate(itertools.pairwise(joints)):
        places = np.linspace(begin, end, 41)[1:-1]
        when = run.when(places)
        assert run.passed(when) == pytest.approx(places, abs=1e-9)
        assert run.speed(when).max() <= highest[k] * (1 + 1e-9)


@pytest.mark.parametrize("number", range(6))
def test_a_plan_keeps_speeds_ramp_and_jerk(number: int) -> None:
    lengths, highest, acceleration, jerk = lists(6)[number]
    run = smooth_line(lengths, highest, acceleration, jerk)
    require_kept(run, lengths, highest, acceleration, jerk)
    assert run.time >= fastest_plan(lengths, highest, acceleration).time * (1 - 1e-9)
    assert run.speed([0.0, run.time]).tolist() == [run.speeds[0], run.speeds[-1]]
    assert run.accelerations is not None
    assert run.accelerations[[0, -1]].tolist() == [0.0, 0.0]


def dense(
    lengths: FloatArray, highest: FloatArray, acceleration: float, jerk: float, parts: int, speeds: int, bends: int
) -> float:
    """Least time by dynamic programming over places, speeds and accelerations: a twin that knows neither nodes nor corners."""
    joints = np.concatenate([[0.0], np.cumsum(lengths)])
    places = np.concatenate([np.linspace(a, b, parts + 1)[:-1] for a, b in itertools.pairwise(joints)])
    places = np.append(places, joints[-1])
    v = np.linspace(0.1 * highest.min(), highest.max(), speeds)
    a = np.linspace(-acceleration, acceleration, bends)
    first, last = a[:, None, None], a[None, :, None]
    cost = np.where(a[:, None] == 0.0, np.zeros_like(v)[None, :], math.inf)
    cost[:, v > highest[-1] * (1 + 1e-12)] = math.inf
    for k in range(len(places) - 2, -1, -1):
        way, piece = places[k + 1] - places[k], k // parts
        top = min(highest[piece], highest[max(piece - 1, 0)] if k % parts == 0 else math.inf)
        bend = (2 * first + last) / 6
        with np.errstate(all="ignore"):
            lasts = 2 * way / (v + np.sqrt(v * v + 4 * bend * way))
            end = v + 0.5 * (first + last) * lasts
            peak = np.where((first > 0) & (last < 0), v + first**2 * lasts / (2 * (first - last)), np.maximum(v, end))
            fine = (
                (np.abs(last - first) <= jerk * lasts * (1 + 1e-9))
                & (end >= v[0])
                & (peak <= highest[piece] * (1 + 1e-9))
            )
            at = np.where(fine, (end - v[0]) / (v[1] - v[0]), 0.0)
            low = np.clip(at.astype(int), 0, speeds - 2)
            rows = np.broadcast_to(np.arange(bends)[None, :, None], low.shape)
            share = at - low
            ahead = np.where(share < 1e-9, cost[rows, low], (1 - share) * cost[rows, low] + share * cost[rows, low + 1])
        cost = np.where(fine & np.isfinite(ahead), lasts + ahead, math.inf).min(axis=1)
        cost[:, v > top * (1 + 1e-12)] = math.inf
    return float(cost[a == 0.0].min())


def convex_rounds(lengths: FloatArray, highest: FloatArray, acceleration: float, jerk: float, parts: int = 40) -> float:
    """Least time by convex programmes over the squared speed, the jerk's limit drawn tangent to it: another road, evenly spaced."""
    steps, tops = np.repeat(lengths / parts, parts), np.repeat(highest, parts) ** 2
    count = len(steps)
    weights = 0.5 * (np.append(steps, 0.0) + np.append(0.0, steps))
    at = np.full(count + 1, 0.9 * highest.min() ** 2)
    best = math.inf
    for _ in range(8):
        u, p, c = cvxpy.Variable(count + 1), cvxpy.Variable(count + 1), cvxpy.Variable(count)
        most = 2 * jerk / np.sqrt(at) - cvxpy.multiply(jerk * at**-1.5, u - at)
        kept = [
            p[1:] == p[:-1] + cvxpy.multiply(steps, c),
            u[1:] == u[:-1] + cvxpy.multiply(steps, p[:-1]) + cvxpy.multiply(0.5 * steps**2, c),
            cvxpy.abs(p) <= 2 * acceleration, p[0] == 0, p[count] == 0, u[:-1] <= tops, u[1:] <= tops, u >= 1e-4,
            cvxpy.abs(c) <= most[:-1], cvxpy.abs(c) <= most[1:],
        ]  # fmt: skip
        programme = cvxpy.Problem(cvxpy.Minimize(cvxpy.sum(cvxpy.multiply(weights, cvxpy.power(u, -0.5)))), kept)
        programme.solve(solver="CLARABEL")
        at = np.maximum(u.value, 1e-4)
        if abs(programme.value - best) < 1e-5 * best:
            break
        best = programme.value
    return float(programme.value)


@pytest.mark.parametrize("number", [2, 3, 5])
def test_another_road_is_not_quicker(number: int) -> None:
    asked = lists(6)[number]
    assert smooth_line(*asked).time == pytest.approx(convex_rounds(*asked), rel=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize("number", range(4))
def test_never_slower_than_a_dense_dynamic_programme(number: int) -> None:
    asked = lists(4)[number]
    twin = dense(*asked, parts=24, speeds=161, bends=49)
    assert smooth_line(*asked).time <= twin * 1.001


def test_what_is_no_plan_is_refused() -> None:
    many = np.resize([1.0, 1.2], MOST_CHANGES + 2)
    with pytest.raises(InputError, match="changes 5001 times along the list"):
        smooth_line(many, many, 1.0, 5.0)
    with pytest.raises(InputError, match="a plan of the line needs at least one piece"):
        smooth_line(many[:2], many[:2], 0.0, 5.0)
