"""`ZonePoints`: where servos that sample at the same times are looked at in the shear zone, and what the axis would do there in sync."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from camwright.design.servo_aware.axis_response import PHASES, SUBSTEPS, Axis
from camwright.profiles.polynomial.profile import FloatArray

# Sampling instants in the shear zone at most, of a servo that samples often: what the axis does there has no finer waves. At line speeds
# below the full one fewer will do, and fewer sampling phases at the ends of the zone, as there are several of them.
MOST_INSTANTS, SLOWER_INSTANTS, SLOWER_PHASES = 128, 96, 8
# Most places in the shear zone that have rows from the start.
MOST_PLACES = 24


@dataclass(frozen=True, eq=False)
class ZonePoints:
    """Points of the shear zone: on a grid of sampling instants, and at its ends.

    Parameters
    ----------
    axis
        An axis; those of other servos that sample at the same times have the same points.
    places
        Master positions (m).
    times
        Times since the sampling instant before (s).
    instants
        Master positions of these instants (m).
    of
        Which instant each point has.
    first, count, stride
        Of the instants ``count`` lie on a grid of phases from its step ``first``, ``stride`` steps apart; those of the ends follow.
    """

    axis: Axis
    places: FloatArray
    times: FloatArray
    instants: FloatArray
    of: NDArray[np.intp]
    first: int
    count: int
    stride: int

    @cached_property
    def ideal(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """What the axis would do at the points in sync, as `Axis.ideal` has it."""
        return self.axis.ideal(self.places)

    @cached_property
    def timed(self) -> tuple[tuple[float, ...], NDArray[np.intp]]:
        """Different times, and which of them each point has."""
        known, index = np.unique(self.times, return_inverse=True)
        return tuple(known.tolist()), index

    def spread(self, least: int, instants: int) -> NDArray[np.intp]:
        """Choose points for the first rows: the ends of the zone and places between, crowded at the ends, at a few times after a sample.

        Parameters
        ----------
        least
            Fewest places; there is one for each sample in the zone, up to `MOST_PLACES`.
        instants
            Times for each place.
        """
        if (least, instants) not in self._chosen:
            start, end = self.axis.shear_zone
            count = min(max(least, math.ceil((end - start) / self.axis.sample)), MOST_PLACES) if end > start else 1
            wanted = start + (end - start) * (1.0 - np.cos(np.pi * np.arange(count) / max(1, count - 1))) / 2
            times = self.axis.servo.sample_time * np.arange(instants) / instants
            self._chosen[least, instants] = self.nearest(np.tile(wanted, instants), np.repeat(times, count))
        return self._chosen[least, instants]

    def nearest(self, places: FloatArray, times: FloatArray) -> NDArray[np.intp]:
        """Find the points that are nearest to places (m) and times since a sampling instant (s)."""
        near = np.abs(self.places[:, None] - places) / self.axis.sample
        near = near + np.abs(self.times[:, None] - times) / self.axis.servo.sample_time
        return np.unique(near.argmin(axis=0))

    @cached_property
    def _chosen(self) -> dict[tuple[int, int], NDArray[np.intp]]:
        """Points that were chosen for first rows: other servos ask for the same."""
        return {}


def zone_points(axis: Axis, knots: float) -> ZonePoints:
    """Lay points over the shear zone of an axis.

    Parameters
    ----------
    knots
        Distance of knots that the grid is to part evenly (m); 0 for the grid of the validation's sampling phases.
    """
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
    edge_times = np.tile(np.arange(phases), len(edges) // phases) * (axis.servo.sample_time / phases)
    if not knots:  # else the grid is none of the validation's, and these times are those of every cut length
        edge_times = edge_times + (edges / v) % (axis.servo.sample_time / phases)
    sub, index = np.nonzero(inside)
    return ZonePoints(
        axis,
        np.concatenate([places[inside], edges]),
        np.concatenate([after[sub], edge_times]),
        np.concatenate([regular, edges - v * edge_times]),
        np.concatenate([index, len(regular) + np.arange(len(edges))]),
        first,
        len(regular),
        stride,
    )
