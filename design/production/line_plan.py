"""The fastest line speed over a list of pieces: forward–backward over their joints.

In the square of the speed over the material a constant acceleration is a straight line of slope ``2 a``. The fastest plan is therefore the
greatest function that lies below each piece's highest speed and nowhere rises or falls faster: at the joints it is found by one pass
forwards and one backwards, and on a piece it is the least of the rise from its start, its own highest speed, and the fall to its end.
"""

from __future__ import annotations

import itertools

import numpy as np

from camwright.profiles.errors import InputError
from camwright.profiles.line_run import LineRun
from camwright.profiles.polynomial.profile import FloatArray

HARDEST = 1e4
"""Greatest acceleration of a line that is planned for (m/s²): beyond it is a jump, and no ramp."""

_SHORTEST = 1e-9
"""Corners less than this apart (s) are one."""


def fastest_plan(lengths: FloatArray, highest: FloatArray, acceleration: float) -> LineRun:
    """Run the line over pieces as fast as their highest speeds and its own ramp allow.

    The line comes at the highest speed of the first piece and leaves at that of the last, as far as its neighbours let it.

    Parameters
    ----------
    lengths
        Lengths of the pieces (m), shape ``(n,)``, positive.
    highest
        Highest line speed on each (m/s), shape ``(n,)``, positive; the higher may be kept neither before nor after a joint.
    acceleration
        Greatest acceleration and deceleration of the line (m/s²), positive, up to `HARDEST`.

    Returns
    -------
    LineRun
        The plan; corners less than `_SHORTEST` apart are one.

    Raises
    ------
    InputError
        A number is not positive, or the acceleration no line's, or there is no piece.

    Examples
    --------
    >>> import numpy as np
    >>> run = fastest_plan(np.array([1.0, 1.0]), np.array([2.0, 1.0]), 1.5)
    >>> [round(speed, 9) for speed in run.speeds.tolist()], round(run.time, 9)
    ([2.0, 1.0, 1.0], 1.666666667)
    """
    if not (len(lengths) and (lengths > 0).all() and (highest > 0).all() and 0 < acceleration <= HARDEST):
        raise InputError(
            f"a plan of the line needs at least one piece, lengths and speeds above zero, and an acceleration up to {HARDEST:g} m/s²; "
            f"got {len(lengths)} pieces and {acceleration!r} m/s²"
        )
    tops = (highest * highest).tolist()
    rises = (2.0 * acceleration * lengths).tolist()
    joints = [tops[0], *(min(pair) for pair in itertools.pairwise(tops)), tops[-1]]
    for k, rise in enumerate(rises):
        joints[k + 1] = min(joints[k + 1], joints[k] + rise)
    for k in range(len(rises) - 1, -1, -1):
        joints[k] = min(joints[k], joints[k + 1] + rises[k])
    places, squares = _corners(lengths, np.array(tops), np.array(joints), 2.0 * acceleration)
    speeds = np.sqrt(squares)
    times = np.concatenate([[0.0], np.cumsum(2.0 * np.diff(places) / (speeds[:-1] + speeds[1:]))])
    kept = np.diff(times, prepend=-np.inf) > _SHORTEST
    return LineRun(times[kept], speeds[kept])


def _corners(lengths: FloatArray, tops: FloatArray, joints: FloatArray, slope: float) -> tuple[FloatArray, FloatArray]:
    """Places on the material where the ramp may change, and the squares of the speed there."""
    first, last = joints[:-1], joints[1:]
    ends = np.concatenate([[0.0], np.cumsum(lengths)])
    peak = np.minimum(tops, 0.5 * (first + last + slope * lengths))
    places = np.stack([ends[:-1], ends[:-1] + (peak - first) / slope, ends[1:] - (peak - last) / slope], axis=1).ravel()
    squares = np.stack([first, peak, peak], axis=1).ravel()
    return np.append(np.maximum.accumulate(places), ends[-1]), np.append(squares, last[-1])
