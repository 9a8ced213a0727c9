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
    goal = moves.distance
    decay = math.log(1e-3 * window / max(window, float(goal.max(initial=0.0)))) / math.log(radius)
    samples = math.ceil(float(moves.time.max(initial=0.0)) / servo.sample_time + decay) + 2
    times = servo.sample_time * np.arange(-1.0, samples)  # one sample at rest is all that is remembered
    command = moves.position(np.broadcast_to(times, (len(goal), len(times)))).T[None]
    lifted = lift_side_by_side(loops_of((servo,), parts=1), 1, (0,), BLOCK)
    axis = follow(lifted, command, np.zeros((1, len(goal))), 0.0, 1.0)[0]
    off = axis - goal[:, None]
    last = ((np.abs(off) > window) * np.arange(1, samples + 1)).max(axis=1) * servo.sample_time
    return Arrivals(np.maximum(last - moves.time, 0.0), np.maximum(off.max(axis=1), 0.0))
