"""The axis in the shear zone as a table: from it come both the rows of a programme and the judgement of its answers.

At a sampling instant the plant's state and the reference that is held from there are sums over the command's past, so rows over its
unknowns. Times after the instant only combine these four. One table serves all rounds of a design.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray

from camwright.design.servo_aware.axis_response import PHASES, Axis, sampled_plants, shared
from camwright.design.servo_aware.command_basis import CommandBasis
from camwright.design.servo_aware.rows import RATIO, AxisRows
from camwright.design.servo_aware.servo_weights import memory, state_weights
from camwright.design.servo_aware.zone_points import ZonePoints
from camwright.profiles.polynomial.profile import CamProfile, FloatArray

# Most samples that are summed for a table as a whole.
MOST_SAMPLES = 50_000


@dataclass(frozen=True, eq=False)
class Tried:
    """A command that is looked at, and its unknowns in the slave's unit; ``None`` where it is not of the basis."""

    profile: CamProfile
    coefficients: FloatArray | None = None


class ZoneTable:
    """Where one servo's axis is looked at in the shear zone: at points ``(place, time after a sampling instant)``.

    At the full line speed the points are those of the validation's phases; a servo that samples more often along the line is looked at
    about as densely, and so is each of many servos, on a lattice on which all splines of the command share one response. The ends of the
    zone are among them.

    Parameters
    ----------
    basis
        The commands.
    number
        Number of the servo.
    points
        Where its axis is looked at, shared with others that sample at the same times.
    """

    def __init__(self, axis: Axis, basis: CommandBasis, number: int, points: ZonePoints) -> None:
        self.axis, self._basis, self.number, self.points = axis, basis, number, points
        self.begun = False
        self._judged: tuple[Tried, FloatArray, float] | None = None

    @property
    def last(self) -> float:
        """Greatest sync error (m) of the command that was looked at last, without sign; infinite before the first."""
        return math.inf if self._judged is None else self._judged[2]

    @property
    def sampled(self) -> tuple[float, float, float, int]:
        """What sorts tables so that those that see the same samples of a command come together, the most samples first."""
        return self.axis.share, self.axis.sample, self.axis.servo.delay, -memory(self.axis.servo.loop)

    def _samples(self, instants: NDArray[np.intp] | slice) -> FloatArray:
        """Master positions that the loop sees at some of the instants, newest first."""
        cut, servo = self.axis.task.cut, self.axis.servo
        past = np.arange(memory(servo.loop) + 1, dtype=np.float64) * servo.sample_time
        return self.points.instants[instants, None] - cut.line_speed * (servo.delay + past)

    @cached_property
    def _weights(self) -> FloatArray:
        """Weights of the samples for state and reference, shape ``(samples, 4)``."""
        return state_weights(self.axis.servo.loop, memory(self.axis.servo.loop))

    @cached_property
    def _combined(self) -> tuple[FloatArray, ...]:
        """What state and reference contribute at each point to the axis, and to its ratio: shapes ``(points, 4)``."""
        known, index = self.points.timed
        turned, pushed = sampled_plants(self.axis.servo.loop, known)
        v = self.axis.task.cut.line_speed
        return tuple(
            np.concatenate([turned[:, 2 - order], pushed[:, 2 - order, None]], axis=1)[index] / v**order
            for order in (0, 1)
        )

    def _motion(self, command: Tried, order: int) -> FloatArray:
        """Axis (0) or its ratio (1) at the points."""
        found: FloatArray = np.einsum("pa,pa->p", self._combined[order], self._states(command)[self.points.of])
        return found

    @property
    def _short(self) -> bool:
        """Whether rows are so soon made of all instants at once that they serve to judge commands as well."""
        return bool(self._basis.step) or not self._long

    @property
    def _long(self) -> bool:
        """Whether there are so many samples that rows are made of those that are looked at again."""
        return memory(self.axis.servo.loop) * len(self.points.instants) > MOST_SAMPLES

    @cached_property
    def _sums(self) -> tuple[FloatArray, FloatArray]:
        """State and reference at the instants as rows over the unknowns, shapes ``(instants, 4, n)`` and ``(instants, 4)``."""
        if not self._basis.step:
            return self._basis.sums(self._samples(slice(None)), self._weights)
        return self._basis.lattice(*self._past)

    @property
    def _past(self) -> tuple[FloatArray, int, float, float, FloatArray]:
        """Instants, how many of them are a lattice, delay and distance of samples (m), and weights, as `CommandBasis.lattice` asks."""
        axis = self.axis
        delay = axis.task.cut.line_speed * axis.servo.delay
        return self.points.instants, self.points.count, delay, axis.sample, self._weights

    def _states(self, command: Tried) -> FloatArray:
        """State and reference at the instants: by rows once there are any, or of the command, whose samples many of them share."""
        points, axis = self.points, self.axis
        seldom = self._judged is None or not self._long
        if self._basis.step and command.coefficients is not None and "_sums" not in vars(self) and seldom:
            return self._basis.looked(*self._past, command.coefficients)
        if (self.begun or self._basis.step) and self._short and command.coefficients is not None:
            matrix, constant = self._sums
            return np.asarray((matrix.reshape(-1, matrix.shape[2]) @ command.coefficients).reshape(-1, 4) + constant)
        past, step = memory(axis.servo.loop), axis.sample / PHASES
        if self._basis.step or points.stride > past:  # on that lattice, or so far apart, none are shared
            return np.asarray(command.profile(self._samples(slice(None)), outside="repeat") @ self._weights)
        ahead = shared(past)
        values = _on_grid(
            command.profile,
            step,
            axis.task.cut.line_speed * axis.servo.delay,
            points.first - ahead * PHASES,
            ahead * PHASES + points.stride * (points.count - 1) + 1,
        )[(ahead - past) * PHASES :]
        windows = np.lib.stride_tricks.sliding_window_view(values, past * PHASES + 1)[:: points.stride, ::-PHASES]
        ends = command.profile(self._samples(slice(points.count, None)), outside="repeat")
        return np.concatenate([windows @ self._weights, ends @ self._weights])

    def errors(self, command: Tried) -> FloatArray:
        """Sync error of the tool at the points (m); of the command that was asked for last it is kept."""
        if self._judged is None or self._judged[0] is not command:
            travel, _, coordinate = self.points.ideal
            tool = self.axis.task.machine.tool
            found = np.asarray(tool(coordinate + (self._motion(command, 0) - travel)) - tool(coordinate))
            self._judged = command, found, float(np.abs(found).max())
        return self._judged[1]

    def peak(self, command: Tried) -> float:
        """Greatest sync error of the tool at the points (m), without sign; it is `last` from then on."""
        self.errors(command)
        return self.last

    def ratios(self, command: Tried) -> FloatArray:
        """Error of the tool's ratio at the points."""
        _, ratio, coordinate = self.points.ideal
        return np.asarray((self._motion(command, 1) - ratio) * self.axis.task.machine.tool_ratio(coordinate))

    def band_rows(self, points: NDArray[np.intp], wider: float = 1.0) -> AxisRows:
        """Make rows that keep the axis in its band at some of the points, the tolerance times a factor; from then on it has `begun`."""
        self.begun = True
        matrix, constant = self._at(points, 0)
        low, high = self.axis.band(self.points.places[points], wider * self.axis.task.cut.sync_tolerance)
        return AxisRows(matrix, constant - self.points.ideal[0][points], low, high, self._origin(points))

    def ratio_rows(self, points: NDArray[np.intp]) -> AxisRows:
        """Make rows that keep the ratio of the axis to that of the sync zone at some of the points."""
        matrix, constant = self._at(points, 1)
        cut = self.axis.task.cut
        lever = np.abs(self.axis.task.machine.tool_ratio(self.points.ideal[2][points]) + np.zeros(len(points)))
        room = RATIO * cut.sync_tolerance / cut.shear_zone / lever
        return AxisRows(matrix, constant - self.points.ideal[1][points], -room, room, self._origin(points))

    def _origin(self, points: NDArray[np.intp]) -> FloatArray:
        """Say what rows of some of the points are of, as `AxisRows` has it."""
        places = self.points.places[points] - self.axis.shear_zone[0]
        return np.column_stack(
            [np.full((len(points), 2), (self.number, self.axis.share)), places, self.points.times[points]]
        )

    def _at(self, points: NDArray[np.intp], order: int) -> tuple[FloatArray, FloatArray]:
        """Axis or its ratio at some of the points, as rows over the unknowns."""
        instants, of = np.unique(self.points.of[points], return_inverse=True)
        if self._basis.step or "_sums" in vars(self):
            matrix, constant = (part[instants] for part in self._sums)
        else:  # the first rows may well tell that there is no answer to judge
            matrix, constant = self._basis.sums(self._samples(instants), self._weights)
        weights = self._combined[order][points]
        return np.einsum("pa,pan->pn", weights, matrix[of]), np.einsum("pa,pa->p", weights, constant[of])


@lru_cache(maxsize=64)  # servos at one line speed ask for the same
def _on_grid(command: CamProfile, step: float, delay: float, first: int, count: int) -> FloatArray:
    """Give the command on steps of a grid, so much behind."""
    return command(step * np.arange(first, first + count) - delay, outside="repeat")
