"""Lines and arcs that are drawn twice, wholly or in part: found, named, and used once.

Of two that lie on each other the one that comes first in the drawing is kept whole; the other keeps what lies beside
it. Two lines lie on each other where they run within a tolerance of each other and their directions differ by at
most 1 degree or so; two arcs where their centres and radii differ by no more than the tolerance.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import chain

import numpy as np

from camwright.bender.piece import Piece, along
from camwright.profiles.bender.boxes import Indices, overlapping
from camwright.profiles.bender.outline import FLAT
from camwright.profiles.errors import InputError
from camwright.profiles.notice import Notice, Number
from camwright.profiles.polynomial.profile import FloatArray

_MOST_CUTS = 100_000
"""Stretches that may lie on others: more would take longer than a user waits."""

_BUCKETS = 180
"""Directions of lines that are compared with each other and with the next bucket's."""


@dataclass(frozen=True)
class EntityOverlap:
    """Two entities that lie on each other.

    Parameters
    ----------
    first, second
        Names; the second is the one that is cut away.
    length
        Length of the second that lies on the first (m).
    start, end
        Where one stretch of it begins and ends (m).
    """

    first: str
    second: str
    length: float
    start: tuple[float, float]
    end: tuple[float, float]

    @property
    def told(self) -> Notice:
        """What to say of them."""
        (x0, y0), (x1, y1) = self.start, self.end
        return Notice(
            "{second} lies on {first} over {length} mm, from ({x0}, {y0}) to ({x1}, {y1}) mm",
            first=self.first,
            second=self.second,
            length=Number(1e3 * self.length, ".3f"),
            x0=Number(1e3 * x0, ".3f"),
            y0=Number(1e3 * y0, ".3f"),
            x1=Number(1e3 * x1, ".3f"),
            y1=Number(1e3 * y1, ".3f"),
        )


@dataclass(frozen=True)
class _Cut:
    """A stretch of a segment that lies on another segment: parts of its length, and the places there (m)."""

    owner: int
    low: float
    high: float
    start: tuple[float, float]
    end: tuple[float, float]


@dataclass(frozen=True, eq=False)
class _Segments:
    """Segments of all pieces: ends, bulges, the piece of each; arcs as centre, radius, start angle and sweep."""

    start: FloatArray
    end: FloatArray
    bulge: FloatArray
    piece: Indices
    number: Indices

    @property
    def chord(self) -> FloatArray:
        """Distances between the ends (m)."""
        return np.asarray(np.hypot(*(self.end - self.start).T), dtype=np.float64)

    @property
    def length(self) -> FloatArray:
        """Lengths along the segments (m)."""
        return along(self.chord, self.bulge)


def without_overlaps(pieces: Sequence[Piece], tolerance: float) -> tuple[list[Piece], tuple[EntityOverlap, ...]]:
    """Take away what lies on something that is drawn before it.

    Parameters
    ----------
    pieces
        In the order of the drawing (m).
    tolerance
        How near to each other lines that are the same lie (m).

    Returns
    -------
    (pieces, overlaps)
        The pieces with every stretch once, and what was found, in the order of the drawing.

    Raises
    ------
    InputError
        Too many lines lie beside each other.
    """
    kept, copies = _copies(pieces)
    distinct = [pieces[k] for k in kept]
    segments = _segments(distinct)
    cuts: dict[int, list[_Cut]] = {}
    for j, cut in _cuts(segments, tolerance):
        cuts.setdefault(j, []).append(cut)
    if not (cuts or copies):
        return list(pieces), ()
    first_of = np.searchsorted(segments.piece, np.arange(len(distinct)))
    touched = {int(segments.piece[j]) for j in cuts}
    found: list[Piece] = []
    for k, piece in enumerate(distinct):
        if k in touched:
            own = {
                j - int(first_of[k]): cuts[j] for j in range(first_of[k], first_of[k] + len(piece.bulges)) if j in cuts
            }
            found += _remains(piece, own, tolerance)
        else:
            found.append(piece)
    named = [(kept[k], overlap) for k, overlap in _named(cuts, segments, distinct)]
    named += [(j, _copied(pieces[i], pieces[j])) for j, i in copies.items()]
    return found, tuple(overlap for _, overlap in sorted(named, key=lambda entry: entry[0]))


def _copies(pieces: Sequence[Piece]) -> tuple[list[int], dict[int, int]]:
    """Tell the pieces that are no copies, and of which each copy is one: many copies make no pairs among themselves."""
    first: dict[bytes, int] = {}
    kept: list[int] = []
    copies: dict[int, int] = {}
    for k, piece in enumerate(pieces):
        # adding 0 turns -0 into 0
        shapes = [one.points.tobytes() + (one.bulges + 0.0).tobytes() for one in (piece, piece.reverse())]
        known = next((first[shape] for shape in shapes if shape in first), None)
        if known is None:
            kept.append(k)
            first[shapes[0]] = k
        else:
            copies[k] = known
    return kept, copies


def _copied(first: Piece, second: Piece) -> EntityOverlap:
    start, end = second.points[:2].tolist()
    return EntityOverlap(first.name, second.name, second.length, tuple(start), tuple(end))


def between_styles(styles: Sequence[Sequence[Piece]], tolerance: float) -> tuple[EntityOverlap, ...]:
    """Find what lies on something of another style: it is named, and never merged.

    Parameters
    ----------
    styles
        The pieces of each style (m).
    tolerance
        How near to each other lines that are the same lie (m).

    Raises
    ------
    InputError
        Too many lines lie beside each other.
    """
    distinct = [[own[k] for k in _copies(own)[0]] for own in styles]  # copies of one style are named there
    pieces = [piece for own in distinct for piece in own]
    style = np.repeat(np.arange(len(styles)), [len(own) for own in distinct])
    if len(np.unique(style)) < 2:
        return ()
    segments = _segments(pieces)
    cuts: dict[int, list[_Cut]] = {}
    for j, cut in _cuts(segments, tolerance):
        if style[segments.piece[j]] != style[segments.piece[cut.owner]]:
            cuts.setdefault(j, []).append(cut)
    return tuple(overlap for _, overlap in _named(cuts, segments, pieces))


def _cuts(segments: _Segments, tolerance: float) -> Iterator[tuple[int, _Cut]]:
    """Stretches that lie on earlier segments, with the number of the segment that loses them."""
    flat = np.abs(segments.bulge) * segments.chord <= 2 * FLAT
    lines, arcs = np.flatnonzero(flat), np.flatnonzero(~flat)
    found = chain(_line_cuts(segments, lines, tolerance), _arc_cuts(segments, arcs, tolerance))
    for count, cut in enumerate(found):
        if count == _MOST_CUTS:
            raise InputError(
                f"more than {_MOST_CUTS} stretches of lines lie on others; purge what is drawn many times over"
            )
        yield cut


def _segments(pieces: Sequence[Piece]) -> _Segments:
    return _Segments(
        np.vstack([piece.points[:-1] for piece in pieces]),
        np.vstack([piece.points[1:] for piece in pieces]),
        np.concatenate([piece.bulges for piece in pieces]),
        np.repeat(np.arange(len(pieces)), [len(piece.bulges) for piece in pieces]),
        np.concatenate([np.arange(len(piece.bulges)) for piece in pieces]),
    )


def _line_cuts(segments: _Segments, lines: Indices, tolerance: float) -> Iterator[tuple[int, _Cut]]:
    """Stretches of lines that lie on earlier lines, with the number of the segment that loses them."""
    way = segments.end[lines] - segments.start[lines]
    angle = np.arctan2(way[:, 1], way[:, 0]) % math.pi
    bucket = np.minimum((angle * (_BUCKETS / math.pi)).astype(np.int64), _BUCKETS - 1)
    for b in np.unique(bucket).tolist():
        here = lines[(bucket == b) | (bucket == (b + 1) % _BUCKETS)]
        turn = -(b + 1) * math.pi / _BUCKETS
        rotate = np.array([[math.cos(turn), -math.sin(turn)], [math.sin(turn), math.cos(turn)]])
        p, q = segments.start[here] @ rotate.T, segments.end[here] @ rotate.T
        i, j = overlapping(np.minimum(p, q) - tolerance, np.maximum(p, q) + tolerance)
        i, j = here[i], here[j]
        # pairs of the next bucket alone are its own; neighbours in one piece meet in a corner and are no doubles
        mine = np.isin(i, lines[bucket == b]) | np.isin(j, lines[bucket == b])
        mine &= (segments.piece[i] != segments.piece[j]) | (np.abs(segments.number[i] - segments.number[j]) > 1)
        yield from _on_lines(segments, i[mine], j[mine], tolerance)


def _on_lines(segments: _Segments, i: Indices, j: Indices, tolerance: float) -> Iterator[tuple[int, _Cut]]:
    """Stretches of lines ``j`` that lie on lines ``i``."""
    origin, way = segments.start[i], segments.end[i] - segments.start[i]
    size = np.hypot(*way.T)
    unit = way / size[:, None]
    ends = [segments.start[j] - origin, segments.end[j] - origin]
    t0, t1 = ((p * unit).sum(axis=1) for p in ends)
    d0, d1 = (unit[:, 0] * p[:, 1] - unit[:, 1] * p[:, 0] for p in ends)
    low, high = np.maximum(np.minimum(t0, t1), 0.0), np.minimum(np.maximum(t0, t1), size)
    with np.errstate(divide="ignore", invalid="ignore"):
        s_low, s_high = (low - t0) / (t1 - t0), (high - t0) / (t1 - t0)
        near = (np.abs(d0 + s_low * (d1 - d0)) < tolerance) & (np.abs(d0 + s_high * (d1 - d0)) < tolerance)
    near &= high - low > 2 * tolerance
    for k in np.flatnonzero(near).tolist():
        parts = []
        for t, s in ((low[k], s_low[k]), (high[k], s_high[k])):
            # an end of the one or of the other: the places themselves, so that what is left joins there
            x, y = segments.start[j[k]] if s <= 0 else segments.end[j[k]] if s >= 1 else origin[k] + t * unit[k]
            if 0 < s < 1:
                x, y = segments.start[i[k]] if t <= 0 else segments.end[i[k]]
            parts.append((min(max(float(s), 0.0), 1.0), (float(x), float(y))))
        parts.sort()
        yield int(j[k]), _Cut(int(i[k]), parts[0][0], parts[1][0], parts[0][1], parts[1][1])


def _arc_cuts(segments: _Segments, arcs: Indices, tolerance: float) -> Iterator[tuple[int, _Cut]]:
    """Stretches of arcs that lie on earlier arcs, with the number of the segment that loses them."""
    start, chord, bulge = segments.start[arcs], segments.end[arcs] - segments.start[arcs], segments.bulge[arcs]
    left = np.stack([-chord[:, 1], chord[:, 0]], axis=1)
    centre = start + 0.5 * chord + left * ((1 - bulge**2) / (4 * bulge))[:, None]
    radius = np.hypot(*chord.T) * (1 + bulge**2) / (4 * np.abs(bulge))
    sweep = 4 * np.arctan(np.abs(bulge))
    # all arcs counted anticlockwise: from where they begin then
    begin = np.where((bulge > 0)[:, None], start, segments.end[arcs]) - centre
    angle = np.arctan2(begin[:, 1], begin[:, 0])
    ball = np.column_stack([centre, radius])
    i, j = overlapping(ball - 0.5 * tolerance, ball + 0.5 * tolerance)
    delta = (angle[i] - angle[j]) % (2 * math.pi)
    for shift in (0.0, -2 * math.pi):
        low, high = np.maximum(delta + shift, 0.0), np.minimum(delta + shift + sweep[i], sweep[j])
        for k in np.flatnonzero((high - low) * radius[j] > 2 * tolerance).tolist():
            one, other = int(arcs[i[k]]), int(arcs[j[k]])
            parts = []
            for t, own in ((low[k], (0.0, 0)), (high[k], (sweep[j[k]], 1))):
                ahead = bulge[j[k]] > 0
                part = t / sweep[j[k]]
                if t == own[0]:
                    place = (segments.start, segments.end)[own[1] if ahead else 1 - own[1]][other]
                else:
                    place = (segments.start, segments.end)[own[1] if bulge[i[k]] > 0 else 1 - own[1]][one]
                parts.append((float(part if ahead else 1 - part), (float(place[0]), float(place[1]))))
            parts.sort()
            yield other, _Cut(one, parts[0][0], parts[1][0], parts[0][1], parts[1][1])


def _remains(piece: Piece, cuts: dict[int, list[_Cut]], tolerance: float) -> list[Piece]:
    """Cut stretches out of a piece; what is left, each run of it a piece of its own."""
    runs: list[list[tuple[FloatArray, FloatArray, float]]] = [[]]
    for number in range(len(piece.bulges)):
        start, end, bulge = piece.points[number], piece.points[number + 1], float(piece.bulges[number])
        own = _merged(cuts.get(number, ()))
        at, place = 0.0, start
        for cut in own:
            if cut.low > at and np.hypot(*(np.array(cut.start) - place)) > tolerance:
                runs[-1].append((place, np.array(cut.start), _part(bulge, cut.low - at)))
            runs.append([])
            at, place = cut.high, np.array(cut.end)
        if at < 1 and (not own or np.hypot(*(end - place)) > tolerance):
            runs[-1].append((place, end, _part(bulge, 1 - at)))
    if piece.closed and len(runs) > 1 and runs[0] and runs[-1]:
        runs[0] = runs.pop() + runs[0]
    return [_run(run, piece) for run in runs if run]


def _part(bulge: float, part: float) -> float:
    return bulge if part == 1 else math.tan(part * math.atan(bulge))


def _merged(cuts: Iterable[_Cut]) -> list[_Cut]:
    """Join the stretches of one segment that overlap each other."""
    merged: list[_Cut] = []
    for cut in sorted(cuts, key=lambda cut: (cut.low, cut.high)):
        if merged and cut.low <= merged[-1].high:
            if cut.high > merged[-1].high:
                merged[-1] = replace(merged[-1], high=cut.high, end=cut.end)
        else:
            merged.append(cut)
    return merged


def _run(run: list[tuple[FloatArray, FloatArray, float]], piece: Piece) -> Piece:
    points = np.vstack([run[0][0], *(end for _, end, _ in run)])
    return replace(piece, points=points, bulges=np.array([bulge for _, _, bulge in run]))


def _named(
    cuts: dict[int, list[_Cut]], segments: _Segments, pieces: Sequence[Piece]
) -> list[tuple[int, EntityOverlap]]:
    """Gather the cuts of each two entities, with the number of the second."""
    lengths = segments.length
    found: dict[tuple[int, int], EntityOverlap] = {}
    for j in sorted(cuts):
        for cut in sorted(cuts[j], key=lambda cut: (cut.owner, cut.low)):
            pair = int(segments.piece[cut.owner]), int(segments.piece[j])
            size = (cut.high - cut.low) * float(lengths[j])
            if pair in found:
                found[pair] = replace(found[pair], length=found[pair].length + size)
            else:
                names = pieces[pair[0]].name, pieces[pair[1]].name
                found[pair] = EntityOverlap(*names, size, cut.start, cut.end)
    return [(second, overlap) for (_, second), overlap in found.items()]
