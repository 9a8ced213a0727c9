"""The bender's moves in the discrete servo of S1: how long an axis is still on its way after its command has ended."""

from __future__ import annotations

import math

import numpy as np

from profiles.bender.motion import Moves
from profiles.errors import InputError
from profiles.polynomial import FloatArray
from profiles.servo import Servo, closed_loop, spectral_radius


def settling_times(moves: Moves, servo: Servo, window: float) -> FloatArray:
    """Time after each move's end from which on the axis stays within a window of its target (s).

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

    Returns
    -------
    ndarray
        Shape ``(n,)``, 0 for a move that has arrived when its command ends.

    Raises
    ------
    InputError
        The servo is unstable.
    """
    radius = spectral_radius(servo)
    if radius >= 1:
        raise InputError(f"the servo is unstable: largest pole {radius:.4f} in the z-plane, must be below 1")
    a, b = closed_loop(servo)
    goal = moves.distance
    decay = math.log(1e-3 * window / max(window, float(goal.max(initial=0.0)))) / math.log(radius)
    samples = math.ceil(float(moves.time.max(initial=0.0)) / servo.sample_time + decay) + 2
    state, before = np.zeros((len(goal), 3)), np.zeros(len(goal))
    last = np.zeros(len(goal))
    for k in range(samples):
        away = np.abs(goal - state[:, 2]) > window
        last[away] = (k + 1) * servo.sample_time
        command = moves.position(np.full((len(goal), 1), k * servo.sample_time))[:, 0]
        state = state @ a.T + command[:, None] * b[:, 0] + before[:, None] * b[:, 1]
        before = command
    return np.maximum(last - moves.time, 0.0)
