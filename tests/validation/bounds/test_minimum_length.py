"""Minimum cut lengths: the published figures, closed forms, and the search against the definition."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camwright.profiles.closed_forms.reach import (
    fastest,
    least_acceleration,
    shortest_return_length,
)
from camwright.profiles.cut import Cut
from camwright.profiles.errors import InputError
from camwright.profiles.limits import Limits
from camwright.profiles.machines import RotaryKnife
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.returns import assemble, baseline
from camwright.profiles.servo import Servo
from camwright.profiles.task import Task
from camwright.validation.bounds.minimum_length import (
    Law,
    cut_length_eq10,
    physical,
    required_sync_zone,
    to_tolerance,
)
from camwright.validation.servo.response import servo_response

FREE = Limits(math.inf, math.inf, math.inf)
"""Nothing here asks for limits."""

KNIFE = RotaryKnife(0.4)
CUT = Cut(0.6, 80 / 60, 0.2, 0.04, 0.16, 1e-4)
QUICK = Limits(200 / 60, 100.0, 20_000.0)
GENTLE = Limits(200 / 60, 30.0, 3000.0)
PAPER = Servo(120.0, 0.7, 35.0, 0.004, 1.0)


def test_figure_of_the_paper() -> None:
    assert cut_length_eq10(0.080, 0.0, 0.400, 80 / 60, 200 / 60) == pytest.approx(0.208, abs=1e-12)


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
    no_width = transition + v / top * (pitch - transition)  # eq. 9
    assert cut_length_eq10(transition, 0.0, pitch, v, top) == pytest.approx(no_width, rel=1e-12)


def test_required_sync_zone_is_eq5_without_a_shear_zone_and_eq6_with_one() -> None:
    assert required_sync_zone(0.08, 0.0) == 0.08
    assert required_sync_zone(0.08, 0.04) == pytest.approx(0.12)


def test_physical_bound_of_the_reference_case() -> None:
    found = physical(Task(KNIFE, CUT, QUICK))
    assert found.length == pytest.approx(0.204, abs=0.5e-3)
    assert (found.sync_zone, found.transition, found.binding) == (0.04, 0.0, "speed")


@settings(deadline=None, max_examples=100)
@given(st.floats(0.0, 0.3), st.floats(0.3, 3.0), st.floats(5.0, 300.0), st.floats(200.0, 1e5))
def test_physical_bound_solves_its_equation(shear: float, v: float, acceleration: float, jerk: float) -> None:
    cut = replace(CUT, shear_zone=shear, line_speed=v)
    limits = Limits(200 / 60, acceleration, jerk)
    length = physical(Task(KNIFE, cut, limits)).length
    assert shear < length < KNIFE.pitch
    time = fastest(KNIFE.pitch - length, limits.speed - v, acceleration, jerk).time
    assert length == pytest.approx(shear + v * time, rel=1e-9)


def test_physical_bound_without_limits_of_acceleration_and_jerk_is_eq10_of_a_perfect_servo() -> None:
    free = Limits(200 / 60, 1e7, 1e14)
    assert physical(Task(KNIFE, CUT, free)).length == pytest.approx(
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
    assert physical(Task(KNIFE, CUT, limits)).binding == binding


def test_bang_bang_bound_in_closed_form() -> None:
    # neither speed nor jerk limits: x_c - l_j = v 2 sqrt((y_c - x_c) / A), a quadratic in the root
    a, v, shear, pitch = 25.0, CUT.line_speed, CUT.shear_zone, KNIFE.pitch
    c = 2 * v / math.sqrt(a)
    root = (-c + math.sqrt(c * c + 4 * (pitch - shear))) / 2  # sqrt(y_c - x_c)
    assert physical(Task(KNIFE, CUT, Limits(100.0, a, 1e12))).length == pytest.approx(pitch - root**2, rel=1e-4)


def test_linear_return_of_the_reference_case() -> None:
    found = to_tolerance(Task(KNIFE, CUT, QUICK), PAPER, "linear_return")
    assert found.length == pytest.approx(0.2995, abs=2e-4)
    assert found.length == pytest.approx(cut_length_eq10(found.transition, 0.04, 0.4, 80 / 60, 200 / 60), abs=5e-6)
    assert found.binding == "settling"


@pytest.mark.parametrize(("tolerance", "length"), [(0.25e-3, 0.2745), (0.5e-3, 0.2632)])
def test_linear_return_at_other_tolerances(tolerance: float, length: float) -> None:
    cut = replace(CUT, sync_tolerance=tolerance)
    found = to_tolerance(Task(KNIFE, cut, QUICK), PAPER, "linear_return")
    assert found.length == pytest.approx(length, abs=2e-4)
    assert works("linear", found.length, found.sync_zone, cut, QUICK)


def lower(name: str, sync_zone: float, limits: Limits) -> float:
    """Cut length of the shortest return beside a sync zone."""
    v = CUT.line_speed
    if name == "linear":
        return cut_length_eq10(sync_zone, 0.0, 0.4, v, limits.speed)
    return sync_zone + shortest_return_length(
        0.4 - sync_zone, limits.speed / v, limits.acceleration / v**2, limits.jerk / v**3
    )


def cycle(name: str, shape: Cut, limits: Limits) -> CamProfile:
    """Cycle of the linear return or of the return of least acceleration, this one by the law of the double-S."""
    if name == "linear":
        return baseline("linear_return", Task(KNIFE, shape, FREE))
    v, rise, length = shape.line_speed, 0.4 - shape.length, shape.return_zone
    speed, jerk = limits.speed / v - 1, limits.jerk / v**3
    motion = fastest(rise, speed, least_acceleration(rise, length, speed, jerk), jerk)
    assert motion.time == pytest.approx(length, rel=1e-6)
    back = motion.profile()
    breaks = back.breaks * (length / back.end)
    breaks[-1] = length
    return assemble(CamProfile(breaks, back.coefficients.copy()).add_line(1.0), Task(KNIFE, shape, FREE))


def works(name: str, length: float, sync_zone: float, cut: Cut, limits: Limits) -> bool:
    shape = replace(cut, length=length, sync_zone=sync_zone, shear_zone_at=sync_zone - cut.shear_zone)
    settling = servo_response(cycle(name, shape, limits), Task(KNIFE, shape, FREE), PAPER).settling
    return settling is not None and required_sync_zone(settling, cut.shear_zone) <= sync_zone + 1e-9


@pytest.mark.parametrize("name", ["linear", "optimised"])
@pytest.mark.parametrize("tolerance", [1e-4, 5e-4])
@pytest.mark.parametrize("limits", [QUICK, GENTLE])
def test_the_minimum_works_and_nothing_near_it_is_shorter(name: str, tolerance: float, limits: Limits) -> None:
    cut = replace(CUT, sync_tolerance=tolerance)
    law: Law = "linear_return" if name == "linear" else "least_acceleration"
    found = to_tolerance(Task(KNIFE, cut, limits), PAPER, law)
    assert found.length >= lower(name, found.sync_zone, limits) * (1 - 1e-12)
    # a nanometre longer: at the shortest return the limits leave the closed form no room for rounding
    assert works(name, found.length + 1e-9, found.sync_zone, cut, limits)
    assert found.transition <= found.sync_zone - cut.shear_zone + 1e-9
    for step in (0.0, 1e-5, -1e-5, 3e-4, -3e-4, 4e-3, -4e-3):
        length, sync_zone = found.length - 5e-6, found.sync_zone + step
        if length > lower(name, sync_zone, limits):
            assert not works(name, length, sync_zone, cut, limits)


@pytest.mark.parametrize(("name", "limits"), [("linear", QUICK), ("optimised", QUICK), ("optimised", GENTLE)])
def test_no_cut_length_on_a_coarse_grid_is_shorter(name: str, limits: Limits) -> None:
    law: Law = "linear_return" if name == "linear" else "least_acceleration"
    least = to_tolerance(Task(KNIFE, CUT, limits), PAPER, law).length
    tried = 0
    for i in range(1, 48):
        sync_zone = 0.04 + 0.36 * i / 48
        length = least - 1e-5
        while length > lower(name, sync_zone, limits):
            assert not works(name, length, sync_zone, CUT, limits)
            length -= 4e-3
            tried += 1
    assert tried > 100


def test_least_acceleration_beats_the_shortest_return() -> None:
    # 331.9 mm is the least that the shortest return within these limits reaches, whatever its sync zone
    found = to_tolerance(Task(KNIFE, CUT, GENTLE), PAPER, "least_acceleration")
    assert found.length == pytest.approx(0.3169, abs=2e-4)
    assert found.length > lower("optimised", found.sync_zone, GENTLE) + 5e-3


def test_a_servo_that_needs_no_time_to_settle_cuts_at_the_physical_bound() -> None:
    # within a tolerance beyond every error, the smallest sync zone tried is the best
    cut = replace(CUT, sync_tolerance=1.0)
    found = to_tolerance(Task(KNIFE, cut, QUICK), PAPER, "least_acceleration")
    assert found.transition == 0.0
    assert found.length == pytest.approx(physical(Task(KNIFE, cut, QUICK)).length, abs=2e-5)
    assert found.binding == "speed"


def test_a_servo_that_never_settles_cuts_the_pitch() -> None:
    lagging = replace(PAPER, velocity_feedforward=0.0)
    found = to_tolerance(Task(KNIFE, CUT, QUICK), lagging, "least_acceleration")
    assert (found.length, found.sync_zone, found.transition, found.binding) == (0.4, 0.4, 0.0, "settling")


def test_the_better_servo_cuts_shorter() -> None:
    stiff = Servo(1500.0, 0.8, 400.0, 0.0002, 1.0)
    found = to_tolerance(Task(KNIFE, CUT, QUICK), stiff, "least_acceleration")
    assert found.length < to_tolerance(Task(KNIFE, CUT, QUICK), PAPER, "least_acceleration").length
    assert found.length == pytest.approx(physical(Task(KNIFE, CUT, QUICK)).length, rel=0.1)


def test_a_knife_that_cannot_run_ahead_cuts_its_own_pitch() -> None:
    tight = replace(QUICK, speed=CUT.line_speed)
    for found in (
        physical(Task(KNIFE, CUT, tight)),
        to_tolerance(Task(KNIFE, CUT, tight), PAPER, "least_acceleration"),
    ):
        assert (found.length, found.binding) == (0.4, "speed")


def test_a_shear_zone_as_long_as_the_pitch_is_refused() -> None:
    with pytest.raises(
        InputError, match=r"shear zone of 0\.4 m is not shorter than the slave travel per cycle of 0\.4 m"
    ):
        physical(Task(KNIFE, replace(CUT, shear_zone=0.4), QUICK))
    with pytest.raises(InputError, match="no room for a return"):
        to_tolerance(Task(KNIFE, replace(CUT, shear_zone=0.5), QUICK), PAPER, "linear_return")


@pytest.mark.parametrize("sample_time", [0.004, 4e-5])
@pytest.mark.parametrize("law", ["linear_return", "poly_3_4_5"])
def test_shear_zone_shorter_than_what_settling_is_eased_by(law: Law, sample_time: float) -> None:
    """One hundredth of the transition is some 0.7 mm: the eased shear zone began after the end of the cut."""
    servo = replace(PAPER, sample_time=sample_time)
    cuts = [replace(CUT, shear_zone=zone, shear_zone_at=0.2 - zone) for zone in (0.0, 4e-5, 4e-4)]
    found = [to_tolerance(Task(KNIFE, cut, QUICK), servo, law) for cut in cuts]
    assert [each.binding for each in found] == ["speed"] * 3
    assert found[0].length < found[1].length < found[2].length
