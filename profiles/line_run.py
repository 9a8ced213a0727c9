"""`LineRun`: the speed of the line over time, and the material that passes."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from camwright.profiles.polynomial.profile import FloatArray

_TRIFLE = 1e-9
"""Material (m) that is none: a ramp that ends at a joint is not on the piece behind it."""


@dataclass(frozen=True, eq=False)
class LineRun:
    """A line whose acceleration is constant between corners; beyond both ends it keeps its speed.

    Parameters
    ----------
    times
        Corners, strictly increasing from zero (s), shape ``(n,)``, at least two.
    speeds
        Line speed there, not negative (m/s), shape ``(n,)``.

    Examples
    --------
    >>> import numpy as np
    >>> run = LineRun(np.array([0.0, 1.0, 3.0]), np.array([0.0, 2.0, 2.0]))
    >>> run.passed([1.0, 3.0, 4.0]).tolist(), run.when([1.0, 5.0]).tolist(), run.speed([0.5]).tolist()
    ([1.0, 5.0, 7.0], [1.0, 3.0], [1.0])
    """

    times: FloatArray
    speeds: FloatArray

    @cached_property
    def positions(self) -> FloatArray:
        """Material passed at the corners (m), from zero."""
        steps = 0.5 * np.diff(self.times) * (self.speeds[:-1] + self.speeds[1:])
        return np.concatenate([[0.0], np.cumsum(steps)])

    @cached_property
    def _accelerations(self) -> FloatArray:
        return np.diff(self.speeds) / np.diff(self.times)

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
        return float(np.abs(self._accelerations).max())

    def fastest_between(self, places: FloatArray) -> FloatArray:
        """Greatest speed from each place on the material to the next (m/s); arguments as `hardest_between`."""
        at = self.speed(self.when(places))
        found = np.maximum(at[:-1], at[1:])
        inside = (self.positions > places[0]) & (self.positions < places[-1])
        np.maximum.at(found, np.searchsorted(places, self.positions[inside], side="left") - 1, self.speeds[inside])
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
        for size, first, last in zip(
            np.abs(self._accelerations).tolist(), firsts.tolist(), lasts.tolist(), strict=True
        ):
            if size:
                part = found[max(first, 0) : max(last, first + 1)]
                np.maximum(part, size, out=part)
        return found

    def _at(self, time: ArrayLike) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Material and speed at the corner before a time, the acceleration from there on, and the time since."""
        t = np.asarray(time, dtype=np.float64)
        k = np.clip(np.searchsorted(self.times, t, side="right") - 1, 0, len(self.times) - 1)
        inside = (t >= 0.0) & (k < len(self.times) - 1)
        a = np.where(inside, self._accelerations[np.minimum(k, len(self.times) - 2)], 0.0)
        return self.positions[k], self.speeds[k], a, t - self.times[k]

    def passed(self, time: ArrayLike) -> FloatArray:
        """Material passed at times (m); shape of ``time``."""
        x, v, a, t = self._at(time)
        return np.asarray(x + t * (v + 0.5 * a * t))

    def speed(self, time: ArrayLike) -> FloatArray:
        """Line speed at times (m/s); shape of ``time``."""
        _, v, a, t = self._at(time)
        return np.asarray(v + a * t)

    def when(self, position: ArrayLike) -> FloatArray:
        """Time at which material has passed (s); the first where the line stands there; infinite where it is never reached."""
        x = np.asarray(position, dtype=np.float64)
        corners = self.positions
        k = np.clip(np.searchsorted(corners, x, side="left") - 1, 0, len(self.times) - 1)
        last = (x > corners[-1]) | (x <= 0.0)
        k = np.where(x > corners[-1], len(self.times) - 1, k)
        a = np.where(last, 0.0, self._accelerations[np.minimum(k, len(self.times) - 2)])
        v, way = self.speeds[k], x - corners[k]
        end = np.sqrt(np.maximum(v * v + 2.0 * a * way, 0.0))
        with np.errstate(divide="ignore", invalid="ignore"):
            since = np.where(way == 0.0, 0.0, 2.0 * way / (v + end))
        return np.asarray(self.times[k] + since)
