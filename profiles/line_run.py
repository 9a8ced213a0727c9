"""`LineRun`: the speed of the line over time, and the material that passes."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from camwright.profiles.polynomial.profile import FloatArray

_TRIFLE = 1e-9
"""Material (m) that is none: a ramp that ends at a joint is not on the piece behind it."""

_ROUNDS = 100
"""Most steps in which the time of a place is found."""


@dataclass(frozen=True, eq=False)
class LineRun:
    """A line whose acceleration is constant, or changes evenly, between corners; beyond both ends it keeps its speed.

    Parameters
    ----------
    times
        Corners, strictly increasing from zero (s), shape ``(n,)``, at least two.
    speeds
        Line speed there, not negative (m/s), shape ``(n,)``.
    accelerations
        Acceleration at the corners (m/s²), between which it changes evenly and adds up to the speeds, shape ``(n,)``; constant between
        them if not given.

    Examples
    --------
    >>> import numpy as np
    >>> run = LineRun(np.array([0.0, 1.0, 3.0]), np.array([0.0, 2.0, 2.0]))
    >>> run.passed([1.0, 3.0, 4.0]).tolist(), run.when([1.0, 5.0]).tolist(), run.speed([0.5]).tolist()
    ([1.0, 5.0, 7.0], [1.0, 3.0], [1.0])
    """

    times: FloatArray
    speeds: FloatArray
    accelerations: FloatArray | None = None

    @cached_property
    def positions(self) -> FloatArray:
        """Material passed at the corners (m), from zero."""
        lasts = np.diff(self.times)
        steps = 0.5 * lasts * (self.speeds[:-1] + self.speeds[1:]) - self._jerks * lasts**3 / 12.0
        return np.concatenate([[0.0], np.cumsum(steps)])

    @cached_property
    def _firsts(self) -> FloatArray:
        """Acceleration where each stretch between corners begins."""
        return np.diff(self.speeds) / np.diff(self.times) if self.accelerations is None else self.accelerations[:-1]

    @cached_property
    def _jerks(self) -> FloatArray:
        """Jerk on each stretch."""
        return (
            np.zeros(len(self.times) - 1)
            if self.accelerations is None
            else np.diff(self.accelerations) / np.diff(self.times)
        )

    @cached_property
    def _hardest(self) -> FloatArray:
        """Greatest magnitude of the acceleration on each stretch."""
        first = np.abs(self._firsts)
        return first if self.accelerations is None else np.maximum(first, np.abs(self.accelerations[1:]))

    @cached_property
    def _turns(self) -> tuple[FloatArray, FloatArray]:
        """Places on stretches where the line is fastest for a moment, and its speed there."""
        with np.errstate(divide="ignore", invalid="ignore"):
            since = -self._firsts / self._jerks
        turns = (self._jerks < 0.0) & (since > 0.0) & (since < np.diff(self.times))
        t, a, j = since[turns], self._firsts[turns], self._jerks[turns]
        v = self.speeds[:-1][turns]
        return self.positions[:-1][turns] + t * (v + t * (a / 2.0 + t * j / 6.0)), v + t * (a + 0.5 * j * t)

    @property
    def time(self) -> float:
        """Time of the last corner (s)."""
        return float(self.times[-1])

    @property
    def length(self) -> float:
        """Material passed until then (m)."""
        return float(self.positions[-1])

    @property
    def hardest(self) -> float:
        """Greatest magnitude of its acceleration (m/s²)."""
        return float(self._hardest.max())

    def fastest_between(self, places: FloatArray) -> FloatArray:
        """Greatest speed from each place on the material to the next (m/s); arguments as `hardest_between`."""
        at = self.speed(self.when(places))
        found = np.maximum(at[:-1], at[1:])
        where, fast = (np.concatenate(pair) for pair in zip((self.positions, self.speeds), self._turns, strict=True))
        inside = (where > places[0]) & (where < places[-1])
        np.maximum.at(found, np.searchsorted(places, where[inside], side="left") - 1, fast[inside])
        return np.asarray(found)

    def hardest_between(self, places: FloatArray) -> FloatArray:
        """Greatest magnitude of its acceleration from each place on the material to the next (m/s²).

        Parameters
        ----------
        places
            Ascending (m), shape ``(n + 1,)``.

        Returns
        -------
        ndarray
            Shape ``(n,)``.
        """
        found = np.zeros(len(places) - 1)
        firsts = np.searchsorted(places, self.positions[:-1] + _TRIFLE, side="right") - 1
        lasts = np.searchsorted(places, self.positions[1:] - _TRIFLE, side="left")
        for size, first, last in zip(self._hardest.tolist(), firsts.tolist(), lasts.tolist(), strict=True):
            if size:
                part = found[max(first, 0) : max(last, first + 1)]
                np.maximum(part, size, out=part)
        return found

    def _at(self, time: ArrayLike) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray, FloatArray]:
        """Material and speed at the corner before a time, acceleration there, jerk from there on, and the time since."""
        t = np.asarray(time, dtype=np.float64)
        k = np.clip(np.searchsorted(self.times, t, side="right") - 1, 0, len(self.times) - 1)
        inside = (t >= 0.0) & (k < len(self.times) - 1)
        part = np.minimum(k, len(self.times) - 2)
        a, j = (np.where(inside, values[part], 0.0) for values in (self._firsts, self._jerks))
        return self.positions[k], self.speeds[k], a, j, t - self.times[k]

    def passed(self, time: ArrayLike) -> FloatArray:
        """Material passed at times (m); shape of ``time``."""
        x, v, a, j, t = self._at(time)
        return np.asarray(x + t * (v + t * (0.5 * a + t * j / 6.0)))

    def speed(self, time: ArrayLike) -> FloatArray:
        """Line speed at times (m/s); shape of ``time``."""
        _, v, a, j, t = self._at(time)
        return np.asarray(v + t * (a + 0.5 * j * t))

    def when(self, position: ArrayLike) -> FloatArray:
        """Time at which material has passed (s); the first where the line stands there; infinite where it is never reached."""
        x = np.asarray(position, dtype=np.float64)
        corners = self.positions
        k = np.clip(np.searchsorted(corners, x, side="left") - 1, 0, len(self.times) - 1)
        last = (x > corners[-1]) | (x <= 0.0)
        k = np.where(x > corners[-1], len(self.times) - 1, k)
        part = np.minimum(k, len(self.times) - 2)
        a, j = (np.where(last, 0.0, values[part]) for values in (self._firsts, self._jerks))
        v, way = self.speeds[k], x - corners[k]
        end = np.sqrt(np.maximum(v * v + 2.0 * a * way, 0.0))
        with np.errstate(divide="ignore", invalid="ignore"):
            since = np.where(way == 0.0, 0.0, 2.0 * way / (v + end))
        if self.accelerations is not None:
            longest = np.where(last, np.inf, np.diff(self.times)[part])
            since = _since(way, v, a, j, np.minimum(since, longest), longest)
        return np.asarray(self.times[k] + since)


def _since(
    way: FloatArray, v: FloatArray, a: FloatArray, j: FloatArray, guess: FloatArray, longest: FloatArray
) -> FloatArray:
    """Find the time in which a line with a jerk goes a way, from a guess: Newton's method, kept within brackets; all of one shape."""
    low, high, since = np.zeros_like(way), longest, guess
    for _ in range(_ROUNDS):
        off = since * (v + since * (0.5 * a + since * j / 6.0)) - way
        low, high = np.where(off < 0.0, since, low), np.where(off > 0.0, since, high)
        speed = v + since * (a + 0.5 * j * since)
        with np.errstate(divide="ignore", invalid="ignore"):
            nearer = since - off / speed
        middle = np.where(np.isfinite(high), 0.5 * (low + high), 2.0 * since)
        nearer = np.where((nearer >= low) & (nearer <= high), nearer, middle)
        done = (off == 0.0) | (np.abs(nearer - since) <= 1e-16 * nearer)
        since = np.where(off == 0.0, since, nearer)
        if done.all():
            break
    return since
