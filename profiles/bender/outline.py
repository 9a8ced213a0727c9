"""`Outline`: a die line as straight lines and arcs, each arc given by its bulge as in a DXF polyline."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from camwright.profiles.errors import InputError
from camwright.profiles.polynomial.profile import FloatArray

FLAT = 1e-9
"""Rise of an arc over its chord (m) below which the segment is a straight line."""


@dataclass(frozen=True, eq=False)
class Outline:
    """One die line, in the order in which it is bent.

    Parameters
    ----------
    points
        Shape ``(n + 1, 2)``: where the ``n`` segments begin and end (m). The last point of a closed outline is its
        first.
    bulges
        Shape ``(n,)``: ``tan(included angle / 4)`` of each segment (S4), 0 for a straight line, positive to the left.
    name
        What the outline is called in messages: entity and layer of the drawing.
    flattening
        Largest distance of the straight lines from the drawn curves that they stand for (m); 0 if there are none.
    """

    points: FloatArray
    bulges: FloatArray
    name: str = "outline"
    flattening: float = 0.0

    def __post_init__(self) -> None:
        if self.points.ndim != 2 or self.points.shape[1:] != (2,) or self.bulges.shape != (len(self.points) - 1,):
            raise InputError(
                f"{self.name}: an outline of n segments needs n + 1 points in the plane and n bulges; "
                f"got points {self.points.shape} and bulges {self.bulges.shape}"
            )
        if len(self.bulges) == 0:
            raise InputError(f"{self.name}: an outline needs at least one segment")
        if not (np.isfinite(self.points).all() and np.isfinite(self.bulges).all()):
            raise InputError(f"{self.name}: a coordinate or bulge is NaN or infinite")
        lengths = np.hypot(*np.diff(self.points, axis=0).T)
        if (lengths == 0).any():
            i = int(np.argmax(lengths == 0))
            x, y = 1e3 * self.points[i]
            raise InputError(
                f"{self.name}: segment {i + 1} has no length, at ({x:.3f}, {y:.3f}) mm; remove the doubled vertex"
            )
        self.points.setflags(write=False)
        self.bulges.setflags(write=False)

    @cached_property
    def closed(self) -> bool:
        """Whether the outline ends where it begins."""
        return bool((self.points[0] == self.points[-1]).all())

    @cached_property
    def chords(self) -> FloatArray:
        """Vectors from start to end of each segment (m), shape ``(n, 2)``."""
        return np.diff(self.points, axis=0)

    @cached_property
    def arcs(self) -> NDArray[np.bool_]:
        """Which segments are arcs, shape ``(n,)``."""
        return np.asarray(np.abs(self.bulges) * np.hypot(*self.chords.T) > 2 * FLAT)

    @cached_property
    def included(self) -> FloatArray:
        """Signed included angles ``alpha = 4 arctan mu`` (rad, S4); 0 for a line, positive to the left."""
        return np.where(self.arcs, 4 * np.arctan(self.bulges), 0.0)

    @cached_property
    def radii(self) -> FloatArray:
        """Radii ``R = chord / (2 sin(alpha / 2))`` (m, S4), positive; infinite for a line."""
        length = np.hypot(*self.chords.T)
        # sin(alpha/2) = 2 mu / (1 + mu²) with mu = tan(alpha/4): no loss of digits near a full circle
        size = np.where(self.arcs, np.abs(self.bulges), 1.0)
        return np.asarray(np.where(self.arcs, length * (1 + size**2) / (4 * size), np.inf), dtype=np.float64)

    @property
    def lengths(self) -> FloatArray:
        """Lengths along the segments (m)."""
        straight = np.hypot(*self.chords.T)
        size = np.where(self.arcs, np.abs(self.bulges), 1.0)
        along = straight * (1 + size**2) / size * np.arctan(size)
        return np.asarray(np.where(self.arcs, along, straight), dtype=np.float64)

    @cached_property
    def centres(self) -> FloatArray:
        """Centres of the arcs (m), shape ``(n, 2)``; NaN for lines."""
        chord = self.chords
        bulge = np.where(self.arcs, self.bulges, np.nan)
        left = np.stack([-chord[:, 1], chord[:, 0]], axis=1)
        # from mid-chord to the centre, to the left: R cos(alpha/2) = chord (1 - mu²) / (4 mu)
        away = (1 - bulge**2) / (4 * bulge)
        return np.asarray(self.points[:-1] + 0.5 * chord + left * away[:, None], dtype=np.float64)

    @cached_property
    def headings(self) -> tuple[FloatArray, FloatArray]:
        """Directions of the tangent at the start and at the end of each segment (rad)."""
        along = np.arctan2(self.chords[:, 1], self.chords[:, 0])
        half = 0.5 * self.included
        return along - half, along + half

    @cached_property
    def turns(self) -> FloatArray:
        """Workpiece angles at the ``n - 1`` inner joints, whatever they join: rad in (-pi, pi], left positive."""
        start, end = self.headings
        return wrapped(start[1:] - end[:-1])

    def reverse(self) -> Outline:
        """Return the same line, bent from its other end."""
        return replace(self, points=self.points[::-1].copy(), bulges=-self.bulges[::-1])

    def begin_at(self, x: float, y: float) -> Outline:
        """Begin a closed outline at the vertex nearest to a place (m), an open one at its nearer end."""
        away = np.hypot(self.points[:, 0] - x, self.points[:, 1] - y)
        if not self.closed:
            return self.reverse() if away[-1] < away[0] else self
        first = int(np.argmin(away[:-1]))
        points = np.roll(self.points[:-1], -first, axis=0)
        return replace(self, points=np.vstack([points, points[:1]]), bulges=np.roll(self.bulges, -first))


def wrapped(angle: FloatArray) -> FloatArray:
    """Bring angles into (-pi, pi]."""
    return np.asarray(np.pi - (np.pi - angle) % (2 * np.pi), dtype=np.float64)
