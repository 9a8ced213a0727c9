"""The discrete servo of S1 run on a profile, at every sampling phase, sampling instants and between them.

The servo samples on its own clock, so where its samples fall in a cycle (the sampling phase) drifts from cycle to
cycle, or stays where the start of the machine happened to put it. Every phase is therefore simulated: `PHASES`
clocks, shifted against each other by equal parts of the sample time, each followed continuously through as many
earlier cycles as its memory reaches back.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import TypeVar

import numpy as np

from profiles.cycle import Cut
from profiles.errors import InputError
from profiles.polynomial import CamProfile, FloatArray
from profiles.servo import Servo, closed_loop, sample_plant, spectral_radius
from validation.motion import require_period

Number = TypeVar("Number", float, FloatArray)
"""Floats and arrays, taken alike."""

PHASES = 16
"""Sampling phases simulated: shifts of the servo's clock by a 16th of the sample time."""

SUBSTEPS = 8
"""Points of the axis per sample, the sampling instant included. Phases are a multiple of it, so all share one command
grid."""

_FORGOTTEN = 1e-12
"""The start-up transient has decayed to this part of itself when the simulated cycle begins."""

_TRANSIENT_GROWTH = 1e3
"""Added to the decay because the loop's poles are not orthogonal: with it, the part of the command that is left out
moves the axis by less than 1e-12 of its size, over all of S1's ranges."""

_BLOCK = 64
"""Samples that one step of the block recursion advances."""

_MOST_VALUES = 2**17
"""Command values of one simulation above which fewer phases are taken (never fewer than `SUBSTEPS`)."""

_MOST_SAMPLES = 2**17
"""Most samples of one phase, memory and cycle together; more would need gigabytes."""


@dataclass(frozen=True, eq=False)
class ServoRun:
    """Periodic response of the servo: one cycle at each sampling phase.

    All arrays have the shape ``(phases, points)``; points are equally spaced along the line, each phase begins up to
    one sample before the return zone and ends beyond the sync zone.

    Parameters
    ----------
    master
        Master position (m), counted on from the start of the return zone: the sync zone ends one cut length later.
    command
        Commanded slave position (m), continuous in time.
    axis
        Slave position (m).
    axis_ratio
        Slave velocity divided by the line speed.
    """

    master: FloatArray
    command: FloatArray
    axis: FloatArray
    axis_ratio: FloatArray

    @property
    def phases(self) -> int:
        """Number of sampling phases."""
        return len(self.master)

    def window(self, start: float, end: float) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Master position, axis and axis ratio between two master positions, the two ends included, for every phase.

        Rows are filled up by repeating the ends, so that all phases have the same number of points. The ends are
        interpolated by the cubic through position and ratio of the neighbouring points, which has no sample between
        them.

        Parameters
        ----------
        start, end
            Part of the cycle (m), counted like `master`, ``start <= end``.

        Returns
        -------
        (master, axis, axis_ratio)
            Shapes ``(phases, n)``.
        """
        step = float(self.master[0, 1] - self.master[0, 0])
        first = np.floor((start - self.master[:, 0]) / step).astype(int)
        last = np.ceil((end - self.master[:, 0]) / step).astype(int)
        rows = np.arange(self.phases)[:, None]
        columns = np.minimum(first[:, None] + np.arange(int((last - first).max()) + 1), self.master.shape[1] - 1)
        x, y, k = self.master[rows, columns], self.axis[rows, columns], self.axis_ratio[rows, columns]
        for bound, beyond, point in ((start, x <= start, first), (end, x >= end, last - 1)):
            left = np.clip(point, 0, self.master.shape[1] - 2)[:, None]
            part = (bound - self.master[rows, left]) / step
            value, ratio = hermite(
                part,
                step,
                (self.axis[rows, left], self.axis[rows, left + 1]),
                (self.axis_ratio[rows, left], self.axis_ratio[rows, left + 1]),
            )
            x, y, k = np.where(beyond, bound, x), np.where(beyond, value, y), np.where(beyond, ratio, k)
        return x, y, k


def hermite(part: Number, step: float, value: Sequence[Number], slope: Sequence[Number]) -> tuple[Number, Number]:
    """Value and slope of the cubic through two points with slopes, at a part ``0 … 1`` of the step between."""
    rise = value[1] - value[0]
    square = 3 * rise - step * (2 * slope[0] + slope[1])
    cube = step * (slope[0] + slope[1]) - 2 * rise
    at = value[0] + part * (step * slope[0] + part * (square + part * cube))
    return at, (step * slope[0] + part * (2 * square + part * 3 * cube)) / step


@lru_cache(maxsize=32)
def memory(servo: Servo) -> int:
    """Count the samples after which the servo has forgotten its past to 1e-12.

    Raises
    ------
    InputError
        The position loop is unstable: a pole lies on or outside the unit circle.
    """
    radius = spectral_radius(servo)
    if not radius < 1.0:
        raise InputError(
            f"the servo is unstable: its largest pole in the z-plane has the magnitude {radius:.6g}, the limit is 1; "
            f"lower the position gain ({servo.position_gain:g} 1/s), shorten the sample time ({servo.sample_time:g} s) "
            f"or raise the bandwidth ({servo.bandwidth:g} rad/s)"
        )
    return max(2, math.ceil(math.log(_FORGOTTEN / _TRANSIENT_GROWTH) / math.log(max(radius, 1e-3))))


def simulate(profile: CamProfile, cut: Cut, servo: Servo) -> ServoRun:
    """Periodic response of the servo to a profile repeated for ever.

    The command is split into its mean straight line, which the servo follows with the constant error ``(1 - alpha) v
    / K`` of eq. 2, and what is periodic in the cut length. Only the latter is simulated, so the accuracy does not
    depend on how far the slave has run. Exact at the sampling instants and between them: no step size but the servo's
    own.

    Parameters
    ----------
    profile
        One cycle over the master period ``[0, x_c]``, slave in m.
    cut
        Cut length, line speed and zones.
    servo
        The servo.

    Raises
    ------
    InputError
        The profile does not run over ``[0, x_c]``, the servo is unstable, or cycle and memory take more than 131072
        samples.
    """
    require_period(profile, cut)
    past = memory(servo)
    samples = math.ceil(cut.period / servo.sample_time) + 2
    if past + samples > _MOST_SAMPLES:
        raise InputError(
            f"the servo simulation takes {past + samples} samples: {samples} for a cycle of {cut.period:.6g} s and "
            f"{past} that the servo remembers; the limit is {_MOST_SAMPLES}; raise the line speed "
            f"({cut.line_speed:g} m/s), the sample time ({servo.sample_time:g} s) or the position gain "
            f"({servo.position_gain:g} 1/s)"
        )
    phases = PHASES
    while phases > SUBSTEPS and phases * (past + samples) > _MOST_VALUES:
        phases //= 2

    # one grid for all: phase j samples at (j / phases - 1 + k) dT from the start of the return zone, k = 0, 1, …
    index = np.arange(-past * phases, (samples + 1) * phases)
    master = cut.return_start + (index / phases - 1.0) * (servo.sample_time * cut.line_speed)
    ends = profile([profile.start, profile.end])
    mean_ratio = float(ends[1] - ends[0]) / profile.length
    inside = master - profile.length * np.floor((master - profile.start) / profile.length)
    inside = np.minimum(np.maximum(inside, profile.start), profile.end)
    deviation = profile(inside) - ends[0] - mean_ratio * (inside - profile.start)

    sampled = deviation[: (past + samples) * phases].reshape(past + samples, phases)
    drive = servo.position_gain * sampled  # what the controller adds up beside the fed back position
    drive[1:] += servo.velocity_feedforward / servo.sample_time * (sampled[1:] - sampled[:-1])
    lifted = _lift(servo, past)
    state = _states(lifted, drive, past)

    # between the samples the velocity reference is held, so the plant alone decides
    held = drive[past:] - servo.position_gain * state[:, 2]
    full = np.concatenate([state, held[:, None]], axis=1)
    position = (lifted.position @ full).reshape(-1, phases)
    velocity = (lifted.velocity @ full).reshape(-1, phases)

    def by_point(values: FloatArray) -> FloatArray:
        """Spread the common grid to ``(points, phases)``; phases and points overlap, so nothing is copied."""
        values, item = values[past * phases :], values.itemsize
        strides = (phases // SUBSTEPS * item, item)
        return np.lib.stride_tricks.as_strided(values, (samples * SUBSTEPS, phases), strides, writeable=False)

    line = ends[0] + mean_ratio * (master - profile.start)
    lag = steady_following_error(mean_ratio * cut.line_speed, servo)
    return ServoRun(
        master=by_point(master).T,
        command=by_point(line + deviation).T,
        axis=(by_point(line - lag) + position).T,
        axis_ratio=(mean_ratio + velocity / cut.line_speed).T,
    )


def steady_following_error(speed: float, servo: Servo) -> float:
    """Following error at constant speed (m), positive where the axis lags: ``(1 - alpha) v / K`` (S1, eq. 2).

    Without velocity feed-forward (``alpha = 0``) this is ``v / K`` (S1, eq. 1).

    Parameters
    ----------
    speed
        Slave speed ``v`` (m/s).
    servo
        The servo, of position gain ``K`` and velocity feed-forward ``alpha``.
    """
    return (1.0 - servo.velocity_feedforward) * speed / servo.position_gain


@dataclass(frozen=True, eq=False)
class _Lifted:
    """The closed loop over many samples at once, and the plant between two samples; a property of the servo alone.

    With the state ``z`` of `profiles.servo.SampledPlant` and the closed loop's input ``f`` (m/s)::

        z[0]                = history @ f[-past:0]
        z[0 … size]         = free @ z[0] + forced @ f[0:size]
        position, velocity  = position @ (z, u), velocity @ (z, u)    at the substeps after a sample

    with ``history`` ``(3, past)``, ``free`` ``(3 (size + 1), 3)``, ``forced`` ``(3 (size + 1), size)``, the other two
    ``(SUBSTEPS, 4)``.
    """

    history: FloatArray
    free: FloatArray
    forced: FloatArray
    position: FloatArray
    velocity: FloatArray


@lru_cache(maxsize=32)
def _lift(servo: Servo, past: int) -> _Lifted:
    """Powers of the closed loop: ``z[j] = A^j z[0] + sum_i A^(j-1-i) b f[i]``."""
    a = closed_loop(servo)[0]
    b = sample_plant(servo, servo.sample_time).input
    powers = _powers_times(a, np.column_stack([np.eye(3), b]), _BLOCK + 1)
    response = np.concatenate([powers[:_BLOCK, :, 3], np.zeros((1, 3))])  # last row: before the input
    lag = np.arange(_BLOCK + 1)[:, None] - 1 - np.arange(_BLOCK)
    plants = [sample_plant(servo, servo.sample_time * s / SUBSTEPS) for s in range(SUBSTEPS)]
    position, velocity = (np.array([[*plant.transition[i], plant.input[i]] for plant in plants]) for i in (2, 1))
    return _Lifted(
        history=_powers_times(a, b[:, None], past)[::-1, :, 0].T,
        free=powers[:, :, :3].reshape(-1, 3),
        forced=response[np.where(lag < 0, _BLOCK, lag)].transpose(0, 2, 1).reshape(-1, _BLOCK),
        position=position,
        velocity=velocity,
    )


def _powers_times(transition: FloatArray, start: FloatArray, length: int) -> FloatArray:
    """Powers of a matrix times columns: ``A^j S`` for ``j`` = 0 … ``length - 1``, shape ``(length, 3, columns)``."""
    found = start[None]
    power = transition
    while len(found) < length:  # twice as many in each round
        found = np.concatenate([found, power @ found])
        power = power @ power
    return found[:length]


def _states(lifted: _Lifted, drive: FloatArray, past: int) -> FloatArray:
    """State of the closed loop at the samples after the first ``past``, from rest at the first.

    All blocks and phases take one matrix product together; only the first states of the blocks depend on each other.

    Parameters
    ----------
    drive
        Input of the closed loop ``f[k] = K c[k] + alpha (c[k] - c[k-1]) / dT`` (m/s), shape ``(samples, phases)``.
    past
        Samples before the first state wanted.

    Returns
    -------
    ndarray
        Shape ``(samples - past, 3, phases)``.
    """
    phases = drive.shape[1]
    wanted = len(drive) - past
    blocks = -(-wanted // _BLOCK)
    padded = np.zeros((blocks * _BLOCK, phases))
    padded[:wanted] = drive[past:]
    forced = lifted.forced @ padded.reshape(blocks, _BLOCK, phases)
    found = np.empty((blocks, _BLOCK, 3, phases))
    state = lifted.history @ drive[:past]
    for block in range(blocks):
        states = (lifted.free @ state + forced[block]).reshape(_BLOCK + 1, 3, phases)
        found[block] = states[:_BLOCK]
        state = states[_BLOCK]
    return found.reshape(blocks * _BLOCK, 3, phases)[:wanted]
