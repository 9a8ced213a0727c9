"""Chords that lie on an arc, as drawing programs write arcs that they cannot keep: found, and made that arc again."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from camwright.bender.piece import Piece
from camwright.profiles.bender.outline import FLAT, wrapped
from camwright.profiles.notice import Notice, Number
from camwright.profiles.polynomial.profile import FloatArray

_FEWEST = 3
"""Chords that make an arc: any two lie on one."""

_LEAST_TURN, _MOST_TURN = 1e-4, math.radians(35.0)
"""Turns (rad) from chord to chord that may belong to an arc: below, a straight line; above, a corner."""


@dataclass(frozen=True)
class FoundArc:
    """Chords that were made an arc.

    Parameters
    ----------
    name
        The line that they are a part of.
    chords
        How many.
    radius, included
        The arc (m, rad).
    distance
        Largest distance between the arc and the chords (m).
    bent
        Whether the arc is bent; else the chords as they are drawn, since they lie farther from it than is allowed.
    """

    name: str
    chords: int
    radius: float
    included: float
    distance: float
    bent: bool

    @property
    def told(self) -> Notice:
        """What to say of them."""
        return Notice(
            "{count} chords of {name} lie on an arc of radius {radius} mm and {included}° within {distance} mm and are bent as that "
            "arc; --arcs keep bends them as drawn"
            if self.bent
            else "{count} chords of {name} have their ends on an arc of radius {radius} mm and {included}°, but lie up to {distance} "
            "mm from it, farther than the arc rule allows, and are bent as drawn; draw the arc, or allow more under [arcs] of the "
            "bender job",
            count=str(self.chords),
            name=self.name,
            radius=Number(1e3 * self.radius, ".3f"),
            included=Number(math.degrees(self.included), ".2f"),
            distance=Number(1e3 * self.distance, ".4f"),
        )


@dataclass(frozen=True, eq=False)
class _Arc:
    """An arc through the first and the last of some vertices, and how far from it they and their chords lie (m)."""

    centre: FloatArray
    radius: float
    included: float
    off: float
    sagitta: float


def with_arcs(piece: Piece, allowed: Callable[[float], float], gap: float) -> tuple[Piece, tuple[FoundArc, ...]]:
    """Replace runs of chords by the arcs on which they lie.

    Parameters
    ----------
    piece
        A joined line (m).
    allowed
        Largest distance (m) between an arc of a given radius (m) and the line that is bent for it.
    gap
        How far from the arc the ends of its chords may lie (m).

    Returns
    -------
    (piece, arcs)
        The line, and what was found in it; first what was replaced, then what lies too far from its arc to be. Lines
        that stand for curves are left as they are.
    """
    if piece.flattening > 0 or not _runs(piece):
        return piece, ()
    points, bulges, found, off = [piece.points[:1]], [], [], 0.0
    done = 0
    for start, stop, arc in _arcs(piece, allowed, gap):
        points.append(piece.points[done + 1 : start + 1])
        bulges.append(piece.bulges[done:start])
        halves = 1 if abs(arc.included) <= math.pi else 2
        if halves == 2:
            points.append(_middle(piece.points[start], arc))
        points.append(piece.points[stop : stop + 1])
        bulges.append(np.full(halves, math.tan(arc.included / halves / 4)))
        found.append(_found(piece, start, stop, arc, bent=True))
        off, done = max(off, arc.off), stop
    points.append(piece.points[done + 1 :])
    bulges.append(piece.bulges[done:])
    line = replace(piece, points=np.vstack(points), bulges=np.concatenate(bulges), flattening=off) if found else piece
    found += [_found(line, start, stop, arc, bent=False) for start, stop, arc in _arcs(line, lambda _: math.inf, gap)]
    return line, tuple(found)


def _found(piece: Piece, start: int, stop: int, arc: _Arc, *, bent: bool) -> FoundArc:
    return FoundArc(piece.name, stop - start, arc.radius, abs(arc.included), arc.off + arc.sagitta, bent)


def _middle(start: FloatArray, arc: _Arc) -> FloatArray:
    cos, sin = math.cos(arc.included / 2), math.sin(arc.included / 2)
    x, y = start - arc.centre
    return np.asarray(arc.centre + np.array([[cos * x - sin * y, sin * x + cos * y]]), dtype=np.float64)


def _arcs(piece: Piece, allowed: Callable[[float], float], gap: float) -> Iterator[tuple[int, int, _Arc]]:
    """First vertex, last vertex and arc of each run of chords, the longest that begins at each vertex."""
    for begin, end in _runs(piece):
        start = begin
        while end - start >= _FEWEST:
            stop, arc = _longest(piece.points, start, end, allowed, gap)
            if arc is None:
                start += 1
            else:
                yield start, stop, arc
                start = stop


def _runs(piece: Piece) -> list[tuple[int, int]]:
    """First and last vertices of the runs of chords that turn to one side by little at a time."""
    chord = np.diff(piece.points, axis=0)
    straight = np.abs(piece.bulges) * np.hypot(*chord.T) <= 2 * FLAT
    turn = wrapped(np.diff(np.arctan2(chord[:, 1], chord[:, 0])))
    size = np.abs(turn)
    smooth = straight[1:] & straight[:-1] & (size > _LEAST_TURN) & (size < _MOST_TURN)
    side: NDArray[np.float64] = np.where(smooth, np.sign(turn), 0.0)
    changes = np.flatnonzero(np.diff(np.concatenate([[0.0], side, [0.0]])) != 0)
    # joint k stands between the chords k and k + 1, at vertex k + 1
    return [
        (a, b + 1)
        for a, b in zip(changes[:-1].tolist(), changes[1:].tolist(), strict=True)
        if side[a] != 0 and b + 1 - a >= _FEWEST
    ]


def _longest(
    points: FloatArray, start: int, end: int, allowed: Callable[[float], float], gap: float
) -> tuple[int, _Arc | None]:
    """Find the longest run from a vertex that lies on an arc: doubled while it does, then halved in."""
    best, step = _fits(points[start : start + _FEWEST + 1], allowed, gap), _FEWEST
    if best is None:
        return start, None
    good, bad = start + _FEWEST, end + 1
    while good < end and bad - good > 1:
        step = min(2 * step, bad - 1 - good) if bad > end else (bad - good) // 2
        trial = min(good + max(step, 1), end)
        arc = _fits(points[start : trial + 1], allowed, gap)
        if arc is None:
            bad = trial
        else:
            good, best = trial, arc
    return good, best


def _fits(vertices: FloatArray, allowed: Callable[[float], float], gap: float) -> _Arc | None:
    """Lay an arc through the first and the last vertex, as near to the others as can be; ``None`` if they lie off it."""
    shift = vertices.mean(axis=0)
    size = float(np.abs(vertices - shift).max())
    x, y = (vertices - shift).T / size
    # the circle nearest to the vertices: x² + y² = 2 a x + 2 b y + c, least squares
    (a, b, _), _, rank, _ = np.linalg.lstsq(np.column_stack([2 * x, 2 * y, np.ones(len(x))]), x**2 + y**2, rcond=None)
    if rank < 3:
        return None
    centre = shift + size * np.array([a, b])
    chord = vertices[-1] - vertices[0]
    if chord.any():  # onto the line on which the centres of arcs through both ends lie
        centre -= chord * (((centre - vertices[0]) @ chord) / (chord @ chord) - 0.5)
    out = vertices - centre
    turn = wrapped(np.diff(np.arctan2(out[:, 1], out[:, 0])))
    included, radius = float(turn.sum()), float(np.hypot(*out[0]))
    off = float(np.abs(np.hypot(*out.T) - radius).max())
    sagitta = radius - float(np.hypot(*(0.5 * (out[:-1] + out[1:])).T).min())
    one_way = bool((np.sign(turn) == np.sign(included)).all() and (np.abs(turn) < _MOST_TURN).all())
    if not one_way or abs(included) > 2 * math.pi * (1 + 1e-9) or off > gap or off + sagitta > allowed(radius):
        return None
    return _Arc(centre, radius, included, off, sagitta)
