"""`AxisRun`: the axis of one or more servos in a part of the cycle, at every sampling phase."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from camwright.profiles.polynomial.profile import FloatArray

Number = TypeVar("Number", float, FloatArray)
"""Floats and arrays, taken alike."""


@dataclass(frozen=True, eq=False)
class AxisRun:
    """Axis of one or more servos in a part of the cycle, at one sampling phase a row.

    All arrays have the shape ``(phases, points)``; the points of a row are equally spaced along the line, but on a slow line.

    Parameters
    ----------
    master
        Master position (m), counted on from the start of the return zone: the sync zone ends one cut length later.
    axis
        Slave position (m).
    axis_ratio
        Slave velocity divided by the line speed.
    even
        Whether the points are equally spaced; those of `camwright.validation.servo.slow_axis.SlowAxis` are not.
    """

    master: FloatArray
    axis: FloatArray
    axis_ratio: FloatArray
    even: bool = field(default=True, kw_only=True)

    @property
    def phases(self) -> int:
        """Number of sampling phases."""
        return len(self.master)

    def window(self, start: float | FloatArray, end: float | FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Master position, axis and axis ratio between two master positions, the two ends included, for every phase.

        Rows are filled up by repeating the ends, so that all phases have the same number of points. The ends are
        interpolated by the cubic through position and ratio of the neighbouring points, which has no sample between
        them.

        Parameters
        ----------
        start, end
            Part of the cycle (m), counted like `master`, ``start <= end``; or one of each phase.

        Returns
        -------
        (master, axis, axis_ratio)
            Shapes ``(phases, n)``.
        """
        x, y, k = self._within(start, end, (self.master, self.axis, self.axis_ratio))
        return x, y, k

    def places(self, start: float | FloatArray, end: float | FloatArray) -> tuple[FloatArray, FloatArray]:
        """Give master position and axis alone, as `window` does; both belong to who asks."""
        x, y = self._within(start, end, (self.master, self.axis))
        return x, y

    def _within(
        self, start: float | FloatArray, end: float | FloatArray, wanted: tuple[FloatArray, ...]
    ) -> list[FloatArray]:
        """Copy what is wanted of master position, axis and axis ratio between two master positions, as `window` says."""
        most = self.master.shape[1] - 1
        bounds = np.empty((2, self.phases))
        bounds[0], bounds[1] = start, end
        first, last = self._around(*bounds)
        left, right = max(int(first.min()), 0), min(int(last.max()), most)
        found = [values[:, left : right + 1].copy() for values in wanted]
        # the phases begin and end within a few columns of each other
        head, tail = slice(int(first.max()) - left + 2), slice(max(int(last.min()) - left - 1, 0), None)
        point = np.minimum(np.maximum([first, np.maximum(last - 1, first)], 0), most - 1)
        rows = np.arange(self.phases)
        (x, beyond_x), axis, ratio = (
            (values[rows, point], values[rows, point + 1]) for values in (self.master, self.axis, self.axis_ratio)
        )
        step = beyond_x - x
        at_bounds = (bounds, *hermite((bounds - x) / step, step, axis, ratio))
        edges = ((head, found[0][:, head] <= bounds[0, :, None]), (tail, found[0][:, tail] >= bounds[1, :, None]))
        for number, (columns, beyond) in enumerate(edges):
            for values, at_bound in zip(found, at_bounds, strict=False):
                np.copyto(values[:, columns], at_bound[number, :, None], where=beyond)
        return found

    def _around(self, start: FloatArray, end: FloatArray) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Last point that is not after a start, and first that is not before an end, of every row."""
        if self.even:
            step = self.master[:, 1] - self.master[:, 0]
            first, last = np.floor((start - self.master[:, 0]) / step), np.ceil((end - self.master[:, 0]) / step)
            return first.astype(np.intp), last.astype(np.intp)
        rows = list(zip(self.master, start, end, strict=True))
        first = np.array([row.searchsorted(bound, side="right") for row, bound, _ in rows]) - 1
        return first, np.array([row.searchsorted(bound) for row, _, bound in rows])


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
