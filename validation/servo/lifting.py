"""The servo's closed loop over many samples at once, as matrices from the command to the axis."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from camwright.profiles.polynomial.profile import FloatArray
from camwright.profiles.servo import Servo, sample_plant

SUBSTEPS = 8
"""Points of the axis per sample, the sampling instant included."""

_BLOCK = 16
"""Samples that one step of the block recursion advances; a power of two."""


@dataclass(frozen=True, eq=False)
class Lifted:
    """The closed loop over its memory and over a block of samples; a property of the servo alone.

    With the command ``c``, the state ``z`` of `camwright.profiles.servo.SampledPlant` and the closed loop's input ``f`` (m/s), all
    as rows::

        z[0]                = c[-past:0] @ history
        velocity, position  = (f[0:size], z[0]) @ points    at the points of the block
        z[size]             = (f[0:size], z[0]) @ end

    with ``history`` ``(past, 3)``, ``points`` ``(2, size + 3, size SUBSTEPS)``, ``end`` ``(size + 3, 3)``; ``size`` is `_BLOCK`.
    """

    history: FloatArray
    points: FloatArray
    end: FloatArray


@lru_cache(maxsize=32)
def lift(servo: Servo, past: int) -> Lifted:
    """Lift a servo: ``z[j] = A^j z[0] + sum_i A^(j-1-i) b f[i]``, and between the samples the plant alone.

    Parameters
    ----------
    servo
        The servo; dead time and lead do not matter.
    past
        Samples that it remembers.
    """
    gain, lead = servo.position_gain, servo.velocity_feedforward / servo.sample_time
    plant = sample_plant(servo, servo.sample_time)
    start = np.eye(3, 4)
    start[:, 3] = plant.input
    loop = plant.transition.copy()
    loop[:, 2] -= gain * plant.input
    powers, ahead = _doubled(start, loop, 4 * (_BLOCK + 1))  # of (I, b)
    response = _doubled(powers[:, 3::4], ahead, past)[0]
    powers = powers.reshape(3, -1, 4)
    earliest_first = response[:, past - 1 :: -1]
    history = (gain + lead) * earliest_first
    history[:, :-1] -= lead * earliest_first[:, 1:]

    # between the samples the reference u = f - K p is held: rows that make velocity and position of (z, f)
    part = sample_plant(servo, servo.sample_time / SUBSTEPS)
    held = np.eye(4)
    held[:3, :3], held[:3, 3] = part.transition, part.input
    rows = _doubled(np.eye(4), held, 4 * SUBSTEPS)[0].reshape(4, SUBSTEPS, 4)[1:3]
    rows[:, :, 2] -= gain * rows[:, :, 3]

    end = np.empty((_BLOCK + 3, 3))
    end[:_BLOCK] = response[:, _BLOCK - 1 :: -1].T
    end[_BLOCK:] = powers[:, _BLOCK, :3].T
    return Lifted(history.T.copy(), _points(rows, powers[:, :_BLOCK, :3], response[:, : _BLOCK - 1]), end)


def _doubled(start: FloatArray, transition: FloatArray, count: int) -> tuple[FloatArray, FloatArray]:
    """Columns times powers of a matrix, side by side: ``S, T S, T² S …``, in rounds that double their number.

    Parameters
    ----------
    start
        Columns ``S``: one power's, or several powers' already.
    transition
        Matrix ``T`` that takes these columns to the next.
    count
        How many columns are wanted at least.

    Returns
    -------
    (found, transition)
        The columns, and the matrix that takes all of them to the next.
    """
    while start.shape[1] < count:
        start = np.concatenate([start, transition @ start], axis=1)
        transition = transition @ transition
    return start, transition


def _points(rows: FloatArray, powers: FloatArray, response: FloatArray) -> FloatArray:
    """Matrices from the inputs of a block and its first state to quantities at its points.

    Parameters
    ----------
    rows
        The quantities at the points after a sample, from ``(z, f)``; shape ``(quantities, SUBSTEPS, 4)``.
    powers
        ``A^j``, shape ``(3, size, 3)``.
    response
        ``A^j b``, shape ``(3, size - 1)``.

    Returns
    -------
    ndarray
        Shape ``(quantities, size + 3, size SUBSTEPS)``.
    """
    kinds, size = len(rows), _BLOCK * SUBSTEPS
    # what one input does: itself at once, then through the states; the next input does the same a sample later
    pulse = np.zeros((kinds, 2 * size - SUBSTEPS))
    pulse[:, size - SUBSTEPS : size] = rows[:, :, 3]
    pulse[:, size:] = (response.T @ rows[:, :, :3].transpose(0, 2, 1)).reshape(kinds, -1)
    row, item = pulse.strides
    found = np.empty((kinds, _BLOCK + 3, size))
    found[:, :_BLOCK] = np.ndarray(
        (kinds, _BLOCK, size), buffer=pulse, offset=(size - SUBSTEPS) * item, strides=(row, -SUBSTEPS * item, item)
    )
    after = rows[:, :, :3].reshape(-1, 3) @ powers.reshape(3, -1)  # of each power a column
    found[:, _BLOCK:] = after.reshape(kinds, SUBSTEPS, _BLOCK, 3).transpose(0, 3, 2, 1).reshape(kinds, 3, size)
    return found


def follow(
    lifted: Lifted, servo: Servo, command: FloatArray, line: FloatArray, slope: float, line_speed: float
) -> tuple[FloatArray, FloatArray]:
    """Axis and its ratio after the memory, from rest before it, about a straight line.

    All blocks and phases take one matrix product together; only the first states of the blocks depend on each other.

    Parameters
    ----------
    lifted, servo
        The servo.
    command
        The command at the samples ``c[k]`` (m), without the line, memory first, shape ``(samples, phases)``.
    line
        Where the axis is without command: its position at the first sample after the memory (m), shape ``(phases,)``.
    slope
        Ratio at which it moves on from there.
    line_speed
        Line speed (m/s).

    Returns
    -------
    (ratio, axis)
        At the samples after the memory and between them (1, m), shape ``(phases, SUBSTEPS (samples - past))``.
    """
    past = len(lifted.history)
    phases, wanted = command.shape[1], len(command) - past
    blocks, size = -(-wanted // _BLOCK), _BLOCK * SUBSTEPS
    lead = servo.velocity_feedforward / servo.sample_time
    drive = np.zeros((blocks * _BLOCK, phases))  # f[k] = K c[k] + alpha (c[k] - c[k-1]) / dT
    np.multiply(command[past:], servo.position_gain + lead, out=drive[:wanted])
    drive[:wanted] -= lead * command[past - 1 : -1]
    known = np.empty((blocks, phases, _BLOCK + 5))  # inputs, first state, the line there, one
    known[:, :, :_BLOCK] = drive.reshape(blocks, _BLOCK, phases).transpose(0, 2, 1)
    states = known[:, :, _BLOCK : _BLOCK + 3]
    states[0] = command[:past].T @ lifted.history
    for block in range(1, blocks):
        states[block] = known[block - 1, :, : _BLOCK + 3] @ lifted.end
    step = slope * line_speed * servo.sample_time / SUBSTEPS
    known[:, :, -2] = line + np.arange(blocks)[:, None] * (size * step)
    known[:, :, -1] = 1.0
    points = np.empty((2, _BLOCK + 5, size))
    np.divide(lifted.points[0], line_speed, out=points[0, :-2])
    points[1, :-2] = lifted.points[1]
    points[0, -2], points[0, -1] = 0.0, slope
    points[1, -2], points[1, -1] = 1.0, np.arange(size) * step
    found = np.empty((2, phases, blocks, size))
    np.matmul(
        known, points[:, None], out=found.transpose(0, 2, 1, 3)
    )  # block by block: too small for threads to take part
    ratio, axis = found.reshape(2, phases, -1)[:, :, : wanted * SUBSTEPS]
    return ratio, axis
