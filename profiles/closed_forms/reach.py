"""How far, how fast: rest-to-rest motion under speed, acceleration and jerk limits, in closed form.

The extreme motion is the double-S: greatest jerk up, acceleration held, jerk down, speed held, and the mirror image (Biagiotti and
Melchiorri, *Trajectory Planning for Automatic Machines and Robots*, section 3.4). A return that leaves and meets the sync zone at
the same ratio is a straight line plus such a motion, so these formulas bound it: by which time, with which acceleration or jerk it
can be made at all. All arguments are magnitudes in one consistent set of units; a limit may be infinite.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from camwright.profiles.closed_forms.transfer import State, Transfer
from camwright.profiles.errors import InputError
from camwright.profiles.halving import halved
from camwright.profiles.polynomial.profile import CamProfile


@dataclass(frozen=True)
class DoubleS:
    """The phases of a rest-to-rest double-S motion.

    Parameters
    ----------
    ramp
        Duration of each of the four jerk phases.
    hold
        Duration of each of the two phases of constant acceleration.
    cruise
        Duration of the phase of constant speed.
    """

    ramp: float
    hold: float
    cruise: float
    jerk: float

    @property
    def time(self) -> float:
        """Whole duration."""
        return 4 * self.ramp + 2 * self.hold + self.cruise

    @property
    def acceleration(self) -> float:
        """Greatest acceleration."""
        return self.jerk * self.ramp

    @property
    def speed(self) -> float:
        """Greatest speed."""
        return self.acceleration * (self.ramp + self.hold)

    @property
    def distance(self) -> float:
        """Distance covered."""
        return self.speed * (2 * self.ramp + self.hold + self.cruise)

    def profile(self) -> CamProfile:
        """Return the motion as a profile over time, from rest at zero; phases of no length are left out."""
        j = self.jerk
        phases = [(self.ramp, j), (self.hold, 0.0), (self.ramp, -j), (self.cruise, 0.0), (self.ramp, -j)]
        phases += [(self.hold, 0.0), (self.ramp, j)]
        return Transfer(State(0.0, 0.0), tuple(phases)).profile()


def fastest(distance: float, speed: float, acceleration: float, jerk: float) -> DoubleS:
    """Return the fastest motion from rest to rest over a distance, for a finite jerk limit.

    Raises
    ------
    InputError
        The distance is negative, a limit is not positive, or the jerk limit is infinite.
    """
    if not (distance >= 0 and speed > 0 and acceleration > 0 and 0 < jerk < math.inf):
        raise InputError(
            f"the fastest motion needs a distance >= 0 and limits > 0, the jerk finite; got distance {distance!r}, "
            f"speed {speed!r}, acceleration {acceleration!r}, jerk {jerk!r}"
        )
    # does the motion to full speed reach full acceleration?
    ramp = acceleration / jerk if speed * jerk >= acceleration**2 else math.sqrt(speed / jerk)
    hold = max(0.0, speed / (jerk * ramp) - ramp)
    if speed * (2 * ramp + hold) <= distance:
        return DoubleS(ramp, hold, distance / speed - 2 * ramp - hold, jerk)
    # full speed is not reached
    if distance * jerk**2 >= 2 * acceleration**3:
        ramp = acceleration / jerk
        hold = math.sqrt(ramp**2 / 4 + distance / acceleration) - 1.5 * ramp
        return DoubleS(ramp, max(0.0, hold), 0.0, jerk)
    return DoubleS(math.cbrt(distance / (2 * jerk)), 0.0, 0.0, jerk)


def in_time(distance: float, time: float, speed: float, acceleration: float, jerk: float) -> DoubleS:
    """Motion from rest to rest over a distance in exactly the given time, with a given peak acceleration and jerk.

    The speed is as high as the distance needs; acceleration and jerk are those of `least_acceleration` or `least_jerk`, so that
    distance and time fit together.
    """
    peak = min(speed, 2 * distance / time)
    ramp = min(acceleration / jerk, math.sqrt(peak / jerk))
    hold = max(0.0, peak / (jerk * ramp) - ramp)
    return DoubleS(ramp, hold, max(0.0, time - 4 * ramp - 2 * hold), jerk)


def greatest_reach(time: float, speed: float, acceleration: float, jerk: float) -> float:
    """Greatest distance from rest to rest in a given time."""
    ramp = acceleration / jerk
    peak = acceleration * (time / 2 - ramp) if time >= 4 * ramp else jerk * time**2 / 16
    if peak <= speed:
        return peak * time / 2
    return speed * (time - _time_to_speed(speed, acceleration, jerk))


def _time_to_speed(speed: float, acceleration: float, jerk: float) -> float:
    if speed * jerk >= acceleration**2:
        return speed / acceleration + acceleration / jerk
    return 2 * math.sqrt(speed / jerk)


def least_acceleration(distance: float, time: float, speed: float, jerk: float) -> float:
    """Least peak acceleration of a motion from rest to rest over a distance in a time; infinite if there is none.

    Below the speed limit ``D = A T²/4 - A² T/(2 J)``; with the speed limit active the ramp to full speed takes
    ``T - D/V = V/A + A/J``. The smaller root is the answer in both.
    """
    if distance == 0:
        return 0.0
    if 2 * distance / time <= speed:
        square = 1 - 32 * distance / (jerk * time**3)
        return 8 * distance / (time**2 * (1 + math.sqrt(square))) if square >= 0 else math.inf
    ramp = time - distance / speed
    if ramp <= 0:
        return math.inf
    square = 1 - 4 * speed / (jerk * ramp**2)
    return 2 * speed / (ramp * (1 + math.sqrt(square))) if square >= 0 else math.inf


def least_jerk(distance: float, time: float, speed: float, acceleration: float) -> float:
    """Least peak jerk of a motion from rest to rest over a distance in a time; infinite if there is none.

    ``J = 32 D/T³`` if neither speed nor acceleration is limited; else from the formulas of `least_acceleration`, solved for
    ``J``.
    """
    if distance == 0:
        return 0.0
    if 2 * distance / time <= speed:
        if 8 * distance / time**2 <= acceleration:
            return 32 * distance / time**3
        rest = acceleration * time**2 / 4 - distance
        return acceleration**2 * time / (2 * rest) if rest > 0 else math.inf
    ramp = time - distance / speed
    if ramp <= 0:
        return math.inf
    if 2 * speed / ramp <= acceleration:
        return 4 * speed / ramp**2
    rest = ramp - speed / acceleration
    return acceleration / rest if rest > 0 else math.inf


def shortest_return_length(height: float, speed: float, acceleration: float, jerk: float) -> float:
    """Shortest length of a return that leaves and meets the sync zone at ``k = 1``.

    The return of length ``L`` is the line ``y = x`` plus a rest-to-rest motion over ``height - L``, whose speed is limited by
    ``speed - 1``; so ``L + greatest_reach(L) = height``, with a left side that grows with ``L``.

    Parameters
    ----------
    height
        Slave travel in the return zone (m), positive.
    speed, acceleration, jerk
        Limits of the slave over the master: greatest ratio (above 1), ratio slope (1/m) and its slope (1/m²).
    """
    return halved(lambda length: length + greatest_reach(length, speed - 1, acceleration, jerk) >= height, height, 0.0)[
        0
    ]
