"""`Piece`: a stretch of die line from one entity, or from several that are joined."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from camwright.profiles.errors import InputError
from camwright.profiles.notice import Notice
from camwright.profiles.polynomial.profile import FloatArray


@dataclass(frozen=True, eq=False)
class Piece:
    """A stretch of die line.

    Parameters
    ----------
    points, bulges
        As in `camwright.profiles.bender.outline.Outline`, in one unit of length.
    name
        Kind, handle and layer of the entity.
    flattening
        Largest distance of the piece from the curve that it stands for, in that unit; 0 for lines and arcs.
    """

    points: FloatArray
    bulges: FloatArray
    name: str
    flattening: float = 0.0

    @property
    def closed(self) -> bool:
        """Whether the piece ends where it begins."""
        return bool((self.points[0] == self.points[-1]).all())

    @property
    def length(self) -> float:
        """Length along the piece."""
        return float(along(np.hypot(*np.diff(self.points, axis=0).T), self.bulges).sum())

    def reverse(self) -> Piece:
        """Return the same stretch from its other end."""
        return replace(self, points=self.points[::-1], bulges=-self.bulges[::-1])

    def scaled(self, unit: float) -> Piece:
        """Return the piece with its lengths in another unit, ``unit`` of it to one of the present."""
        return replace(self, points=unit * self.points, flattening=unit * self.flattening)


def along(chord: FloatArray, bulge: FloatArray) -> FloatArray:
    """Lengths of arcs with given chords and bulges; below a bulge of 1e-6 they differ by less than a part in 1e11."""
    size = np.maximum(np.abs(bulge), 1e-6)
    return np.where(np.abs(bulge) > size * 0.5, chord * (1 + size**2) * np.arctan(size) / size, chord)


def chained(pieces: Sequence[Piece], name: str, *, closed: bool) -> Piece:
    """Make one piece of several (m) that follow each other; each begins where the one before it ends.

    Raises
    ------
    InputError
        A segment has no length once its ends are moved together.
    """
    points = np.vstack([pieces[0].points[:1], *(piece.points[1:] for piece in pieces)])
    if closed:
        points[-1] = points[0]
    empty = np.flatnonzero((np.diff(points, axis=0) == 0).all(axis=1))
    if len(empty):
        x, y = 1e3 * points[empty[0]]
        raise InputError(
            f"{name}: an entity at ({x:.3f}, {y:.3f}) mm is not longer than the gap that is closed; remove it"
        )
    title = (
        name if len(pieces) == 1 else Notice("{name} and {count} joined to it", name=name, count=str(len(pieces) - 1))
    )
    return Piece(points, np.concatenate([piece.bulges for piece in pieces]), title, max(p.flattening for p in pieces))
