"""Minimum cut lengths: the published figures, closed forms, and the search against the definition."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from profiles.cycle import Cut
from profiles.errors import InputError
from profiles.limits import Limits
from profiles.machines import RotaryKnife
from profiles.reach import fastest_return, shortest_time
from profiles.returns import assemble, baseline
from profiles.servo import Servo
from validation.minimum_length import (
    cut_length_eq9,
    cut_length_eq10,
    linear_return_to_tolerance,
    optimised_to_tolerance,
    physical,
    required_sync_zone,
)
from validation.response import servo_response

KNIFE = RotaryKnife(0.4)
CUT = Cut(0.6, 80 / 60, 0.2, 0.04, 0.16, 1e-4)
QUICK = Limits(200 / 60, 100.0, 20_000.0)
GENTLE = Limits(200 / 60, 30.0, 3000.0)
PAPER = Servo(120.0, 0.7, 35.0, 0.004, 1.0)


def test_figure_of_the_paper() -> None:
    assert cut_length_eq9(0.080, 0.400, 80 / 60, 200 / 60) == pytest.approx(0.208, abs=1e-12)


def test_eq10_with_the_crossing_and_a_shear_zone() -> None:
    # 40 + 80 + 0.4 * (400 - 120) mm
    assert cut_length_eq10(0.080, 0.040, 0.400, 80 / 60, 200 / 60) == pytest.approx(0.232, abs=1e-12)


@given(st.floats(0.0, 0.2), st.floats(0.0, 0.1), st.floats(0.31, 2.0), st.floats(0.1, 3.0), st.floats(3.1, 9.0))
def test_eqs_9_and_10_are_eqs_7_and_8_solved(
    shear: float, transition: float, pitch: float, v: float, top: float
) -> None:
    sync = required_sync_zone(transition, shear)
    back = cut_length_eq10(transition, shear, pitch, v, top) - sync  # eq. 7
    assert (pitch - sync) / top == pytest.approx(back / v, rel=1e-9)  # eq. 8
    assert cut_length_eq9(transition, pitch, v, top) == cut_length_eq10(transition, 0.0, pitch, v, top)


def test_required_sync_zone_is_eq5_without_a_shear_zone_and_eq6_with_one() -> None:
    assert required_sync_zone(0.08, 0.0) == 0.08
    assert required_sync_zone(0.08, 0.04) == pytest.approx(0.12)


def test_physical_bound_of_the_reference_case() -> None:
    found = physical(KNIFE, CUT, QUICK)
    assert found.length == pytest.approx(0.204, abs=0.5e-3)
    assert (found.sync_zone, found.transition, found.binding) == (0.04, 0.0, "speed")


@settings(deadline=None, max_examples=100)
@given(st.floats(0.0, 0.3), st.floats(0.3, 3.0), st.floats(5.0, 300.0), st.floats(200.0, 1e5))
def test_physical_bound_solves_its_equation(shear: float, v: float, acceleration: float, jerk: float) -> None:
    cut = replace(CUT, shear_zone=shear, line_speed=v)
    limits = Limits(200 / 60, acceleration, jerk)
    length = physical(KNIFE, cut, limits).length
    assert shear < length < KNIFE.pitch
    time = shortest_time(KNIFE.pitch - length, limits.speed - v, acceleration, jerk)
    assert length == pytest.approx(shear + v * time, rel=1e-9)


def test_physical_bound_without_limits_of_acceleration_and_jerk_is_eq10_of_a_perfect_servo() -> None:
    free = Limits(200 / 60, 1e7, 1e14)
    assert physical(KNIFE, CUT, free).length == pytest.approx(
        cut_length_eq10(0.0, 0.04, 0.4, 80 / 60, 200 / 60), rel=1e-4
    )


@pytest.mark.parametrize(
    ("limits", "binding"),
    [
        (Limits(200 / 60, 1e7, 1e14), "speed"),
        (Limits(50.0, 10.0, 1e9), "acceleration"),
        (Limits(50.0, 1e6, 300.0), "jerk"),
    ],
)
def test_physical_bound_names_what_binds(limits: Limits, binding: str) -> None:
    assert physical(KNIFE, CUT, limits).binding == binding


def test_bang_bang_bound_in_closed_form() -> None:
    # neither speed nor jerk limits: x_c - l_j = v 2 sqrt((y_c - x_c) / A), a quadratic in the root
    a, v, shear, pitch = 25.0, CUT.line_speed, CUT.shear_zone, KNIFE.pitch
    c = 2 * v / math.sqrt(a)
    root = (-c + math.sqrt(c * c + 4 * (pitch - shear))) / 2  # sqrt(y_c - x_c)
    assert physical(KNIFE, CUT, Limits(100.0, a, 1e12)).length == pytest.approx(pitch - root**2, rel=1e-4)


def test_linear_return_of_the_reference_case() -> None:
    found = linear_return_to_tolerance(KNIFE, CUT, QUICK, PAPER)
    assert found.length == pytest.approx(0.301, abs=3e-3)
    assert found.length == pytest.approx(cut_length_eq10(found.transition, 0.04, 0.4, 80 / 60, 200 / 60), abs=2e-6)
    assert found.binding == "settling"


@pytest.mark.parametrize(("tolerance", "length"), [(0.25e-3, 0.292), (0.5e-3, 0.265)])
def test_linear_return_at_other_tolerances(tolerance: float, length: float) -> None:
    found = linear_return_to_tolerance(KNIFE, replace(CUT, sync_tolerance=tolerance), QUICK, PAPER)
    assert found.length == pytest.approx(length, abs=3e-3)


def assert_edge(name: str, sync_zone: float, length: float, cut: Cut, limits: Limits, *, works: bool) -> None:
    shape = replace(cut, length=length, sync_zone=sync_zone, shear_zone_at=sync_zone - cut.shear_zone)
    if name == "linear":
        profile = baseline("linear_return", KNIFE, shape)
    else:
        v = cut.line_speed
        back = fastest_return(0.4 - sync_zone, limits.speed / v, limits.acceleration / v**2, limits.jerk / v**3)
        assert back.end + sync_zone == pytest.approx(length, rel=1e-9)
        profile = assemble(back, KNIFE, replace(shape, length=sync_zone + back.end))
        shape = replace(shape, length=sync_zone + back.end)
    settling = servo_response(profile, KNIFE, shape, PAPER).settling
    assert (settling is not None and settling + cut.shear_zone <= sync_zone) is works


@pytest.mark.parametrize("name", ["linear", "optimised"])
@pytest.mark.parametrize("tolerance", [1e-4, 5e-4])
@pytest.mark.parametrize("limits", [QUICK, GENTLE])
def test_search_ends_on_the_edge_of_what_works(name: str, tolerance: float, limits: Limits) -> None:
    cut = replace(CUT, sync_tolerance=tolerance)
    search = linear_return_to_tolerance if name == "linear" else optimised_to_tolerance
    found = search(KNIFE, cut, limits, PAPER)
    assert_edge(name, found.sync_zone, found.length, cut, limits, works=True)
    below = found.sync_zone - 5e-6
    v = cut.line_speed
    if name == "linear":
        shorter = cut_length_eq10(below, 0.0, 0.4, v, limits.speed)
    else:
        shorter = (
            below + fastest_return(0.4 - below, limits.speed / v, limits.acceleration / v**2, limits.jerk / v**3).end
        )
    assert_edge(name, below, shorter, cut, limits, works=False)
    assert found.length >= physical(KNIFE, cut, limits).length or name == "linear"


def test_the_better_servo_cuts_shorter() -> None:
    stiff = Servo(1500.0, 0.8, 400.0, 0.0002, 1.0)
    found = optimised_to_tolerance(KNIFE, CUT, QUICK, stiff)
    assert found.length < optimised_to_tolerance(KNIFE, CUT, QUICK, PAPER).length
    assert found.length == pytest.approx(physical(KNIFE, CUT, QUICK).length, rel=0.1)


def test_a_knife_that_cannot_run_ahead_cuts_its_own_pitch() -> None:
    tight = replace(QUICK, speed=CUT.line_speed)
    for found in (physical(KNIFE, CUT, tight), optimised_to_tolerance(KNIFE, CUT, tight, PAPER)):
        assert (found.length, found.binding) == (0.4, "speed")


def test_a_shear_zone_as_long_as_the_pitch_is_refused() -> None:
    with pytest.raises(
        InputError, match=r"shear zone of 0\.4 m is not shorter than the slave travel per cycle of 0\.4 m"
    ):
        physical(KNIFE, replace(CUT, shear_zone=0.4), QUICK)
    with pytest.raises(InputError, match="no room for a return"):
        linear_return_to_tolerance(KNIFE, replace(CUT, shear_zone=0.5), QUICK, PAPER)
