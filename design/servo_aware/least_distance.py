"""Strictly convex quadratic programmes as least-distance problems, solved by non-negative least squares.

Lawson and Hanson, *Solving Least Squares Problems* (1974), chapter 23: with the Cholesky factor ``H = R R'`` and ``u = R' x + c``,
``R c = g``, the cost ``x' H x / 2 + g' x`` is ``|u|² / 2`` but for a constant, and the point nearest to the origin that keeps rows
``A' u >= h`` is ``r / -r[n]`` with the residual ``r`` of the non-negative least squares problem ``[A; h'] y = (0, …, 0, 1)``.
"""

from __future__ import annotations

import numpy as np

from camwright.profiles.polynomial.profile import FloatArray

# Rows that seem to leave no point at all leave a residual below this.
_NO_POINT = 1e-9
# By this share of the cost an answer may be above its dual.
_GAP = 1e-8


def least_distance(
    square: FloatArray, cost: FloatArray, matrix: FloatArray, low: FloatArray, high: FloatArray
) -> FloatArray | None:
    """Minimise ``x @ square @ x / 2 + cost @ x`` where ``low <= matrix @ x <= high``.

    Parameters
    ----------
    square
        Shape ``(n, n)``, symmetric and positive definite.
    cost
        Shape ``(n,)``.
    matrix, low, high
        Shapes ``(rows, n)`` and ``(rows,)``; infinite sides are no rows.

    Returns
    -------
    ndarray or None
        The minimiser, optimal to `_GAP`; how far it breaks rows by rounding is for the caller to judge. ``None`` where rounding leaves no
        such answer, or no point seems to keep the rows.
    """
    from scipy.linalg import solve_triangular
    from scipy.optimize import nnls

    try:
        factor = np.linalg.cholesky(square)
    except np.linalg.LinAlgError:
        return None
    shift = solve_triangular(factor, cost, lower=True)
    rows = solve_triangular(factor, matrix.T, lower=True)
    off = shift @ rows
    above, below = np.isfinite(high), np.isfinite(low)
    sides = np.hstack([-rows[:, above], rows[:, below]])
    bounds = np.concatenate([-(high + off)[above], (low + off)[below]])
    stacked = np.vstack([sides, bounds])
    size = np.linalg.norm(stacked, axis=0)
    size[size == 0.0] = 1.0
    target = np.zeros(len(stacked))
    target[-1] = 1.0
    try:
        prices, distance = nnls(stacked / size, target)
    except RuntimeError:  # too many rounds
        return None
    if distance < _NO_POINT:
        return None
    residual = (stacked / size) @ prices - target
    point = -residual[:-1] / residual[-1]
    # the point is the sum of the rows by their multipliers; it is the nearest one if only rows that it touches have any
    gap = float((prices / size / -residual[-1]) @ (sides.T @ point - bounds))
    if abs(gap) > _GAP * float(point @ point):
        return None
    found = np.asarray(solve_triangular(factor.T, point - shift, lower=False), dtype=np.float64)
    held = np.nonzero(prices)[0]
    if len(held) == 0:
        return found
    # the factor may be all but singular: rows that it touches are met again by the least step
    signs = np.concatenate([-np.ones(above.sum()), np.ones(below.sum())])[held]
    touched = np.concatenate([np.nonzero(above)[0], np.nonzero(below)[0]])[held]
    met = np.where(signs < 0, high[touched], low[touched])
    step: FloatArray = np.linalg.lstsq(matrix[touched], met - matrix[touched] @ found)[0]
    return found + step
