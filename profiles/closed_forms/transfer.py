"""From one state of motion to another in a given time: the least and the greatest distance, in closed form.

A state is a velocity and an acceleration. Speed, acceleration and jerk are limited, so the motions that make the transfer are a convex
set, and the distances that they cover are an interval. Its greatest is reached by the motion that is fastest at every moment: greatest
jerk up, acceleration held, jerk down, speed held, and the same from the end backwards, where jerk up comes last. Before the switch to
"down" it is the fastest of all that leave the first state, after the switch back to "up" the fastest of all that meet the second, so a
limit that it breaks there is broken by all. The least distance is the greatest of the mirrored states.
`camwright.profiles.closed_forms.reach` has the
formulas of the special case from rest to rest. All arguments are in one consistent set of units.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from camwright.profiles.polynomial.profile import CamProfile, FloatArray

ROUNDING = 1e-12
"""Share of a limit by which a state may exceed it."""
LATE = 1e-9
"""Share of its time that a transfer may last longer, which is rounding."""
SLIVER = 1e-13
"""Share of its time below which a phase is none."""
_STEPS = 200
"""Safeguarded Newton steps; halvings alone would need no more."""


@dataclass(frozen=True)
class State:
    """Velocity and acceleration at one end of a transfer."""

    velocity: float
    acceleration: float


@dataclass(frozen=True)
class Bounds:
    """Limits of a transfer.

    Parameters
    ----------
    least_velocity, greatest_velocity
        Limits of the velocity, signed.
    acceleration, jerk
        Limits of the magnitudes, the jerk finite.
    """

    least_velocity: float
    greatest_velocity: float
    acceleration: float
    jerk: float


@dataclass(frozen=True)
class Transfer:
    """A motion of constant jerk on each of its phases.

    Parameters
    ----------
    start
        State at its start.
    phases
        Pairs of duration and jerk.
    """

    start: State
    phases: tuple[tuple[float, float], ...]

    @property
    def distance(self) -> float:
        """Distance covered, signed."""
        return self._ends()[-1][0]

    @property
    def time(self) -> float:
        """Time that it takes."""
        return sum(time for time, _ in self.phases)

    @property
    def peak_acceleration(self) -> float:
        """Greatest magnitude of the acceleration."""
        return float(abs(self.corners()[1]).max())

    @property
    def heat(self) -> float:
        """Integral of the squared acceleration over the time."""
        times, levels = self.corners()
        pieces = zip(times[1:] - times[:-1], levels, levels[1:], strict=False)
        return float(sum(h * (a * a + a * b + b * b) / 3 for h, a, b in pieces))

    def _ends(self) -> list[tuple[float, float, float]]:
        """Position, velocity and acceleration at the start and at the end of each phase."""
        s, v, a = 0.0, self.start.velocity, self.start.acceleration
        ends = [(s, v, a)]
        for t, j in self.phases:
            s, v, a = s + t * (v + t * (a / 2 + t * j / 6)), v + t * (a + t * j / 2), a + t * j
            ends.append((s, v, a))
        return ends

    def least_velocity(self) -> float:
        """Least velocity on the way."""
        ends = self._ends()
        lows = [v for _, v, _ in ends]
        for (_, v, a), (t, j) in zip(ends, self.phases, strict=False):
            if j > 0 and 0 < -a < j * t:
                lows.append(v - a * a / (2 * j))
        return min(lows)

    def reach(self) -> tuple[float, float]:
        """Least and greatest position on the way, counted from its start."""
        places = [*(s for s, _, _ in self._ends()), *(s for s, _ in self.turns())]
        return min(places), max(places)

    def turns(self) -> Iterator[tuple[float, float]]:
        """Position and acceleration wherever it stands still for a moment, behind its start, one after the other."""
        for (s, v, a), (t, j) in zip(self._ends(), self.phases, strict=False):
            for turn in sorted(turn for turn in _turns(v, a, j) if 0 < turn <= t):
                yield s + turn * (v + turn * (a / 2 + turn * j / 6)), a + turn * j

    def profile(self) -> CamProfile:
        """Return the way as a profile over time, from zero; phases of no length but for rounding are left out."""
        t, breaks, rows = 0.0, [0.0], []
        least = SLIVER * sum(width for width, _ in self.phases)
        for (s, v, a), (width, jerk) in zip(self._ends(), self.phases, strict=False):
            if width <= least:
                continue
            rows.append([s, v, a / 2, jerk / 6])
            t += width
            breaks.append(t)
        return CamProfile.from_arrays(breaks, rows)

    def mirrored(self) -> Transfer:
        """Return the same motion in the other direction."""
        start = State(-self.start.velocity, -self.start.acceleration)
        return Transfer(start, tuple((t, -j) for t, j in self.phases))

    def backwards(self) -> Transfer:
        """Return the same motion run backwards in time, over the same distance: of a start it makes a stop."""
        _, v, a = self._ends()[-1]
        return Transfer(State(v, -a), tuple(reversed(self.phases)))

    def corners(self) -> tuple[FloatArray, FloatArray]:
        """Give the times at which the jerk may change, from zero to the end, and the accelerations there; linear in between."""
        times = np.cumsum([0.0, *(t for t, _ in self.phases)])
        kept = np.concatenate([[True], np.diff(times) > 0])
        return times[kept], np.array([a for _, _, a in self._ends()])[kept]


def _turns(velocity: float, acceleration: float, jerk: float) -> tuple[float, ...]:
    """Give the times at which a motion of constant jerk stands still for a moment."""
    square = acceleration * acceleration - 2 * jerk * velocity
    if square < 0:
        return ()
    q = -(acceleration + math.copysign(math.sqrt(square), acceleration))
    return (*((q / jerk,) if jerk else ()), *((2 * velocity / q,) if q else ()))


def farthest(time: float, start: State, end: State, bounds: Bounds) -> Transfer | None:
    """Transfer over the greatest distance in a given time; None if no motion makes the transfer in that time."""
    allowed = 1 + ROUNDING
    top, a_max, j = bounds.greatest_velocity, bounds.acceleration, bounds.jerk
    rounding = ROUNDING * max(abs(top), abs(bounds.least_velocity))
    if max(start.velocity, end.velocity) > top + rounding:
        return None
    if max(abs(start.acceleration), abs(end.acceleration)) > a_max * allowed:
        return None
    if abs(end.acceleration - start.acceleration) > j * time * allowed:
        return None
    phases = _highest(time, start, end, a_max, j)
    if phases is None:
        return None
    peak = _peak(start, phases)
    if peak > top + rounding:
        phases = _with_cruise(time, start, end, bounds)
        if phases is None:
            return None
    found = Transfer(start, phases)
    return found if found.least_velocity() >= bounds.least_velocity - rounding else None


def nearest(time: float, start: State, end: State, bounds: Bounds) -> Transfer | None:
    """Transfer over the least distance, farthest backwards, in a given time; None if no motion makes the transfer in that time."""
    back = farthest(
        time,
        State(-start.velocity, -start.acceleration),
        State(-end.velocity, -end.acceleration),
        Bounds(-bounds.greatest_velocity, -bounds.least_velocity, bounds.acceleration, bounds.jerk),
    )
    return None if back is None else back.mirrored()


def _highest(time: float, start: State, end: State, a_max: float, j: float) -> tuple[tuple[float, float], ...] | None:
    """Phases of the farthest transfer without a limit of speed: up, held, down, held, up.

    The first part lasts ``u``: from ``a_0`` upwards until `a_max`. The last part lasts ``w``: upwards to ``a_1``, from ``-a_max`` on.
    Between them the acceleration falls. The change of velocity grows with ``u``.
    """
    a0, a1, gain = start.acceleration, end.acceleration, end.velocity - start.velocity

    def parts(u: float) -> tuple[float, float, float, float]:
        """Acceleration at the top, length of the last part, acceleration at the bottom, change of velocity."""
        high = min(a0 + j * u, a_max)
        w = 0.5 * (time - u - (high - a1) / j)
        if a1 - j * w < -a_max:
            low, w = -a_max, time - u - (high + a_max) / j
        else:
            w = max(w, 0.0)
            low = a1 - j * w
        rise, fall, last = (high - a0) / j, (high - low) / j, (a1 - low) / j
        change = 0.5 * rise * (a0 + high) + (u - rise) * high + 0.5 * fall * (high + low)
        return high, w, low, change + (w - last) * low + 0.5 * last * (low + a1)

    # the last part has no length left where the way down from the top takes all the time
    most = 0.5 * (time - (a0 - a1) / j)
    if most > (a_max - a0) / j:
        most = time - (a_max - a1) / j
    low, high = 0.0, max(most, 0.0)
    rounding = ROUNDING * (abs(start.velocity) + abs(end.velocity) + a_max * time)
    if parts(low)[3] > gain + rounding or parts(high)[3] < gain - rounding:
        return None
    u = 0.5 * (low + high)
    for _ in range(_STEPS):
        top, _, bottom, change = parts(u)
        low, high = (u, high) if change < gain else (low, u)
        # a longer first part moves the fall to later by as much, and once more while it still climbs
        pace = (top - bottom) * (2.0 if a0 + j * u < a_max else 1.0)
        step = u + (gain - change) / pace if pace > 0 else high
        new = step if low < step < high else 0.5 * (low + high)
        if new in (low, high) or new == u:
            break
        u = new
    top, w, bottom, _ = parts(u)
    rise, last = (top - a0) / j, (a1 - bottom) / j
    return ((rise, j), (u - rise, 0.0), ((top - bottom) / j, -j), (w - last, 0.0), (last, j))


def _peak(start: State, phases: tuple[tuple[float, float], ...]) -> float:
    """Greatest velocity on the way."""
    return -Transfer(start, phases).mirrored().least_velocity()


def _with_cruise(time: float, start: State, end: State, bounds: Bounds) -> tuple[tuple[float, float], ...] | None:
    """Phases of the farthest transfer that reaches the greatest velocity; None where it cannot but exceed it."""
    a_max, j, top = bounds.acceleration, bounds.jerk, bounds.greatest_velocity
    rounding = ROUNDING * max(abs(top), abs(bounds.least_velocity))
    # backwards in time the acceleration has the other sign
    ends = ((top - start.velocity, start.acceleration), (top - end.velocity, -end.acceleration))
    if any(slope > 0 and slope**2 / (2 * j) > gain + rounding for gain, slope in ends):
        return None
    first, last = (_to_cruise(gain, slope, a_max, j) for gain, slope in ends)
    cruise = time - sum(t for t, _ in first) - sum(t for t, _ in last)
    if cruise < -LATE * time:
        return None
    return (*first, (max(0.0, cruise), 0.0), *((t, j) for t, j in reversed(last)))


def _to_cruise(gain: float, a0: float, a_max: float, j: float) -> tuple[tuple[float, float], ...]:
    """Phases of the quickest way to a higher velocity without acceleration: up, held, down."""
    square = j * gain + 0.5 * a0 * a0  # of the highest acceleration, if none is held
    top = max(min(math.sqrt(max(square, 0.0)), a_max), a0, 0.0)
    hold = (square - top * top) / (j * top) if top > 0 else 0.0
    return (((top - a0) / j, j), (max(0.0, hold), 0.0), (top / j, -j))
