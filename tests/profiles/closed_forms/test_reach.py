"""Rest-to-rest reach in closed form: Ruckig as the referee, inverse relations, and the formulas of the literature."""

from __future__ import annotations

import math
from typing import Any

import pytest
import ruckig
from hypothesis import given
from hypothesis import strategies as st

from camwright.profiles.closed_forms.reach import (
    fastest,
    greatest_reach,
    in_time,
    least_acceleration,
    least_jerk,
    shortest_return_length,
)
from camwright.profiles.errors import InputError


def size(low: float, high: float) -> st.SearchStrategy[float]:
    """Positive numbers, evenly spread over the orders of magnitude."""
    return st.floats(math.log(low), math.log(high)).map(math.exp)


def by_ruckig(distance: float, start: float, speed: float, acceleration: float, jerk: float, least: float) -> float:
    """Shortest time between two states of the same velocity, by Ruckig."""
    query = ruckig.InputParameter(1)
    query.current_position, query.target_position = [0.0], [distance]
    query.current_velocity = query.target_velocity = [start]
    query.current_acceleration = query.target_acceleration = [0.0]
    query.max_velocity, query.min_velocity = [speed], [least]
    query.max_acceleration, query.max_jerk = [acceleration], [jerk]
    answer = ruckig.Trajectory(1)
    assert ruckig.Ruckig(1).calculate(query, answer) == ruckig.Result.Working
    return float(answer.duration)


LIMITS = (size(0.01, 100.0), size(0.01, 1e3), size(0.01, 1e5))


@given(size(1e-3, 1e2), *LIMITS)
def test_shortest_time_is_that_of_ruckig(distance: float, speed: float, acceleration: float, jerk: float) -> None:
    expected = by_ruckig(distance, 0.0, speed, acceleration, jerk, -speed)
    assert fastest(distance, speed, acceleration, jerk).time == pytest.approx(expected, rel=1e-9)


@given(size(0.1, 10.0), st.floats(1.05, 10.0), size(0.1, 1e3), size(0.1, 1e5))
def test_shortest_return_is_that_of_ruckig(height: float, speed: float, acceleration: float, jerk: float) -> None:
    """Over the master the material moves at 1: from ratio 1 to ratio 1 in the shortest master travel."""
    expected = by_ruckig(height, 1.0, speed, acceleration, jerk, 0.0)
    assert shortest_return_length(height, speed, acceleration, jerk) == pytest.approx(expected, rel=1e-9)


@given(size(1e-3, 1e2), *LIMITS)
def test_fastest_motion_is_what_it_says(distance: float, speed: float, acceleration: float, jerk: float) -> None:
    motion = fastest(distance, speed, acceleration, jerk)
    profile = motion.profile()
    assert motion.distance == pytest.approx(distance, rel=1e-9)
    assert motion.speed <= speed * (1 + 1e-12)
    assert motion.acceleration <= acceleration * (1 + 1e-12)
    assert profile.length == pytest.approx(motion.time, rel=1e-12)
    assert profile.advance == pytest.approx(distance, rel=1e-9)
    assert profile.extrema(1)[1].value == pytest.approx(motion.speed, rel=1e-9)
    assert profile.extrema(2)[1].value == pytest.approx(motion.acceleration, rel=1e-9)


@given(size(1e-2, 1e2), *LIMITS)
def test_reach_and_time_are_inverse(time: float, speed: float, acceleration: float, jerk: float) -> None:
    distance = greatest_reach(time, speed, acceleration, jerk)
    assert fastest(distance, speed, acceleration, jerk).time == pytest.approx(time, rel=1e-9)


@given(size(1e-2, 1e2), *LIMITS, st.sampled_from(range(4)), st.floats(1.0, 3.0))
def test_reach_grows_with_each_limit(
    time: float, speed: float, acceleration: float, jerk: float, which: int, factor: float
) -> None:
    numbers = [time, speed, acceleration, jerk]
    before = greatest_reach(*numbers)
    numbers[which] *= factor
    assert greatest_reach(*numbers) >= before * (1 - 1e-12)


@given(size(1e-2, 1e2), *LIMITS, st.floats(0.05, 0.999))
def test_each_least_limit_just_reaches(
    time: float, speed: float, acceleration: float, jerk: float, share: float
) -> None:
    """What is needed of one limit lies below what there is, does, and a little less does not."""
    distance = share * greatest_reach(time, speed, acceleration, jerk)
    needs = (
        (least_acceleration(distance, time, speed, jerk), lambda x: (speed, x, jerk), acceleration),
        (least_jerk(distance, time, speed, acceleration), lambda x: (speed, acceleration, x), jerk),
    )
    for needed, limits, have in needs:
        assert needed <= have * (1 + 1e-9)
        assert greatest_reach(time, *limits(needed)) == pytest.approx(distance, rel=1e-7)
        assert greatest_reach(time, *limits(0.999 * needed)) < distance


@given(size(1e-2, 1e2), *LIMITS, st.floats(0.05, 0.999))
def test_motion_in_a_given_time_takes_that_time(
    time: float, speed: float, acceleration: float, jerk: float, share: float
) -> None:
    distance = share * greatest_reach(time, speed, acceleration, jerk)
    needed = least_acceleration(distance, time, speed, jerk)
    motion = in_time(distance, time, speed, needed, jerk)
    assert motion.time == pytest.approx(time, rel=1e-9)
    assert motion.distance == pytest.approx(distance, rel=1e-6)


# -- the formulas of the literature ---------------------------------------------------------------------------------------


@given(size(1e-2, 1e2), size(1e-2, 1e2), st.floats(32.0001, 1e5))
def test_jerk_limited_peak_acceleration(distance: float, time: float, share: float) -> None:
    """``D = A T²/4 - A² T/(2 J)`` where no speed limit is active."""
    jerk = share * distance / time**3
    a = least_acceleration(distance, time, math.inf, jerk)
    assert a * time**2 / 4 - a**2 * time / (2 * jerk) == pytest.approx(distance, rel=1e-9)


@given(size(1e-2, 1e2), size(1e-2, 1e2))
def test_least_peaks_without_other_limits(distance: float, time: float) -> None:
    unit = distance / time**2
    assert least_acceleration(distance, time, math.inf, math.inf) == pytest.approx(4 * unit, rel=1e-12)
    assert least_jerk(distance, time, math.inf, math.inf) == pytest.approx(32 * unit / time, rel=1e-12)
    at_least_jerk = in_time(distance, time, math.inf, math.inf, 32 * unit / time)
    assert at_least_jerk.acceleration == pytest.approx(8 * unit, rel=1e-9)
    assert at_least_jerk.ramp == pytest.approx(time / 4, rel=1e-9)
    assert at_least_jerk.hold + at_least_jerk.cruise <= 1e-9 * time


def test_nothing_to_do_needs_nothing() -> None:
    assert fastest(0.0, 1.0, 1.0, 1.0).time == 0.0
    assert least_acceleration(0.0, 1.0, 1.0, 1.0) == 0.0
    assert least_jerk(0.0, 1.0, 1.0, 1.0) == 0.0


@pytest.mark.parametrize(
    "needed",
    [
        least_acceleration(1.0, 1.0, 1.0, 1e9),  # at speed 1 all the time is not from rest
        least_acceleration(1.0, 1.0, 10.0, 31.9),
        least_acceleration(1.0, 1.0, 1.5, 50.0),
        least_jerk(1.0, 1.0, 1.0, 1e9),
        least_jerk(1.0, 1.0, 10.0, 3.9),
        least_jerk(1.0, 1.0, 1.25, 6.0),
    ],
)
def test_impossible_is_infinite(needed: float) -> None:
    assert needed == math.inf


@pytest.mark.parametrize(
    "numbers",
    [
        (-1.0, 1.0, 1.0, 1.0),
        (1.0, 0.0, 1.0, 1.0),
        (1.0, 1.0, -1.0, 1.0),
        (1.0, 1.0, 1.0, 0.0),
        (1.0, 1.0, 1.0, math.inf),
    ],
)
def test_senseless_limits_are_refused(numbers: Any) -> None:
    with pytest.raises(
        InputError, match=r"needs a distance >= 0 and limits > 0, the jerk finite; got distance .*, speed"
    ):
        fastest(*numbers)
