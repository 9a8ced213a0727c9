"""Columns of velocity and acceleration in units nobody states: which scale makes them belong to the positions."""

from __future__ import annotations

import numpy as np

from camwright.profiles.polynomial.profile import FloatArray

_POSITION_MISS = 2e-3
_RATIO_MISS = 0.1
"""What the columns may miss the positions, and each other, by (rms, relative): what rounding and quintic pieces leave."""
_ROUNDED = 1e-4
"""Part of the range by which printed positions may miss those that the columns lead to, to be these but for rounding."""
_FEWEST = 6


def scaled_derivatives(
    x: FloatArray, y: FloatArray, velocity: FloatArray, acceleration: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray] | None:
    """Scale two columns into ratio and ratio slope.

    Over a step ``h`` a cubic and a quintic of linear acceleration advance by ``h (v0 + v1)/2 + h² (a0 - a1)/12``, and
    their ratio changes by ``h (a0 + a1)/2``: least squares in the two scales.

    Parameters
    ----------
    x, y
        Positions, shape ``(n,)``.
    velocity, acceleration
        The columns, shape ``(n,)``, each in a unit of its own.

    Returns
    -------
    tuple or None
        Positions, ratio and ratio slope in the units of ``x`` and ``y``, or nothing if no scales make the columns belong to
        the positions. The positions are those that the columns lead to where these are within rounding of the given ones:
        quintics would put the rounding of a position on the acceleration.
    """
    if len(x) < _FEWEST or not velocity.any() or not acceleration.any():
        return None
    h, dy = np.diff(x), np.diff(y)
    mean = 0.5 * h * (velocity[1:] + velocity[:-1])
    bend = h * h * (acceleration[:-1] - acceleration[1:]) / 12.0
    p, q = 0.0, 0.0
    rise, slope = np.diff(velocity), 0.5 * h * (acceleration[1:] + acceleration[:-1])
    if not slope.any():
        return None
    share = float(rise @ slope / (slope @ slope))  # the acceleration in units of the velocity's change
    whole = mean + share * bend
    if not whole.any() or share == 0.0:
        return None
    p = float(dy @ whole / (whole @ whole))
    q = p * share
    position = float(np.linalg.norm(dy - p * whole) / np.linalg.norm(dy)) if dy.any() else 1.0
    ratio = float(np.linalg.norm(rise - share * slope) / np.linalg.norm(rise)) if rise.any() else 1.0
    if not (position <= _POSITION_MISS and ratio <= _RATIO_MISS and p > 0.0 and q > 0.0):
        return None
    led = y[0] + np.concatenate([[0.0], np.cumsum(p * whole)])
    led += (y[-1] - led[-1]) * np.arange(len(y)) / (len(y) - 1)
    close = float(np.abs(led - y).max()) <= _ROUNDED * float(np.ptp(y))
    return led if close else y, p * velocity, q * acceleration
