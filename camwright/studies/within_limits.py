"""Whether a profile keeps the limits of a job: what breaks one is marked wherever it is compared."""

from __future__ import annotations

import numpy as np

from camwright.jobs.job import Job
from camwright.profiles.polynomial.profile import CamProfile
from camwright.validation.motion import MotionMeasures
from camwright.validation.motor import motor_torque
from camwright.validation.production.line_ramp import line_ramp

_BEYOND = 1e-8
"""Part of a limit by which the solver's accuracy may exceed it."""

_POINTS = 20_001
"""Points along the cycle at which torque and speed are held against the motor's curve."""


def keeps_limits(profile: CamProfile, motion: MotionMeasures, job: Job) -> bool:
    """Whether a profile keeps speed, acceleration, jerk, reversal, the stroke and the motor's curve, and bears the ramps of the line.

    Parameters
    ----------
    job
        The job, the place of the sync zone chosen.
    """
    return (
        _keeps_motion(motion, job)
        and _keeps_stroke(profile, job)
        and _keeps_curve(profile, job)
        and _bears_ramps(profile, job)
    )


def _bears_ramps(profile: CamProfile, job: Job) -> bool:
    """Whether the line may ramp as the job says."""
    if not job.line.ramps:
        return True
    allowed = line_ramp(profile, job.task)
    return job.line.speeding <= allowed.speeding.value * (1 + _BEYOND) and job.line.braking <= allowed.braking.value * (
        1 + _BEYOND
    )


def _keeps_motion(motion: MotionMeasures, job: Job) -> bool:
    """Whether a motion keeps speed, acceleration, jerk and, where it is forbidden, does not turn back."""
    limits = job.limits
    if motion.peak_acceleration is None or motion.peak_jerk is None:
        return False
    return (
        motion.peak_speed <= limits.speed * (1 + _BEYOND)
        and motion.min_speed >= job.task.least_velocity - _BEYOND * limits.speed
        and motion.peak_acceleration <= limits.acceleration * (1 + _BEYOND)
        and motion.peak_jerk <= limits.jerk * (1 + _BEYOND)
    )


def _keeps_stroke(profile: CamProfile, job: Job) -> bool:
    """Whether the slave stays on its guide, if it has one."""
    if job.machine.guide is None:
        return True
    low, high = job.machine.guide
    start = job.task.slave_zero(profile) - low
    least, greatest = profile.extrema(0)
    rounding = _BEYOND * (high - low)
    return start + least.value >= -rounding and start + greatest.value <= high - low + rounding


def _keeps_curve(profile: CamProfile, job: Job) -> bool:
    """Whether the motor can give the torque of a steady motion at each of its speeds; judged at points along the cycle."""
    curve = job.limits.motor
    if curve is None:
        return True
    torque = motor_torque(profile, job.task)
    x = np.linspace(profile.start, profile.end, _POINTS)
    available = curve.torque(job.cut.line_speed * job.machine.motor_ratio * profile(x, 1))
    return bool(np.all(np.abs(torque(x)) <= available * (1 + _BEYOND)))
