"""The validation of a profile: every check that concerns its machine, on one list.

Each check compares a value with a limit that it must not exceed, within the allowances named here.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from camwright.profiles.cut import Cut
from camwright.profiles.machines import Machine
from camwright.profiles.polynomial.profile import CamProfile, Extremum
from camwright.profiles.servo import Servo, spectral_radius
from camwright.profiles.task import Task
from camwright.validation.bounds.minimum_length import cut_length_eq10, physical_length, required_sync_zone
from camwright.validation.check import Check
from camwright.validation.motion import (
    POSITION_JUMP,
    RATIO_JUMP,
    SLOPE_JUMP,
    MotionMeasures,
    greatest_jump,
    greatest_magnitude,
    measure_motion,
    measure_tool,
    position_scale,
    ratio_scale,
    slope_scale,
    sync_ratio_error,
)
from camwright.validation.motor import (
    MotorMeasures,
    greatest_load,
    measure_motor,
)
from camwright.validation.production.line_ramp import line_ramp
from camwright.validation.servo.axis_motion import axis_checks, axis_peaks, greatest_peaks
from camwright.validation.servo.lead import LengthError, length_errors
from camwright.validation.servo.line_speeds import line_speed_errors
from camwright.validation.servo.response import ServoResponse, servo_response
from camwright.validation.servo.sweep import Sweep, servo_sweep

CLOSURE = 1e-12
"""What the slave's advance may be off the pitch, relative to the pitch, or to the way out of a slave that comes back: rounding."""

SYNC_RATIO = 1e-9
"""What the tool's speed may be off in the sync zone: a nanometre per metre, below the resolution of any drive."""

ALLOWANCE = 1e-9
"""What a limit may be exceeded by, relative to the limit (for the reversal: to the speed in sync): rounding."""


_SPEEDS = 101
"""Line speeds at which the sync error of a servo-aware design is judged."""

_QUICK, _QUICK_SPEEDS = 0.5, 6
"""Least share of the line speed at which the axis' own limits are judged, and at how many line speeds from there."""


@dataclass(frozen=True)
class ValidationReport:
    """What the validation found.

    Parameters
    ----------
    checks
        All checks, in a fixed order.
    motion, tool
        Measures of the slave, and of the tool; the same where the slave is counted in m.
    motor
        What the profile asks of the motor; judged where the limits know the motor's torque-speed curve.
    tangential_mismatch
        For a rotary knife, the share of the line speed by which a blade in tangential sync falls short of it along the material at the ends
        of the sync zone; horizontal sync has none. None for other machines. Information, judged by no check.
    servo
        Response of the job's servo, ``None`` if it is unstable.
    profile, task, loop
        What was judged, and the servo that it was judged with.
    """

    checks: tuple[Check, ...]
    motion: MotionMeasures
    tool: MotionMeasures
    motor: MotorMeasures
    tangential_mismatch: float | None
    servo: ServoResponse | None
    profile: CamProfile = field(repr=False, compare=False)
    task: Task = field(repr=False, compare=False)
    loop: Servo = field(repr=False, compare=False)

    @property
    def passed(self) -> bool:
        """Whether every check passed."""
        return all(check.passed for check in self.checks)

    @cached_property
    def sweep(self) -> Sweep:
        """Responses over the published ranges of the servo's parameters: information, worked out when it is asked for."""
        return servo_sweep(self.profile, self.task, self.loop)

    @cached_property
    def length_errors(self) -> tuple[LengthError, ...]:
        """Where the cut falls at shares of the line speed, empty if the servo is unstable: information too."""
        return () if self.servo is None else length_errors(self.profile, self.task, self.loop)


def judge(
    profile: CamProfile,
    task: Task,
    servo: Servo,
    *,
    servo_aware: bool = False,
    slowest: float = 1.0,
) -> ValidationReport:
    """Judge a profile, whoever made it.

    Parameters
    ----------
    profile
        One cycle over the master period ``[0, x_c]`` (slave unit).
    task
        The machine, its sync zone placed, the cut that it is judged for, and the limits of the slave.
    servo_aware
        Whether to judge it as a servo-aware design: the axis, too, must keep the limits of speed, acceleration and reversal, and is in sync
        in the shear zone by design, so that there is no transition to judge.
    slowest
        Least line speed at which a servo-aware design must be in sync, as a share of the cut's.

    Raises
    ------
    InputError
        The profile does not run over ``[0, x_c]``, or the machine cannot be in sync over the zone.
    """
    motion, motor = measure_motion(profile, task), measure_motor(profile, task)
    radius = spectral_radius(servo)
    response = servo_response(profile, task, servo) if radius < 1.0 else None
    checks = (
        *_closure(profile, task.machine),
        *_motion(profile, task, motion),
        *_stroke(profile, task),
        *_motor(profile, task, motor),
        *_line(profile, task),
        Check("servo_stability", radius < 1.0, radius, 1.0, "1", None, "largest closed-loop pole in the z-plane (S1)"),
        *_servo(response, task.cut, transition=not servo_aware),
        *(_axis(profile, task, servo, slowest) if servo_aware and response is not None else ()),
        *(_minimum_lengths(response, task) if not servo_aware else ()),
    )
    return ValidationReport(
        checks=checks,
        motion=motion,
        tool=measure_tool(profile, task, motion),
        motor=motor,
        tangential_mismatch=task.machine.tangential_mismatch(task.cut),
        servo=response,
        profile=profile,
        task=task,
        loop=servo,
    )


def _closure(profile: CamProfile, machine: Machine) -> list[Check]:
    """Closure of the cycle and continuity at every join, the seam included."""
    unit, turned = machine.slave_unit, machine.slave_unit == "rad"
    joins = (
        ("position_joins", POSITION_JUMP * position_scale(profile, machine), unit, "position at any join"),
        (
            "ratio_joins",
            RATIO_JUMP * ratio_scale(profile, machine),
            "rad/m" if turned else "1",
            "ratio at any join or the seam (acceleration bounded)",
        ),
        (
            "ratio_slope_joins",
            SLOPE_JUMP * slope_scale(profile),
            "rad/m^2" if turned else "1/m",
            "ratio slope at any join or the seam (jerk bounded)",
        ),
    )
    jumps = [greatest_jump(profile, order) for order in range(3)]
    return [
        Check.at_most(
            "position_closure",
            abs(profile.advance - machine.pitch),
            CLOSURE * (machine.pitch or _travel(profile)),
            unit,
            "the slave advances by the pitch in one cycle" if machine.pitch else "the slave comes back in one cycle",
            profile.end,
        ),
        *(
            Check.at_most(name, jump.value, allowed, per, f"no jump of the {what}", jump.at)
            for jump, (name, allowed, per, what) in zip(jumps, joins, strict=True)
        ),
    ]


def _travel(profile: CamProfile) -> float:
    """Way between the slave's least and greatest position (slave unit)."""
    least, greatest = profile.extrema(0)
    return greatest.value - least.value


def _motion(profile: CamProfile, task: Task, motion: MotionMeasures) -> list[Check]:
    """Sync zone, speed, acceleration, jerk and reversal, exact."""
    machine, cut, limits = task.machine, task.cut, task.limits
    v, unit = cut.line_speed, machine.slave_unit
    in_sync = sync_ratio_error(profile, task)
    least = profile.extrema(1)[0]
    backward = max(0.0, -v * least.value)
    reverses = task.reverses

    def bounded(name: str, value: float | None, limit: float, per: str, order: int, unbounded: Extremum) -> Check:
        source = f"peak of the {name}, exact, at every master position"
        if value is None:
            return Check(name, False, None, limit, unit + per, unbounded.at, source)
        place = greatest_magnitude(profile, order).at
        return Check.at_most(name, value, limit, unit + per, source, place, ALLOWANCE * limit)

    ratio_jump = greatest_jump(profile, 1)
    jump = greatest_jump(profile, 2) if motion.peak_acceleration is not None else ratio_jump
    source = f"tool at {cut.sync_ratio:g} times the line speed in the whole sync zone"
    source = "k = 1 in the whole sync zone (S1)" if cut.sync_ratio == 1.0 else source
    sync = Check.at_most("sync_ratio", in_sync.value, SYNC_RATIO, "1", source, in_sync.at)
    return [
        *(() if cut.shaped else (sync,)),  # a shaped command is judged by its axis alone
        bounded("speed", motion.peak_speed, limits.speed, "/s", 1, ratio_jump),
        bounded("acceleration", motion.peak_acceleration, limits.acceleration, "/s^2", 2, ratio_jump),
        bounded("jerk", motion.peak_jerk, limits.jerk, "/s^3", 3, jump),
        Check.at_most(
            "reversal",
            backward,
            limits.speed if reverses else 0.0,
            f"{unit}/s",
            "greatest backward speed; 0 unless reversal is allowed or the machine comes back",
            least.at,
            ALLOWANCE * (limits.speed if reverses else v * ratio_scale(profile, machine)),
        ),
    ]


def _stroke(profile: CamProfile, task: Task) -> list[Check]:
    """Whether the slave stays on its guide, if it has one."""
    machine = task.machine
    if machine.guide is None:
        return []
    start = task.slave_zero(profile)
    low, high = machine.guide
    middle, stroke = low + 0.5 * (high - low), high - low
    least, greatest = profile.extrema(0)
    behind, ahead = middle - (start + least.value), start + greatest.value - middle
    source = "greatest distance of the carriage from the middle of its stroke"
    at = least.at if behind > ahead else greatest.at
    return [
        Check.at_most("stroke", max(behind, ahead), 0.5 * stroke, machine.slave_unit, source, at, ALLOWANCE * stroke)
    ]


def _motor(profile: CamProfile, task: Task, motor: MotorMeasures) -> list[Check]:
    """Whether the motor can do it, where its torque-speed curve is given; its torque where the job says what it moves."""
    curve = task.limits.motor
    if curve is None:
        return []
    top, most = curve.top_speed, curve.points[0][1]
    source = "peak speed of the motor, exact, against the end of its torque-speed curve"
    at = greatest_magnitude(profile, 1).at
    checks = [Check.at_most("motor_speed", motor.peak_speed, top, "rad/s", source, at, ALLOWANCE * top)]
    name, source = (
        "motor_torque",
        "torque against what the motor gives at its speed, where that is nearest or exceeded most",
    )
    if motor.peak_torque is not None:
        torque, available = greatest_load(profile, task, curve)
        checks.append(Check.at_most(name, torque.value, available, "N m", source, torque.at, ALLOWANCE * most))
    elif task.machine.moves_something:
        checks.append(Check(name, False, None, most, "N m", greatest_jump(profile, 1).at, source))
    return checks


def _line(profile: CamProfile, task: Task) -> list[Check]:
    """Whether the slave keeps its limits while the line ramps as hard as the job says, at any phase."""
    line = task.line
    if not line.ramps:
        return []
    allowed = line_ramp(profile, task)
    asked = (line.speeding, allowed.speeding), (line.braking, allowed.braking)
    worst, bound = max(asked, key=lambda each: each[0] / max(each[1].value, 1e-300))
    limit = bound.value if math.isfinite(bound.value) else None
    source = "ramp of the line against what the limits leave at every phase and every line speed up to the job's"
    passed = limit is None or worst <= limit * (1 + ALLOWANCE) or _borne_but_for_rounding(profile, task)
    return [Check("line_ramp", passed, worst, limit, "m/s^2", bound.at, source)]


def _borne_but_for_rounding(profile: CamProfile, task: Task) -> bool:
    """Whether the ramps asked for exceed the slave's limits by no more than what any limit may be: a small ramp is a small part of them."""
    limits, line = task.limits, task.line
    wider = replace(limits, acceleration=limits.acceleration * (1 + ALLOWANCE), jerk=limits.jerk * (1 + ALLOWANCE))
    allowed = line_ramp(profile, task.with_limits(wider))
    return line.speeding <= allowed.speeding.value and line.braking <= allowed.braking.value


def _servo(response: ServoResponse | None, cut: Cut, *, transition: bool) -> list[Check]:
    """Check what the axis makes of the profile, at the worst phase; without a response all fail."""
    shear = cut.shear_zone
    settling = response.settling if response else None
    crossing = response.crossing if response else None
    needed = required_sync_zone(settling, shear) if settling is not None else None
    crossed = required_sync_zone(crossing, shear) if crossing is not None else None
    settled = needed is not None and needed <= cut.sync_zone
    equation = "eq. 6" if shear > 0 else "eq. 5"
    error = response.shear_zone_error if response else None
    follows = response.peak_following_error if response else None
    zone, rule = cut.sync_zone, f"l_t + l_j <= l_s ({equation}) with l_t"
    rows: list[tuple[str, bool, float | None, float | None, str]] = [
        (
            "following_error",
            response is not None,
            follows,
            None,
            "greatest command minus axis, at every sampling phase (S1's servo)",
        ),
        (
            "crossing",
            settled or (crossed is not None and crossed <= zone),
            crossed,
            zone,
            f"{rule} to the first crossing of the ideal line, or settled before",
        ),
        ("settling", settled, needed, zone, f"{rule} the settling length to the sync tolerance"),
        (
            "shear_zone_error",
            error is not None and error <= cut.sync_tolerance,
            error,
            cut.sync_tolerance,
            "tool against material in the shear zone, at every sampling phase",
        ),
    ]
    kept = rows if transition else rows[-1:]
    return [Check(name, passed, value, limit, "m", None, source) for name, passed, value, limit, source in kept]


def _axis(profile: CamProfile, task: Task, servo: Servo, slowest: float) -> list[Check]:
    """Check the axis itself: its sync error and its limits, at all line speeds that it is for."""
    limits, v = task.limits, task.cut.line_speed
    speeds = np.linspace(slowest, 1.0, _SPEEDS) * v
    # an axis at half the line speed has a quarter of the acceleration: limits are looked at above
    quick = [v] if slowest == 1.0 else np.linspace(max(slowest, _QUICK), 1.0, _QUICK_SPEEDS) * v
    peaks = [axis_peaks(profile, task.at_speed(float(speed)).cut, servo) for speed in quick]
    found = axis_checks(
        greatest_peaks(peaks), limits.speed, limits.acceleration, task.least_velocity, task.machine.slave_unit
    )
    if slowest == 1.0:
        return found
    worst = float(line_speed_errors(profile, task, [servo], speeds).max())
    source = f"tool against material in the shear zone at {_SPEEDS} line speeds from {slowest * v:.4g} m/s, at every sampling phase"
    return [Check.at_most("sync_over_line_speeds", worst, task.cut.sync_tolerance, "m", source), *found]


def _minimum_lengths(response: ServoResponse | None, task: Task) -> list[Check]:
    """Minimum cut lengths of S1, which are those of a rotary knife in tangential sync.

    With a sync ratio ``s`` the knife moves as with a line ``s`` times as fast whose lengths are ``s`` times as long.
    """
    cut = task.cut
    if not task.machine.published:
        return []
    s, v = cut.sync_ratio, cut.sync_ratio * cut.line_speed
    settling = response.settling if response else None
    shortest = (
        cut_length_eq10(s * settling, s * cut.shear_zone, task.machine.pitch, v, task.limits.speed) / s
        if settling is not None
        else None
    )
    as_one = replace(
        cut,
        length=s * cut.length,
        line_speed=v,
        sync_zone=s * cut.sync_zone,
        shear_zone=s * cut.shear_zone,
        sync_ratio=1.0,
    )
    return [
        Check(
            "minimum_cut_length",
            shortest is not None and shortest <= cut.length * (1 + ALLOWANCE),
            shortest,
            cut.length,
            "m",
            None,
            "minimum cut length (eq. 10) with l_t the settling length to the sync tolerance",
        ),
        Check.at_most(
            "physical_cut_length",
            physical_length(task.with_cut(as_one)) / s,
            cut.length,
            "m",
            "shortest cut length of a perfect axis under limits of speed, acceleration and jerk",
            room=ALLOWANCE * cut.length,
        ),
    ]
