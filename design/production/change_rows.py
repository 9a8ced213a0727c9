"""`ChangeRows`: the axis through a change from one cam into another, as rows over the unknowns of the cycle in between."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from camwright.design.production.transition import RunningCam
from camwright.design.servo_aware.axis_response import Axis
from camwright.design.servo_aware.command_basis import INTERVALS, ROBUST_SHARE, Command, CommandBasis, clamped
from camwright.design.servo_aware.rows import AxisRows
from camwright.profiles.polynomial.profile import CamProfile, FloatArray, join
from camwright.profiles.servo import Servo

CYCLES = 2
"""Cycles over which the axis is looked at, the transition's first."""

_FEWEST, _MOST, _EACH_SAMPLE = 16, 480, 6
"""Places in a shear zone: fewest, most, and for each sample in it; what softens a change swings up where the zone ends."""

_TIMES = 4
"""Times after a sample at which the axis is looked at."""

_MOST_PLACES = 512
"""Places of a cycle at most at which the axis' own motion is looked at, two for each sample."""

_AXIS_MARGIN = 1e-3
"""Share by which the limits of the axis are drawn in, as rows stand at single places."""


@dataclass(frozen=True, eq=False)
class ChangeRows:
    """The command through a change, and what servos make of it.

    Master zero is where the cam before ends; slave positions count like those of the cam after it.

    Parameters
    ----------
    before, after
        The cam that runs, and the one that is to run.
    command
        Whether the whole cycle is free (``"shaped"``) or its return alone.
    """

    before: RunningCam
    after: RunningCam
    command: Command

    @cached_property
    def basis(self) -> CommandBasis:
        """The free part of the cycle: a spline between the states in which the one cam ends and the other goes on."""
        profile = self.after.profile
        end = profile.end if self.command == "shaped" else self.after.zone_start
        count = round(ROBUST_SHARE * INTERVALS[self.command])
        nodes = np.append(end / count * np.arange(count), end)
        place, ratio, slope = self.before.last
        last = [float(profile(end, order, side="left" if end == profile.end else "right")) for order in range(3)]
        start, goal = (
            np.array([place - self.after.zero, ratio, slope / 2]),
            np.array([last[0], last[1], last[2] / 2]),
        )
        return CommandBasis(end, self.after.task.machine.pitch, *clamped(nodes, start, goal), None)

    @property
    def scale(self) -> float:
        """Slave travel that is 1 in the unknowns (slave unit)."""
        task = self.after.task
        return max(abs(task.machine.pitch), abs(task.sync.advance))

    def profile(self, unknowns: FloatArray) -> CamProfile:
        """Return the cycle of an answer."""
        free, after = self.basis.profile(unknowns * self.scale), self.after.profile
        whole = free if free.end >= after.end else join(free, after.restrict(free.end, after.end))
        return whole.over(0.0, after.end)

    def bands(self, servo: Servo, line_speed: float) -> AxisRows:
        """Rows of the shear zones: how far the axis is from sync, between the ends of its tolerance.

        Parameters
        ----------
        line_speed
            Line speed (m/s).
        """
        axis = Axis(self.after.task.at_speed(line_speed), servo)
        start, end = axis.shear_zone
        count = min(max(_FEWEST, math.ceil(_EACH_SAMPLE * (end - start) / axis.sample)), _MOST)
        inside = np.linspace(start, end, count) if end > start else np.array([start])
        # a loop that looks ahead feels the change before it begins
        cycles = np.arange(-1 if servo.delay < 0.0 else 0, CYCLES)
        length, pitch = self.after.profile.end, self.after.task.machine.pitch
        places = np.add.outer(cycles * length, inside).ravel()
        ideal = np.add.outer(cycles * pitch, axis.ideal(inside)[0]).ravel()
        low, high = (np.tile(side, len(cycles)) for side in axis.band(inside, axis.task.cut.sync_tolerance))
        matrix, constant = self._rows(axis, places, 0)
        return AxisRows(matrix, constant - np.repeat(ideal, _TIMES), np.repeat(low, _TIMES), np.repeat(high, _TIMES))

    def own(self, servo: Servo, line_speed: float) -> AxisRows:
        """Rows of the axis' own speed and acceleration, within the limits; as `bands`."""
        task = self.after.task.at_speed(line_speed)
        axis = Axis(task, servo)
        length = self.after.profile.end
        step = max(0.5 * axis.sample, length / _MOST_PLACES)
        places = np.arange(0.0, CYCLES * length, step)
        found = []
        for order, low, high in (
            (1, task.least_ratio, task.greatest_ratio),
            (2, -task.greatest_slope, task.greatest_slope),
        ):
            room = _AXIS_MARGIN * high
            matrix, constant = self._rows(axis, places, order)
            # a slave that must not run backwards may by a tenth of what its check allows: where it stands, rows leave no other way
            least = low - 0.1 * room if low == 0.0 else low + room
            # rows in units of the limit, so that both kinds can stand in one block
            found.append((matrix / high, constant / high, least / high, (high - room) / high))
        return AxisRows(
            np.vstack([each[0] for each in found]),
            np.concatenate([each[1] for each in found]),
            *(np.repeat([each[side] for each in found], len(places) * _TIMES) for side in (2, 3)),
        )

    def _rows(self, axis: Axis, places: FloatArray, order: int) -> tuple[FloatArray, FloatArray]:
        """Axis, or a derivative of it over the master, at places (m), each at `_TIMES` times after a sample."""
        times = np.arange(_TIMES) * (axis.servo.sample_time / _TIMES)
        return axis.rows(self._sums, np.repeat(places, _TIMES), np.tile(times, len(places)), order)

    def _sums(self, places: FloatArray, weights: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Weighted sums of the command through the change; shapes ``(rows, samples)``, as `CommandBasis.rows`."""
        end = self.basis.length
        free = (places >= 0.0) & (places < end)
        matrix, constant = self.basis.rows(np.where(free, places, 0.0), np.where(free, weights, 0.0))
        zero = self.before.zero - self.after.zero
        known = np.zeros(places.shape)
        for profile, shift, part in (
            (self.before.profile, zero, places < 0.0),
            (self.after.profile, 0.0, places >= end),
        ):
            known[part] = profile(places[part], outside="repeat") + shift
        return matrix, constant + (known * weights).sum(axis=1)
