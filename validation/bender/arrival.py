"""The bender's moves in the discrete servo of S1: when an axis has really arrived, and how far it runs over its target."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from camwright.profiles.bender.motion import Moves
from camwright.profiles.errors import InputError
from camwright.profiles.polynomial.profile import FloatArray
from camwright.profiles.servo import Servo, closed_loop, spectral_radius


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
    a, b = closed_loop(servo)
    goal = moves.distance
    decay = math.log(1e-3 * window / max(window, float(goal.max(initial=0.0)))) / math.log(radius)
    samples = math.ceil(float(moves.time.max(initial=0.0)) / servo.sample_time + decay) + 2
    state, before = np.zeros((len(goal), 3)), np.zeros(len(goal))
    last, beyond = np.zeros(len(goal)), np.zeros(len(goal))
    for k in range(samples):
        away = np.abs(goal - state[:, 2]) > window
        beyond = np.maximum(beyond, state[:, 2] - goal)
        last[away] = (k + 1) * servo.sample_time
        command = moves.position(np.full((len(goal), 1), k * servo.sample_time))[:, 0]
        state = state @ a.T + command[:, None] * b[:, 0] + before[:, None] * b[:, 1]
        before = command
    return Arrivals(np.maximum(last - moves.time, 0.0), beyond)
