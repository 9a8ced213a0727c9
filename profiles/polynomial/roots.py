"""Roots of polynomials in rows, in intervals, all at once."""

from __future__ import annotations

import numpy as np

from camwright.profiles.polynomial.rows import Rows, recentred

_NONE = 1e-15
"""Part of the greatest contribution on the interval below which the highest powers count as none."""

_REAL = 1e-6
"""Imaginary part up to which a root counts as real: a double root splits into a pair of about sqrt(eps) off."""


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


def _by_companion(table: Rows) -> Rows:
    """Real roots as eigenvalues of the companion matrices, turned so that the large coefficients come first; NaN for the others."""
    count, degree = table.shape[0], table.shape[1] - 1
    matrices = np.zeros((count, degree, degree))
    inner = np.arange(degree - 1)
    matrices[:, inner, inner + 1] = 1.0
    matrices[:, :, 0] = (-table[:, :-1] / table[:, -1:])[:, ::-1]
    values = np.linalg.eigvals(matrices)
    return np.where(np.abs(values.imag) < _REAL, values.real, np.nan)
