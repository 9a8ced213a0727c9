"""How short a piece can be cut: published equations, physical bound, and what the servo really needs.

Letters as in S1: cut length ``x_c``, pitch ``y_c``, line speed ``v``, speed limit ``v_max``, sync zone ``l_s``,
transition length ``l_t``, shear zone ``l_j``. At ``x_c = y_c`` the knife turns at the line speed and is always in
sync, so whatever the limits are, no minimum lies above the pitch; below it the knife must run ahead of the material
in the return zone.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal

from profiles.cycle import Cut
from profiles.errors import InputError
from profiles.limits import Limits
from profiles.machines import RotaryKnife
from profiles.polynomial import CamProfile
from profiles.reach import fastest_return, shortest_return_length
from profiles.returns import assemble, baseline
from profiles.servo import Servo
from validation.response import servo_response

Binding = Literal["speed", "acceleration", "jerk", "settling"]

_SCAN = 24
"""Sync zones tried between shear zone and pitch before the shortest that works is looked for below the first that
does."""

_RESOLUTION = 1e-6
"""Accuracy of the sync zone found, relative to the pitch: well below what a drive resolves."""

_RELAXATION = 0.01
"""Part by which a quantity is eased to see how much the minimum gains by it."""


@dataclass(frozen=True)
class MinimumCutLength:
    """A minimum cut length and what it consists of.

    Parameters
    ----------
    length
        The minimum cut length (m).
    sync_zone
        Sync zone with which it is reached (m).
    transition
        Transition length: the settling length of this very cycle (m), 0 for the physical bound.
    binding
        What binds: the quantity which, eased by one per cent, shortens the cut most.
    """

    length: float
    sync_zone: float
    transition: float
    binding: Binding


def required_sync_zone(transition: float, shear_zone: float) -> float:
    """Shortest sync zone: ``l_s >= l_t + l_j`` (S1, eq. 6; eq. 5 for a cut of no width), all lengths in m."""
    return transition + shear_zone


def cut_length_eq9(transition: float, pitch: float, line_speed: float, speed: float) -> float:
    """Minimum cut length for a cut of no width: ``x_c = l_t + (v / v_max) (y_c - l_t)`` (S1, eq. 9).

    Examples
    --------
    >>> round(cut_length_eq9(transition=0.080, pitch=0.400, line_speed=80 / 60, speed=200 / 60), 6)
    0.208
    """
    return cut_length_eq10(transition, 0.0, pitch, line_speed, speed)


def cut_length_eq10(transition: float, shear_zone: float, pitch: float, line_speed: float, speed: float) -> float:
    """Minimum cut length with a shear zone: ``x_c = l_j + l_t + (v / v_max) (y_c - l_t - l_j)`` (S1, eq. 10).

    The knife runs at its speed limit throughout the return zone; acceleration and jerk are not limited.

    Parameters
    ----------
    transition
        Transition length ``l_t`` (m).
    shear_zone
        Shear zone ``l_j`` (m).
    pitch
        Slave travel per cycle ``y_c`` (m).
    line_speed, speed
        Line speed ``v`` and speed limit ``v_max`` of the slave (m/s).
    """
    sync_zone = required_sync_zone(transition, shear_zone)
    return sync_zone + line_speed / speed * (pitch - sync_zone)


def physical(machine: RotaryKnife, cut: Cut, limits: Limits) -> MinimumCutLength:
    """Shortest cut length of a perfect axis: in sync in the shear zone alone, the fastest return beside it.

    Seen from the material the return is a motion from rest to rest over ``y_c - x_c``, at no more than ``v_max - v``;
    so ``x_c = l_j + v t(y_c - x_c)`` with the shortest time ``t`` of a double-S, whose right side falls as ``x_c``
    grows.

    Raises
    ------
    InputError
        The shear zone is not shorter than the pitch.
    """
    _require_room(machine, cut)
    length = _fastest_cut(machine, cut.line_speed, limits, cut.shear_zone)
    gain = {
        name: length - _fastest_cut(machine, cut.line_speed, eased, cut.shear_zone)
        for name, eased in _eased(limits).items()
    }
    return MinimumCutLength(length, cut.shear_zone, 0.0, _greatest(gain))


def linear_return_to_tolerance(machine: RotaryKnife, cut: Cut, limits: Limits, servo: Servo) -> MinimumCutLength:
    """Shortest cut length with the axis within tolerance in the whole shear zone: linear return.

    Eqs. 6 to 10 with the settling length instead of the crossing, at every sampling phase, each of the cycle in
    question: the return runs at the speed limit (eq. 8), so a sync zone ``l_s`` makes the cut length ``l_s + (v /
    v_max) (y_c - l_s)``; the shortest ``l_s`` is looked for that holds settling length and shear zone. The linear
    return knows no limits of acceleration and jerk.

    Parameters
    ----------
    machine, cut, limits, servo
        Pitch; line speed, shear zone and sync tolerance; speed limit; servo. The cut's own lengths are not used.

    Raises
    ------
    InputError
        The shear zone is not shorter than the pitch, or the servo cannot be simulated
        (`validation.simulation.simulate`).
    """

    def cut_length(sync_zone: float, given: Limits) -> float:
        return cut_length_eq10(sync_zone, 0.0, machine.pitch, cut.line_speed, max(given.speed, cut.line_speed))

    def cycle(shape: Cut) -> CamProfile:
        return baseline("linear_return", machine, shape)

    return _shortest(machine, cut, limits, servo, cut_length, cycle)


def optimised_to_tolerance(machine: RotaryKnife, cut: Cut, limits: Limits, servo: Servo) -> MinimumCutLength:
    """Shortest cut length with the axis within tolerance in the whole shear zone: fastest return.

    As `linear_return_to_tolerance`, with the return of shortest length within the limits of speed, acceleration and
    jerk (`profiles.reach.fastest_return`). A gentler return in a shorter sync zone is not tried.
    """

    def cut_length(sync_zone: float, given: Limits) -> float:
        return _fastest_cut(machine, cut.line_speed, given, sync_zone)

    def cycle(shape: Cut) -> CamProfile:
        back = fastest_return(machine.pitch - shape.sync_zone, *_over_master(limits, cut.line_speed))
        return assemble(back, machine, shape)

    return _shortest(machine, cut, limits, servo, cut_length, cycle)


def _shortest(
    machine: RotaryKnife,
    cut: Cut,
    limits: Limits,
    servo: Servo,
    cut_length: Callable[[float, Limits], float],
    cycle: Callable[[Cut], CamProfile],
) -> MinimumCutLength:
    """Shortest sync zone that holds the settling length of its own cycle and the shear zone: a scan, then bisection.

    The settling length may rise and fall with the sync zone (a swing of the axis slips under the tolerance); the scan
    finds the first of equally spaced zones that works, the bisection the edge below it. A range of working zones that
    fits between two neighbours of the scan is not found.
    """
    _require_room(machine, cut)
    pitch, shear = machine.pitch, cut.shear_zone

    def transition(sync_zone: float) -> float:
        """Settling length, or infinity if shear zone and settling length do not fit."""
        length = cut_length(sync_zone, limits)
        shape = replace(cut, length=length, sync_zone=sync_zone, shear_zone_at=sync_zone - shear, origin="return")
        settling = servo_response(cycle(shape), machine, shape, servo).settling
        return settling if settling is not None and required_sync_zone(settling, shear) <= sync_zone else math.inf

    if limits.speed <= cut.line_speed:  # the knife cannot run ahead of the material
        return MinimumCutLength(pitch, pitch, 0.0, "speed")
    step = (pitch - shear) / _SCAN
    low, high, needed = pitch - step, pitch, 0.0
    for i in range(1, _SCAN):
        found = transition(shear + i * step)
        if found < math.inf:
            low, high, needed = shear + (i - 1) * step, shear + i * step, found
            break
    while high - low > _RESOLUTION * pitch:
        middle = 0.5 * (low + high)
        found = transition(middle)
        if found < math.inf:
            high, needed = middle, found
        else:
            low = middle
    length = cut_length(high, limits)
    gain = {name: length - cut_length(high, eased) for name, eased in _eased(limits).items()}
    gain["settling"] = length - cut_length(high - _RELAXATION * needed, limits)
    return MinimumCutLength(length, high, needed, _greatest(gain))


def _fastest_cut(machine: RotaryKnife, line_speed: float, limits: Limits, sync_zone: float) -> float:
    """Cut length of the fastest return within the limits, beside a sync zone (m)."""
    if limits.speed <= line_speed or sync_zone >= machine.pitch:  # no running ahead, or no need to
        return machine.pitch
    return sync_zone + shortest_return_length(machine.pitch - sync_zone, *_over_master(limits, line_speed))


def _over_master(limits: Limits, line_speed: float) -> tuple[float, float, float]:
    """Limits of ratio (1), ratio slope (1/m) and its slope (1/m²) at a line speed."""
    return limits.speed / line_speed, limits.acceleration / line_speed**2, limits.jerk / line_speed**3


def _eased(limits: Limits) -> dict[Binding, Limits]:
    """Return the limits with one of them eased, by the name of that one."""
    more = 1 + _RELAXATION
    return {
        "speed": replace(limits, speed=more * limits.speed),
        "acceleration": replace(limits, acceleration=more * limits.acceleration),
        "jerk": replace(limits, jerk=more * limits.jerk),
    }


def _greatest(gain: dict[Binding, float]) -> Binding:
    return max(gain, key=lambda name: gain[name])


def _require_room(machine: RotaryKnife, cut: Cut) -> None:
    if not cut.shear_zone < machine.pitch:
        raise InputError(
            f"the shear zone of {cut.shear_zone!r} m is not shorter than the slave travel per cycle of "
            f"{machine.pitch!r} m, so there is no room for a return; shorten the shear zone"
        )
