"""The torque between the points at which a programme looks at it, and the mesh that takes peaks away which hide there."""

from __future__ import annotations

import numpy as np

from camwright.design.torque.mesh import divide, states_within, widths
from camwright.design.torque.programme import Guess
from camwright.design.torque.task import Pattern, TorqueTask
from camwright.profiles.polynomial.profile import FloatArray

SHARES = np.linspace(0.0, 1.0, 33)
"""Places of every interval at which the torque is looked at."""
MOST = 380
"""Intervals of a motion at most: a table of 400 points holds them all."""
ABOVE = (1e-4, 5e-5, 5e-5)
"""Shares by which a peak may lie above what the programme knows of it, in the rounds in which intervals are divided."""


def peaks(guess: Guess, pattern: Pattern, task: TorqueTask) -> FloatArray:
    """Greatest magnitude of the torque or force at the slave in every interval."""
    return np.asarray(np.abs(_within(guess, pattern, task)[0]).max(axis=1))


def drawn_between(guess: Guess, pattern: Pattern, task: TorqueTask) -> float:
    """Mean power drawn at the slave (W): the programme's own points miss where in an interval the power changes its sign."""
    force, velocity, lengths = _within(guess, pattern, task)
    return float(lengths @ np.trapezoid(np.maximum(force * velocity, 0.0), SHARES, axis=1))


def _within(guess: Guess, pattern: Pattern, task: TorqueTask) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Torque or force and velocity at the slave at places of every interval, a row for each, and the intervals' shares of the return."""
    machine, scale, time = task.machine, task.scale, task.duration
    a, v, q = states_within(guess, pattern, SHARES)
    phases = [phase for phase in pattern if phase != "rest"]
    sign = np.repeat([-1.0 if phase == "back" else 1.0 for phase in phases], [len(mesh) for mesh in guess.mesh])
    y = task.start + scale * q
    inertial = machine.inertia(y) * a + machine.inertia_slope(y) * scale * v**2 / 2
    force = scale / time**2 * inertial + machine.friction * sign[:, None]
    return force, scale / time * v, widths(guess, pattern)


def sharpened(guess: Guess, pattern: Pattern, task: TorqueTask, limit: float, above: float) -> Guess | None:
    """Divide the intervals in which the torque goes beyond a limit by more than a share, no more than `MOST` leave; None if none is."""
    greatest = peaks(guess, pattern, task)
    room = (MOST - len(greatest)) // 2
    worst = np.argsort(-greatest, kind="stable")[: max(room, 0)]
    chosen = np.zeros(len(greatest), dtype=bool)
    chosen[worst] = greatest[worst] > limit * (1 + above)
    return divide(guess, pattern, chosen) if chosen.any() else None
