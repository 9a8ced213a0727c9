"""A motor's torque-speed curve as limits of the slave.

A motion keeps a falling curve if it stays within one of its rectangles, some speed and the torque that the motor still gives there. A
rectangle is a limit of speed and one of acceleration, so the machinery for these serves; the best rectangle is taken. What a motion
could gain by using different torques at different speeds is left.
"""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import numpy as np

from camwright.profiles.limits import Limits
from camwright.profiles.machines import Machine
from camwright.profiles.polynomial.profile import FloatArray

# Places, around a crank or along a guide, at which the inertia is looked at.
PLACES = 3600
# How often the lowest speed of a rectangle is halved where the torque depends on the speed itself.
HALVINGS = 6


@lru_cache(maxsize=1024)
def motor_limits(machine: Machine, limits: Limits) -> tuple[Limits, ...]:
    """Limits of the slave, one for each rectangle of the motor's curve that leaves any acceleration; those given if there is no curve.

    The force at the slave is at most ``I A + I' V² / 2 + F`` with the largest inertia ``I`` and inertia slope ``I'``: exact for constant
    inertia, on the safe side elsewhere. There the force grows with the speed even at rest, so lower speeds are looked at, too.
    """
    if limits.motor is None:
        return (limits,)
    around = _around(machine)
    inertia = float(np.max(machine.inertia(around)))
    slope = float(np.max(np.abs(machine.inertia_slope(around))))
    rectangles = limits.motor.rectangles()
    if slope > 0:
        first, torque = rectangles[0]
        rectangles = [(first / 2**k, torque) for k in range(HALVINGS, 0, -1)] + rectangles
    found = []
    for motor_speed, torque in rectangles:
        speed = min(limits.speed, motor_speed / machine.motor_ratio)
        force = torque * machine.motor_ratio - machine.friction - 0.5 * slope * speed**2
        if force <= 0:
            continue
        acceleration = min(limits.acceleration, force / inertia) if inertia > 0 else limits.acceleration
        found.append(replace(limits, speed=speed, acceleration=acceleration, motor=None))
    return tuple(found)


def motor_speed_limits(machine: Machine, limits: Limits) -> Limits:
    """Limits without the motor's torque: only its top speed remains."""
    if limits.motor is None:
        return limits
    return replace(limits, speed=min(limits.speed, limits.motor.top_speed / machine.motor_ratio), motor=None)


def _around(machine: Machine) -> FloatArray:
    """Slave coordinates at which the inertia is looked at; one will do where it does not change.

    Raises
    ------
    TypeError
        The inertia changes, and the machine has neither a pitch nor a guide that says how far.
    """
    if machine.constant_inertia:
        return np.zeros(1)
    if machine.guide is None and not machine.pitch:
        raise TypeError(f"the inertia of a {machine.kind} changes with its place: it must say where by a guide")
    least, greatest = machine.guide or (0.0, machine.pitch)
    return np.linspace(least, greatest, PLACES + 1)
