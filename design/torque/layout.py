"""How the unknowns and parameters of a torque programme lie, and the points at which it looks at the torque."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from camwright.design.torque.numbers import TorqueForm
from camwright.design.torque.task import Pattern
from camwright.design.torque.zone import zone_looks
from camwright.profiles.polynomial.profile import FloatArray

LOBATTO = (
    0.5 + 0.5 * np.array([-1.0, -math.sqrt(0.2), math.sqrt(0.2), 1.0]),
    np.array([1.0, 5.0, 5.0, 1.0]) / 12.0,
)
"""Gauss-Lobatto points on the unit interval, and their weights: exact to degree 5, and at the nodes, where a peak may stand."""

INNER = len(LOBATTO[0]) - 1
"""Points of an interval but its last."""
NUMBERS = 4
"""Parameters besides those of mesh and points: units of torque and power, what a peak pays, and what the mean square."""

Indices = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class Layout:
    """How the unknowns and parameters of a programme lie.

    Unknowns are the accelerations, velocities and positions at the nodes, the lengths of the phases, the bound of a peak, the power drawn
    at each point, the ends of a sync zone that is to be placed, and the power drawn at each of its points. Parameters are the lengths of
    the intervals as shares of their phase; of each point its weight in a mean over its phase, its place in its interval and the direction
    of the motion; of each point of the zone its place and weight; the `NUMBERS`; and those in which tasks of one form differ.

    Parameters
    ----------
    pattern, counts
        The phases, and the intervals of each that has motion.
    looks
        Points at which a sync zone that is to be placed is looked at, besides its ends; 0 where there is none.
    form
        What the pieces are made of.
    """

    pattern: Pattern
    counts: tuple[int, ...]
    looks: int
    form: TorqueForm

    @cached_property
    def phase(self) -> Indices:
        """Phase of each interval."""
        return np.repeat([k for k, phase in enumerate(self.pattern) if phase != "rest"], self.counts)

    @cached_property
    def owner(self) -> Indices:
        """Interval of each point: of its points the last is the next one's first, but at the end of a phase."""
        last = np.cumsum(self.counts) - 1
        return np.insert(np.repeat(np.arange(self.intervals), INNER), INNER * (last + 1), last)

    @cached_property
    def place(self) -> Indices:
        """Which of its interval's points each point is."""
        last = np.cumsum(self.counts) - 1
        return np.insert(np.tile(np.arange(INNER), self.intervals), INNER * (last + 1), INNER)

    @property
    def intervals(self) -> int:
        """Intervals of all phases."""
        return sum(self.counts)

    @property
    def free(self) -> bool:
        """Whether the lengths of phases are unknown."""
        return len(self.pattern) > 1

    @property
    def placed(self) -> bool:
        """Whether the programme places a sync zone."""
        return self.looks > 0

    @property
    def points(self) -> int:
        """Points at which the torque of the return is looked at."""
        return len(self.owner)

    @property
    def zone_points(self) -> int:
        """The same of the sync zone."""
        return len(zone_looks(self.looks)[0]) if self.placed else 0

    @cached_property
    def signs(self) -> FloatArray:
        """Direction of the motion at each point."""
        return np.array([{"back": -1.0}.get(self.pattern[k], 1.0) for k in self.phase[self.owner]])

    @cached_property
    def sizes(self) -> list[int]:
        """Numbers of unknowns by kind."""
        nodes = [self.intervals + 1] * 3
        drawn = (self.points, self.zone_points) if self.form.aim == "energy" else (0, 0)
        return [*nodes, len(self.pattern), 1, drawn[0], 2 if self.placed else 0, drawn[1]]

    @cached_property
    def slices(self) -> list[slice]:
        """Where the unknowns of each kind lie."""
        return _slices(self.sizes)

    @cached_property
    def given(self) -> list[slice]:
        """Where the parameters of each kind lie."""
        return _slices([self.intervals, *[self.points] * 3, *[self.zone_points] * 2, NUMBERS, self.form.count])

    def parameters(self, mesh: FloatArray, numbers: tuple[float, ...]) -> FloatArray:
        """Parameters on a mesh; the numbers are the `NUMBERS` and those of the task."""
        zone = zone_looks(self.looks) if self.placed else ()
        return np.concatenate([mesh, self.weights(mesh), LOBATTO[0][self.place], self.signs, *zone, numbers])

    def weights(self, mesh: FloatArray) -> FloatArray:
        """Weights of the points in a mean over their phase."""
        found = LOBATTO[1][self.place] * mesh[self.owner]
        follows = np.append(False, self.phase[1:] == self.phase[:-1])
        found[self.place == 0] += LOBATTO[1][-1] * np.where(follows, np.roll(mesh, 1), 0.0)
        return np.asarray(found)


def _slices(sizes: list[int]) -> list[slice]:
    edges = np.cumsum([0, *sizes])
    return [slice(int(one), int(other)) for one, other in itertools.pairwise(edges)]
