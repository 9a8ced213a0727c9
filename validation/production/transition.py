"""A cycle that leads from one cam into another, judged by the slave's limits: nothing of it repeats, so no check of a cycle is for it."""

from __future__ import annotations

import numpy as np

from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.task import Task
from camwright.validation.check import Check

_ALLOWED = 1e-9
"""Share of a limit that is rounding."""

_SMOOTH = 1e-7
"""Share of a limit by which position, ratio and ratio slope may step inside: a solver's accuracy."""

_POINTS = 2001


def judge_transition(profile: CamProfile, zero: float, task: Task) -> tuple[Check, ...]:
    """Judge a transition.

    Parameters
    ----------
    profile
        The cycle (slave unit over m).
    zero
        Slave coordinate of the machine at its slave zero (slave unit).
    task
        Machine and limits; the cut's line speed is that at which they are to hold.
    """
    v, limits, unit, least = task.cut.line_speed, task.limits, task.machine.slave_unit, task.least_velocity
    slowest, fastest = (extremum.value * v for extremum in profile.extrema(1))
    checks = [
        _at_most("speed", max(abs(slowest), abs(fastest)), limits.speed, f"{unit}/s"),
        Check("reversal", slowest >= least - _ALLOWED * limits.speed, slowest, least, f"{unit}/s", None, "exact"),
    ]
    for order, name, limit in ((2, "acceleration", limits.acceleration), (3, "jerk", limits.jerk)):
        peak = profile.peak(order) * v**order
        checks.append(_at_most(name, peak, limit, f"{unit}/s^{order}"))
    steps = [np.abs(profile.jumps(order, seam=False)).max(initial=0.0) * v**order for order in range(3)]
    allowed = (_SMOOTH * profile.length, _SMOOTH * limits.speed, _SMOOTH * limits.acceleration)
    for order, name in enumerate(("position_step", "speed_step", "acceleration_step")):
        checks.append(_at_most(name, float(steps[order]), allowed[order], (unit, f"{unit}/s", f"{unit}/s^2")[order]))
    if task.machine.guide is not None:
        low, high = task.machine.guide
        behind, ahead = (zero + extremum.value for extremum in profile.extrema(0))
        beyond = max(low - behind, ahead - high, 0.0)
        checks.append(_at_most("stroke", beyond, _ALLOWED * (high - low), unit))
    if limits.motor is not None:
        checks.append(_at_most("motor", _load(profile, zero, task), 1.0, "1"))
    return tuple(checks)


def _at_most(name: str, value: float, limit: float, unit: str) -> Check:
    return Check(name, value <= limit * (1 + _ALLOWED), value, limit, unit, None, "exact")


def _load(profile: CamProfile, zero: float, task: Task) -> float:
    """Greatest share of the motor's torque at its speed, at points along the cycle."""
    machine, curve, v = task.machine, task.limits.motor, task.cut.line_speed
    x = np.concatenate([np.linspace(profile.start, profile.end, _POINTS), profile.breaks])
    y, pace, bend = zero + profile(x), v * profile(x, 1), v**2 * profile(x, 2)
    force = machine.inertia(y) * bend + machine.inertia_slope(y) * pace**2 / 2 + machine.friction * np.sign(pace)
    speed = np.abs(pace) * machine.motor_ratio
    given = curve.torque(np.minimum(speed, curve.top_speed)) * machine.motor_ratio if curve is not None else np.inf
    beyond = np.inf if curve is not None and speed.max() > curve.top_speed * (1 + _ALLOWED) else 0.0
    return float(max((np.abs(force) / given).max(), beyond))
