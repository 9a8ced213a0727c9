"""The servo's closed loop over many samples at once, as matrices from the command to the axis; many servos side by side."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from camwright.profiles.polynomial.profile import FloatArray
from camwright.profiles.servo import Servo, plant_rows

SUBSTEPS = 8
"""Points of the axis per sample, the sampling instant included."""

BLOCK = 16
"""Samples that one step of the recursion advances where a servo is lifted once for many runs; a power of two."""


@dataclass(frozen=True, eq=False)
class Loops:
    """Sampled servos side by side. Their dead time and lead time are the command's affair.

    Parameters
    ----------
    held
        Plants on ``(z, u)`` over no time to a whole sample, in equal parts: shape ``(servos, parts + 1, 4, 4)``, with the state ``z`` of
        `camwright.profiles.servo.SampledPlant` and the velocity reference ``u`` that is held.
    gain
        Position gain (1/s), shape ``(servos,)``.
    drive
        Weights of the command's samples, newest first, in the velocity reference (1/s), shape ``(servos, 2)`` or ``(servos, 4)``.
    sample_time
        Shape ``(servos,)`` (s).
    """

    held: FloatArray
    gain: FloatArray
    drive: FloatArray
    sample_time: FloatArray

    def closed(self) -> FloatArray:
        """Close the loops over a sample: ``A`` of `camwright.profiles.servo.closed_loop`, shape ``(servos, 3, 3)``."""
        loops = self.held[:, -1, :3, :3].copy()
        loops[:, :, 2] -= self.held[:, -1, :3, 3] * self.gain[:, None]
        return loops

    def take(self, rows: NDArray[np.intp]) -> Loops:
        """Pick servos by their number."""
        return Loops(self.held[rows], self.gain[rows], self.drive[rows], self.sample_time[rows])


def loops_of(servos: Sequence[Servo], parts: int = SUBSTEPS) -> Loops:
    """Sample servos, each over equal parts of its own sample time."""
    held = np.zeros((len(servos), parts + 1, 4, 4))
    held[:, 0] = np.eye(4)
    held[:, 1, 3, 3] = 1.0
    held[:, 1, :3] = [plant_rows(servo, servo.sample_time / parts) for servo in servos]
    known = 1
    while known < parts:  # twice as many in each round
        more = min(known, parts - known)
        held[:, known + 1 : known + more + 1] = held[:, known, None] @ held[:, 1 : more + 1]
        known += more
    gain, sample_time = np.array([(servo.position_gain, servo.sample_time) for servo in servos]).T
    drives = [servo.drive for servo in servos]
    most = max(len(each) for each in drives)
    drive = np.array([each + (0.0,) * (most - len(each)) for each in drives])
    return Loops(held, gain, drive, sample_time)


@dataclass(frozen=True, eq=False)
class Lifted:
    """Closed loops over their memory and over a block of samples; a property of the servos alone.

    With the command ``c``, the state ``z`` and the closed loop's input ``f`` (m/s), all as rows, of each servo::

        z[0]        = c[-past:0] @ history'
        quantities  = (f[0:size], z[0]) @ points    at the points of the block
        z[size]     = (f[0:size], z[0]) @ end

    Parameters
    ----------
    orders
        The quantities: derivatives of the axis over time, 0 the position, 1 the velocity, 2 the acceleration.
    history
        Shape ``(servos, 3, past)``.
    points
        Shape ``(orders, servos, size + 3, size parts)``.
    end
        Shape ``(servos, size + 3, 3)``.
    """

    loops: Loops
    orders: tuple[int, ...]
    history: FloatArray
    points: FloatArray
    end: FloatArray

    def take(self, rows: NDArray[np.intp]) -> Lifted:
        """Pick servos by their number."""
        return Lifted(self.loops.take(rows), self.orders, self.history[rows], self.points[:, rows], self.end[rows])

    @property
    def size(self) -> int:
        """Samples of a block."""
        return int(self.end.shape[1]) - 3

    @property
    def parts(self) -> int:
        """Points per sample."""
        return int(self.points.shape[-1]) // self.size


@lru_cache(maxsize=32)
def lift(servo: Servo, past: int, orders: tuple[int, ...]) -> Lifted:
    """Lift one servo, to be run on many profiles: `lift_side_by_side` in blocks of `BLOCK` samples."""
    return lift_side_by_side(loops_of((servo,)), past, orders, BLOCK)


def lift_side_by_side(loops: Loops, past: int, orders: tuple[int, ...], size: int = 1) -> Lifted:
    """Lift servos: ``z[j] = A^j z[0] + sum_i A^(j-1-i) b f[i]``, and between the samples the plant alone.

    Parameters
    ----------
    past
        Samples that they remember, at least one.
    orders
        Derivatives of the axis that are asked for.
    size
        Samples that one step advances: many where the matrices serve for many runs, one where they serve once.
    """
    many = len(loops.gain)
    gain = loops.gain[:, None, None]
    start = np.empty((many, 3, 4))
    start[:, :, :3], start[:, :, 3] = np.eye(3), loops.held[:, -1, :3, 3]
    powers, ahead = _doubled(start, loops.closed(), 4 * (size + 1))  # of (I, b)
    response = _doubled(powers[:, :, 3::4], ahead, max(past, size))[0]
    powers = powers.reshape(many, 3, -1, 4)
    earliest_first = response[:, :, past - 1 :: -1]
    weights = loops.drive[:, :, None, None]
    history = weights[:, 0] * earliest_first
    for number in range(1, min(weights.shape[1], past)):
        history[:, :, :-number] += weights[:, number] * earliest_first[:, :, number:]

    # between the samples the reference u = f - K p is held: rows that make the quantities of (z, f)
    rows = loops.held[:, :-1, [2 - order for order in orders]].transpose(2, 0, 1, 3)
    rows[..., 2] -= gain[:, :, 0] * rows[..., 3]

    end = np.empty((many, size + 3, 3))
    end[:, :size] = response[:, :, size - 1 :: -1].transpose(0, 2, 1)
    end[:, size:] = powers[:, :, size, :3].transpose(0, 2, 1)
    points = _points(rows, powers[:, :, :size, :3], response[:, :, : size - 1], size)
    return Lifted(loops, orders, history, points, end)


def _doubled(start: FloatArray, transition: FloatArray, count: int) -> tuple[FloatArray, FloatArray]:
    """Columns times powers of matrices, side by side: ``S, T S, T² S …``, in rounds that double their number.

    Parameters
    ----------
    start
        Columns ``S``: one power's, or several powers' already; shape ``(servos, 3, columns)``.
    transition
        Matrices ``T`` that take these columns to the next.
    count
        How many columns are wanted at least.

    Returns
    -------
    (found, transition)
        The columns, and the matrices that take all of them to the next.
    """
    while start.shape[2] < count:
        start = np.concatenate([start, transition @ start], axis=2)
        transition = transition @ transition
    return start, transition


def _points(rows: FloatArray, powers: FloatArray, response: FloatArray, size: int) -> FloatArray:
    """Matrices from the inputs of a block and its first state to quantities at its points.

    Parameters
    ----------
    rows
        The quantities at the points after a sample, from ``(z, f)``; shape ``(quantities, servos, parts, 4)``.
    powers
        ``A^j``, shape ``(servos, 3, size, 3)``.
    response
        ``A^j b``, shape ``(servos, 3, size - 1)``.

    Returns
    -------
    ndarray
        Shape ``(quantities, servos, size + 3, size parts)``.
    """
    kinds, many, parts, _ = rows.shape
    width = size * parts
    # what one input does: itself at once, then through the states; the next input does the same a sample later
    pulse = np.zeros((kinds, many, 2 * width - parts))
    pulse[..., width - parts : width] = rows[..., 3]
    pulse[..., width:] = (response.transpose(0, 2, 1) @ rows[..., :3].transpose(0, 1, 3, 2)).reshape(kinds, many, -1)
    kind, servo, item = pulse.strides
    found = np.empty((kinds, many, size + 3, width))
    found[:, :, :size] = np.ndarray(
        (kinds, many, size, width),
        buffer=pulse,
        offset=(width - parts) * item,
        strides=(kind, servo, -parts * item, item),
    )
    after = rows[..., :3] @ powers.reshape(many, 3, -1)  # of each power a column
    found[:, :, size:] = after.reshape(kinds, many, parts, size, 3).transpose(0, 1, 4, 3, 2).reshape(kinds, many, 3, -1)
    return found


def follow(
    lifted: Lifted, command: FloatArray, line: FloatArray, slope: float, line_speed: float | FloatArray
) -> FloatArray:
    """Axes after the memory, from rest before it, about a straight line.

    Every block and phase is a matrix product of its own; only the first states of the blocks depend on each other.

    Parameters
    ----------
    lifted
        The servos, or one for all of them.
    command
        The command at the samples ``c[k]`` (m), without the line, memory first: shape ``(servos, samples, phases)``, or
        ``(1, samples, phases)`` for all alike.
    line
        Where the axis is without command: its position at the first sample after the memory (m), shape ``(servos, phases)``.
    slope
        Ratio at which it moves on from there.
    line_speed
        Line speed (m/s), or that of each servo.

    Returns
    -------
    ndarray
        The derivatives over the master of the lifted orders, at the samples after the memory and between them: shape
        ``(orders, servos phases, parts (samples - past))``.
    """
    loops, size, width = lifted.loops, lifted.size, lifted.points.shape[-1]
    many, past, phases = len(line), lifted.history.shape[2], command.shape[2]
    speed = np.atleast_1d(line_speed)
    wanted = command.shape[1] - past
    blocks = -(-wanted // size)
    weights = loops.drive[:, :, None, None]
    drive = np.zeros(
        (many, blocks * size, phases)
    )  # f[k] = K c[k] + alpha (c[k] - c[k-1]) / dT, and more with more feed-forward
    np.multiply(command[:, past:], weights[:, 0], out=drive[:, :wanted])
    for number in range(1, weights.shape[1]):
        drive[:, :wanted] += weights[:, number] * command[:, past - number : -number]
    # inputs, first state, the line there, one: in memory as they are multiplied, servo by servo or block by block
    known = np.empty((blocks, many, phases, size + 5) if size > 1 else (many, phases, blocks, size + 5))
    if size == 1:
        known = known.transpose(2, 0, 1, 3)
    known[..., :size] = drive.reshape(many, blocks, size, phases).transpose(1, 0, 3, 2)
    inputs, states = known[..., : size + 3], known[..., size : size + 3]
    states[0] = (lifted.history @ command[:, :past]).transpose(0, 2, 1)
    for block in range(1, blocks):
        np.matmul(inputs[block - 1], lifted.end, out=states[block])
    rise = (slope * speed / lifted.parts * loops.sample_time)[:, None]  # of the line from point to point
    known[..., -2] = line + np.arange(blocks)[:, None, None] * (width * rise)
    known[..., -1] = 1.0

    points = np.empty((len(lifted.orders), len(rise), size + 5, width))
    for order, matrix, found in zip(lifted.orders, lifted.points, points, strict=True):
        np.divide(matrix, speed[:, None, None] ** order, out=found[:, :-2])
        found[:, -2] = 1.0 if order == 0 else 0.0
        found[:, -1] = np.arange(width) * rise if order == 0 else slope if order == 1 else 0.0
    if size == 1:
        return np.asarray(known.transpose(1, 2, 0, 3).reshape(many, -1, size + 5) @ points).reshape(
            len(points), many * phases, -1
        )
    made = np.empty((len(points), many, phases, blocks, width))
    np.matmul(  # block by block: too small for threads to take part
        known, points[:, None], out=made.transpose(0, 3, 1, 2, 4)
    )
    return made.reshape(len(points), many * phases, -1)[:, :, : wanted * lifted.parts]
