"""How short a piece can be cut: published equations, physical bound, and what the servo really needs.

Letters as in S1: cut length ``x_c``, pitch ``y_c``, line speed ``v``, speed limit ``v_max``, sync zone ``l_s``,
transition length ``l_t``, shear zone ``l_j``. At ``x_c = y_c`` the knife turns at the line speed and is always in
sync, so whatever the limits are, no minimum lies above the pitch; below it the knife must run ahead of the material
in the return zone.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Literal

from camwright.profiles.closed_forms.reach import in_time, least_acceleration, shortest_return_length
from camwright.profiles.cut import Cut
from camwright.profiles.errors import InputError
from camwright.profiles.limits import Limits
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.returns import assemble, baseline
from camwright.profiles.servo import Servo
from camwright.profiles.task import Task
from camwright.validation.bounds.zone_search import ZoneSearch
from camwright.validation.servo.response import greatest_sync_error, servo_response

Binding = Literal["speed", "acceleration", "jerk", "settling"]

Law = Literal["linear_return", "poly_3_4_5", "least_acceleration"]
"""Returns of which the minimum is looked for."""

_FINE = 64
"""Parts into which the room between shear zone and pitch is divided by the sync zones tried."""

_ZONE_RESOLUTION = 1e-5
"""Step of the sync zone with which the search ends, relative to the pitch."""

_GAIN_RESOLUTION = 1e-4
"""The same where only the gain by an eased quantity is asked for."""

_LENGTH_RESOLUTION = 3e-6
"""Accuracy of the cut length found for a sync zone, relative to the pitch; no smaller gain is looked for."""

_BAND_RESOLUTIONS = 8, 2e-4, 4e-3
"""Parts of the room, accuracy of the cut length and step of the sync zone where several line speeds are looked at."""

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
        Transition length: the settling length of this very cycle (m), 0 for the physical bound and where the knife
        turns at the line speed throughout.
    binding
        What binds: the quantity which, eased by one per cent, shortens the cut most: a limit, or the settling length.
    """

    length: float
    sync_zone: float
    transition: float
    binding: Binding


def required_sync_zone(transition: float, shear_zone: float) -> float:
    """Shortest sync zone: ``l_s >= l_t + l_j`` (S1, eq. 6; eq. 5 for a cut of no width), all lengths in m."""
    return transition + shear_zone


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


def physical_length(task: Task) -> float:
    """Shortest cut length of a perfect axis (m): in sync in the shear zone alone, the fastest return beside it.

    Seen from the material the return is a motion from rest to rest over ``y_c - x_c``, at no more than ``v_max - v``;
    so ``x_c = l_j + v t(y_c - x_c)`` with the shortest time ``t`` of a double-S, whose right side falls as ``x_c``
    grows.

    Raises
    ------
    InputError
        The shear zone is not shorter than the pitch.
    """
    _require_room(task)
    return fastest_cut(task.machine.pitch, task.cut.line_speed, task.limits, task.cut.shear_zone)


def physical(task: Task) -> MinimumCutLength:
    """Shortest cut length of a perfect axis, as `physical_length`, and what binds."""
    cut, length = task.cut, physical_length(task)
    gain = {
        name: length - fastest_cut(task.machine.pitch, cut.line_speed, eased, cut.shear_zone)
        for name, eased in _eased(task.limits).items()
    }
    return MinimumCutLength(length, cut.shear_zone, 0.0, _greatest(gain))


def to_tolerance(task: Task, servo: Servo, law: Law) -> MinimumCutLength:
    """Shortest cut length with the axis within tolerance in the whole shear zone, by a return.

    The shortest cycle of that return that some sync zone has and in which the axis, at every sampling phase, stays
    within the sync tolerance over the last ``l_j`` of the sync zone. The knife runs no faster than the speed limit
    (eq. 8), but slower where that settles sooner. The linear return knows no limits of acceleration and jerk; that of
    the least peak acceleration (`camwright.profiles.closed_forms.reach.least_acceleration`) is tried from the shortest
    that the limits allow at all (`camwright.profiles.closed_forms.reach.shortest_return_length`) to ever gentler ones.

    Sync zones in steps of a 64th of the room between shear zone and pitch are tried; about the best, the step is
    halved down to 1e-5 of the pitch. For each, the cut length is bisected to 3e-6 of the pitch between the shortest
    return and the best length so far, as if a longer cut always settled better. A range of sync zones narrower than
    the steps, or of cut lengths below the one that bisection finds, is not found.

    Parameters
    ----------
    task, servo
        Pitch; line speed, shear zone and sync tolerance; speed limit; servo. The cut's own lengths are not used.
    law
        The return.

    Raises
    ------
    InputError
        The shear zone is not shorter than the pitch, or the servo cannot be simulated
        (`camwright.validation.servo.simulation.simulate`).
    """
    laws = _Laws(task, servo, law)
    cut, pitch = task.cut, task.machine.pitch
    _require_room(task)
    if task.limits.speed <= cut.line_speed:  # the knife cannot run ahead of the material
        return MinimumCutLength(pitch, pitch, 0.0, "speed")
    search = laws.search(_ZONE_RESOLUTION)
    best, zone = search.find()
    if zone == pitch:
        return MinimumCutLength(best, zone, 0.0, "settling")
    shape = search.shape(best, zone)
    shaped = task.with_cut(shape)
    settling = servo_response(laws.cycle(shaped), shaped, servo).settling
    # once more about the answer with each quantity eased, to see what binds
    eased = {name: replace(laws, task=task.with_limits(limits)) for name, limits in _eased(task.limits).items()}
    eased["settling"] = replace(laws, relief=_RELAXATION)
    gain: dict[Binding, float] = {}
    for name, other in eased.items():
        again = other.search(_GAIN_RESOLUTION)
        gain[name] = best - again.refine(again.shorter(zone, best) or best, zone)[0]
    # settled it has, in tolerance as it is; to rounding, before the shear zone begins
    transition = zone - cut.shear_zone if settling is None else settling
    return MinimumCutLength(best, zone, transition, _greatest(gain))


def over_line_speeds(
    task: Task, servo: Servo, law: Literal["linear_return", "poly_3_4_5"], shares: tuple[float, ...]
) -> float | None:
    """Shortest cut length with the axis within tolerance in the whole shear zone at several line speeds, by a law, in its best sync zone.

    As `to_tolerance`, on a coarser grid of sync zones. A cam is fixed over the master, so a slower line is a quicker servo
    (`camwright.profiles.servo.Servo.at_speed`); the limits bind at the full line speed.

    Parameters
    ----------
    task, servo
        As in `to_tolerance`.
    shares
        Line speeds as shares of the cut's.

    Returns
    -------
    float or None
        Cut length (m); ``None`` where no cut below the pitch holds.
    """
    pitch = task.machine.pitch
    _require_room(task)
    if task.limits.speed <= task.cut.line_speed:
        return None
    laws = _Laws(task, servo, law, shares=shares)
    best, zone = ZoneSearch(task.cut, pitch, laws.lower, laws.excess, *_BAND_RESOLUTIONS).find()
    return None if zone == pitch else best


@dataclass(frozen=True)
class _Laws:
    """Cycles of one kind of return, and whether the axis follows them.

    ``relief`` is the part of the transition by which it may end late, ``shares`` the line speeds at which it follows.
    """

    task: Task
    servo: Servo
    law: Law
    relief: float = 0.0
    shares: tuple[float, ...] = (1.0,)

    def search(self, zone_resolution: float) -> ZoneSearch:
        """Search for the minimum cut length."""
        task = self.task
        return ZoneSearch(
            task.cut, task.machine.pitch, self.lower, self.excess, _FINE, _LENGTH_RESOLUTION, zone_resolution
        )

    def lower(self, sync_zone: float) -> float:
        """Cut length of the shortest return beside a sync zone (m)."""
        pitch, line_speed, limits = self.task.machine.pitch, self.task.cut.line_speed, self.task.limits
        if self.law == "linear_return":
            return cut_length_eq10(sync_zone, 0.0, pitch, line_speed, limits.speed)
        if self.law == "poly_3_4_5":
            return _fastest_quintic_cut(pitch, line_speed, limits, sync_zone)
        return fastest_cut(pitch, line_speed, limits, sync_zone)

    def cycle(self, task: Task) -> CamProfile:
        """Cycle of a task with the return of this search."""
        shape = task.cut
        if self.law != "least_acceleration":
            return baseline(self.law, task)
        speed, acceleration, jerk = task.greatest_ratio, task.greatest_slope, task.greatest_jerk
        rise, length = task.machine.pitch - shape.length, shape.return_zone
        # rounding may ask for a little more than the limit at the shortest return
        least = min(acceleration, least_acceleration(rise, length, speed - 1, jerk))
        motion = in_time(rise, length, speed - 1, least, jerk).profile()
        return assemble(motion.over(0.0, length).add_line(1.0), task)

    def excess(self, shape: Cut) -> float:
        """Logarithm of the greatest sync error in the shear zone, over all phases, by the tolerance: the error dies away like a power.

        Of several line speeds the first at which the axis does not follow decides.
        """
        task = self.task.with_cut(shape)
        # a shear zone that is shorter than the relief is its end alone
        start = min(shape.shear_start + self.relief * shape.shear_zone_at, shape.length)
        cycle, greatest = self.cycle(task), 0.0
        for share in self.shares:
            error = greatest_sync_error(cycle, task, self.servo.at_speed(share), start, shape.length)
            greatest = max(greatest, error)
            if greatest > shape.sync_tolerance:
                break
        return math.log(greatest / shape.sync_tolerance) if greatest > 0.0 else -math.inf


def _fastest_quintic_cut(pitch: float, line_speed: float, limits: Limits, sync_zone: float) -> float:
    """Cut length of the fastest polynomial 3-4-5 within the limits, beside a sync zone (m).

    Seen from the material it rises by ``y_c - x_c`` over the return of length ``R``: its peaks are 15/8 of the mean ratio, ``10/sqrt(3)``
    and 60 of the rise over ``R²`` and ``R³``. The rise falls and the powers grow with ``R``, so one bisection finds where all limits hold.
    """
    if limits.speed <= line_speed or sync_zone >= pitch:
        return pitch
    speed, acceleration, jerk = _over_master(limits, line_speed)
    low, high = 0.0, pitch - sync_zone
    while high - low > _LENGTH_RESOLUTION * pitch:
        length = 0.5 * (low + high)
        rise = pitch - sync_zone - length
        shares = (
            15 / 8 * rise / length / (speed - 1),
            10 / 3**0.5 * rise / length**2 / acceleration,
            60 * rise / length**3 / jerk,
        )
        low, high = (low, length) if max(shares) <= 1.0 else (length, high)
    return sync_zone + high


@lru_cache(maxsize=256)  # the cut length has no part in it: all cuts of a book at one line speed ask the same
def fastest_cut(pitch: float, line_speed: float, limits: Limits, sync_zone: float) -> float:
    """Cut length of the fastest return within the limits, beside a sync zone, of a knife with a pitch (m)."""
    if limits.speed <= line_speed or sync_zone >= pitch:  # no running ahead, or no need to
        return pitch
    return sync_zone + shortest_return_length(pitch - sync_zone, *_over_master(limits, line_speed))


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


def _require_room(task: Task) -> None:
    if not task.cut.shear_zone < task.machine.pitch:
        raise InputError(
            f"the shear zone of {task.cut.shear_zone!r} m is not shorter than the slave travel per cycle of "
            f"{task.machine.pitch!r} m, so there is no room for a return; shorten the shear zone"
        )
