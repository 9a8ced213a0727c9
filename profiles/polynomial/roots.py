"""Roots of polynomials in rows, in intervals, all at once."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from camwright.profiles.polynomial.rows import Rows, recentred

_NONE = 1e-15
"""Part of the greatest contribution on the interval below which the highest powers count as none."""

_REAL = 1e-6
"""Imaginary part up to which a root counts as real: a double root splits into a pair of about sqrt(eps) off."""
_CLEAR = 1e-9
"""Share of the greatest Bernstein coefficient by which all must be off zero: beyond what splits a double root, and beyond rounding."""


def roots_between(table: Rows, a: Rows, b: Rows) -> Rows:
    """Real roots of polynomials inside the open intervals ``(a, b)``, found on the unit interval for the sake of scaling.

    Parameters
    ----------
    table
        Shape ``(n, m)``, ascending powers, one polynomial a row.
    a, b
        Ends of each row's interval, shape ``(n,)``.

    Returns
    -------
    ndarray
        Shape ``(n, m - 1)``, in each row the roots in ascending order and then NaN; empty rows where ``b <= a``.
    """
    count, width = table.shape
    if width == 1:  # constants
        return np.empty((count, 0))
    found = np.full((count, width - 1), np.nan)
    unit = recentred(table, a) * (b - a)[:, None] ** np.arange(width)
    size = np.abs(unit)
    significant = size > _NONE * size.max(axis=1, keepdims=True)
    degree = np.where(b > a, width - 1 - significant[:, ::-1].argmax(axis=1), 0)  # 0 also for a polynomial that is zero
    degree[~significant.any(axis=1)] = 0
    degree[_of_one_sign(unit)] = 0  # eigenvalues take far longer
    linear = np.nonzero(degree == 1)[0]
    if len(linear):
        found[linear, 0] = -unit[linear, 0] / unit[linear, 1]
    for each in range(2, width):
        rows = np.nonzero(degree == each)[0]
        if len(rows):
            found[rows, :each] = _by_companion(unit[rows, : each + 1])
    found = np.where((found > 0.0) & (found < 1.0), found, np.nan)
    found.sort(axis=1)
    return a[:, None] + (b - a)[:, None] * found


def _of_one_sign(unit: Rows) -> NDArray[np.bool_]:
    """Tell of each polynomial whether its Bernstein coefficients say that it is clear of zero on the unit interval; shape ``(n,)``."""
    height = unit @ _to_bernstein(unit.shape[1])
    aside = _CLEAR * np.abs(height).max(axis=1)
    return np.asarray((height.min(axis=1) > aside) | (height.max(axis=1) < -aside))


@lru_cache(maxsize=64)
def _to_bernstein(width: int) -> Rows:
    """Matrix from ascending powers on the unit interval to Bernstein coefficients: ``b_i = sum_j C(i, j) / C(n, j) c_j``."""
    return np.array([[math.comb(i, j) / math.comb(width - 1, j) for i in range(width)] for j in range(width)])


def _by_companion(table: Rows) -> Rows:
    """Real roots as eigenvalues of the companion matrices, turned so that the large coefficients come first; NaN for the others."""
    count, degree = table.shape[0], table.shape[1] - 1
    matrices = np.zeros((count, degree, degree))
    inner = np.arange(degree - 1)
    matrices[:, inner, inner + 1] = 1.0
    matrices[:, :, 0] = (-table[:, :-1] / table[:, -1:])[:, ::-1]
    values = np.linalg.eigvals(matrices)
    return np.where(np.abs(values.imag) < _REAL, values.real, np.nan)
