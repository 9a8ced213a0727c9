"""Smooth ratios as profiles: Chebyshev interpolation on pieces, halved until it is as exact as double precision allows, and integrated."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

import numpy as np

from camwright.profiles.errors import InputError
from camwright.profiles.polynomial.profile import CamProfile, FloatArray

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
            return CamProfile(breaks, rows).integral()
        count *= 2
    raise InputError(
        f"a motion between master {start!r} and {end!r} m is too abrupt to be carried as polynomials: {MOST_PIECES} pieces of degree "
        f"{DEGREE} are not enough; shorten the sync zone"
    )


def _interpolate(ratio: Callable[[FloatArray], FloatArray], breaks: FloatArray) -> FloatArray:
    """Coefficients of the pieces, ascending powers from each piece's start."""
    width = np.diff(breaks)
    points, to_series, to_powers = interpolation(DEGREE)
    values = ratio((breaks[:-1, None] + width[:, None] * points).ravel()).reshape(len(width), -1)
    return np.asarray((values @ to_series) @ to_powers / width[:, None] ** np.arange(DEGREE + 1))


@lru_cache(maxsize=4)
def interpolation(degree: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Chebyshev points on the unit interval, and the two steps from values there to ascending powers.

    Returns
    -------
    (points, to_series, to_powers)
        ``(values @ to_series) @ to_powers`` are the powers; multiplied in this order, because the product of the matrices has large numbers
        of both signs, which would spoil them.
    """
    node = np.cos(np.pi * (np.arange(degree + 1) + 0.5) / (degree + 1))
    to_series = np.linalg.inv(np.polynomial.chebyshev.chebvander(node, degree)).T
    to_powers = np.zeros((degree + 1, degree + 1))
    to_powers[0, 0] = 1.0
    to_powers[1, :2] = [-1.0, 2.0]
    for k in range(2, degree + 1):  # T_k(2 t - 1) = 2 (2 t - 1) T_(k-1) - T_(k-2)
        to_powers[k] = -2 * to_powers[k - 1] - to_powers[k - 2]
        to_powers[k, 1:] += 4 * to_powers[k - 1, :-1]
    return 0.5 + 0.5 * node, np.asarray(to_series), to_powers
