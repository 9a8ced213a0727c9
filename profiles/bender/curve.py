"""`Curve`: a strictly increasing curve through table rows and its inverse, for single numbers."""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass

import numpy as np

from camwright.profiles.polynomial.profile import FloatArray


@dataclass(frozen=True, eq=False)
class Curve:
    """Cubics between rows, carried on beyond the first and last row.

    One number at a time: the walk along a rule needs each bend's result before the next bend.

    Parameters
    ----------
    x, y
        The rows, both strictly increasing.
    coefficients
        Ascending powers of ``x - x[i]`` on interval ``i``, four each.
    """

    x: list[float]
    y: list[float]
    coefficients: list[tuple[float, float, float, float]]

    @classmethod
    def linear(cls, x: FloatArray, y: FloatArray) -> Curve:
        """Straight lines between the rows."""
        slope = np.diff(y) / np.diff(x)
        return cls(x.tolist(), y.tolist(), [(a, b, 0.0, 0.0) for a, b in zip(y.tolist(), slope.tolist(), strict=False)])

    @classmethod
    def monotone_cubic(cls, x: FloatArray, y: FloatArray) -> Curve:
        """Fritsch and Carlson's monotone cubic (PCHIP): smooth, and nowhere turning back between rising rows."""
        from scipy.interpolate import PchipInterpolator

        table = PchipInterpolator(x, y).c[::-1].T
        return cls(x.tolist(), y.tolist(), [(a, b, c, d) for a, b, c, d in table.tolist()])

    def value(self, x: float) -> float:
        """Evaluate the curve."""
        i = min(max(bisect_right(self.x, x) - 1, 0), len(self.coefficients) - 1)
        if x < self.x[0]:  # carried on straight: a cubic may turn back outside its interval
            return self.y[0] + (x - self.x[0]) * self.coefficients[0][1]
        if x > self.x[-1]:
            return self.y[-1] + (x - self.x[-1]) * self._slope(i, self.x[-1] - self.x[i])
        a, b, c, d = self.coefficients[i]
        t = x - self.x[i]
        return a + t * (b + t * (c + t * d))

    def _slope(self, i: int, t: float) -> float:
        _, b, c, d = self.coefficients[i]
        return b + t * (2 * c + t * 3 * d)

    def inverse(self, y: float) -> float:
        """Find the ``x`` with ``value(x) = y``: bisection, closed by Newton's steps that stay in the bracket."""
        if y < self.y[0]:
            return self.x[0] + (y - self.y[0]) / self.coefficients[0][1]
        i = min(max(bisect_right(self.y, y) - 1, 0), len(self.coefficients) - 1)
        if y > self.y[-1]:
            return self.x[-1] + (y - self.y[-1]) / self._slope(i, self.x[-1] - self.x[i])
        a, b, c, d = self.coefficients[i]
        if c == 0.0 and d == 0.0:
            return self.x[i] + (y - a) / b
        low, high = 0.0, self.x[i + 1] - self.x[i]
        t = high * (y - a) / (self.y[i + 1] - a)
        for _ in range(80):
            rest = a + t * (b + t * (c + t * d)) - y
            low, high = (t, high) if rest < 0 else (low, t)
            slope = self._slope(i, t)
            newton = t - rest / slope if slope > 0 else low
            following = newton if low <= newton <= high else 0.5 * (low + high)
            if abs(following - t) <= 1e-15 * self.x[-1]:
                return self.x[i] + following
            t = following
        return self.x[i] + t
