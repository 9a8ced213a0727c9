"""What speeds a motion along a path can have at its places, by its limits of acceleration and jerk.

With ``w = u²`` over the way the acceleration is ``w' / 2`` and the jerk ``w'' √w / 2``. So a limit ``J`` of the jerk says
``w'' >= -2 J / √w``: of two motions from the same state the one that brakes hardest is the slower everywhere, because where it is slower it
may also bend more. And ``w'' <= 2 J / √w`` bounds the speed from above with the least speed in place of the unknown one.
"""

from __future__ import annotations

import math

import numpy as np

from camwright.profiles.polynomial.profile import FloatArray

SAMPLES = 400
"""Times of the first braking at which its speed is taken; between them the chord lies below it."""
ROUNDING = 1e-12


def slowest(q: FloatArray, state: tuple[float, float], acceleration: float, jerk: float) -> FloatArray:
    """Least square of the speed at ways from the start, of a motion that never turns.

    Parameters
    ----------
    q
        Ways from the start, increasing from 0.
    state
        Speed and acceleration at the start.
    acceleration, jerk
        Their limits; either may be infinite.
    """
    speed, slope = state
    if not math.isfinite(acceleration):
        return np.zeros(len(q))
    if not math.isfinite(jerk):
        return np.maximum(speed**2 - 2.0 * acceleration * q, 0.0)
    t = np.linspace(0.0, max(acceleration + slope, 0.0) / jerk, SAMPLES)
    u = speed + t * (slope - jerk * t / 2)
    way = t * (speed + t * (slope / 2 - jerk * t / 6))
    resting = np.nonzero(u <= 0.0)[0]
    if len(resting):  # it rests before the limit is reached
        last = int(resting[0])
        return np.asarray(np.interp(q, way[:last], u[:last] ** 2, right=0.0))
    then = np.maximum(u[-1] ** 2 - 2.0 * acceleration * (q - way[-1]), 0.0)
    return np.asarray(np.where(q < way[-1], np.interp(q, way, u**2), then))


def fastest(
    q: FloatArray, state: tuple[float, float], acceleration: float, jerk: float, least: FloatArray
) -> FloatArray:
    """Greatest square of the speed at ways from the start, its least being known; the other arguments as in `slowest`."""
    speed, slope = state
    step = np.diff(q)
    with np.errstate(divide="ignore"):
        bend = jerk / np.sqrt(np.minimum(least[1:], least[:-1]))
    steepest = np.minimum(acceleration, slope + np.cumsum(step * bend))
    return np.asarray(speed**2 + np.concatenate([[0.0], 2.0 * np.cumsum(step * steepest)]) * (1 + ROUNDING))
