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
from camwright.validation.bounds.path_reach import slowest
from camwright.validation.bounds.path_task import PathTask

RATIOS = 1.3, 1.05
"""Ratios of neighbouring lengths of a part, stretched, that are tried in turn while the level is not proved."""
TURNS = 2
"""Pitches of the machine that a part is looked at; a longer one pays no time beyond."""
PLACES = 2001
MOST = 1e30
"""Acceleration that counts as any."""
PEAKS, STEP, SLOW = 9, 1.01, 2e-3
"""Halvings of the peak of a motion that turns, ratio of neighbouring lengths, and the share that its sampling may be wrong by."""
SAMPLED = 801
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


def turning_peak_around(task: PathTask, around: Around, level: float) -> float:
    """Lower bound of the peak torque of every motion that turns, at most the level.

    With the torque at most ``P`` the kinetic energy changes by no more than ``P`` over the way, so each of the two ways to rest has a
    least length, and every length a least time; between the two rests speed and acceleration leave a least time too.
    """
    low, high = 0.0, level
    for _ in range(PEAKS):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if _may_turn(task, around, middle) else (middle, high)
    return low


def _may_turn(task: PathTask, around: Around, peak: float) -> bool:
    """Tell whether the time may be enough for a motion that turns, of a peak of the torque."""
    room = 0.5 * (task.greatest * task.time + task.way)
    parts = [
        _ways_to_rest(task, (inertia, around.pitch), state, (peak, room))
        for inertia, state in (
            (around.ahead, (task.speeds[0], task.slopes[0])),
            (around.behind, (task.speeds[1], -task.slopes[1])),
        )
    ]
    if not all(len(ends) for ends, _ in parts):
        return False
    (first, before), (last, after) = parts
    short = task.way - first[1:, None] - last[1:]
    over = first[:-1, None] + last[:-1] - task.way
    left = np.maximum(np.maximum(short, over), 0.0)
    # from rest to rest over what is left, by the acceleration or by the torque with the least inertia
    push = min(task.acceleration, peak / float(np.min(around.ahead)))
    between = np.maximum(left / task.greatest, 2.0 * np.sqrt(left / push))
    return bool(float((before[:, None] + after + between).min()) <= task.time)


def _ways_to_rest(
    task: PathTask, inertia: tuple[FloatArray, float], state: tuple[float, float], within: tuple[float, float]
) -> tuple[FloatArray, FloatArray]:
    """Give neighbouring lengths of a way from a state to rest, and the least time of one between each two; none where there is no room.

    The inertia is that at even places over a pitch, and the pitch; within a peak of the torque and a room.
    """
    (along, pitch), (peak, room) = inertia, within
    q = np.linspace(0.0, room, SAMPLED)
    held = np.interp(q % pitch, np.linspace(0.0, pitch, len(along)), along)
    energy = 0.5 * held[0] * state[0] ** 2
    braked = np.nonzero(slowest(q, state, task.acceleration, task.jerk) <= 0.0)[0]
    least = max(energy / peak, float(q[max(int(braked[0]) - 1, 0)]) if len(braked) else math.inf)
    if least >= room:
        return np.empty(0), np.empty(0)
    count = max(1, math.ceil(math.log(room / least) / math.log(STEP)))
    ends = np.geomspace(least, room, count + 1)
    pushed = np.minimum(2.0 * (energy + peak * q) / held, state[0] ** 2 + 2.0 * min(task.acceleration, MOST) * q)
    ahead = np.maximum(ends[1:, None] - q, 0.0)
    rest = np.minimum(2.0 * peak / held, 2.0 * task.acceleration) * ahead
    speed = np.sqrt(np.minimum(np.minimum(pushed, rest), task.greatest**2))
    pace = 1.0 / np.maximum(speed, SLOW * task.greatest)
    spent = np.concatenate([np.zeros((count, 1)), np.cumsum(0.5 * (pace[:, 1:] + pace[:, :-1]), axis=1)], axis=1) * q[1]
    times = [float(np.interp(way, q, row)) for way, row in zip(ends[:-1], spent, strict=True)]
    return ends, np.array(times) * (1.0 - SLOW)


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
