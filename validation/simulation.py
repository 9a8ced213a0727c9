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
from profiles.servo import Servo, sample_plant, spectral_radius
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

_BLOCK = 32
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
    sample = servo.sample_time * cut.line_speed
    index = np.arange(-(past + 1) * phases, samples * phases, dtype=np.float64)
    master = cut.return_start + index * (sample / phases)
    start = float(profile.coefficients[0, 0])
    mean_ratio = (_end(profile) - start) / profile.length
    deviation = _deviation(profile, master, mean_ratio)
    lifted = _lift(servo, past)
    loop = _loop(lifted, servo, deviation[: (past + samples) * phases].reshape(-1, phases))

    def by_phase(values: FloatArray) -> FloatArray:
        """Spread the common grid to ``(phases, points)``; phases overlap, so nothing is copied."""
        item = values.itemsize
        strides = (item, phases // SUBSTEPS * item)
        spread: FloatArray = np.ndarray((phases, samples * SUBSTEPS), np.float64, buffer=values, strides=strides)
        spread.setflags(write=False)
        return spread

    master, deviation = master[past * phases :], deviation[past * phases :]
    line = start + mean_ratio * (master - profile.start)
    axis = (loop @ lifted.position).reshape(phases, -1)
    axis += by_phase(line - steady_following_error(mean_ratio * cut.line_speed, servo))
    ratio = (loop @ (lifted.velocity / cut.line_speed)).reshape(phases, -1)
    ratio += mean_ratio
    return ServoRun(master=by_phase(master), command=by_phase(line + deviation), axis=axis, axis_ratio=ratio)


def _end(profile: CamProfile) -> float:
    """Position at the end of the profile (m)."""
    width = float(profile.breaks[-1] - profile.breaks[-2])
    value = 0.0
    for coefficient in reversed(profile.coefficients[-1].tolist()):
        value = value * width + coefficient
    return value


def _deviation(profile: CamProfile, master: FloatArray, mean_ratio: float) -> FloatArray:
    """Repeated profile minus the straight line through its start.

    As the master only rises, the points of a piece follow one another: the breaks are looked up among the points, not
    the points among the breaks, and every coefficient is repeated for the points of its piece.

    Parameters
    ----------
    master
        Ascending master positions (m), any number of cycles.
    mean_ratio
        Slope of the line, ``advance / length`` of the profile.
    """
    first, last = (math.floor((float(x) - profile.start) / profile.length) for x in (master[0], master[-1]))
    cycles = np.arange(first, last + 1) * profile.length
    table = np.empty((profile.degree + 2, len(cycles), profile.pieces))  # coefficients and, last, start of each piece
    table[:-1] = profile.coefficients.T[:, None]
    table[0] -= profile.coefficients[0, 0] + mean_ratio * (profile.breaks[:-1] - profile.start)
    table[-1] = cycles[:, None] + profile.breaks[:-1]
    bounds = np.searchsorted(master, table[-1].ravel())
    bounds[0] = 0
    counts = np.append(bounds[1:], len(master)) - bounds
    repeated = table.reshape(profile.degree + 2, -1).repeat(counts, axis=1)
    local = master - repeated[-1]
    found: FloatArray = repeated[-2]
    for coefficient in repeated[-3::-1]:  # Horner
        found *= local
        found += coefficient
    local *= mean_ratio
    found -= local
    return found


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
    """The closed loop over many samples at once, and between two samples; a property of the servo alone.

    With the command ``c``, the state ``z`` of `profiles.servo.SampledPlant`, the closed loop's input ``f`` (m/s), all
    as rows, and ``w = (z, f)``::

        z[0]                = c[-past:0] @ history
        w[0 … size - 1]     = z[0] @ free + f[0:size] @ forced
        z[size]             = z[0] @ free_end + f[0:size] @ forced_end
        position, velocity  = w @ position, w @ velocity    at the substeps after a sample

    with ``history`` ``(past, 3)``, ``free`` ``(3, 4 size)``, ``forced`` ``(size, 4 size)``, ``free_end`` ``(3, 3)``,
    ``forced_end`` ``(size, 3)``, the other two ``(4, SUBSTEPS)``; ``size`` is `_BLOCK`.
    """

    history: FloatArray
    free: FloatArray
    forced: FloatArray
    free_end: FloatArray
    forced_end: FloatArray
    position: FloatArray
    velocity: FloatArray


@lru_cache(maxsize=32)
def _lift(servo: Servo, past: int) -> _Lifted:
    """Powers of the closed loop: ``z[j] = A^j z[0] + sum_i A^(j-1-i) b f[i]``."""
    plant = sample_plant(servo, servo.sample_time)
    gain, lead = servo.position_gain, servo.velocity_feedforward / servo.sample_time
    a = plant.transition.copy()
    a[:, 2] -= gain * plant.input
    response = _powers_times(a, plant.input[:, None], max(past, _BLOCK) + 1)[..., 0]
    earliest_first = np.append(response[past - 1 :: -1], np.zeros((1, 3)), axis=0)
    powers = _powers_times(a, np.eye(3), _BLOCK + 1)
    free = np.zeros((3, _BLOCK, 4))
    free[..., :3] = powers[:-1].transpose(2, 0, 1)
    forced = np.zeros((_BLOCK, _BLOCK, 4))
    before, after = np.triu_indices(_BLOCK, 1)
    forced[before, after, :3] = response[after - before - 1]
    forced[np.arange(_BLOCK), np.arange(_BLOCK), 3] = 1.0
    # between the samples the reference u = f - K p is held, so the plant alone decides: on (z, u), then on (z, f)
    part = sample_plant(servo, servo.sample_time / SUBSTEPS)
    held = np.eye(4)
    held[:3] = np.column_stack([part.transition, part.input])
    between = _powers_times(held, np.eye(4), SUBSTEPS)
    between[:, :, 2] -= gain * between[:, :, 3]
    return _Lifted(
        history=(gain + lead) * earliest_first[:-1] - lead * earliest_first[1:],
        free=free.reshape(3, -1),
        forced=forced.reshape(_BLOCK, -1),
        free_end=powers[-1].T.copy(),
        forced_end=response[_BLOCK - 1 :: -1].copy(),
        position=between[:, 2].T.copy(),
        velocity=between[:, 1].T.copy(),
    )


def _powers_times(transition: FloatArray, start: FloatArray, length: int) -> FloatArray:
    """Powers of a matrix times columns: ``A^j S`` for ``j`` = 0 … ``length - 1``, shape ``(length, rows, columns)``."""
    found, power, done = start, transition, 1
    while done < length:  # twice as many in each round, side by side
        found = np.concatenate([found, power @ found], axis=1)
        power = power @ power
        done *= 2
    return found.reshape(len(start), done, -1)[:, :length].transpose(1, 0, 2).copy()


def _loop(lifted: _Lifted, servo: Servo, command: FloatArray) -> FloatArray:
    """State and input of the closed loop at the samples after its memory, from rest before it.

    All blocks and phases take one matrix product together; only the first states of the blocks depend on each other.

    Parameters
    ----------
    command
        The command at the samples ``c[k]`` (m), memory first, shape ``(samples, phases)``.

    Returns
    -------
    ndarray
        ``(z, f)`` with ``f[k] = K c[k] + alpha (c[k] - c[k-1]) / dT`` (m/s), shape ``(phases, samples - past, 4)``.
    """
    past = len(lifted.history)
    phases, wanted = command.shape[1], len(command) - past
    blocks = -(-wanted // _BLOCK)
    lead = servo.velocity_feedforward / servo.sample_time
    inputs = np.zeros((phases, blocks * _BLOCK))
    inputs[:, :wanted] = ((servo.position_gain + lead) * command[past:] - lead * command[past - 1 : -1]).T
    inputs = inputs.reshape(-1, _BLOCK)
    ends = (inputs @ lifted.forced_end).reshape(phases, blocks, 3)
    first = np.empty((phases, blocks, 3))
    first[:, 0] = command[:past].T @ lifted.history
    for block in range(1, blocks):
        first[:, block] = first[:, block - 1] @ lifted.free_end + ends[:, block - 1]
    found = inputs @ lifted.forced
    found += first.reshape(-1, 3) @ lifted.free
    return found.reshape(phases, -1, 4)[:, :wanted]
