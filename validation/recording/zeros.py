"""What lies between a recorded command and its axis: another zero, or a lag."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from camwright.profiles.polynomial.profile import CamProfile, FloatArray

_LONGEST_LAG = 0.1
"""Lag (s) beyond which what lies between command and axis is another zero: dead times and following errors are less."""

_TELLING = 0.05
"""Change of the slave's velocity, as a part of its greatest, from which on a lag and a zero are told apart."""


@dataclass(frozen=True)
class Zeros:
    """Zero and lag of an axis against its command.

    Parameters
    ----------
    zero
        What the axis is off its command whatever it does (slave unit); ``None`` where the motion does not tell it from a lag.
    lag
        Time by which it runs later (s); ``None`` likewise.
    taken_off
        What was taken off the axis, because no lag explains it: the zeros of two encoders (slave unit).
    """

    zero: float | None
    lag: float | None
    taken_off: float


def zeros_of(profile: CamProfile, master: FloatArray, line_speed: float, apart: FloatArray) -> Zeros:
    """Tell a zero from a lag: the one is the same at any velocity, the other in proportion to it.

    What a linear servo leaves between command and axis is a sum of the command's derivatives; those up to the third are fitted.

    Parameters
    ----------
    master
        Master position of the rows (m).
    line_speed
        Mean line speed (m/s).
    apart
        Axis minus command at the rows (slave unit).
    """
    ratio = profile(master, 1, outside="repeat")
    mean, fastest = float(apart.mean()), float(np.abs(ratio).max()) * line_speed
    foreign = abs(mean) > _LONGEST_LAG * fastest
    if not float(np.ptp(ratio)) > _TELLING * float(np.abs(ratio).max()):
        return Zeros(None, None, mean if foreign else 0.0)
    motion = [profile(master, order, outside="repeat") * line_speed**order for order in (2, 3)]
    columns = np.stack([np.ones_like(ratio), -ratio * line_speed, *motion], axis=1)
    scale = np.sqrt((columns**2).sum(axis=0))
    scale[scale == 0.0] = 1.0
    zero, lag = (np.linalg.lstsq(columns / scale, apart, rcond=None)[0] / scale)[:2].tolist()
    return Zeros(0.0 if foreign else zero, lag, zero if foreign else 0.0)
