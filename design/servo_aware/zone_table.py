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

from camwright.design.servo_aware.axis_response import PHASES, SUBSTEPS, Axis, sampled_plants, shared
from camwright.design.servo_aware.command_basis import CommandBasis
from camwright.design.servo_aware.rows import RATIO, AxisRows
from camwright.design.servo_aware.servo_weights import memory, state_weights
from camwright.profiles.polynomial.profile import CamProfile, FloatArray

# Sampling instants in the shear zone at most, of a servo that samples often: what the axis does there has no finer waves. At line speeds
# below the full one fewer will do, and fewer sampling phases at the ends of the zone, as there are several of them.
MOST_INSTANTS, SLOWER_INSTANTS, SLOWER_PHASES = 128, 96, 8
# Most samples that are summed for a table as a whole.
MOST_SAMPLES = 50_000
# Most places in the shear zone that have rows from the start.
MOST_PLACES = 24


@dataclass(frozen=True, eq=False)
class _Points:
    """Points of a table: their places (m), their times since the sampling instant before (s), the instants (m), and which one each has.

    Of the instants ``count`` lie on a grid of sampling phases from its step ``first``, ``stride`` steps apart; those of the ends follow.
    """

    places: FloatArray
    times: FloatArray
    instants: FloatArray
    of: NDArray[np.intp]
    first: int
    count: int
    stride: int


def _points(axis: Axis, knots: float) -> _Points:
    """Lay points over the shear zone of an axis: on a grid of sampling instants (parts of a step of knots), and at its ends."""
    start, end = axis.shear_zone
    v, after = axis.task.cut.line_speed, np.arange(SUBSTEPS) * (axis.servo.sample_time / SUBSTEPS)
    step = axis.sample / PHASES
    most = MOST_INSTANTS if axis.share == 1.0 else SLOWER_INSTANTS
    stride = max(1, math.ceil((end - start) / (step * most)))
    if knots:
        step, stride = knots / math.ceil(knots / (step * stride)), 1
    first = math.ceil((start - axis.sample) / step)
    regular = np.arange(first, math.floor(end / step) + 1, stride) * step
    places = regular + v * after[:, None]
    inside = (places >= start) & (places <= end)
    phases = PHASES if axis.share == 1.0 else SLOWER_PHASES
    edges = np.repeat(list(dict.fromkeys((start, end))), phases)
    edge_times = (edges / v) % (axis.servo.sample_time / phases)
    edge_times += np.tile(np.arange(phases), len(edges) // phases) * (axis.servo.sample_time / phases)
    sub, index = np.nonzero(inside)
    return _Points(
        np.concatenate([places[inside], edges]),
        np.concatenate([after[sub], edge_times]),
        np.concatenate([regular, edges - v * edge_times]),
        np.concatenate([index, len(regular) + np.arange(len(edges))]),
        first,
        len(regular),
        stride,
    )


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
    """

    def __init__(self, axis: Axis, basis: CommandBasis, number: int) -> None:
        self.axis, self._basis, self.number = axis, basis, number
        self.begun = False
        self.last = math.inf
        self._judged: tuple[Tried, FloatArray] | None = None

    @cached_property
    def _points(self) -> _Points:
        """Where the axis is looked at."""
        return _points(self.axis, self._basis.step)

    @cached_property
    def _ideal(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """What the axis would do at the points in sync, as `Axis.ideal` has it."""
        return self.axis.ideal(self._points.places)

    @property
    def places(self) -> FloatArray:
        """Master positions of the points (m)."""
        return self._points.places

    @property
    def times(self) -> FloatArray:
        """Times of the points since the sampling instant before (s)."""
        return self._points.times

    def _samples(self, instants: NDArray[np.intp] | slice) -> FloatArray:
        """Master positions that the loop sees at some of the instants, newest first."""
        cut, servo = self.axis.task.cut, self.axis.servo
        past = np.arange(memory(servo.loop) + 1) * servo.sample_time
        return self._points.instants[instants, None] - cut.line_speed * (servo.delay + past)

    @cached_property
    def _weights(self) -> FloatArray:
        """Weights of the samples for state and reference, shape ``(samples, 4)``."""
        return state_weights(self.axis.servo.loop, memory(self.axis.servo.loop))

    @cached_property
    def _combined(self) -> tuple[FloatArray, ...]:
        """What state and reference contribute at each point to the axis, and to its ratio: shapes ``(points, 4)``."""
        known, index = np.unique(self.times, return_inverse=True)
        turned, pushed = sampled_plants(self.axis.servo.loop, tuple(known.tolist()))
        v = self.axis.task.cut.line_speed
        return tuple(
            np.concatenate([turned[:, 2 - order], pushed[:, 2 - order, None]], axis=1)[index] / v**order
            for order in (0, 1)
        )

    def _motion(self, command: Tried, order: int) -> FloatArray:
        """Axis (0) or its ratio (1) at the points."""
        found: FloatArray = np.einsum("pa,pa->p", self._combined[order], self._states(command)[self._points.of])
        return found

    @property
    def _short(self) -> bool:
        """Whether rows are so soon made of all instants at once that they serve to judge commands as well."""
        return bool(self._basis.step) or memory(self.axis.servo.loop) * len(self._points.instants) <= MOST_SAMPLES

    @cached_property
    def _sums(self) -> tuple[FloatArray, FloatArray]:
        """State and reference at the instants as rows over the unknowns, shapes ``(instants, 4, n)`` and ``(instants, 4)``."""
        if not self._basis.step:
            return self._basis.sums(self._samples(slice(None)), self._weights)
        return self._lattice(self._points.instants, self._points.count)

    def _lattice(self, instants: FloatArray, regular: int) -> tuple[FloatArray, FloatArray]:
        """State and reference at instants the first of which are a lattice, as `CommandBasis.lattice`."""
        delay = self.axis.task.cut.line_speed * self.axis.servo.delay
        return self._basis.lattice(instants, regular, delay, self.axis.sample, self._weights)

    def _states(self, command: Tried) -> FloatArray:
        """State and reference at the instants: by rows once there are any, or of the command, whose samples many of them share."""
        points, axis = self._points, self.axis
        if (self.begun or self._basis.step) and self._short and command.coefficients is not None:
            matrix, constant = self._sums
            return np.asarray((matrix.reshape(-1, matrix.shape[2]) @ command.coefficients).reshape(-1, 4) + constant)
        if self._basis.step:  # on that lattice none are shared
            return np.asarray(command.profile(self._samples(slice(None)), outside="repeat") @ self._weights)
        past, step = memory(axis.servo.loop), axis.sample / PHASES
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
            travel, _, coordinate = self._ideal
            tool = self.axis.task.machine.tool
            found = np.asarray(tool(coordinate + (self._motion(command, 0) - travel)) - tool(coordinate))
            self._judged, self.last = (command, found), float(np.abs(found).max())
        return self._judged[1]

    def peak(self, command: Tried) -> float:
        """Greatest sync error of the tool at the points (m), without sign; it is `last` from then on."""
        self.errors(command)
        return self.last

    def ratios(self, command: Tried) -> FloatArray:
        """Error of the tool's ratio at the points."""
        _, ratio, coordinate = self._ideal
        return np.asarray((self._motion(command, 1) - ratio) * self.axis.task.machine.tool_ratio(coordinate))

    def band_rows(self, points: NDArray[np.intp], wider: float = 1.0) -> AxisRows:
        """Make rows that keep the axis in its band at some of the points, the tolerance times a factor; from then on it has `begun`."""
        self.begun = True
        matrix, constant = self._at(points, 0)
        low, high = self.axis.band(self.places[points], wider * self.axis.task.cut.sync_tolerance)
        return AxisRows(matrix, constant - self._ideal[0][points], low, high, self._origin(points))

    def ratio_rows(self, points: NDArray[np.intp]) -> AxisRows:
        """Make rows that keep the ratio of the axis to that of the sync zone at some of the points."""
        matrix, constant = self._at(points, 1)
        cut = self.axis.task.cut
        lever = np.abs(self.axis.task.machine.tool_ratio(self._ideal[2][points]) + np.zeros(len(points)))
        room = RATIO * cut.sync_tolerance / cut.shear_zone / lever
        return AxisRows(matrix, constant - self._ideal[1][points], -room, room, self._origin(points))

    def _origin(self, points: NDArray[np.intp]) -> FloatArray:
        """Say what rows of some of the points are of, as `AxisRows` has it."""
        places = self.places[points] - self.axis.shear_zone[0]
        return np.column_stack([np.full((len(points), 2), (self.number, self.axis.share)), places, self.times[points]])

    def _at(self, points: NDArray[np.intp], order: int) -> tuple[FloatArray, FloatArray]:
        """Axis or its ratio at some of the points, as rows over the unknowns."""
        instants, of = np.unique(self._points.of[points], return_inverse=True)
        if "_sums" in vars(self):
            matrix, constant = (part[instants] for part in self._sums)
        elif self._basis.step:
            matrix, constant = self._lattice(self._points.instants[instants], 0)
        else:  # the first rows may well tell that there is no answer to judge
            matrix, constant = self._basis.sums(self._samples(instants), self._weights)
        weights = self._combined[order][points]
        return np.einsum("pa,pan->pn", weights, matrix[of]), np.einsum("pa,pa->p", weights, constant[of])

    def spread(self, least: int, instants: int) -> NDArray[np.intp]:
        """Choose points for the first rows: the ends of the zone and places between, crowded at the ends, at a few times after a sample.

        Parameters
        ----------
        least
            Fewest places; there is one for each sample in the zone, up to `MOST_PLACES`.
        instants
            Times for each place.
        """
        start, end = self.axis.shear_zone
        count = min(max(least, math.ceil((end - start) / self.axis.sample)), MOST_PLACES) if end > start else 1
        wanted = start + (end - start) * (1.0 - np.cos(np.pi * np.arange(count) / max(1, count - 1))) / 2
        times = self.axis.servo.sample_time * np.arange(instants) / instants
        return self.nearest(np.tile(wanted, instants), np.repeat(times, count))

    def nearest(self, places: FloatArray, times: FloatArray) -> NDArray[np.intp]:
        """Find the points that are nearest to places (m) and times since a sampling instant (s)."""
        near = np.abs(self.places[:, None] - places) / self.axis.sample
        near = near + np.abs(self.times[:, None] - times) / self.axis.servo.sample_time
        return np.unique(near.argmin(axis=0))


@lru_cache(maxsize=64)  # servos at one line speed ask for the same
def _on_grid(command: CamProfile, step: float, delay: float, first: int, count: int) -> FloatArray:
    """Give the command on steps of a grid, so much behind."""
    return command(step * np.arange(first, first + count) - delay, outside="repeat")
