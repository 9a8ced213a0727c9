"""From rest to a velocity, and the same backwards in time: the shortest, the gentlest, the coolest and the quickest way, in closed form.

A slave stands, and is to have a velocity ``v`` and an acceleration ``a_1`` after a distance ``S``, without ever running backwards. Seen
over the velocity, its acceleration is at most ``sqrt(2 J u)`` (it came from rest under a jerk limit ``J``), ``A``, and
``sqrt(a_1² + 2 J (v - u))`` (it has ``a_1`` at the end). A distance is the integral of ``u du / a(u)``, so the motion that has all of the
greatest of these, jerk up, acceleration held, jerk down, needs the least distance and the least time. A longer distance needs a lower
``A``, or a lower jerk at the start, or a wait.

A stop is a start run backwards in time: the velocity is the same, the acceleration changes its sign. All arguments are in one
consistent set of units; velocities and distances are not negative.
"""

from __future__ import annotations

import math

from camwright.profiles.closed_forms.transfer import Bounds, State, Transfer, farthest
from camwright.profiles.halving import halved

REST = State(0.0, 0.0)
"""The state of a slave that stands."""

ROUNDING = 1e-12
"""Share of a distance by which it may be too short: rounding."""

_DOUBLINGS = 200
"""Of a time, until it is long enough."""


def shortest(end: State, bounds: Bounds) -> Transfer | None:
    """Way from rest to a state over the least distance, which also takes the least time; None if the limits allow none.

    Parameters
    ----------
    end
        Velocity, positive, and acceleration at the end.
    bounds
        Limits; the least velocity is taken as zero.
    """
    return _rise(end, bounds.acceleration, bounds.jerk, bounds)


def gentlest(distance: float, end: State, bounds: Bounds) -> Transfer | None:
    """Way from rest to a state over a distance with the least peak of the acceleration; None if the limits allow none.

    From rest to a velocity ``v`` without acceleration it takes ``T = 2 S / v`` and its peak is ``(J/2) (T - sqrt(T² - 4 v / J))``. Where
    the end itself has an acceleration that is enough, the quickest of all ways with that peak is taken.
    """
    least = shortest(end, bounds)
    if least is None or least.distance > distance * (1 + ROUNDING):
        return None
    floor = abs(end.acceleration)
    if floor > 0:
        easiest = _within(floor, end, bounds)
        if easiest is not None and easiest.distance <= distance:
            return quickest(distance, end, Bounds(0.0, bounds.greatest_velocity, floor, bounds.jerk))
        peak, _ = halved(
            lambda top: (way := _within(top, end, bounds)) is not None and way.distance <= distance,
            bounds.acceleration,
            floor,
        )
    else:
        time = 2 * distance / end.velocity
        square = max(time**2 - 4 * end.velocity / bounds.jerk, 0.0)
        peak = min(2 * end.velocity / (time + math.sqrt(square)), bounds.acceleration)
    return _within(peak, end, bounds)


def coolest(distance: float, end: State, bounds: Bounds) -> Transfer | None:
    """Way from rest to a state over a distance with the least integral of the squared acceleration; None if the limits allow none.

    The time is free. By Pontryagin the acceleration grows in proportion to the time, is held at its limit, and goes with the greatest jerk
    to that of the end: away from the limits the Hamiltonian ``p u - a²`` is zero and ``p`` constant, so ``a² = p u``, which is
    ``a`` proportional to the time. Without limits the heat is ``4 v³ / 9 S``, over ``3 S / v``.
    """
    least = shortest(end, bounds)
    if least is None or least.distance > distance * (1 + ROUNDING):
        return None

    def fits(first: float) -> bool:
        way = _rise(end, bounds.acceleration, first, bounds)
        return way is not None and way.distance <= distance

    first = bounds.jerk
    while fits(0.5 * first):
        first *= 0.5
    return _rise(end, bounds.acceleration, halved(fits, first, 0.5 * first)[0], bounds)


def quickest(distance: float, end: State, bounds: Bounds) -> Transfer | None:
    """Way from rest to a state over a distance in the least time; None if the limits allow none.

    It may be faster on the way than at the end, up to the greatest velocity. The slave may wait at rest, so what can be done in a time can
    be done in a longer one, and the least time is found by bisection.
    """
    least = shortest(end, bounds)
    if least is None or least.distance > distance * (1 + ROUNDING):
        return None
    forwards = Bounds(0.0, bounds.greatest_velocity, bounds.acceleration, bounds.jerk)
    start = least.time
    if least.distance >= distance * (1 - ROUNDING):
        return least

    def reaches(time: float) -> bool:
        way = farthest(time, REST, end, forwards)
        return way is not None and way.distance >= distance

    late = start
    for _ in range(_DOUBLINGS):
        late *= 2.0
        if reaches(late):
            break
    return farthest(halved(reaches, late, start)[0], REST, end, forwards)


def top_velocity(end: State, jerk: float) -> float:
    """Velocity that no way to a state can do without: its own, and more where it ends with a falling one."""
    return end.velocity + min(end.acceleration, 0.0) ** 2 / (2 * jerk)


def _within(top: float, end: State, bounds: Bounds) -> Transfer | None:
    """Shortest way with another limit of the acceleration."""
    return _rise(end, top, bounds.jerk, bounds)


def _rise(end: State, top: float, first: float, bounds: Bounds) -> Transfer | None:
    """Acceleration up with the jerk ``first``, held at ``top``, and with the jerk limit to that of the end; None if that is no way.

    Without a hold ``a²/2f + (a² - a_1²)/2J = v`` where it falls in the end, and ``a²/2f + (a_1² - a²)/2J = v`` where it rises on.
    """
    v, last, jerk = end.velocity, end.acceleration, bounds.jerk
    if abs(last) > top * (1 + ROUNDING) or top_velocity(end, jerk) > bounds.greatest_velocity * (1 + ROUNDING):
        return None
    if last > 0 and last * last > 2 * jerk * v * (1 + ROUNDING):
        return None  # it would have to come from behind
    rises = last > 0 and last * last > 2 * first * v
    if rises:
        across = 1 / (2 * first) - 1 / (2 * jerk)
        level = math.sqrt(max(v - last * last / (2 * jerk), 0.0) / across)
    else:
        level = math.sqrt((v + last * last / (2 * jerk)) / (1 / (2 * first) + 1 / (2 * jerk)))
    hold = 0.0
    if level > top:
        level = max(top, last)
        hold = (v - level * level / (2 * first) - (level * level - last * last) / (2 * jerk)) / level
    closing = (last - level) / jerk
    return Transfer(REST, ((level / first, first), (max(hold, 0.0), 0.0), (abs(closing), math.copysign(jerk, closing))))
