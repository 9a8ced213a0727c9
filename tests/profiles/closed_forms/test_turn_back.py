"""Turning back within a room: least peak, room kept, home reached."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camwright.profiles.closed_forms.overshoot import shortest_stop
from camwright.profiles.closed_forms.transfer import Bounds
from camwright.profiles.closed_forms.turn_back import gentlest_turn, quickest_home


@settings(max_examples=40)
@given(st.floats(0.2, 2.0), st.floats(0.02, 0.5), st.floats(0.1, 2.0), st.floats(3.0, 20.0), st.floats(100.0, 2000.0))
def test_it_turns_within_the_room_and_ends_at_rest_at_home(
    v: float, room: float, way: float, a: float, j: float
) -> None:
    bounds = Bounds(-2.0, 2.0, a, j)
    found = gentlest_turn(v, room, way, bounds)
    if found is None:
        assert shortest_stop(v, bounds) > room or way < 4 * room
        return
    profile = found.profile()
    least, greatest = profile.extrema(0)
    assert greatest.value <= room * (1 + 1e-9)
    assert profile.advance == pytest.approx(-way, rel=1e-8)
    assert abs(float(profile(profile.end, 1, side="left"))) <= 1e-6
    assert least.value >= -way * (1 + 1e-8)
    assert found.peak_acceleration <= a * (1 + 1e-9)


def test_the_peak_is_that_of_braking_within_the_room() -> None:
    """Without a jerk limit that is felt, v² / 2R."""
    found = gentlest_turn(1.0, 0.1, 0.5, Bounds(-2.0, 2.0, 20.0, 1e7))
    assert found.peak_acceleration == pytest.approx(1.0 / 0.2, rel=1e-4)


def test_too_little_room_has_no_turn() -> None:
    assert gentlest_turn(1.0, 0.01, 0.5, Bounds(-2.0, 2.0, 20.0, 1000.0)) is None


def test_the_quickest_way_home_waits_for_nothing() -> None:
    bounds = Bounds(-1.0, 1.0, 10.0, 1e6)
    found = quickest_home(1.0, 1.0, bounds)
    # brake 0.1 s over 50 mm, then 1050 mm from rest to rest at 1 m/s at most
    assert sum(time for time, _ in found.phases) == pytest.approx(0.1 + 1.05 / 1.0 + 1.0 / 10.0, rel=1e-3)
    assert math.isclose(found.reach()[1], 0.05, rel_tol=1e-3)
