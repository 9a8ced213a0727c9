"""Rows of a servo-aware programme: where the axis must be in the shear zone, and how fast, over the unknowns of a command."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from camwright.design.servo_aware.axis_response import Axis
from camwright.design.servo_aware.command_basis import CommandBasis
from camwright.profiles.polynomial.profile import FloatArray

RATIO = 2.0
"""Error of the axis' ratio allowed in the shear zone, times its length over the sync tolerance: along the zone the tool could at most go
from one edge of its band to the other."""

# Most places in the shear zone that have rows from the start, and most rows added at a time, of one servo and of each of several.
MOST_PLACES, MOST_ROWS, MOST_EACH = 24, 12, 4
_EVERYWHERE = 1e300


@dataclass(frozen=True, eq=False)
class AxisRows:
    """Rows ``low <= matrix @ z + constant <= high``, in slave units."""

    matrix: FloatArray
    constant: FloatArray
    low: FloatArray
    high: FloatArray

    @property
    def size(self) -> FloatArray:
        """What rows are divided by, so that their bounds are about one."""
        return np.maximum(np.abs(self.low), np.abs(self.high))


def band_rows(axis: Axis, basis: CommandBasis, places: FloatArray, times: FloatArray, wider: float = 1.0) -> AxisRows:
    """Make rows that keep an axis in its band, the tolerance times a factor.

    Parameters
    ----------
    axis, basis
        The axis, and the commands.
    places, times
        Master positions (m) and times since the sampling instant before (s), shape ``(n,)``.
    wider
        The factor.
    """
    matrix, constant = axis.rows(basis, places, times)
    low, high = axis.band(places, wider * axis.task.cut.sync_tolerance)
    return AxisRows(matrix, constant - axis.ideal(places)[0], low, high)


def ratio_rows(axis: Axis, basis: CommandBasis, places: FloatArray, times: FloatArray) -> AxisRows:
    """Make rows that keep the ratio of an axis to that of the sync zone; arguments as in `band_rows`."""
    matrix, constant = axis.rows(basis, places, times, 1)
    _, ratio, coordinate = axis.ideal(places)
    lever = np.abs(axis.task.machine.tool_ratio(coordinate) + np.zeros(len(places)))
    room = RATIO * axis.task.cut.sync_tolerance / axis.task.cut.shear_zone / lever
    return AxisRows(matrix, constant - ratio, -room, room)


def first_places(axis: Axis, least: int, instants: int) -> tuple[FloatArray, FloatArray]:
    """Choose where the first rows stand: at the ends of the shear zone and between, at a few times after a sample.

    Parameters
    ----------
    axis
        The axis.
    least
        Fewest places; there is one for each sample in the zone, up to `MOST_PLACES`.
    instants
        Times for each place.

    Returns
    -------
    (places, times)
        As `band_rows` takes them.
    """
    start, end = axis.shear_zone
    count = min(max(least, math.ceil((end - start) / axis.sample)), MOST_PLACES) if end > start else 1
    places = start + (end - start) * (1.0 - np.cos(np.pi * np.arange(count) / max(1, count - 1))) / 2
    times = axis.servo.sample_time * np.arange(instants) / instants
    return np.tile(places, instants), np.repeat(times, count)


def worst_places(excess: FloatArray, most: int = MOST_ROWS) -> NDArray[np.intp]:
    """Find the local maxima above zero, the worst first."""
    padded = np.concatenate([[-_EVERYWHERE], excess, [-_EVERYWHERE]])
    found = np.nonzero((excess > 0.0) & (excess >= padded[:-2]) & (excess > padded[2:]))[0]
    return np.asarray(found[np.argsort(-excess[found], kind="stable")][:most])
