"""A cycle as numbers for the page's plots: samples over the master, zones, limits."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from camwright.jobs.job import Job
from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.profiles.task import Task
from camwright.validation.motion import is_steady

POINTS = 721
"""Samples over the cycle."""

_DIGITS = 7
"""Digits of the greatest sample that are sent; what a screen shows is three."""

_STANDING = 1e-9
"""Share of the greatest ratio below which the slave stands and rubs on nothing."""

Samples = dict[str, list[float]]
"""Columns by name, of one length."""


def samples(profile: CamProfile, task: Task) -> Samples:
    """Sample a cycle over the master.

    Parameters
    ----------
    profile
        The cycle (slave unit).
    task
        Its machine, the sync zone placed, and its cut.

    Returns
    -------
    dict
        ``x_m``, ``y`` and ``ratio`` over the master, ``speed``, ``acceleration`` and ``jerk`` over time, and ``torque`` at the motor (N m)
        where the machine moves something and the cycle has no jump; beside it ``available_torque``, what the motor gives at its speed
        there (N m), where the job has its curve. `POINTS` of each, evenly spaced, and where speed, acceleration and jerk are greatest and
        least: a peak may be narrower than a step. A row of `_DIGITS` digits.
    """
    peaks = [extremum.at for order in (1, 2, 3) for extremum in profile.extrema(order)]
    x, v = np.union1d(np.linspace(profile.start, profile.end, POINTS), peaks), task.cut.line_speed
    y, ratio, slope, third = (profile(x, order) for order in range(4))
    columns = {
        "y": y,
        "ratio": ratio,
        "speed": ratio * v,
        "acceleration": slope * v**2,
        "jerk": third * v**3,
    }
    if task.machine.moves_something and is_steady(profile, task.machine):
        columns["torque"] = _torque(profile, task, y, ratio, slope)
        if task.limits.motor is not None:
            columns["available_torque"] = task.limits.motor.torque(ratio * v * task.machine.motor_ratio)
    return {"x_m": x.tolist(), **rounded(columns)}


def rounded(columns: Mapping[str, FloatArray]) -> Samples:
    """Round columns to what a screen can show, so that less is sent; the magnitude of each is that of its greatest value."""
    found = {}
    for name, values in columns.items():
        greatest = float(np.abs(values).max(initial=0.0))
        digits = _DIGITS - 1 - math.floor(math.log10(greatest)) if greatest > 0.0 else 0
        found[name] = np.round(values, digits).tolist()
    return found


def _torque(profile: CamProfile, task: Task, y: FloatArray, ratio: FloatArray, slope: FloatArray) -> FloatArray:
    """Torque at the motor (N m) at each sample: inertia, its change with the place, friction."""
    machine, v = task.machine, task.cut.line_speed
    place = task.slave_zero(profile) + y
    inertial = v**2 * (machine.inertia(place) * slope + machine.inertia_slope(place) * ratio**2 / 2)
    moving = np.abs(ratio) > _STANDING * np.abs(ratio).max()
    return np.asarray((inertial + machine.friction * np.sign(ratio) * moving) / machine.motor_ratio)


def zones(job: Job) -> dict[str, list[list[float]]]:
    """Where the sync zone and the shear zone lie on the master of a cycle (m), as parts of it."""
    cut = job.cut
    start = cut.shear_start % cut.length
    end = start + cut.shear_zone
    shear = [[start, end]] if end <= cut.length else [[start, cut.length], [0.0, end - cut.length]]
    return {"sync": [list(part) for part in cut.sync_parts], "shear": shear if cut.shear_zone > 0.0 else []}


def limits_of(job: Job) -> dict[str, float | bool]:
    """List the limits of the slave in SI units."""
    limits = job.limits
    return {
        "speed": limits.speed,
        "acceleration": limits.acceleration,
        "jerk": limits.jerk,
        "reversal": limits.reversal,
    }
