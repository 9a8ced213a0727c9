"""The bender's moves in the discrete servo of S1: when an axis has really arrived, and how far it runs over its target."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from camwright.profiles.bender.motion import Moves
from camwright.profiles.errors import InputError
from camwright.profiles.polynomial.profile import FloatArray
from camwright.profiles.servo import Servo, spectral_radius
from camwright.validation.servo.lifting import BLOCK, follow, lift_side_by_side, loops_of

_FORGOTTEN = 1e-13
"""Part of a thousandth of the window that is left of a move's start where time at constant speed is left out."""


_LONG = 4000
"""Samples at constant speed that are kept all the same."""


@dataclass(frozen=True, eq=False)
class Arrivals:
    """How moves end, one entry a move.

    Parameters
    ----------
    settling
        Time after the command's end from which on the axis stays within the window (s), 0 if it has arrived by then.
    overshoot
        How far the axis runs beyond its target (unit of the moves), 0 if it does not.
    """

    settling: FloatArray
    overshoot: FloatArray


def arrivals(moves: Moves, servo: Servo, window: float) -> Arrivals:
    """Run moves in the discrete servo.

    Each move starts from rest on a sampling instant; the axis is looked at on the sampling instants. The
    simulation of S1's loop ends when its slowest pole has brought the greatest move down to a thousandth of the window.
    Once it is forgotten at constant speed, only the following error is left, and what follows no longer depends on how long that
    lasts: whole samples of it are left out, so that the time does not grow with the distance.

    Parameters
    ----------
    moves
        The commands.
    servo
        The axis.
    window
        Distance from the target that counts as arrived, in the unit of the moves.

    Raises
    ------
    InputError
        The servo is unstable.
    """
    radius = spectral_radius(servo)
    if radius >= 1:
        raise InputError(f"the servo is unstable: largest pole {radius:.4f} in the z-plane, must be below 1")
    decay = math.log(1e-3 * window / max(window, float(moves.distance.max(initial=0.0)))) / math.log(radius)
    moves = _shortened(moves, servo, math.ceil(decay + math.log(_FORGOTTEN) / math.log(radius)))
    goal = moves.distance
    samples = math.ceil(float(moves.time.max(initial=0.0)) / servo.sample_time + decay) + 2
    times = servo.sample_time * np.arange(-1.0, samples)  # one sample at rest is all that is remembered
    command = moves.position(np.broadcast_to(times, (len(goal), len(times)))).T[None]
    lifted = lift_side_by_side(loops_of((servo,), parts=1), 1, (0,), BLOCK)
    axis = follow(lifted, command, np.zeros((1, len(goal))), 0.0, 1.0)[0]
    off = axis - goal[:, None]
    last = ((np.abs(off) > window) * np.arange(1, samples + 1)).max(axis=1) * servo.sample_time
    return Arrivals(np.maximum(last - moves.time, 0.0), np.maximum(off.max(axis=1), 0.0))


def _shortened(moves: Moves, servo: Servo, decay: int) -> Moves:
    """Leave whole samples at constant speed out of moves that have more of them than it takes to forget the start."""
    middle = moves.knots.shape[1] // 2  # the piece at constant speed ends here
    cruise = moves.knots[:, middle] - moves.knots[:, middle - 1]
    spare = np.maximum(np.floor(cruise / servo.sample_time) - max(decay, _LONG), 0.0) * servo.sample_time
    knots = moves.knots - np.where(np.arange(moves.knots.shape[1]) >= middle, spare[:, None], 0.0)
    return Moves(knots, moves.weights, moves.power)
