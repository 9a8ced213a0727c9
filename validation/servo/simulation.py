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

from camwright.profiles.cut import Cut
from camwright.profiles.errors import InputError
from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.profiles.servo import Servo, spectral_radius
from camwright.validation.motion import require_period
from camwright.validation.servo.lifting import SUBSTEPS, follow, lift

Number = TypeVar("Number", float, FloatArray)
"""Floats and arrays, taken alike."""

PHASES = 16
"""Sampling phases simulated: shifts of the servo's clock by a 16th of the sample time. A multiple of `SUBSTEPS`, so that all
phases share one command grid."""

_FORGOTTEN = 1e-12
"""The start-up transient has decayed to this part of itself when the simulated cycle begins."""

_TRANSIENT_GROWTH = 1e3
"""Added to the decay because the loop's poles are not orthogonal: with it, the part of the command that is left out
moves the axis by less than 1e-12 of its size, over all of S1's ranges."""

_MOST_VALUES = 2**17
"""Command values of one simulation above which fewer phases are taken (never fewer than `SUBSTEPS`)."""

_MOST_SAMPLES = 2**17
"""Most samples of one phase, memory and cycle together; more would need gigabytes."""


@dataclass(frozen=True, eq=False)
class AxisRun:
    """Axis of one or more servos in a part of the cycle, at one sampling phase a row.

    All arrays have the shape ``(phases, points)``; the points of a row are equally spaced along the line.

    Parameters
    ----------
    master
        Master position (m), counted on from the start of the return zone: the sync zone ends one cut length later.
    axis
        Slave position (m).
    axis_ratio
        Slave velocity divided by the line speed.
    """

    master: FloatArray
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
        step = self.master[:, 1:2] - self.master[:, :1]
        most = self.master.shape[1] - 1
        first = np.floor((start - self.master[:, 0]) / step[:, 0]).astype(int)
        last = np.ceil((end - self.master[:, 0]) / step[:, 0]).astype(int)
        left, right = max(int(first.min()), 0), min(int(last.max()), most)
        x, y, k = (values[:, left : right + 1].copy() for values in (self.master, self.axis, self.axis_ratio))
        # the phases begin and end within a few columns of each other
        head, tail = slice(int(first.max()) - left + 2), slice(max(int(last.min()) - left - 1, 0), None)
        first, last = np.clip([first, np.maximum(last - 1, first)], 0, most - 1)
        edges = ((start, first, head, x[:, head] <= start), (end, last, tail, x[:, tail] >= end))
        rows = np.arange(self.phases)
        for bound, point, columns, beyond in edges:
            value, ratio = hermite(
                (bound - self.master[rows, point]) / step[:, 0],
                step[:, 0],
                (self.axis[rows, point], self.axis[rows, point + 1]),
                (self.axis_ratio[rows, point], self.axis_ratio[rows, point + 1]),
            )
            np.copyto(x[:, columns], bound, where=beyond)
            np.copyto(y[:, columns], value[:, None], where=beyond)
            np.copyto(k[:, columns], ratio[:, None], where=beyond)
        return x, y, k


@dataclass(frozen=True, eq=False)
class ServoRun(AxisRun):
    """Periodic response of one servo: a cycle at each sampling phase.

    Each phase begins up to one sample before the return zone and ends beyond the sync zone.

    Parameters
    ----------
    command
        Commanded slave position (m), continuous in time, shape ``(phases, points)``.
    """

    command: FloatArray


def hermite(part: Number, step: Number, value: Sequence[Number], slope: Sequence[Number]) -> tuple[Number, Number]:
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
    return memory_at(radius)


def memory_at(radius: float) -> int:
    """Count the samples after which a servo whose largest pole has this magnitude, below 1, has forgotten its past."""
    return max(2, math.ceil(math.log(_FORGOTTEN / _TRANSIENT_GROWTH) / math.log(max(radius, 1e-3))))


def require_samples(cut: Cut, servo: Servo, past: int, samples: int) -> None:
    """Refuse a simulation of more samples than fit.

    Raises
    ------
    InputError
        The samples that are remembered and those of the simulated part are more than 131072 together.
    """
    if past + samples > _MOST_SAMPLES:
        raise InputError(
            f"the servo simulation takes {past + samples} samples: {samples} for a cycle of {cut.period:.6g} s and "
            f"{past} that the servo remembers; the limit is {_MOST_SAMPLES}; raise the line speed "
            f"({cut.line_speed:g} m/s), the sample time ({servo.sample_time:g} s) or the position gain "
            f"({servo.position_gain:g} 1/s)"
        )


def simulate(profile: CamProfile, cut: Cut, servo: Servo) -> ServoRun:
    """Periodic response of the servo to a profile repeated for ever.

    The command is split into its mean straight line, which the servo follows with the constant error of
    `steady_following_error`, and what is periodic in the cut length. Only the latter is simulated, so the accuracy does not
    depend on how far the slave has run. Exact at the sampling instants and between them: no step size but the servo's
    own. The loop sees the command of the time ``t - delay`` (`camwright.profiles.servo.Servo.delay`): of the master position that
    lies ``v delay`` behind.

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
    loop = servo.loop
    past = memory(loop)
    samples = math.ceil(cut.period / servo.sample_time) + 2
    require_samples(cut, servo, past, samples)
    phases = PHASES
    while phases > SUBSTEPS and phases * (past + samples) > _MOST_VALUES:
        phases //= 2

    # one grid for all: phase j samples at (j / phases - 1 + k) dT from the start of the return zone, k = 0, 1, …
    sample = servo.sample_time * cut.line_speed
    master = np.arange(-(past + 1) * phases, samples * phases, dtype=np.float64)
    master *= sample / phases
    master += cut.return_start
    start, slope = float(profile.coefficients[0, 0]), mean_ratio(profile)
    periodic = deviation(profile, master)
    shift = math.fmod(cut.line_speed * servo.delay, cut.length)  # the deviation is periodic
    seen = deviation(profile, master - shift) if shift else periodic

    def by_phase(values: FloatArray) -> FloatArray:
        """Spread the common grid to ``(phases, points)``; phases overlap, so nothing is copied."""
        item = values.itemsize
        strides = (item, phases // SUBSTEPS * item)
        spread: FloatArray = np.ndarray((phases, samples * SUBSTEPS), np.float64, buffer=values, strides=strides)
        spread.setflags(write=False)
        return spread

    master, periodic = master[past * phases :], periodic[past * phases :]
    line = start + slope * (master - profile.start)
    ratio, axis = follow(
        lift(loop, past),
        loop,
        seen[: (past + samples) * phases].reshape(-1, phases),
        line[:phases] - steady_following_error(slope * cut.line_speed, servo),
        slope,
        cut.line_speed,
    )
    return ServoRun(master=by_phase(master), axis=axis, axis_ratio=ratio, command=by_phase(line + periodic))


def deviation(profile: CamProfile, master: FloatArray) -> FloatArray:
    """Repeated profile minus the straight line through its start, which is periodic in the cut length.

    As the master only rises, the points of a piece follow one another: the breaks are looked up among the points, not
    the points among the breaks, and every coefficient is repeated for the points of its piece.

    Parameters
    ----------
    master
        Master positions (m), any number of cycles, ascending along the last axis; shape ``(points,)`` or ``(rows, points)``.
    """
    table = _straightened(profile)
    rows = master.reshape(-1, master.shape[-1])
    least, greatest = (rows[0, 0], rows[0, -1]) if len(rows) == 1 else (rows[:, 0].min(), rows[:, -1].max())
    first, last = (math.floor((float(x) - profile.start) / profile.length) for x in (least, greatest))
    table = np.tile(table, last + 1 - first)
    table[-1] += np.repeat(np.arange(first, last + 1) * profile.length, profile.pieces)
    bounds = np.zeros((len(rows), table.shape[1] + 1), dtype=np.intp)
    for row, bound in zip(rows, bounds, strict=True):
        bound[1:-1] = row.searchsorted(table[-1, 1:])
    bounds[:, -1] = rows.shape[1]
    counts = (bounds[:, 1:] - bounds[:, :-1]).ravel()
    if len(rows) > 1:
        table = np.tile(table, len(rows))
    local = master.ravel() - table[-1].repeat(counts)
    found: FloatArray = table[-2].repeat(counts)
    for coefficient in table[-3::-1]:  # Horner, one coefficient spread at a time: less memory is faster
        found *= local
        found += coefficient.repeat(counts)
    return found.reshape(master.shape)


@lru_cache(maxsize=8)
def _straightened(profile: CamProfile) -> FloatArray:
    """Coefficients of the profile minus the straight line, ascending powers, and last the start of each piece; a row each."""
    ratio = mean_ratio(profile)
    table = np.zeros((max(profile.degree, 1) + 2, profile.pieces))
    table[: profile.degree + 1] = profile.coefficients.T
    table[0] -= profile.coefficients[0, 0] + ratio * (profile.breaks[:-1] - profile.start)
    table[1] -= ratio
    table[-1] = profile.breaks[:-1]
    return table


@lru_cache(maxsize=8)
def mean_ratio(profile: CamProfile) -> float:
    """Slave advance over the master's: slope of the straight line that a repeated profile follows."""
    width, end = float(profile.breaks[-1] - profile.breaks[-2]), 0.0
    for coefficient in reversed(profile.coefficients[-1].tolist()):
        end = end * width + coefficient
    return (end - float(profile.coefficients[0, 0])) / profile.length


def steady_following_error(speed: float, servo: Servo) -> float:
    """Following error at constant speed (m), positive where the axis lags: ``(1 - alpha) v / K + v delay``.

    Without delay these are eq. 2 of S1 and, without velocity feed-forward (``alpha = 0``), eq. 1: ``v / K``.

    Parameters
    ----------
    speed
        Slave speed ``v`` (m/s).
    servo
        The servo, of position gain ``K``, velocity feed-forward ``alpha``, dead time and lead.
    """
    return (1.0 - servo.velocity_feedforward) * speed / servo.position_gain + speed * servo.delay
