"""The bounds of starts and stops: never above what a motion needs, and met by the designs."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camwright.profiles.closed_forms.run_up import (
    coolest,
    gentlest,
    quickest,
    shortest,
    top_velocity,
)
from camwright.profiles.closed_forms.transfer import Bounds, State
from camwright.profiles.closed_forms.turn_back import gentlest_turn
from camwright.validation.production.run_up_bound import least_heat, least_peak, least_time, least_turn_peak, least_way


@settings(max_examples=40)
@given(st.floats(0.1, 5.0), st.floats(2.0, 100.0), st.floats(50.0, 2e4), st.floats(-0.95, 0.95), st.floats(1.0, 6.0))
def test_bounds_are_below_and_near(v: float, a: float, j: float, share: float, factor: float) -> None:
    end = State(v, share * min(a, math.sqrt(2 * j * v)))
    bounds = Bounds(0.0, top_velocity(end, j), a, j)
    least = shortest(end, bounds)
    assert least_way(end, a, j) == pytest.approx(least.distance, rel=1e-6)
    way = factor * least.distance
    found = (
        gentlest(way, end, bounds).peak_acceleration,
        coolest(way, end, bounds).heat,
        quickest(way, end, bounds).time,
    )
    bound = least_peak(way, end, j), least_heat(way, end, a, j), least_time(way, end, a, j)
    assert all(low <= high * (1 + 1e-7) for low, high in zip(bound, found, strict=True))
    assert bound[0] == pytest.approx(
        found[0], rel=1e-5
    )  # near the least way the peak goes with the root of what is left of it


@settings(max_examples=40)
@given(st.floats(0.1, 5.0), st.floats(2.0, 100.0), st.floats(50.0, 2e4), st.floats(1.0, 6.0))
def test_bounds_prove_starts_to_an_even_speed(v: float, a: float, j: float, factor: float) -> None:
    end, bounds = State(v, 0.0), Bounds(0.0, v, a, j)
    way = factor * shortest(end, bounds).distance
    assert least_heat(way, end, a, j) == pytest.approx(coolest(way, end, bounds).heat, rel=1e-3)
    assert least_time(way, end, a, j) == pytest.approx(quickest(way, end, bounds).time, rel=1e-3)


def test_no_way_is_enough_for_an_end_beyond_the_limits() -> None:
    assert least_way(State(1.0, 31.0), 30.0, 3000.0) == math.inf
    assert least_way(State(0.01, 10.0), 30.0, 3000.0) == math.inf
    assert least_peak(1.0, State(0.01, 10.0), 3000.0) == math.inf


@settings(max_examples=40)
@given(st.floats(0.2, 2.0), st.floats(0.05, 0.5), st.floats(100.0, 5000.0))
def test_a_turn_is_proved(v: float, room: float, j: float) -> None:
    found = gentlest_turn(v, room, 1.0, Bounds(-3.0, 3.0, 100.0, j))
    bound = least_turn_peak(v, room, j)
    if found is None:
        assert bound > 100.0 * (1 - 1e-6)
    else:
        assert bound <= found.peak_acceleration * (1 + 1e-9)
