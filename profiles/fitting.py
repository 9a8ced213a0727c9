"""Smooth ratios as profiles: Chebyshev interpolation on pieces, halved until it is as exact as double precision allows, and integrated."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from profiles.errors import InputError
from profiles.polynomial import CamProfile, FloatArray

DEGREE = 13
"""Degree of the ratio on a piece: high enough for few pieces, low enough for the power basis to be well conditioned."""
TOLERANCE = 2e-13
"""Error of the ratio allowed between the interpolation points, relative to its largest value."""
MOST_PIECES = 256


def fit_profile(ratio: Callable[[FloatArray], FloatArray], start: float, end: float) -> CamProfile:
    """Fit a profile to a smooth ratio, from slave zero: polynomials of degree 14 on equal pieces.

    The ratio is fitted and not the position: each derivative taken of a fit enlarges its rounding a thousandfold, and the ratio slope must
    not jump at the joins.

    Parameters
    ----------
    ratio
        Ratio (slave unit per m) as a function of an array of master positions (m).
    start, end
        Domain (m).

    Raises
    ------
    InputError
        256 pieces are not enough: the ratio is not smooth on the domain.
    """
    count = 2
    while count <= MOST_PIECES:
        breaks = np.linspace(start, end, count + 1)
        rows = _interpolate(ratio, breaks)
        between = np.linspace(start, end, 41 * count + 1)
        truth = ratio(between)
        if np.abs(CamProfile(breaks.copy(), rows.copy())(between) - truth).max() <= TOLERANCE * np.abs(truth).max():
            return _integrated(breaks, rows)
        count *= 2
    raise InputError(
        f"a motion between master {start!r} and {end!r} m is too abrupt to be carried as polynomials: {MOST_PIECES} pieces of degree {DEGREE} "
        f"are not enough; shorten the sync zone"
    )


def _integrated(breaks: FloatArray, rows: FloatArray) -> CamProfile:
    """Position from zero, continuous, of a ratio given piece by piece."""
    powers = np.arange(1, rows.shape[1] + 1)
    table = np.concatenate([np.zeros((len(rows), 1)), rows / powers], axis=1)
    rise = np.sum(table * np.diff(breaks)[:, None] ** np.arange(table.shape[1]), axis=1)
    table[1:, 0] = np.cumsum(rise)[:-1]
    return CamProfile(breaks, table)


def _interpolate(ratio: Callable[[FloatArray], FloatArray], breaks: FloatArray) -> FloatArray:
    """Coefficients of the pieces, ascending powers from each piece's start."""
    node = np.cos(np.pi * (np.arange(DEGREE + 1) + 0.5) / (DEGREE + 1))
    half = 0.5 * np.diff(breaks)
    middle = 0.5 * (breaks[:-1] + breaks[1:])
    values = ratio((middle[:, None] + half[:, None] * node).ravel()).reshape(len(half), -1)
    series = np.polynomial.chebyshev.chebvander(node, DEGREE)
    chebyshev = np.linalg.solve(series, values.T)
    rows = []
    for i, h in enumerate(half):
        centred = np.polynomial.chebyshev.cheb2poly(chebyshev[:, i])
        # from (x - middle) / half to (x - start): t = u / half - 1
        moved = np.zeros(DEGREE + 1)
        for value in centred[::-1]:
            moved = np.concatenate([[0.0], moved[:-1]]) / h - moved
            moved[0] += value
        rows.append(moved)
    return np.array(rows)
