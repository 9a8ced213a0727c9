"""Ramps of least peak acceleration, of least heat or the shortest, from closed forms: into the sync zone and out of it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

from camwright.design.returns.curve_limits import motor_limits
from camwright.profiles.closed_forms.overshoot import shortest_stop
from camwright.profiles.closed_forms.run_up import (
    coolest,
    gentlest,
    quickest,
    shortest,
    top_velocity,
)
from camwright.profiles.closed_forms.transfer import Bounds, State, Transfer
from camwright.profiles.closed_forms.turn_back import gentlest_turn, quickest_home, turns_within
from camwright.profiles.halving import halved
from camwright.profiles.limits import Limits
from camwright.profiles.ramp import Aim, Ramp, Stand

ALLOWED = 1e-9
"""Share by which the sync zone may exceed a limit: rounding."""

_STRIDE = 2.0
_FASTEST = 1e6
"""Factor on the line speed beyond which nothing is looked for."""

_CAPS = tuple(0.97**k for k in range(1, 100, 3))
"""Shares of what a ramp of the line leaves of the acceleration that are tried: the less is used, the more is left of the jerk."""

_REFINED = 40
"""Steps in which the jerk that is left is taken for the peak that was found."""

_OVER = 1.1
"""Factor on the velocity in the end up to which a ramp may go on a line that ramps, where the end has a falling one."""

_WAYS: dict[Aim, Callable[[float, State, Bounds], Transfer | None]] = {
    "peak_acceleration": gentlest,
    "rms_acceleration": coolest,
    "shortest": quickest,
}
_COSTS: dict[Aim, Callable[[Ramp], float]] = {
    "peak_acceleration": lambda ramp: ramp.peak_acceleration,
    "rms_acceleration": lambda ramp: ramp.heat,
    "shortest": lambda ramp: ramp.master,
}


@dataclass(frozen=True)
class Arcs:
    """Ramps over the least ways that a start and a stop need at the line speed; None where no way is enough.

    Parameters
    ----------
    run_up
        From rest to the sync zone.
    run_out
        From the sync zone to a standstill.
    """

    run_up: Ramp | None
    run_out: Ramp | None

    @property
    def whole(self) -> float:
        """Way that both need together (slave unit); infinite where one has none."""
        return math.inf if self.run_up is None or self.run_out is None else self.run_up.arc + self.run_out.arc


def ramp_in(at: Stand, aim: Aim) -> Ramp | None:
    """Design the way from the park into the sync zone; None if the limits allow none from there."""
    return _best(at, aim, lambda limits: _run_up(at.run_up, at.into, limits, aim))


def ramp_out(at: Stand, aim: Aim) -> Ramp | None:
    """Design the way out of the sync zone to rest at the park; None if the limits allow none."""
    if at.task.machine.guide is not None:
        return _best(at, aim, lambda limits: _turn(at, limits, aim))

    def found(limits: Limits) -> Transfer | None:
        way = _run_up(at.run_out, _reversed(at.out_of), limits, aim)
        return None if way is None else way.backwards()

    return _best(at, aim, found)


def least_arcs(at: Stand) -> Arcs:
    """Least ways that start and stop need, wherever the slave parks."""

    def least(end: State) -> Transfer | None:
        ways = (shortest(end, _bounds(end, limits)) for limits in _limits(at))
        return min((way for way in ways if way is not None), key=lambda way: way.distance, default=None)

    up, out, v = least(at.into), least(_reversed(at.out_of)), at.task.cut.line_speed
    return Arcs(None if up is None else Ramp(up, v), None if out is None else Ramp(out.backwards(), v))


def can_start_and_stop(at: Stand) -> bool:
    """Whether the machine can start from its park and stop there."""
    return (
        zone_kept(at)
        and at.parked_within
        and ramp_in(at, "shortest") is not None
        and ramp_out(at, "shortest") is not None
    )


def has_room(at: Stand) -> bool:
    """Whether the ways from the park and beyond the sync zone are as long as start and stop need at least."""
    arcs = least_arcs(at)
    if arcs.run_up is None or arcs.run_up.arc > at.run_up or not zone_kept(at):
        return False
    if at.task.machine.guide is None:
        return arcs.run_out is not None and arcs.run_out.arc <= at.run_out
    stops = (Bounds(-each.speed, each.speed, each.acceleration, each.jerk) for each in _limits(at))
    return any(shortest_stop(at.out_of.velocity, each) <= at.room for each in stops)


def can_stand(at: Stand) -> bool:
    """Whether there is room to start and stop from some park: of a slave that goes round any, of one that comes back its home."""
    if at.task.machine.guide is not None:
        return has_room(at)
    return zone_kept(at) and least_arcs(at).whole <= at.run_up + at.run_out


def balanced(at: Stand) -> Stand:
    """Park a slave that goes round where start and stop need the same limit of the acceleration, the least that is enough for both.

    Where no limit is enough it is parked in the middle.
    """
    if at.task.machine.guide is not None:
        return at
    whole = at.run_up + at.run_out
    middle = at.parked_at(at.zone_start - 0.5 * whole)
    if at.into == _reversed(at.out_of):  # the same both ways
        return middle

    def enough(share: float) -> bool:
        return least_arcs(_eased(at, share)).whole <= whole

    if not enough(1.0):
        return middle
    least = least_arcs(_eased(at, halved(enough, 1.0, 0.0)[0]))
    assert least.run_up is not None  # noqa: S101 - that is what was found
    return at.parked_at(at.zone_start - least.run_up.arc - 0.5 * (whole - least.whole))


def highest_that_works(at: Stand, works: Callable[[Stand], bool]) -> float | None:
    """Highest line speed at which something works that works at every lower one too (m/s); None if it works at none."""
    speed = at.task.cut.line_speed

    def holds(factor: float) -> bool:
        return works(at.at_speed(factor * speed))

    good, bad = 1.0, 1.0
    if holds(1.0):
        while holds(bad * _STRIDE):
            good = bad = bad * _STRIDE
            if bad > _FASTEST:
                return None
        bad *= _STRIDE
    else:
        while not holds(good / _STRIDE):
            good = bad = good / _STRIDE
            if good < 1 / _FASTEST:
                return None
        good /= _STRIDE
    return halved(holds, good, bad)[0] * speed


def zone_kept(at: Stand) -> bool:
    """Whether the sync zone itself keeps the limits at the line speed."""
    v = at.task.cut.line_speed
    peaks = [at.zone.peak(order) * v**order for order in (1, 2, 3)]
    return any(
        speed <= each.speed * (1 + ALLOWED)
        and acceleration <= each.acceleration * (1 + ALLOWED)
        and jerk <= each.jerk * (1 + ALLOWED)
        for each in motor_limits(at.task.machine, at.task.limits)
        for speed, acceleration, jerk in [peaks]
    )


def _best(at: Stand, aim: Aim, find: Callable[[Limits], Transfer | None]) -> Ramp | None:
    """Take the best of the ramps within each of the limits that the motor's curve stands for."""
    if not at.run_up > 0:
        return None
    v = at.task.cut.line_speed

    def ramps(limits: Iterator[Limits]) -> list[Ramp]:
        ways = (find(each) for each in limits)
        return [Ramp(way, v) for way in ways if way is not None]

    best = min(ramps(_limits(at)), key=_COSTS[aim], default=None)
    if best is None or not at.task.line.ramps:
        return best
    for _ in range(_REFINED):
        best = min((best, *ramps(_reserved(at, (best.peak_acceleration,), absolute=True))), key=_COSTS[aim])
    return best


def _limits(at: Stand) -> Iterator[Limits]:
    """Limits that a motion may be held to, each enough by itself: one for each rectangle of the motor's curve, and what the line leaves."""
    return _reserved(at, _CAPS) if at.task.line.ramps else iter(motor_limits(at.task.machine, at.task.limits))


def _reserved(at: Stand, caps: tuple[float, ...], *, absolute: bool = False) -> Iterator[Limits]:
    """Limits that leave room for the ramps of the line, at every phase.

    With the line's acceleration ``a`` and jerk ``j`` an acceleration ``A`` and a jerk ``J`` of the slave become ``A + k a`` and
    ``J + 3 A a / v + k j``, with its ratio ``k``. With the greatest ratio and a peak ``c`` of the acceleration, ``A - k a`` and
    ``J - 3 c a / v - k j`` are left: enough, if not all.

    Parameters
    ----------
    caps
        Peaks to try: shares of what is left of the acceleration, or absolute values.
    """
    task, line = at.task, at.task.line
    v, a, j = task.cut.line_speed, line.hardest, line.known_jerk
    fastest = _OVER * max(at.into.velocity, at.out_of.velocity)
    for each in motor_limits(task.machine, task.limits):
        top = each.speed if task.machine.guide is not None else min(each.speed, fastest)
        acceleration = each.acceleration - top / v * a
        for cap in caps:
            peak = min(cap, acceleration) if absolute else cap * acceleration
            jerk = each.jerk - 3 * peak * a / v - top / v * j
            if peak > 0 and jerk > 0:
                yield replace(each, speed=top, acceleration=peak, jerk=jerk)


def _run_up(arc: float, end: State, limits: Limits, aim: Aim) -> Transfer | None:
    return _WAYS[aim](arc, end, _bounds(end, limits)) if arc > 0 else None


def _bounds(end: State, limits: Limits) -> Bounds:
    """Limits of a ramp: never backwards, and never faster than it must be in the end."""
    top = min(limits.speed, top_velocity(end, limits.jerk))
    return Bounds(0.0, top, limits.acceleration, limits.jerk)


def _reversed(state: State) -> State:
    """State of the motion run backwards in time."""
    return State(state.velocity, -state.acceleration)


def _turn(at: Stand, limits: Limits, aim: Aim) -> Transfer | None:
    """Way of a carriage out of the sync zone and home, within the room that its guide leaves."""
    bounds, speed, way = (
        Bounds(-limits.speed, limits.speed, limits.acceleration, limits.jerk),
        at.out_of.velocity,
        -at.run_out,
    )
    if aim == "shortest":
        return quickest_home(speed, way, bounds) if turns_within(speed, at.room, way, bounds) else None
    return gentlest_turn(speed, at.room, way, bounds)


def _eased(at: Stand, share: float) -> Stand:
    """Return the same with a share of the limit of the acceleration."""
    limits = at.task.limits
    eased = replace(limits, acceleration=share * limits.acceleration)
    return Stand(at.task.with_limits(eased), at.zone, at.park)
