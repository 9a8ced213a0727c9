"""How fast the axis itself moves: its speed and acceleration at every sampling phase, between the samples too."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from camwright.profiles.cut import Cut
from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.profiles.servo import Servo
from camwright.validation.check import Check
from camwright.validation.motion import require_period
from camwright.validation.servo.lifting import lift
from camwright.validation.servo.simulation import PHASES, memory, simulate_part, slow_axis
from camwright.validation.servo.slow_axis import decided, humps

ALLOWANCE = 1e-3
"""What the axis may exceed a limit by, relative to the limit: it is looked at on points, not everywhere."""


@dataclass(frozen=True)
class AxisPeaks:
    """Extremes of the axis' motion over all sampling phases (slave unit).

    Parameters
    ----------
    greatest_velocity, least_velocity
        Signed (slave unit/s).
    peak_acceleration
        Greatest magnitude (slave unit/s²). The sampled reference jumps, so the axis' jerk knows no limit but the servo's.
    """

    greatest_velocity: float
    least_velocity: float
    peak_acceleration: float

    @property
    def peak_speed(self) -> float:
        """Greatest magnitude of the velocity."""
        return max(self.greatest_velocity, -self.least_velocity)


def axis_peaks(profile: CamProfile, cut: Cut, servo: Servo) -> AxisPeaks:
    """Simulate the servo at all phases and take the extremes of the axis' motion.

    Parameters
    ----------
    profile
        One cycle over the master period ``[0, x_c]``.
    cut, servo
        As in `camwright.validation.servo.simulation.simulate`.

    Raises
    ------
    InputError
        The profile does not run over ``[0, x_c]``, or the servo is unstable.
    """
    require_period(profile, cut)
    cycle = (cut.return_start, cut.return_start + cut.length)
    slow = slow_axis(profile, cut, servo, (2, 1), cycle, phases=PHASES)
    if slow is not None:
        return decided(slow, lambda master, found: _with_places(master, found, cut.line_speed))
    lifted = lift(servo.loop, memory(servo.loop), (2, 1))
    slope, ratio = simulate_part(profile, cut, (servo,), lifted, cycle)[1]
    return _peaks(ratio, slope, cut.line_speed)


def _peaks(ratio: FloatArray, slope: FloatArray, line_speed: float) -> AxisPeaks:
    """Extremes of ratio and ratio slope, over time."""
    v = line_speed
    return AxisPeaks(v * float(ratio.max()), v * float(ratio.min()), v**2 * float(np.abs(slope).max()))


def _with_places(master: FloatArray, found: FloatArray, line_speed: float) -> tuple[AxisPeaks, list[float]]:
    """Extremes of ratio slope and ratio, and where they may be (m)."""
    slope, ratio = found
    sizes = (ratio, -ratio, np.abs(slope))
    return _peaks(ratio, slope, line_speed), [place for size in sizes for place in humps(master, size)]


def greatest_peaks(peaks: Sequence[AxisPeaks]) -> AxisPeaks:
    """Take the extremes of several motions of the axis."""
    return AxisPeaks(
        max(each.greatest_velocity for each in peaks),
        min(each.least_velocity for each in peaks),
        max(each.peak_acceleration for each in peaks),
    )


def axis_checks(peaks: AxisPeaks, speed: float, acceleration: float, least_velocity: float, unit: str) -> list[Check]:
    """Check the axis' motion against the limits of speed, acceleration and reversal.

    Parameters
    ----------
    speed, acceleration
        Limits (slave unit/s, slave unit/s²).
    least_velocity
        Least velocity allowed (slave unit/s).
    unit
        Slave unit.
    """
    backward, allowed = max(0.0, -peaks.least_velocity), max(0.0, -least_velocity)
    how = "of the axis itself, at every sampling phase (S1's servo)"
    rows = (
        ("axis_speed", peaks.peak_speed, speed, ALLOWANCE * speed, f"{unit}/s", f"peak speed {how}"),
        (
            "axis_acceleration",
            peaks.peak_acceleration,
            acceleration,
            ALLOWANCE * acceleration,
            f"{unit}/s^2",
            f"peak acceleration {how}",
        ),
        ("axis_reversal", backward, allowed, ALLOWANCE * speed, f"{unit}/s", f"greatest backward speed {how}"),
    )
    return [
        Check(name, value <= limit + room, value, limit, per, None, source)
        for name, value, limit, room, per, source in rows
    ]
