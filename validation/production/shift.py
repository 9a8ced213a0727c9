"""Hours of production in one run: cams one after the other, a line that changes its speed, a noisy encoder, a slipping wheel, the servo.

The master is the material as the encoder measures it. The servo samples on its own clock; what it is told is the slave of the noisy master
of its dead time ago. The run is cut into blocks; each begins a memory earlier, so that what lies before has decayed to 1e-12, and all are
run side by side by `camwright.validation.servo.lifting`, which gives the axis at the samples and at seven places between.

Where the wheel slips, more or less material passes than it measures: by a share that is the same from one cut to the next. A piece is then
longer by that share, and the material moves by it past a tool that is in sync with the wheel.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from camwright.profiles.line_run import LineRun
from camwright.profiles.polynomial.profile import FloatArray
from camwright.profiles.servo import Servo
from camwright.profiles.task import Task
from camwright.validation.production.motion_table import MotionTable
from camwright.validation.servo.axis_run import hermite
from camwright.validation.servo.lifting import SUBSTEPS, follow, lift
from camwright.validation.servo.simulation import memory

_SAMPLES = 2**17
"""Samples of one chunk of blocks, which are run side by side."""

_BLOCK = 1024
"""Samples of a block, its memory not counted."""


@dataclass(frozen=True, eq=False)
class Disturbance:
    """What goes wrong along the line.

    Parameters
    ----------
    noise
        What the encoder reads too much at each sample (m), any length: it begins anew at its end. Nothing without.
    slip
        Share by which more material passes than is measured, for each piece, shape ``(pieces,)``. Nothing without.
    """

    noise: FloatArray = field(default_factory=lambda: np.zeros(0))
    slip: FloatArray = field(default_factory=lambda: np.zeros(0))


UNDISTURBED = Disturbance()
"""A perfect encoder on a wheel that does not slip."""


@dataclass(frozen=True, eq=False)
class Shift:
    """What is run: the command, and where each piece is in sync.

    Parameters
    ----------
    table
        The command over the material; each cam begins at the end of a sync zone.
    tasks
        Machines with their sync zones placed, and cuts with their zones; cut lengths are not looked at.
    of
        Which of them holds at each piece, shape ``(pieces,)``.
    """

    table: MotionTable
    tasks: Sequence[Task]
    of: NDArray[np.intp]

    def places(self) -> FloatArray:
        """Start, middle and end of the shear zone of each piece on the material (m), shape ``(pieces, 3)``."""
        zone, at, width = np.array(
            [(task.cut.sync_zone, task.cut.shear_zone_at, task.cut.shear_zone) for task in self.tasks]
        )[self.of].T
        joints = self.table.joints[1:]
        first = joints - zone + at
        last = np.minimum(first + width, joints)
        return np.stack([first, 0.5 * (first + last), last], axis=1)

    def off(self, x: FloatArray, piece: NDArray[np.intp], axis: FloatArray) -> FloatArray:
        """Tool less the place where it would be in sync (m), at material positions in sync zones of pieces; all of one shape."""
        error = np.empty(x.shape)
        kind = self.of[piece]
        for number, task in enumerate(self.tasks):
            here = kind == number
            if not here.any():
                continue
            machine, sync, at = task.machine, task.sync, piece[here]
            along = np.clip(x[here] - (self.table.joints[at + 1] - task.cut.sync_zone), sync.start, sync.end)
            actual = axis[here] - machine.pitch * (at + 1)
            error[here] = machine.tool(actual) - machine.tool(task.slave_at_sync_start + sync(along))
        return error


@dataclass(frozen=True, eq=False)
class ShiftRun:
    """What one servo makes of a shift, piece by piece; all of shape ``(pieces,)``.

    Parameters
    ----------
    lengths
        Length of each piece (m), the first as if the cut before it had been as far off as its own.
    sync_errors
        Greatest magnitude of the sync error in the shear zone (m).
    """

    lengths: FloatArray
    sync_errors: FloatArray


def run_shift(shift: Shift, line: LineRun, servo: Servo, disturbance: Disturbance = UNDISTURBED) -> ShiftRun:
    """Run a servo over a shift.

    Parameters
    ----------
    shift
        What is run.
    line
        Line speed over time; it passes all the material of the shift.
    disturbance
        Noise and slip.

    Raises
    ------
    InputError
        The servo is unstable.
    """
    places, joints = shift.places(), shift.table.joints
    slip = disturbance.slip if len(disturbance.slip) else np.zeros(len(places))
    moments = line.when(places)
    at_cut, peaks, done = np.zeros(len(places)), np.zeros(len(places)), 0
    step = servo.sample_time / SUBSTEPS
    begin, held = 0.0, np.zeros((2, 0))
    for chunk in _axis(shift.table, line, servo, disturbance.noise, float(moments[-1, 2])):
        held = np.concatenate([held, chunk], axis=1)
        over = int(np.searchsorted(moments[:, 2], begin + (held.shape[1] - 2) * step))
        if over > done:
            here = np.arange(done, over)
            seen = _Seen(shift, line, places, slip, begin, step, held)
            at_cut[here], peaks[here] = seen.errors(moments, here)
            done = over
        if done < len(places):  # what no piece needs any more is dropped
            gone = max(0, min(int((moments[done, 0] - begin) / step) - 1, held.shape[1] - 2))
            begin, held = begin + gone * step, held[:, gone:]
    lengths = np.diff(joints) * (1.0 + slip) - np.diff(at_cut, prepend=at_cut[0])
    return ShiftRun(lengths, peaks)


@dataclass(frozen=True, eq=False)
class _Seen:
    """A stretch of the axis.

    Parameters
    ----------
    shift, line, places, slip
        What is run, and where.
    begin, step
        Time of the first point and from point to point (s).
    points
        Velocity and position of the axis, shape ``(2, n)``.
    """

    shift: Shift
    line: LineRun
    places: FloatArray
    slip: FloatArray
    begin: float
    step: float
    points: FloatArray

    def errors(self, moments: FloatArray, here: NDArray[np.intp]) -> tuple[FloatArray, FloatArray]:
        """Give the error at the cut of some pieces, and the greatest in their shear zones (m).

        Parameters
        ----------
        moments
            Times of start, middle and end of all shear zones (s), shape ``(pieces, 3)``.
        here
            Numbers of the pieces.
        """
        edges = self._off(self.places[here], np.repeat(here[:, None], 3, axis=1), self._between(moments[here]))
        peak = np.abs(edges).max(axis=1)
        begin, stop = (np.ceil((moments[here, k] - self.begin) / self.step).astype(np.intp) for k in (0, 2))
        many = stop - begin
        inner = many > 0
        if inner.any():
            ends = np.cumsum(many[inner])
            point = np.arange(ends[-1]) + np.repeat(begin[inner] - ends + many[inner], many[inner])
            passed = self.line.passed(self.begin + point * self.step)
            error = self._off(passed, np.repeat(here[inner], many[inner]), self.points[1, point])
            peak[inner] = np.maximum(peak[inner], np.maximum.reduceat(np.abs(error), ends - many[inner]))
        return edges[:, 1], peak

    def _off(self, x: FloatArray, piece: NDArray[np.intp], axis: FloatArray) -> FloatArray:
        """Sync error, the material's slip since the cut taken off."""
        return np.asarray(self.shift.off(x, piece, axis) - self.slip[piece] * (x - self.places[piece, 1]))

    def _between(self, time: FloatArray) -> FloatArray:
        """Axis at times between points: the cubic through positions and velocities of the neighbours; shape of ``time``."""
        (rate, axis), at = self.points, (time - self.begin) / self.step
        k = np.clip(at.astype(np.intp), 0, len(axis) - 2)
        return np.asarray(
            hermite(at - k, np.full(k.shape, self.step), (axis[k], axis[k + 1]), (rate[k], rate[k + 1]))[0]
        )


def _axis(table: MotionTable, line: LineRun, servo: Servo, noise: FloatArray, until: float) -> Iterator[FloatArray]:
    """Run the servo from time zero, chunk after chunk: velocity and position of the axis, `SUBSTEPS` points a sample."""
    past, sample = memory(servo.loop), servo.sample_time
    lifted = lift(servo.loop, past, (1, 0))
    wanted = math.ceil(until / sample) + 2
    begin = 0
    while begin < wanted:
        blocks = min(_SAMPLES // _BLOCK, -(-(wanted - begin) // _BLOCK))
        starts = begin + _BLOCK * np.arange(blocks)
        sampled = starts + np.arange(-past, _BLOCK)[:, None]
        seen = line.passed(sampled * sample - servo.delay)
        if len(noise):
            seen += noise[sampled % len(noise)]
        command = table(seen)
        base = command[past].copy()
        command -= base
        yield follow(lifted, command[None], base[None], 0.0, 1.0).reshape(2, -1)
        begin += blocks * _BLOCK
