"""The softest motion from rest to rest: the least mean square of the acceleration under limits, in closed form.

The motion is unique, and with it its mirror image about its middle keeps the limits, so it is that mirror image: half of it decides.
There the acceleration rises as fast as the jerk limit allows, is held at its limit, falls along a straight line, and is zero while the
speed is held at its limit (Pontryagin: away from the limits of jerk and acceleration it is the costate of the speed, a straight line
that the speed limit bends to zero).
"""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class SoftestMotion:
    """The phases of half a softest motion.

    Parameters
    ----------
    rise, hold, fall, cruise
        Durations of the rise to the greatest acceleration, of holding it, of the fall to none, and of the whole cruise.
    acceleration
        Greatest acceleration.
    """

    rise: float
    hold: float
    fall: float
    cruise: float
    acceleration: float

    @property
    def time(self) -> float:
        """Duration of the whole motion."""
        return 2 * (self.rise + self.hold + self.fall) + self.cruise

    @property
    def mean_square(self) -> float:
        """Mean square of the acceleration over the whole motion."""
        return self.acceleration**2 * (2 * self.hold + 2 * (self.rise + self.fall) / 3) / self.time


def softest(distance: float, time: float, speed: float, acceleration: float, jerk: float) -> SoftestMotion | None:
    """Return the motion from rest to rest with the least mean square of the acceleration; None if the limits allow no motion.

    In unit time, with ``s = r + f`` for rise and fall where there is no hold:

    - no limit but the jerk's ``J`` reached: ``r (1 - r) = 6 D / J``;
    - acceleration ``A`` held: ``f² = 6 (1/8 - r/4 + r²/6 - D / 2A)``, ``r = A / J``;
    - speed ``V`` held: ``r + s = 3/2 - 3 D / 2V`` and ``r s = 2 V / J``;
    - both: ``f² = r² - 12 u r - 12 u² + 12 u - 12 D / A``, ``u = V / A``, and the hold lasts ``u - (r + f) / 2``.

    Parameters
    ----------
    distance, time
        What is covered, in which time; positive.
    speed, acceleration, jerk
        Limits, the jerk's finite.
    """
    v, a, j = speed * time / distance, acceleration * time**2 / distance, jerk * time**3 / distance
    rise = 12 / j / (1 + _root(1 - 24 / j))
    hold, fall, level = 0.0, 0.5 - rise, j * rise
    if level > a:
        level, rise = a, a / j
        fall = _root(6 * (1 / 8 - rise / 4 + rise**2 / 6 - 1 / (2 * a)))
        hold = 0.5 - rise - fall
    cruise = 0.0
    if level * ((rise + fall) / 2 + hold) > v:
        both = 1.5 - 1.5 / v
        rise = 4 * v / j / (both + _root(both**2 - 8 * v / j)) if both > 0 else math.nan
        hold, fall, level = 0.0, both - 2 * rise, j * rise
        if level > a:
            level, rise, u = a, a / j, v / a
            fall = _root(rise**2 - 12 * u * rise - 12 * u**2 + 12 * u - 12 / a)
            hold = u - (rise + fall) / 2
        cruise = 1.0 - 2 * (rise + hold + fall)
    # a fall steeper than the rise would break the jerk limit: then, and where a root is none, no motion keeps the limits
    if not (fall >= rise * (1 - _ROUNDING) and hold >= -_ROUNDING and cruise >= -_ROUNDING):
        return None
    hold, cruise = max(hold, 0.0), max(cruise, 0.0)
    return SoftestMotion(rise * time, hold * time, fall * time, cruise * time, level * distance / time**2)


_ROUNDING = 1e-7


def _root(square: float) -> float:
    """Square root; not a number of what is negative."""
    return math.sqrt(square) if square >= 0 else math.nan
