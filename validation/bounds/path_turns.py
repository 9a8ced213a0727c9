"""Lower bound of the squared torque of a motion that turns, or stands beyond the ends of its path.

Such a motion comes to rest from its first speed, on a way of its own, and in the end sets out from rest to its last speed. How long these
two ways are is not known; but they, and what it must go back between them, take the time ``T`` together. So for any price ``μ`` of the
time and every pair of lengths the two parts' dual values at that price (`camwright.validation.bounds.path_convex`) less ``μ`` times the
time that is left for them are a bound, and the least of all pairs is one of every motion that turns. A part whose length lies between two
is bounded by one that pays for its time up to the first of them, and for its torque up to the second. What it must go between them, back
or on, it goes from rest to rest: with ``σ = ∫ √(I/2) dq`` the squared torque is ``2 I σ̈²``, so that over ``Σ`` in a time ``t`` costs
``24 I Σ² / t³`` with the least inertia, or takes ``t`` at the greatest speed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from camwright.profiles.polynomial.profile import FloatArray
from camwright.validation.bounds.path_convex import INTERVALS, PathDual
from camwright.validation.bounds.path_task import PathTask

RATIOS = 1.3, 1.05
"""Ratios of neighbouring lengths of a part, stretched, that are tried in turn while the level is not proved."""
TURNS = 2
"""Pitches of the machine that a part is looked at; a longer one pays no time beyond."""
PLACES = 2001
GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)
PRICES = 8
"""Prices of time that are tried."""
SEARCH = 15, 0.01
"""Steps of Newton's method, and the least share of one: what is missed makes the bound no greater."""
AT_ONCE = 1e-30
"""Least time (s) that is divided by: what costs nothing takes none."""
FIRST, LAST = -3.5, 1.5
"""Powers of e of the prices between which the best is sought, times that of a constant inertia."""


@dataclass(frozen=True, eq=False)
class Around:
    """What lies on the way of a motion that goes beyond the ends of its path.

    Parameters
    ----------
    ahead, behind
        Inertia at even places over a pitch of the machine, forwards from the start of the path and backwards from its end.
    pitch
        Length of that (m or rad).
    """

    ahead: FloatArray
    behind: FloatArray
    pitch: float


def turning_square_around(task: PathTask, around: Around, level: float) -> float:
    """Lower bound of the integral of the squared torque of every motion that turns; what is above the level is not told from it."""
    best = 0.0
    for ratio in RATIOS:
        if best < level:
            best = max(best, _in_lengths(task, around, level, ratio))
    return best


def _in_lengths(task: PathTask, around: Around, level: float, ratio: float) -> float:
    """Bound with neighbouring lengths of a ratio."""
    room = 0.5 * (task.greatest * task.time + task.way)  # what it goes too far it must go back
    parts = [
        _Part(inertia, around.pitch, speed, task.greatest, room, level, ratio)
        for inertia, speed in ((around.ahead, task.speeds[0]), (around.behind, task.speeds[1]))
    ]
    if any(part.hopeless for part in parts):
        return level
    one, other = (math.sqrt(energy) for energy in task.energies)
    unit = 2.0 * float(task.inertia.mean()) * (one + other) ** 2 / task.time**2
    soonest, cost = _between(task, around, parts[0].shortest, parts[1].shortest)

    def value(power: float) -> float:
        price = unit * math.exp(power)
        first, second = (part.at_price(price) for part in parts)
        time = np.maximum(soonest, (3.0 * cost / price) ** 0.25)
        back = price * time + cost / np.maximum(time, AT_ONCE) ** 3
        return float((first[:, None] + second + back - price * task.time).min())

    low, high = FIRST, LAST
    inner = [high - GOLDEN * (high - low), low + GOLDEN * (high - low)]
    values = [value(power) for power in inner]
    best = max(0.0, *values)
    for _ in range(PRICES - 2):  # the best price, by the golden section
        if best >= level:
            break
        if values[0] > values[1]:
            high, inner[1], values[1] = inner[1], inner[0], values[0]
            inner[0] = high - GOLDEN * (high - low)
            values[0] = value(inner[0])
        else:
            low, inner[0], values[0] = inner[0], inner[1], values[1]
            inner[1] = low + GOLDEN * (high - low)
            values[1] = value(inner[1])
        best = max(best, *values)
    return min(best, level)


def _between(task: PathTask, around: Around, ahead: FloatArray, behind: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Least time, and cost times the third power of the time, of what is left to go between two parts, by their shortest lengths."""
    far = TURNS * around.pitch
    q = np.linspace(task.way - far, far, PLACES * TURNS)
    root = np.sqrt(0.5 * np.interp(q % around.pitch, np.linspace(0.0, around.pitch, len(around.ahead)), around.ahead))
    sigma = np.concatenate([[0.0], np.cumsum(0.5 * np.diff(q) * (root[1:] + root[:-1]))])
    longest = [np.append(lengths[1:], math.inf) for lengths in (ahead, behind)]

    def crossed(from_: FloatArray, to: FloatArray, of: FloatArray) -> FloatArray:
        return np.maximum(np.interp(to, q, of) - np.interp(from_, q, of)[:, None], 0.0)

    ways = [crossed(task.way - behind, ahead, of).T for of in (q, sigma)]
    on = [crossed(longest[0], task.way - longest[1], of) for of in (q, sigma)]
    way, root_way = (np.maximum(*each) for each in zip(ways, on, strict=True))
    return way / task.greatest, 24.0 * float(np.min(around.ahead)) * root_way**2


class _Part:
    """The way from a speed to rest, of lengths that are tried."""

    def __init__(
        self, inertia: FloatArray, pitch: float, speed: float, greatest: float, room: float, level: float, ratio: float
    ) -> None:
        far = min(room, TURNS * pitch)
        q = np.linspace(0.0, far, PLACES * TURNS)
        along = np.interp(q % pitch, np.linspace(0.0, pitch, len(inertia)), inertia)
        whole = PathTask(along, far, (speed, 0.0), 0.0, greatest)
        s = whole.stretched
        least = 16.0 / 9.0 * whole.energies[0] ** 1.5 / level
        longest = float(s[-1]) + (room - far) * math.sqrt(2.0 / float(np.min(inertia)))
        self.hopeless = least >= longest
        count = max(1, math.ceil(math.log(max(float(s[-1]) / least, 1.0 + 1e-9)) / math.log(ratio)))
        ends = np.append(np.geomspace(min(least, 0.999 * float(s[-1])), float(s[-1]), count + 1), longest)
        self.shortest = np.interp(ends[:-1], s, q)
        self._duals = []
        for way, first, last in zip(self.shortest, ends[:-1], ends[1:], strict=True):
            places = np.interp(np.linspace(0.0, way, PLACES), q, along)
            self._duals.append(
                PathDual(PathTask(places, float(way), (speed, 0.0), 0.0, greatest), float(last - first), SEARCH)
            )
        self._starts = [np.zeros(INTERVALS + 1) for _ in self._duals]
        top = whole.energies[0] ** 0.75
        shares = (np.arange(INTERVALS) + 0.5) / INTERVALS
        self._lines = [top * (1.0 - shares * first / last) for first, last in pairwise(ends)]

    def at_price(self, price: float) -> FloatArray:
        """Dual values of all lengths at a price of time."""
        values = []
        for number, dual in enumerate(self._duals):
            self._starts[number], value, _ = dual.at_price(price, self._starts[number], self._lines[number])
            values.append(max(value, 0.0))
        return np.array(values)
