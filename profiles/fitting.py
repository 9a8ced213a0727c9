"""Smooth functions as profiles: Chebyshev interpolation on pieces, halved until it is as exact as double precision allows."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from profiles.errors import InputError
from profiles.polynomial import CamProfile, FloatArray

DEGREE = 13
"""Degree of the pieces: high enough for few pieces, low enough for the power basis to be well conditioned."""
TOLERANCE = 2e-14
"""Error allowed between the interpolation points, relative to the function's largest value."""
MOST_PIECES = 256


def fit_profile(function: Callable[[FloatArray], FloatArray], start: float, end: float) -> CamProfile:
    """Fit a smooth function by polynomials of degree 13 on equal pieces.

    Parameters
    ----------
    function
        Function of an array of master positions (m).
    start, end
        Domain (m).

    Raises
    ------
    InputError
        256 pieces are not enough: the function is not smooth on the domain.
    """
    count = 2
    while count <= MOST_PIECES:
        breaks = np.linspace(start, end, count + 1)
        rows = _interpolate(function, breaks)
        profile = CamProfile(breaks, rows)
        between = np.linspace(start, end, 41 * count + 1)
        truth = function(between)
        if np.abs(profile(between) - truth).max() <= TOLERANCE * np.abs(truth).max():
            return profile
        count *= 2
    raise InputError(
        f"a motion between master {start!r} and {end!r} m is too abrupt to be carried as polynomials: {MOST_PIECES} pieces of degree {DEGREE} "
        f"are not enough; shorten the sync zone"
    )


def _interpolate(function: Callable[[FloatArray], FloatArray], breaks: FloatArray) -> FloatArray:
    """Coefficients of the pieces, ascending powers from each piece's start."""
    node = np.cos(np.pi * (np.arange(DEGREE + 1) + 0.5) / (DEGREE + 1))
    half = 0.5 * np.diff(breaks)
    middle = 0.5 * (breaks[:-1] + breaks[1:])
    values = function((middle[:, None] + half[:, None] * node).ravel()).reshape(len(half), -1)
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
