"""Cubic splines, smooth to the second derivative, by the tridiagonal equations of their slopes."""

from __future__ import annotations

import numpy as np

from camwright.profiles.polynomial.profile import CamProfile, FloatArray


def clamped_spline(x: FloatArray, y: FloatArray, start_slope: float, end_slope: float) -> CamProfile:
    """Make the cubic spline with given slopes at its ends.

    With the widths ``h`` and chords ``d`` of the pieces the slopes ``s`` satisfy at every inner point::

        h[i] s[i-1] + 2 (h[i-1] + h[i]) s[i] + h[i-1] s[i+1] = 3 (h[i] d[i-1] + h[i-1] d[i])

    Parameters
    ----------
    x, y
        Points, shape ``(n,)``, at least two; ``x`` increases.
    start_slope, end_slope
        Slopes at the first and the last point.
    """
    h, d = np.diff(x), np.diff(y) / np.diff(x)
    left, right = h[1:], h[:-1]
    wanted = 3.0 * (left * d[:-1] + right * d[1:])
    if len(wanted):
        wanted[0] -= left[0] * start_slope
        wanted[-1] -= right[-1] * end_slope
    inner = _tridiagonal(left, 2.0 * (left + right), right, wanted)
    return _from_slopes(x, y, np.concatenate([[start_slope], inner, [end_slope]]))


def cyclic_spline(x: FloatArray, y: FloatArray) -> CamProfile:
    """Make the cubic spline that is smooth across the seam of the repeated cycle, too.

    The slave may advance from cycle to cycle. Two points make a line, for there is nothing to bend.

    Parameters
    ----------
    x, y
        Points, shape ``(n,)``, at least two; ``x`` increases.
    """
    h, d = np.diff(x), np.diff(y) / np.diff(x)
    n = len(h)
    if n == 1:
        return _from_slopes(x, y, np.array([d[0], d[0]]))
    before, chord_before = np.roll(h, 1), np.roll(d, 1)
    left, right = h, before  # factors of the slopes before and behind
    middle, wanted = 2.0 * (left + right), 3.0 * (left * chord_before + right * d)
    if n == 2:
        slopes = np.linalg.solve([[middle[0], left[0] + right[0]], [left[1] + right[1], middle[1]]], wanted)
    else:  # the corners left[0] and right[-1] by Sherman and Morrison
        gamma = -middle[0]
        diagonal = middle.copy()
        diagonal[0] -= gamma
        diagonal[-1] -= left[0] * right[-1] / gamma
        column = np.zeros(n)
        column[0], column[-1] = gamma, right[-1]
        first = _tridiagonal(left, diagonal, right, wanted)
        second = _tridiagonal(left, diagonal, right, column)
        factor = (first[0] + left[0] * first[-1] / gamma) / (1.0 + second[0] + left[0] * second[-1] / gamma)
        slopes = first - factor * second
    return _from_slopes(x, y, np.append(slopes, slopes[0]))


def _tridiagonal(left: FloatArray, middle: FloatArray, right: FloatArray, wanted: FloatArray) -> FloatArray:
    """Solve a diagonally dominant tridiagonal system; ``left[0]`` and ``right[-1]`` are not part of it."""
    low, high, value = left.tolist(), right.tolist(), wanted.tolist()
    pivot = middle.tolist()
    for i in range(1, len(pivot)):
        factor = low[i] / pivot[i - 1]
        pivot[i] -= factor * high[i - 1]
        value[i] -= factor * value[i - 1]
    for i in range(len(pivot) - 1, -1, -1):
        if i + 1 < len(pivot):
            value[i] -= high[i] * value[i + 1]
        value[i] /= pivot[i]
    return np.array(value, dtype=np.float64)


def _from_slopes(x: FloatArray, y: FloatArray, slopes: FloatArray) -> CamProfile:
    """Make the cubics through positions and slopes."""
    h, d = np.diff(x), np.diff(y) / np.diff(x)
    s0, s1 = slopes[:-1], slopes[1:]
    return CamProfile(
        np.array(x, dtype=np.float64),
        np.column_stack([y[:-1], s0, (3.0 * d - 2.0 * s0 - s1) / h, (s0 + s1 - 2.0 * d) / h**2]),
    )
