"""Lower bounds by an independent road: below every motion that keeps the limits, close to the optimal one."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.sparse import csr_array

from camwright.design.optimise import solve
from camwright.profiles.closed_forms.reach import greatest_reach
from camwright.profiles.closed_forms.softest import softest
from camwright.profiles.cut import Cut
from camwright.profiles.errors import InputError
from camwright.profiles.laws import law
from camwright.profiles.limits import Limits
from camwright.profiles.machines import RotaryKnife
from camwright.profiles.objective import MotionObjective
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.returns import BASELINES, baseline
from camwright.profiles.task import Task
from camwright.validation.bounds.optimality import (
    CLOSED_FORM,
    DUAL,
    QUINTIC,
    SOFTEST,
    _dual_bound,
    _Return,
    lower_bound,
)
from camwright.validation.bounds.quadratic import multipliers
from camwright.validation.bounds.return_dual import integral_of_least

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
    return unit * profile.peak(order)


def keeps(profile: CamProfile, cut: Cut, limits: Limits) -> bool:
    """Whether a cycle has no jumps up to the acceleration and keeps its limits."""
    v = cut.line_speed
    if any(np.abs(profile.jumps(order)).max() > 1e-9 for order in (0, 1, 2)):
        return False
    low, high = profile.extrema(1)
    peaks = [profile.peak(order) for order in (2, 3)]
    return (
        high.value * v <= limits.speed
        and low.value * v >= (-limits.speed if limits.reversal else 0.0)
        and peaks[0] * v**2 <= limits.acceleration
        and peaks[1] * v**3 <= limits.jerk
    )


@pytest.mark.parametrize("objective", ["peak_acceleration", "rms_acceleration", "peak_jerk", "rms_jerk"])
@settings(max_examples=6)
@given(st.floats(-0.6, 0.8), st.floats(1.05, 3.0), st.floats(1.1, 3.0), st.floats(1.2, 30.0), st.booleans())
def test_no_motion_is_below_a_bound(
    objective: MotionObjective, off: float, speed: float, acceleration: float, jerk: float, reversal: bool
) -> None:
    """Whatever profile a bound is taken at, it holds for the optimum and for every law that keeps the limits."""
    assume(abs(off) > 1e-6)  # nearer to the straight line even a jump of the ratio is within the tolerance of `keeps`
    cut = replace(CUT, length=0.4 * math.exp(off))
    distance, time = max(abs(0.4 - cut.length), 0.01), cut.return_zone / cut.line_speed
    limits = Limits(
        cut.line_speed + speed * 1.875 * distance / time,
        acceleration * 5.8 * distance / time**2,
        jerk * 60 * distance / time**3,
        reversal,
    )
    try:
        optimum = solve(Task(KNIFE, cut, limits), objective).profile
    except InputError:
        return
    motions = [profile for name in BASELINES if keeps(profile := baseline(name, Task(KNIFE, cut, LIMITS)), cut, limits)]
    bounds = [lower_bound(profile, Task(KNIFE, cut, limits), objective).value for profile in [optimum, *motions[:2]]]
    for profile in [optimum, *motions]:
        assert max(bounds) <= measured(profile, cut, objective) * (1 + 1e-8)


@pytest.mark.parametrize(
    ("objective", "gap"),
    [("peak_acceleration", 1e-8), ("peak_jerk", 1e-8), ("rms_acceleration", 1e-8), ("rms_jerk", 1e-4)],
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
def test_gap_of_a_design_is_small(objective: MotionObjective, gap: float, limits: Limits) -> None:
    result = solve(Task(KNIFE, CUT, limits), objective)
    bound = lower_bound(result.profile, Task(KNIFE, CUT, limits), objective)
    assert bound.method in (CLOSED_FORM, SOFTEST, QUINTIC, DUAL)
    assert 0.0 <= 1 - bound.value / result.minimised + 1e-9 <= gap


@pytest.mark.parametrize("origin", ["return", "cut"])
@pytest.mark.parametrize("objective", ["rms_acceleration", "rms_jerk"])
def test_bound_does_not_depend_on_the_origin(objective: MotionObjective, origin: str) -> None:
    limits, cut = Limits(1.8, 13.0, 1100.0), replace(CUT, origin=origin)
    result = solve(Task(KNIFE, cut, limits), objective)
    expected = lower_bound(
        solve(Task(KNIFE, CUT, limits), objective).profile, Task(KNIFE, CUT, limits), objective
    ).value
    assert lower_bound(result.profile, Task(KNIFE, cut, limits), objective).value == pytest.approx(expected, rel=1e-6)


def test_closed_forms_are_taken_where_they_hold() -> None:
    profile = baseline("poly_3_4_5", Task(KNIFE, CUT, LIMITS))
    free = Limits(1e3, 1e6, 1e9)
    time, distance = 0.3, 0.2
    quintic = lower_bound(profile, Task(KNIFE, CUT, replace(free, reversal=True)), "rms_jerk")
    assert (quintic.value, quintic.method) == (pytest.approx(math.sqrt(720) * distance / time**3, rel=1e-12), QUINTIC)
    jerk = lower_bound(profile, Task(KNIFE, CUT, replace(free, reversal=True)), "peak_jerk")
    assert (jerk.value, jerk.method) == (pytest.approx(32 * distance / time**3, rel=1e-12), CLOSED_FORM)
    acceleration = lower_bound(profile, Task(KNIFE, CUT, LIMITS), "peak_acceleration")
    a = acceleration.value
    assert a * time**2 / 4 - a**2 * time / (2 * LIMITS.jerk) == pytest.approx(distance, rel=1e-12)


@pytest.mark.parametrize("objective", ["peak_acceleration", "rms_acceleration", "peak_jerk", "rms_jerk"])
def test_straight_line_has_the_bound_zero(objective: str) -> None:
    cut = replace(CUT, length=0.4)
    assert (
        lower_bound(baseline("poly_3_4_5", Task(KNIFE, cut, LIMITS)), Task(KNIFE, cut, LIMITS), objective).value == 0.0
    )


# -- the dual road by itself, where the answer is known -------------------------------------------------------------------


def test_dual_bound_of_the_quintic_is_720() -> None:
    assert _dual_bound(law("poly_3_4_5"), LOOSE) == pytest.approx(720, rel=1e-5)
    assert _dual_bound(law("poly_3_4_5"), LOOSE) <= 720 * (1 + 1e-9)


@pytest.mark.parametrize("name", ["poly_4_5_6_7", "cycloid", "modified_sine"])
def test_dual_bound_does_not_need_the_optimum(name: str) -> None:
    """Only the grid comes from the profile."""
    assert _dual_bound(law(name), LOOSE) == pytest.approx(720, rel=1e-4)
    assert _dual_bound(law(name), LOOSE) <= 720 * (1 + 1e-9)


@pytest.mark.parametrize("room", [1e-1, 1e-2, 1e-3])
@pytest.mark.parametrize("speed", [1.2, 1.5, 3.0])
def test_gap_of_the_least_rms_jerk_in_tight_jobs(speed: float, room: float) -> None:
    """Limits of acceleration and jerk, alike in share, that let a slave go further than it must by a share of ``room``."""
    share = 1.0
    while greatest_reach(1.0, speed, 20 * share, 400 * share) > 1 + room:
        share *= 0.999
    limits = Limits(1 + speed * 0.2, 20 * share * 0.2, 400 * share * 0.2)
    machine, cut = RotaryKnife(1.7), Cut(1.5, 1.0, 0.5, 0.0, 0.0, 1e-4)
    result = solve(Task(machine, cut, limits), "rms_jerk")
    bound = lower_bound(result.profile, Task(machine, cut, limits), "rms_jerk")
    assert bound.method == DUAL
    assert bound.value <= result.minimised * (1 + 1e-8)
    assert bound.value >= result.minimised * (1 - 1e-2)


def test_integral_of_the_least() -> None:
    rng = np.random.default_rng(5)
    first, centre, last, h = 3 * rng.normal(size=(4, 200))
    h = np.abs(h) + 0.1
    s = np.linspace(0, 1, 200_001)
    jerk = np.linspace(-1.3, 1.3, 5001)
    found = integral_of_least(first, centre, last, h, 1.3)
    for i in range(0, 200, 10):
        c, b = first[i], -3 * first[i] + 4 * centre[i] - last[i]
        a = 2 * first[i] - 4 * centre[i] + 2 * last[i]
        price = c + s * (b + s * a)
        best = np.clip(-price, -1.3, 1.3)
        assert found[i] == pytest.approx(-h[i] * np.trapezoid(best**2 / 2 + price * best, s), rel=1e-8)
        least = (jerk**2 / 2 + price[7] * jerk).min()
        assert best[7] ** 2 / 2 + price[7] * best[7] == pytest.approx(least, abs=1e-6)


def test_multipliers_of_a_small_programme() -> None:
    """Least ``(x² + 4 y²) / 2`` with ``x + y = 3`` and ``x <= 2``: x = 2, y = 1, price 4, multiplier 2."""
    bottom, top = np.array([-9.0, -np.inf]), np.array([2.0, np.inf])
    upper, lower, prices = multipliers(np.array([1.0, 4.0]), bottom, top, csr_array(np.ones((1, 2))), np.array([3.0]))
    assert (float(upper[0]), float(prices[0])) == (pytest.approx(2.0, abs=1e-5), pytest.approx(4.0, abs=1e-5))
    assert 0 <= float(lower[0]) <= 1e-5


@settings(max_examples=200)
@given(st.floats(0.01, 9.0), st.floats(0.0, 3.0), st.floats(0.0, 3.0), st.floats(1e-4, 1.0))
def test_softest_motion_is_proved_by_duality(speed: float, acceleration: float, jerk: float, room: float) -> None:
    """Any multipliers give a lower bound of the mean square; those of the motion itself give its own value.

    Prices: ``w`` of the way and ``w`` per unit of cruise of the speed, which make the price of the acceleration a straight line up to the
    cruise; and ``r`` of the jerk, whose slope makes up for what the line and the acceleration differ by on the ramp.
    """
    v, a, j = 1 + speed, 4 * math.exp(acceleration), 32 * math.exp(2 * jerk)
    motion = softest(1.0, 1.0, v, a, j)
    if motion is None:
        assert greatest_reach(1.0, v, a, j) < 1 + 1e-6
        return
    assert greatest_reach(1.0, v, a, j) > 1 - 1e-6
    top, rise, hold, fall = motion.acceleration, motion.rise, motion.hold, motion.fall
    assert motion.time == pytest.approx(1.0, rel=1e-9)
    assert top <= a * (1 + 1e-9)
    assert top / rise <= j * (1 + 1e-9)
    assert top * ((rise + fall) / 2 + hold) <= v * (1 + 1e-9)
    # half of the motion, in pieces on which all is polynomial; Gauss points are exact
    w = top / fall
    way = rise + hold + fall
    node, weight = np.polynomial.legendre.leggauss(6)

    def integral(f: object, start: float, end: float) -> float:
        return float((f(start + (end - start) * (node + 1) / 2) * weight).sum() * (end - start) / 2)  # type: ignore[operator]

    # r' = a - w (way - s) on the ramp, r = 0 at its end: never negative there, the jerk being as large as it may
    def r(s: np.ndarray) -> np.ndarray:
        return top / rise * (s**2 - rise**2) / 2 + w * ((way - s) ** 2 - (way - rise) ** 2) / 2

    inner = r(np.linspace(0, rise, 50))
    assert (inner >= -1e-9 * (1 + np.abs(inner).max())).all()
    ramp = -j * integral(lambda s: np.abs(r(s)), 0, rise) - integral(lambda s: (top / rise * s) ** 2 / 2, 0, rise)
    held = -integral(lambda s: w * (way - s) * top - top**2 / 2, rise, rise + hold)
    falling = -integral(lambda s: (w * (way - s)) ** 2 / 2, rise + hold, way)
    dual = 2 * (ramp + held + falling) + w - v * w * motion.cruise
    assert 2 * dual == pytest.approx(motion.mean_square, rel=1e-6)


def test_unknown_objective_is_refused() -> None:
    with pytest.raises(InputError, match=r"there is no objective 'peak_snap'; .*peak_acceleration, rms_acceleration"):
        lower_bound(baseline("poly_3_4_5", Task(KNIFE, CUT, LIMITS)), Task(KNIFE, CUT, LIMITS), "peak_snap")
