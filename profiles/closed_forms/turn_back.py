"""From a velocity back to rest behind the start, with little room ahead: how a carriage leaves the sync zone and goes home.

A carriage leaves the sync zone at a velocity ``v`` and must turn within the room ``R`` that its guide leaves. Over the velocity ``u`` its
deceleration is at most ``A`` and ``sqrt(2 J (v - u))``, for it begins with none, and it need not let go of it at the turn. So ``R`` is at
least the integral of ``u du`` over the lesser of both, and the least peak is the ``A`` with which it is just that
(`camwright.profiles.closed_forms.overshoot.shortest_stop`). The rest of the way has all the time that it needs: of the ways home with that
peak the quickest is taken. All arguments are in one consistent set of units.
"""

from __future__ import annotations

from dataclasses import replace

from camwright.profiles.closed_forms.overshoot import shortest_stop
from camwright.profiles.closed_forms.run_up import REST
from camwright.profiles.closed_forms.transfer import Bounds, State, Transfer, nearest
from camwright.profiles.halving import halved

ROUNDING = 1e-12
"""Share of the room by which a turn may go beyond: rounding."""

_DOUBLINGS = 200
"""Of a time, until it is long enough."""


def gentlest_turn(velocity: float, room: float, way: float, bounds: Bounds) -> Transfer | None:
    """Way from a velocity to rest behind the start that turns within a room, with the least peak of the acceleration; None if none does.

    Parameters
    ----------
    velocity
        At the start, positive, without acceleration.
    room
        Farthest that the way may lead ahead.
    way
        Distance behind the start at which it ends, a magnitude.
    bounds
        Limits; the least velocity is negative.
    """

    def stops(top: float) -> bool:
        return shortest_stop(velocity, replace(bounds, acceleration=top)) <= room * (1 + ROUNDING)

    def turns(top: float) -> bool:
        return turns_within(velocity, room, way, replace(bounds, acceleration=top))

    if not stops(bounds.acceleration):
        return None
    least, _ = halved(stops, bounds.acceleration, 0.0)
    if not turns(least):  # it lets go of the deceleration before the turn, for home is near
        if not turns(bounds.acceleration):
            return None
        least, _ = halved(turns, bounds.acceleration, least)
    return quickest_home(velocity, way, replace(bounds, acceleration=least))


def quickest_home(velocity: float, way: float, bounds: Bounds) -> Transfer | None:
    """Way from a velocity to rest at a distance behind the start in the least time; None if no time is enough.

    It ends at rest, where the slave can wait, so what can be done in a time can be done in a longer one.
    """

    def reached(time: float) -> Transfer | None:
        found = nearest(time, State(velocity, 0.0), REST, bounds)
        return found if found is not None and found.distance <= -way else None

    low, high = 0.0, 2 * (velocity / bounds.acceleration + bounds.acceleration / bounds.jerk)
    for _ in range(_DOUBLINGS):
        if reached(high) is not None:
            break
        low, high = high, 2 * high
    time, _ = halved(lambda time: reached(time) is not None, high, low)
    return reached(time)


def turns_within(velocity: float, room: float, way: float, bounds: Bounds) -> bool:
    """Whether the quickest way home turns within the room; asked of the shortest stop first, which no way home undercuts."""
    if shortest_stop(velocity, bounds) > room * (1 + ROUNDING):
        return False
    found = quickest_home(velocity, way, bounds)
    return found is not None and found.reach()[1] <= room * (1 + ROUNDING)
