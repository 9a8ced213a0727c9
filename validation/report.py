"""The validation of a profile: every check that concerns the rotary knife, on one list.

Each check compares a value with a limit that it must not exceed, within the allowances named here.
"""

from __future__ import annotations

from dataclasses import dataclass

from profiles.cycle import Cut
from profiles.limits import Limits
from profiles.machines import RotaryKnife
from profiles.polynomial import CamProfile, Extremum
from profiles.servo import Servo, spectral_radius
from validation.checks import Check
from validation.minimum_length import cut_length_eq10, physical, required_sync_zone
from validation.motion import (
    POSITION_JUMP,
    RATIO_JUMP,
    SLOPE_JUMP,
    Motion,
    greatest_jump,
    greatest_magnitude,
    measure_motion,
    slope_scale,
    sync_ratio_error,
)
from validation.response import ServoResponse, servo_response
from validation.sweep import Sweep, servo_sweep

CLOSURE = 1e-12
"""What the slave's advance may be off the pitch, relative to the pitch: rounding."""

SYNC_RATIO = 1e-9
"""What the ratio may be off 1 in the sync zone: a nanometre per metre, below the resolution of any drive."""

ALLOWANCE = 1e-9
"""What a limit may be exceeded by, relative to the limit (for the reversal: to the line speed): rounding."""


@dataclass(frozen=True)
class ValidationReport:
    """What the validation found.

    Parameters
    ----------
    checks
        All checks, in a fixed order.
    motion
        Measures of the motion.
    servo
        Response of the job's servo, ``None`` if it is unstable.
    sweep
        Responses over the published ranges of the servo's parameters: information, judged by no check.
    """

    checks: tuple[Check, ...]
    motion: Motion
    servo: ServoResponse | None
    sweep: Sweep

    @property
    def passed(self) -> bool:
        """Whether every check passed."""
        return all(check.passed for check in self.checks)


def validate(profile: CamProfile, machine: RotaryKnife, cut: Cut, limits: Limits, servo: Servo) -> ValidationReport:
    """Judge a profile, whoever made it.

    Parameters
    ----------
    profile
        One cycle over the master period ``[0, x_c]``, slave in m.
    machine
        The machine.
    cut
        The cut it is judged for.
    limits
        Limits of the slave.
    servo
        The servo.

    Raises
    ------
    InputError
        The profile does not run over ``[0, x_c]``, or the servo's memory is too long to simulate.
    """
    motion = measure_motion(profile, cut)
    radius = spectral_radius(servo)
    response = servo_response(profile, machine, cut, servo) if radius < 1.0 else None
    checks = (
        *_closure(profile, machine),
        *_motion(profile, cut, limits, motion),
        Check("servo_stability", radius < 1.0, radius, 1.0, "1", None, "largest closed-loop pole in the z-plane (S1)"),
        *_servo(response, machine, cut, limits),
        _physical_bound(machine, cut, limits),
    )
    return ValidationReport(checks, motion, response, servo_sweep(profile, machine, cut, servo))


def _at_most(name: str, value: float, limit: float, allowed: float, unit: str, at: float | None, source: str) -> Check:
    return Check(name, value <= limit + allowed, value, limit, unit, at, source)


def _closure(profile: CamProfile, machine: RotaryKnife) -> list[Check]:
    """Closure of the cycle and continuity at every join, the seam included."""
    step, ratio, slope = (greatest_jump(profile, order) for order in (0, 1, 2))
    return [
        _at_most(
            "position_closure",
            abs(profile.advance - machine.pitch),
            CLOSURE * machine.pitch,
            0.0,
            "m",
            profile.end,
            "the slave advances by the pitch in one cycle",
        ),
        _at_most(
            "position_joins",
            step.value,
            POSITION_JUMP * profile.length,
            0.0,
            "m",
            step.at,
            "no jump of the position at any join",
        ),
        _at_most(
            "ratio_joins",
            ratio.value,
            RATIO_JUMP,
            0.0,
            "1",
            ratio.at,
            "no jump of the ratio at any join or the seam (acceleration bounded)",
        ),
        _at_most(
            "ratio_slope_joins",
            slope.value,
            SLOPE_JUMP * slope_scale(profile),
            0.0,
            "1/m",
            slope.at,
            "no jump of the ratio slope at any join or the seam (jerk bounded)",
        ),
    ]


def _motion(profile: CamProfile, cut: Cut, limits: Limits, motion: Motion) -> list[Check]:
    """Sync zone, speed, acceleration, jerk and reversal, exact."""
    v = cut.line_speed
    in_sync = sync_ratio_error(profile, cut)
    least = profile.extrema(1)[0]
    backward = max(0.0, -v * least.value)
    allowed_backward = limits.speed if limits.reversal else 0.0

    def bounded(name: str, value: float | None, limit: float, unit: str, order: int, unbounded: Extremum) -> Check:
        source = f"peak of the {name}, exact, at every master position"
        if value is None:
            return Check(name, False, None, limit, unit, unbounded.at, source)
        return _at_most(name, value, limit, ALLOWANCE * limit, unit, greatest_magnitude(profile, order).at, source)

    ratio_jump = greatest_jump(profile, 1)
    jump = greatest_jump(profile, 2) if motion.peak_acceleration is not None else ratio_jump
    return [
        _at_most("sync_ratio", in_sync.value, SYNC_RATIO, 0.0, "1", in_sync.at, "k = 1 in the whole sync zone (S1)"),
        bounded("speed", motion.peak_speed, limits.speed, "m/s", 1, ratio_jump),
        bounded("acceleration", motion.peak_acceleration, limits.acceleration, "m/s^2", 2, ratio_jump),
        bounded("jerk", motion.peak_jerk, limits.jerk, "m/s^3", 3, jump),
        _at_most(
            "reversal",
            backward,
            allowed_backward,
            ALLOWANCE * v,
            "m/s",
            least.at,
            "greatest backward speed; 0 unless reversal is allowed",
        ),
    ]


def _servo(response: ServoResponse | None, machine: RotaryKnife, cut: Cut, limits: Limits) -> list[Check]:
    """Check what the axis makes of the profile, at the worst phase; without a response all fail."""
    shear = cut.shear_zone
    settling = response.settling if response else None
    crossing = response.crossing if response else None
    needed = required_sync_zone(settling, shear) if settling is not None else None
    crossed = required_sync_zone(crossing, shear) if crossing is not None else None
    shortest = (
        cut_length_eq10(settling, shear, machine.pitch, cut.line_speed, limits.speed) if settling is not None else None
    )
    settled = needed is not None and needed <= cut.sync_zone
    equation = "eq. 6" if shear > 0 else "eq. 5"
    error = response.shear_zone_error if response else None
    return [
        Check(
            "following_error",
            response is not None,
            response.peak_following_error if response else None,
            None,
            "m",
            None,
            "greatest command minus axis, at every sampling phase (S1's servo)",
        ),
        Check(
            "crossing",
            settled or (crossed is not None and crossed <= cut.sync_zone),
            crossed,
            cut.sync_zone,
            "m",
            None,
            f"l_t + l_j <= l_s ({equation}) with l_t to the first crossing of the ideal line, or settled before",
        ),
        Check(
            "settling",
            settled,
            needed,
            cut.sync_zone,
            "m",
            None,
            f"l_t + l_j <= l_s ({equation}) with l_t the settling length to the sync tolerance",
        ),
        Check(
            "shear_zone_error",
            error is not None and error <= cut.sync_tolerance,
            error,
            cut.sync_tolerance,
            "m",
            None,
            "axis against material in the shear zone, at every sampling phase",
        ),
        Check(
            "minimum_cut_length",
            shortest is not None and shortest <= cut.length * (1 + ALLOWANCE),
            shortest,
            cut.length,
            "m",
            None,
            "minimum cut length (eq. 10) with l_t the settling length to the sync tolerance",
        ),
    ]


def _physical_bound(machine: RotaryKnife, cut: Cut, limits: Limits) -> Check:
    return _at_most(
        "physical_cut_length",
        physical(machine, cut, limits).length,
        cut.length,
        ALLOWANCE * cut.length,
        "m",
        None,
        "shortest cut length of a perfect axis under limits of speed, acceleration and jerk",
    )
