"""Measures of the motion against closed forms and against a fine grid."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import pytest

from camwright.profiles.cut import Cut
from camwright.profiles.errors import InputError
from camwright.profiles.limits import Limits
from camwright.profiles.machines import CrankSlider, LinearCarriage, RotaryKnife
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.returns import BASELINES, baseline
from camwright.profiles.task import Task
from camwright.validation.motion import (
    MotionMeasures,
    greatest_jump,
    greatest_magnitude,
    is_steady,
    measure_motion,
    measure_tool,
    position_scale,
    slope_scale,
    sync_ratio_error,
)

FREE = Limits(math.inf, math.inf, math.inf)
"""Nothing here asks for limits."""

KNIFE = RotaryKnife(0.4)
CUT = Cut(0.6, 80 / 60, 0.2, 0.04, 0.16, 1e-4)
D, T = -0.2, 0.3
"""Rest-to-rest height y_c - x_c (m) and duration (x_c - l_s) / v (s) of the return of CUT."""

PEAK_ACCELERATION = {  # in |D| / T²
    "cubic": 6.0,
    "poly_3_4_5": 10 / math.sqrt(3),
    "cycloid": 2 * math.pi,
    "parabolic": 4.0,
    "velocity_trapezoid": 4.5,
    "modified_trapezoid": 8 * math.pi / (2 + math.pi),
    "modified_sine": 4 * math.pi**2 / (4 + math.pi),
}
RMS_ACCELERATION = {
    "parabolic": 4.0,
    "cubic": math.sqrt(12),
    "poly_3_4_5": math.sqrt(120 / 7),
    "cycloid": math.pi * math.sqrt(2),
}


@pytest.mark.parametrize("name", [name for name in PEAK_ACCELERATION if name not in ("cubic", "parabolic")])
def test_peak_acceleration_is_the_law_s(name: str) -> None:
    motion = measure_motion(baseline(name, Task(KNIFE, CUT, FREE)), Task(KNIFE, CUT, FREE))
    assert motion.peak_acceleration == pytest.approx(PEAK_ACCELERATION[name] * abs(D) / T**2, rel=1e-10)


@pytest.mark.parametrize("name", ["cubic", "parabolic"])
def test_a_jump_of_the_ratio_slope_leaves_acceleration_bounded_and_jerk_not(name: str) -> None:
    motion = measure_motion(baseline(name, Task(KNIFE, CUT, FREE)), Task(KNIFE, CUT, FREE))
    assert motion.peak_acceleration == pytest.approx(PEAK_ACCELERATION[name] * abs(D) / T**2, rel=1e-12)
    assert (motion.peak_jerk, motion.rms_jerk) == (None, None)


@pytest.mark.parametrize("name", list(RMS_ACCELERATION))
@pytest.mark.parametrize("origin", ["return", "cut"])
def test_rms_acceleration_is_the_law_s_over_the_return_zone(name: str, origin: str) -> None:
    cut = replace(CUT, origin=origin)
    motion = measure_motion(baseline(name, Task(KNIFE, cut, FREE)), Task(KNIFE, cut, FREE))
    assert motion.rms_acceleration == pytest.approx(RMS_ACCELERATION[name] * abs(D) / T**2, rel=1e-9)


def test_jerk_of_the_quintic() -> None:
    motion = measure_motion(baseline("poly_3_4_5", Task(KNIFE, CUT, FREE)), Task(KNIFE, CUT, FREE))
    assert motion.peak_jerk == pytest.approx(60 * abs(D) / T**3, rel=1e-12)
    assert motion.rms_jerk == pytest.approx(math.sqrt(720) * abs(D) / T**3, rel=1e-12)
    assert motion.min_speed == pytest.approx(CUT.line_speed + 15 / 8 * D / T, rel=1e-12)
    assert motion.peak_speed == pytest.approx(CUT.line_speed, rel=1e-14)


@pytest.mark.parametrize("origin", ["return", "cut"])
def test_linear_return_has_no_bounded_acceleration(origin: str) -> None:
    cut = replace(CUT, origin=origin)
    motion = measure_motion(baseline("linear_return", Task(KNIFE, cut, FREE)), Task(KNIFE, cut, FREE))
    assert motion == MotionMeasures(
        pytest.approx(80 / 60), pytest.approx(40 / 60), None, None, None, None, pytest.approx(0.0, abs=1e-15)
    )


@pytest.mark.parametrize("name", BASELINES)
@pytest.mark.parametrize("origin", ["return", "cut"])
@pytest.mark.parametrize("length", [0.31, 0.4, 0.6, 0.7301])
def test_every_baseline_is_in_sync_and_no_grid_point_exceeds_its_peaks(name: str, origin: str, length: float) -> None:
    cut = replace(CUT, length=length, sync_zone=0.1301, shear_zone_at=0.09, origin=origin)
    profile = baseline(name, Task(KNIFE, cut, FREE))
    motion = measure_motion(profile, Task(KNIFE, cut, FREE))
    assert motion.sync_ratio_error <= 1e-12
    x = np.linspace(0.0, profile.end, 2001)
    velocity = cut.line_speed * profile(x, 1)
    assert velocity.max() <= motion.peak_speed * (1 + 1e-12)
    assert velocity.min() >= motion.min_speed - 1e-12
    if motion.peak_acceleration is not None:
        grid = np.abs(cut.line_speed**2 * profile(x, 2))
        assert grid.max() <= motion.peak_acceleration * (1 + 1e-9) + 1e-9
        assert grid.max() >= 0.99 * motion.peak_acceleration - 1e-9


def test_sync_ratio_error_sees_both_halves_of_a_split_sync_zone() -> None:
    cut = replace(CUT, origin="cut")
    profile = baseline("poly_3_4_5", Task(KNIFE, cut, FREE))
    for piece, at in ((0, 0.0), (profile.pieces - 1, 0.5)):
        coefficients = profile.coefficients.copy()
        coefficients[piece, 2] += 0.5e-3 / 0.1  # ratio off by 1e-3 at the end of a piece of 0.1 m
        found = sync_ratio_error(CamProfile(profile.breaks.copy(), coefficients), Task(KNIFE, cut, FREE))
        assert found.value == pytest.approx(1e-3, rel=1e-9)
        assert found.at == pytest.approx(at + 0.1, abs=1e-9)


def test_sync_ratio_error_ignores_a_break_that_rounding_has_moved_into_the_zone() -> None:
    profile = baseline("linear_return", Task(KNIFE, CUT, FREE))
    breaks = profile.breaks.copy()
    breaks[1] = np.nextafter(breaks[1], 1.0)
    assert sync_ratio_error(CamProfile(breaks, profile.coefficients.copy()), Task(KNIFE, CUT, FREE)).value <= 1e-12


def test_jumps_and_scale_of_a_parabolic_return() -> None:
    profile = baseline("parabolic", Task(KNIFE, CUT, FREE))
    jump = greatest_jump(profile, 2)
    peak = 4 * abs(D) / 0.4**2  # ratio slope (1/m) over the return zone of 0.4 m
    assert (jump.value, jump.at) == (pytest.approx(2 * peak), pytest.approx(0.2))
    assert slope_scale(profile) == pytest.approx(peak)
    assert greatest_magnitude(profile, 2).value == pytest.approx(peak)


@dataclass(frozen=True)
class SwingingArm(CrankSlider):
    """A slave counted in rad that comes back: none of the machines here, but one that anybody may write."""

    @property
    def pitch(self) -> float:
        """Zero: it comes back."""
        return 0.0


def test_a_slave_in_rad_is_measured_against_a_turn() -> None:
    """Whatever its pitch: rounding in an arm that comes back is no jump."""
    arm = SwingingArm(0.15, 0.6)
    out_and_back = CamProfile.from_arrays([0.0, 0.5, 1.0], [[0.0, 1.0, 0.0, -4.0], [1e-15, -2.0, -6.0, 12.0]])
    assert position_scale(out_and_back, arm) == position_scale(out_and_back, CrankSlider(0.15, 0.6)) == 2 * math.pi
    assert greatest_jump(out_and_back, 0).value > 0
    assert is_steady(out_and_back, arm)


def test_a_position_jump_makes_the_acceleration_unbounded() -> None:
    profile = baseline("poly_3_4_5", Task(KNIFE, CUT, FREE))
    coefficients = profile.coefficients.copy()
    coefficients[0, 0] -= 1e-9
    motion = measure_motion(CamProfile(profile.breaks.copy(), coefficients), Task(KNIFE, CUT, FREE))
    assert motion.peak_acceleration is None
    assert motion.peak_jerk is None


def test_a_profile_of_another_cut_is_refused_with_both_lengths() -> None:
    profile = baseline("poly_3_4_5", Task(KNIFE, CUT, FREE))
    with pytest.raises(InputError, match=r"from 0\.0 m to 0\.6 m, but one cycle of this cut runs from 0 m .* 0\.61 m"):
        measure_motion(profile, Task(KNIFE, replace(CUT, length=0.61), FREE))
    with pytest.raises(InputError, match=r"from 0\.1 m to 0\.7 m"):
        measure_motion(profile.shift(0.1), Task(KNIFE, CUT, FREE))


CRANK = CrankSlider(0.15, 0.6, 0.02, sync_at=1.5)


@pytest.mark.parametrize("origin", ["return", "cut"])
def test_the_carriage_of_a_crank_against_differences(origin: str) -> None:
    cut = replace(CUT, length=0.9, sync_zone=0.1, origin=origin)
    cycle = baseline("poly_3_4_5", Task(CRANK, cut, FREE))
    tool, slave = measure_tool(cycle, Task(CRANK, cut, FREE)), measure_motion(cycle, Task(CRANK, cut, FREE))
    h = 1e-5
    x = np.linspace(2 * h, cut.length - 2 * h, 20_001)
    start = Task(CRANK, cut, FREE).slave_at_start
    at = [CRANK.tool(start + cycle(x + k * h)) for k in (-1, 0, 1)]
    velocity = cut.line_speed * (at[2] - at[0]) / (2 * h)
    acceleration = cut.line_speed**2 * (at[2] - 2 * at[1] + at[0]) / h**2
    assert tool.peak_speed == pytest.approx(np.abs(velocity).max(), rel=1e-6)
    assert tool.min_speed == pytest.approx(velocity.min(), rel=1e-6)
    assert tool.peak_acceleration == pytest.approx(np.abs(acceleration).max(), rel=1e-3)
    assert slave.min_speed > 0 > tool.min_speed
    assert tool.sync_ratio_error == slave.sync_ratio_error
    assert tool.sync_ratio_error <= 1e-12
    # the jerk by the chain rule
    y, step = start + cycle(x), 1e-6
    third = (CRANK.tool_curvature(y + step) - CRANK.tool_curvature(y - step)) / (2 * step)
    ratio, slope = cycle(x, 1), cycle(x, 2)
    jerk = CRANK.tool_ratio(y) * cycle(x, 3) + 3 * CRANK.tool_curvature(y) * ratio * slope + third * ratio**3
    assert tool.peak_jerk == pytest.approx(cut.line_speed**3 * np.abs(jerk).max(), rel=2e-3)


def test_a_slave_in_metres_is_its_own_tool() -> None:
    cycle = baseline("cycloid", Task(KNIFE, CUT, FREE))
    assert measure_tool(cycle, Task(KNIFE, CUT, FREE)) == measure_motion(cycle, Task(KNIFE, CUT, FREE))


def test_sync_ratio_is_judged_against_what_is_asked() -> None:
    carriage = LinearCarriage(0.6)
    fast = replace(CUT, sync_ratio=1.05)
    assert (
        measure_motion(baseline("cycloid", Task(carriage, fast, FREE)), Task(carriage, fast, FREE)).sync_ratio_error
        <= 1e-12
    )
    found = measure_motion(baseline("cycloid", Task(carriage, CUT, FREE)), Task(carriage, fast, FREE))
    assert found.sync_ratio_error == pytest.approx(1 - 1 / 1.05, rel=1e-9)
