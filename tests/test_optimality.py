"""Lower bounds by an independent road: below every motion that keeps the limits, close to the optimal one."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from design.optimise import solve
from design.problem import Objective
from profiles.cycle import Cut
from profiles.errors import InputError
from profiles.laws import law
from profiles.limits import Limits
from profiles.machines import RotaryKnife
from profiles.polynomial import CamProfile
from profiles.returns import BASELINES, baseline
from validation.optimality import CLOSED_FORM, DUAL, QUINTIC, _absolute_integral, _dual_bound, _Return, lower_bound

KNIFE = RotaryKnife(0.4)
CUT = Cut(0.6, 80 / 60, 0.2, 0.04, 0.16, 1e-4)
LIMITS = Limits(200 / 60, 30.0, 3000.0)
LOOSE = _Return(low=-1e3, high=1e3, slope=1e3, jerk=1e5)


def measured(profile: CamProfile, cut: Cut, objective: str) -> float:
    """Objective of a cycle over time, as a bound is stated."""
    order = 2 if objective.endswith("acceleration") else 3
    unit = cut.line_speed**order
    if objective.startswith("rms"):
        return unit * math.sqrt(profile.mean_square(order, cut.return_start, cut.return_start + cut.return_zone))
    return unit * max(abs(extremum.value) for extremum in profile.extrema(order))


def keeps(profile: CamProfile, cut: Cut, limits: Limits) -> bool:
    """Whether a cycle has no jumps up to the acceleration and keeps its limits."""
    v = cut.line_speed
    if any(np.abs(profile.jumps(order)).max() > 1e-9 for order in (0, 1, 2)):
        return False
    low, high = profile.extrema(1)
    peaks = [max(abs(extremum.value) for extremum in profile.extrema(order)) for order in (2, 3)]
    return (
        high.value * v <= limits.speed
        and low.value * v >= limits.least_velocity
        and peaks[0] * v**2 <= limits.acceleration
        and peaks[1] * v**3 <= limits.jerk
    )


@pytest.mark.parametrize("objective", ["peak_acceleration", "rms_acceleration", "peak_jerk", "rms_jerk"])
@settings(max_examples=6)
@given(st.floats(-0.8, 0.8), st.floats(1.05, 3.0), st.floats(1.1, 3.0), st.floats(1.2, 30.0), st.booleans())
def test_no_motion_is_below_a_bound(
    objective: Objective, off: float, speed: float, acceleration: float, jerk: float, reversal: bool
) -> None:
    """Whatever profile a bound is taken at, it holds for the optimum and for every law that keeps the limits."""
    cut = replace(CUT, length=0.4 * math.exp(off))
    distance, time = max(abs(0.4 - cut.length), 0.01), cut.return_zone / cut.line_speed
    limits = Limits(
        cut.line_speed + speed * 1.875 * distance / time,
        acceleration * 5.8 * distance / time**2,
        jerk * 60 * distance / time**3,
        reversal,
    )
    try:
        optimum = solve(KNIFE, cut, limits, objective).profile
    except InputError:
        return
    motions = [profile for name in BASELINES if keeps(profile := baseline(name, KNIFE, cut), cut, limits)]
    bounds = [lower_bound(profile, KNIFE, cut, limits, objective).value for profile in [optimum, *motions[:2]]]
    for profile in [optimum, *motions]:
        assert max(bounds) <= measured(profile, cut, objective) * (1 + 1e-8)


@pytest.mark.parametrize(
    ("objective", "gap"),
    [("peak_acceleration", 1e-8), ("peak_jerk", 1e-8), ("rms_acceleration", 2e-3), ("rms_jerk", 3e-3)],
)
@pytest.mark.parametrize(
    "limits",
    [
        LIMITS,
        Limits(1.8, 13.0, 1100.0),  # all within reach of the motion
        Limits(200 / 60, 9.6, 900.0),
        replace(LIMITS, reversal=True),
    ],
)
def test_gap_of_a_design_is_small(objective: Objective, gap: float, limits: Limits) -> None:
    result = solve(KNIFE, CUT, limits, objective)
    bound = lower_bound(result.profile, KNIFE, CUT, limits, objective)
    assert bound.method in (CLOSED_FORM, QUINTIC, DUAL)
    assert 0.0 <= 1 - bound.value / result.objective + 1e-9 <= gap


@pytest.mark.parametrize("origin", ["return", "cut"])
@pytest.mark.parametrize("objective", ["rms_acceleration", "rms_jerk"])
def test_bound_does_not_depend_on_the_origin(objective: Objective, origin: str) -> None:
    limits, cut = Limits(1.8, 13.0, 1100.0), replace(CUT, origin=origin)
    result = solve(KNIFE, cut, limits, objective)
    expected = lower_bound(solve(KNIFE, CUT, limits, objective).profile, KNIFE, CUT, limits, objective).value
    assert lower_bound(result.profile, KNIFE, cut, limits, objective).value == pytest.approx(expected, rel=1e-6)


def test_closed_forms_are_taken_where_they_hold() -> None:
    profile = baseline("poly_3_4_5", KNIFE, CUT)
    free = Limits(1e3, 1e6, 1e9)
    time, distance = 0.3, 0.2
    quintic = lower_bound(profile, KNIFE, CUT, replace(free, reversal=True), "rms_jerk")
    assert (quintic.value, quintic.method) == (pytest.approx(math.sqrt(720) * distance / time**3, rel=1e-12), QUINTIC)
    jerk = lower_bound(profile, KNIFE, CUT, replace(free, reversal=True), "peak_jerk")
    assert (jerk.value, jerk.method) == (pytest.approx(32 * distance / time**3, rel=1e-12), CLOSED_FORM)
    acceleration = lower_bound(profile, KNIFE, CUT, LIMITS, "peak_acceleration")
    a = acceleration.value
    assert a * time**2 / 4 - a**2 * time / (2 * LIMITS.jerk) == pytest.approx(distance, rel=1e-12)


@pytest.mark.parametrize("objective", ["peak_acceleration", "rms_acceleration", "peak_jerk", "rms_jerk"])
def test_straight_line_has_the_bound_zero(objective: str) -> None:
    cut = replace(CUT, length=0.4)
    assert lower_bound(baseline("poly_3_4_5", KNIFE, cut), KNIFE, cut, LIMITS, objective).value == 0.0


# -- the dual road by itself, where the answer is known -------------------------------------------------------------------


def test_dual_bound_of_the_quintic_is_720() -> None:
    assert _dual_bound(law("poly_3_4_5"), LOOSE, 3) == pytest.approx(720, rel=1e-4)
    assert _dual_bound(law("poly_3_4_5"), LOOSE, 3) <= 720 * (1 + 1e-9)


@pytest.mark.parametrize("jerk", [1e3, 1e4])
def test_dual_bound_of_the_cubic_is_12(jerk: float) -> None:
    """The cubic is the optimum without a jerk limit: with one, the bound at the design lies between 12 and the design's value."""
    limits = Limits(1e3, 1e6, jerk * 0.2)
    result = solve(RotaryKnife(1.7), Cut(1.5, 1.0, 0.5, 0.0, 0.0, 1e-4), limits, "rms_acceleration")
    motion = result.back.add_line(-1.0).scale(slave=1 / 0.2)
    value = motion.mean_square(2)
    bound = _dual_bound(motion, _Return(low=-1e3, high=1e3, slope=1e3, jerk=jerk), 2)
    assert 12 * (1 - 1e-3) <= bound <= value * (1 + 1e-9)
    assert bound == pytest.approx(value, rel=1e-3)


@pytest.mark.parametrize("name", ["poly_4_5_6_7", "cycloid", "modified_sine"])
@pytest.mark.parametrize(("order", "least"), [(2, 12), (3, 720)])
def test_dual_bound_taken_elsewhere_still_is_a_bound(name: str, order: int, least: float) -> None:
    assert _dual_bound(law(name), LOOSE, order) <= least * (1 + 1e-3 if order == 2 else 1 + 1e-9)


def test_integral_of_absolute_values() -> None:
    rng = np.random.default_rng(5)
    first, centre, last, h = rng.normal(size=(4, 200))
    h = np.abs(h) + 0.1
    s = np.linspace(0, 1, 200_001)
    for i in range(0, 200, 10):
        c, b = first[i], -3 * first[i] + 4 * centre[i] - last[i]
        a = 2 * first[i] - 4 * centre[i] + 2 * last[i]
        naive = h[i] * np.trapezoid(np.abs(c + s * (b + s * a)), s)
        exact = _absolute_integral(first[i : i + 1], centre[i : i + 1], last[i : i + 1], h[i : i + 1])[0]
        assert exact == pytest.approx(naive, rel=1e-8)
    # straight lines and constants
    line = _absolute_integral(np.array([-1.0, 2.0]), np.array([0.0, 2.0]), np.array([1.0, 2.0]), np.array([3.0, 5.0]))
    assert line.tolist() == pytest.approx([1.5, 10.0], rel=1e-14)


def test_unknown_objective_is_refused() -> None:
    with pytest.raises(InputError, match=r"there is no objective 'peak_snap'; .*peak_acceleration, rms_acceleration"):
        lower_bound(baseline("poly_3_4_5", KNIFE, CUT), KNIFE, CUT, LIMITS, "peak_snap")
