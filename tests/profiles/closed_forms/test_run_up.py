"""Run-ups: formulas, the naive twin on a grid of velocities, and Ruckig as the referee of the quickest."""

import math
from random import Random

import numpy as np
import pytest
import ruckig
from hypothesis import given, settings
from hypothesis import strategies as st

from camwright.profiles.closed_forms.run_up import (
    coolest,
    gentlest,
    quickest,
    shortest,
    top_velocity,
)
from camwright.profiles.closed_forms.transfer import Bounds, State, Transfer

V, A, J = 80 / 60, 30.0, 3000.0
PAPER = Bounds(0.0, 200 / 60, A, J)
SYNC = State(V, 0.0)

speeds = st.floats(0.1, 5.0)
accelerations = st.floats(2.0, 100.0)
jerks = st.floats(50.0, 20_000.0)
shares = st.floats(-0.95, 0.95)
longer = st.floats(1.0, 6.0)


def ends(way: Transfer) -> tuple[float, float, float]:
    """Position, velocity and acceleration at the end."""
    profile = way.profile()
    last = profile.end
    return tuple(float(profile(last, order, side="left")) for order in range(3))


def test_the_machine_of_the_paper() -> None:
    least = shortest(SYNC, PAPER)
    assert least.time * 1e3 == pytest.approx(54.4444, abs=1e-4)
    assert least.time == pytest.approx(V / A + A / J, rel=1e-14)
    assert least.distance * 1e3 == pytest.approx(36.2963, abs=1e-4)
    soft = gentlest(0.1, SYNC, PAPER)
    assert soft.peak_acceleration == pytest.approx(9.07177, abs=1e-5)
    assert soft.time == pytest.approx(0.15, rel=1e-14)


def test_a_run_up_no_faster_than_the_line_takes_what_is_left_at_its_speed() -> None:
    least = shortest(SYNC, PAPER)
    for factor in (1.0, 1.5, 4.0):
        way = quickest(factor * least.distance, SYNC, Bounds(0.0, V, A, J))
        assert way.time == pytest.approx(least.time + (factor - 1) * least.distance / V, rel=1e-12)
    way = quickest(1.5 * least.distance, SYNC, Bounds(0.0, V, A, J))
    assert way.time * 1e3 == pytest.approx(68.06, abs=5e-3)


def test_too_short_a_way_has_no_motion() -> None:
    too_short = 0.9 * shortest(SYNC, PAPER).distance
    assert [find(too_short, SYNC, PAPER) for find in (gentlest, coolest, quickest)] == [None] * 3


def test_a_slow_end_does_not_reach_the_acceleration() -> None:
    least = shortest(State(0.01, 0.0), PAPER)
    assert least.time == pytest.approx(2 * math.sqrt(0.01 / J), rel=1e-14)
    assert least.peak_acceleration == pytest.approx(math.sqrt(0.01 * J), rel=1e-14)


def test_an_end_beyond_the_limits_has_no_motion() -> None:
    assert shortest(State(4.0, 0.0), PAPER) is None
    assert shortest(State(1.0, 31.0), PAPER) is None
    assert shortest(State(0.01, 10.0), PAPER) is None  # it would have to come from behind
    assert shortest(State(200 / 60, -20.0), PAPER) is None  # it would have to be faster before


def test_the_coolest_start_without_limits() -> None:
    free = Bounds(0.0, 10.0, 1e6, 1e12)
    way = coolest(0.1, SYNC, free)
    assert way.heat == pytest.approx(4 * V**3 / (9 * 0.1), rel=1e-4)
    assert way.time == pytest.approx(3 * 0.1 / V, rel=1e-4)


def naive_least_distance(end: State, acceleration: float, jerk: float) -> float:
    """Sum over velocities of what each takes, with the greatest acceleration that its neighbours leave."""
    c = end.acceleration**2 + 2 * jerk * end.velocity
    top = top_velocity(end, jerk)
    u = top * (0.5 - 0.5 * np.cos(np.linspace(0, math.pi, 4_001)))
    middle = 0.5 * (u[1:] + u[:-1])
    most = np.minimum(
        acceleration, np.minimum(np.sqrt(2 * jerk * middle), np.sqrt(np.maximum(c - 2 * jerk * middle, 1e-300)))
    )
    way = float((middle / most * np.diff(u)).sum())
    if end.acceleration < 0:
        u = np.linspace(end.velocity, top, 4_001)
        middle = 0.5 * (u[1:] + u[:-1])
        way += float((middle / np.sqrt(np.maximum(c - 2 * jerk * middle, 1e-300)) * np.diff(u)).sum())
    return way


@settings(max_examples=40)
@given(speeds, accelerations, jerks, shares, longer)
def test_every_way_meets_its_end_and_keeps_the_limits(
    v: float, a: float, j: float, share: float, factor: float
) -> None:
    last = share * min(a, math.sqrt(2 * j * v))
    end = State(v, last)
    bounds = Bounds(0.0, 1.01 * top_velocity(end, j), a, j)
    least = shortest(end, bounds)
    way = factor * least.distance
    for found in (least, gentlest(way, end, bounds), coolest(way, end, bounds), quickest(way, end, bounds)):
        profile = found.profile()
        covered = least.distance if found is least else way
        assert ends(found) == pytest.approx((covered, v, last), rel=1e-7, abs=1e-7 * a)
        low, high = profile.extrema(1)
        assert low.value >= -1e-9 * v
        assert high.value <= bounds.greatest_velocity * (1 + 1e-9)
        assert found.peak_acceleration <= a * (1 + 1e-9)
        assert profile.peak(3) <= j * (1 + 1e-9)
    soft, cool, quick = (find(way, end, bounds) for find in (gentlest, coolest, quickest))
    assert soft.peak_acceleration <= min(cool.peak_acceleration, quick.peak_acceleration) * (1 + 1e-9)
    assert cool.heat <= min(soft.heat, quick.heat) * (1 + 1e-7)
    assert quick.time <= min(soft.time, cool.time) * (1 + 1e-9)


@given(speeds, accelerations, jerks, shares)
def test_least_distance_is_that_of_the_velocities(v: float, a: float, j: float, share: float) -> None:
    end = State(v, share * min(a, math.sqrt(2 * j * v)))
    least = shortest(end, Bounds(0.0, 10 * top_velocity(end, j), a, j))
    assert least.distance == pytest.approx(naive_least_distance(end, a, j), rel=3e-3)


@given(speeds, accelerations, jerks, shares)
def test_backwards_twice_is_the_same(v: float, a: float, j: float, share: float) -> None:
    end = State(v, share * min(a, math.sqrt(2 * j * v)))
    way = shortest(end, Bounds(0.0, 10 * top_velocity(end, j), a, j))
    stop = way.backwards()
    assert stop.distance == pytest.approx(way.distance, rel=1e-9)
    assert ends(stop)[1:] == pytest.approx((0.0, 0.0), abs=1e-6 * a)
    assert stop.backwards().phases == way.phases


def by_ruckig(distance: float, end: State, bounds: Bounds) -> float:
    """Least time from rest to a state, by Ruckig; it may run backwards and is then quicker than it may be."""
    asked = ruckig.InputParameter(1)
    asked.target_position, asked.target_velocity, asked.target_acceleration = (
        [distance],
        [end.velocity],
        [end.acceleration],
    )
    asked.max_velocity, asked.max_acceleration, asked.max_jerk = (
        [bounds.greatest_velocity],
        [bounds.acceleration],
        [bounds.jerk],
    )
    found = ruckig.Trajectory(1)
    ruckig.Ruckig(1).calculate(asked, found)
    return float(found.duration)


def referee(count: int, seed: int) -> float:
    """Greatest difference to Ruckig (s) over random machines whose quickest start is asked for."""
    chance, worst = Random(seed), 0.0  # noqa: S311 - the same machines each time
    for _ in range(count):
        v, a, j = chance.uniform(0.2, 4), chance.uniform(5, 80), 10 ** chance.uniform(2.5, 4.3)
        end, bounds = State(v, 0.0), Bounds(0.0, v * chance.uniform(1.0, 2.5), a, j)
        # at the least way itself Ruckig's rounding decides whether it backs up
        distance = shortest(end, bounds).distance * chance.choice((1.0 + 1e-9, chance.uniform(1.0, 5.0)))
        worst = max(worst, abs(quickest(distance, end, bounds).time - by_ruckig(distance, end, bounds)))
    return worst


def test_ruckig_needs_the_same_time() -> None:
    assert referee(50, 1) <= 1e-9


@pytest.mark.slow
def test_ruckig_needs_the_same_time_on_a_thousand_machines() -> None:
    assert referee(1000, 2) <= 1e-9


def test_ruckig_backs_up_where_the_way_is_too_short() -> None:
    """With nine tenths of the least way the quickest motion takes a run-up, which a ramp may not."""
    too_short = 0.9 * shortest(SYNC, PAPER).distance
    time = by_ruckig(too_short, SYNC, PAPER)
    assert (time * 1e3, time * V * 1e3) == pytest.approx((78.44, 104.58), abs=5e-3)
