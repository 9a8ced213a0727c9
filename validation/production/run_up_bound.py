"""Lower bounds of starts and stops, over the velocity: no motion in time is looked at.

Of a slave that gets from rest to a velocity ``v`` with an acceleration ``a_1``, the acceleration at the velocity ``u`` is at most::

    a(u) = min( sqrt(2 J u), A, sqrt(c - 2 J u) ),     c = a_1² + 2 J v

the first because it came from rest and never ran backwards, the last because the jerk limit must bring it to ``a_1``. It passes every
velocity below ``v`` at least once, so its way is at least the integral of ``u du / a(u)``; where ``a_1`` is negative it passes ``c / 2J``
and comes down again. So a way ``S`` needs an ``A`` with which the integral is no more than ``S``. In the same manner, for any price ``p``
of the way, the heat is at least the integral of ``min over a of (a + p u / a)`` less ``p S``.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from camwright.profiles.closed_forms.transfer import State
from camwright.profiles.halving import halved
from camwright.profiles.polynomial.profile import FloatArray

ROUNDING = 1e-12
"""Share of a way that is rounding."""

_PLACES = 20_001
_PRICES = 60
"""Steps of the search for the best price; every price gives a bound."""


def least_way(end: State, acceleration: float, jerk: float) -> float:
    """Least way from rest to a state; infinite if no way is enough.

    Parameters
    ----------
    end
        Velocity, positive, and acceleration at the end.
    acceleration, jerk
        Limits.
    """
    v, last = end.velocity, end.acceleration
    if abs(last) > acceleration * (1 + 1e-9) or (last > 0 and last * last > 2 * jerk * v * (1 + ROUNDING)):
        return math.inf
    beyond = last * last / (2 * jerk)  # between the velocity and the one that the last root ends at
    fall = 0.0 if last >= 0 else beyond  # passed twice
    half = 0.5 * (v + beyond)  # up to here the first root is the lesser one
    first = min(half, v + fall, acceleration**2 / (2 * jerk))
    late = min(v + fall, max(half, v + beyond - acceleration**2 / (2 * jerk)))
    way = (2 / 3) * first * math.sqrt(first / (2 * jerk)) + (late**2 - first**2) / (2 * acceleration)
    way += _closing(v + beyond, beyond + v - late, beyond - fall, jerk)
    return way + (0.0 if last >= 0 else _closing(v + beyond, beyond, 0.0, jerk))


def _closing(top: float, far: float, near: float, jerk: float) -> float:
    """Integral of ``u du / sqrt(2 J (w - u))`` to a velocity ``w``, from so far below it to so near."""
    far, near = max(far, 0.0), max(near, 0.0)
    roots = 2 * top * (math.sqrt(far) - math.sqrt(near)) - (2 / 3) * (far * math.sqrt(far) - near * math.sqrt(near))
    return roots / math.sqrt(2 * jerk)


def least_peak(distance: float, end: State, jerk: float) -> float:
    """Peak of the acceleration below which no way over a distance leads from rest to a state."""
    c = end.acceleration**2 + 2 * jerk * end.velocity
    return _least(
        lambda top: least_way(end, top, jerk) <= distance * (1 + ROUNDING), abs(end.acceleration), math.sqrt(c)
    )


def least_time(distance: float, end: State, acceleration: float, jerk: float) -> float:
    """Time below which no way over a distance leads from rest to a state that is never faster than it must be.

    With the greatest velocity ``w`` the time is ``(S + integral of (w - u) dt) / w``, and the integral is least where the acceleration is
    greatest: it is that of the least way.
    """
    c = end.acceleration**2 + 2 * jerk * end.velocity
    top = end.velocity if end.acceleration >= 0 else c / (2 * jerk)
    u = top * (
        0.5 - 0.5 * np.cos(np.linspace(0.0, math.pi, _PLACES))
    )  # dense at both ends, where the acceleration is a root
    missed = _integral(
        u,
        lambda mid: (
            (top - mid) / np.minimum(_allowed(mid, acceleration, jerk), np.sqrt(np.maximum(c - 2 * jerk * mid, 1e-300)))
        ),
    )
    return (distance + missed) / top


def least_heat(distance: float, end: State, acceleration: float, jerk: float) -> float:
    """Integral of the squared acceleration over time below which no way over a distance leads from rest to a state."""
    v, last = end.velocity, end.acceleration
    c = last * last + 2 * jerk * v
    u = v * (0.5 - 0.5 * np.cos(np.linspace(0.0, math.pi, _PLACES)))
    mid = 0.5 * (u[1:] + u[:-1])
    most = _allowed(mid, acceleration, jerk)
    if last >= 0:  # else it goes higher, by how much is not known
        most = np.minimum(most, np.sqrt(np.maximum(c - 2 * jerk * mid, 1e-300)))

    def bound(price: float) -> float:
        a = np.minimum(np.sqrt(price * mid), most)
        return float(((a + price * mid / a) * np.diff(u)).sum()) - price * distance

    free = 4 * v**3 / (9 * distance**2)  # the best price without limits
    prices = free * np.geomspace(1e-2, 1e3, _PRICES)
    found = [bound(float(price)) for price in prices]
    best = int(np.argmax(found))
    low, high = prices[max(best - 1, 0)], prices[min(best + 1, len(prices) - 1)]
    finer = max(bound(float(price)) for price in np.geomspace(low, high, _PRICES))
    return max(0.0, finer, *found) * (1 - 1e-6)  # the sums over the velocity are as good as that


def least_turn_peak(velocity: float, room: float, jerk: float) -> float:
    """Peak of the acceleration below which a carriage cannot turn within a room: the integral of ``u du / min(A, sqrt(2 J (v - u)))``."""

    def way(top: float) -> float:
        early = max(0.0, velocity - top**2 / (2 * jerk))
        return early**2 / (2 * top) + _closing(velocity, velocity - early, 0.0, jerk)

    return _least(lambda top: way(top) <= room * (1 + ROUNDING), 0.0, math.sqrt(2 * jerk * velocity))


def _allowed(u: FloatArray, acceleration: float, jerk: float) -> FloatArray:
    return np.minimum(np.sqrt(2 * jerk * u), acceleration)


def _integral(u: FloatArray, of: Callable[[FloatArray], FloatArray]) -> float:
    return float((of(0.5 * (u[1:] + u[:-1])) * np.diff(u)).sum())


def _least(enough: Callable[[float], bool], floor: float, ceiling: float) -> float:
    """Least value between a floor and a ceiling that is enough, from below: what is told is not enough, or the floor; else infinite."""
    if floor > 0 and enough(floor):
        return floor
    if not enough(ceiling):
        return math.inf
    return halved(enough, ceiling, floor)[1]
