"""Where the points of a table may go: candidates for `camwright.profiles.tables.knots.choose`, few points first."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import lru_cache
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.profiles.polynomial.rows import ascending
from camwright.profiles.tables.cam_table import TableUnits, Unit, sample_profile
from camwright.profiles.tables.interpolation import quintics
from camwright.profiles.tables.target import Target

MOST_SPLINE = 1000
"""Points beyond which splines are not refined: the file grows, the motion does not improve."""
MOST_LINE = 4097
MOST_PIECES = 400
"""Points beyond which quintics are not refined."""

_GROWTH = 1.2
_MOST_DIVISIONS = 720
_EXACT_DEGREE = 5
_GAPS = (0.0, 1e-4, 1e-3, 4e-3, 0.02, 0.08)
"""Breaks nearer to each other than this part of the cycle share a point, tried in turn: rounding in float32, and limits
of points, are worse than a corner of the acceleration cut off."""
_SAME = 1e-9
"""A break within this part of the cycle of a zone's end is that end."""

_CLOSEST = 1e-9
"""Spans shorter than this part of the cycle are not divided."""

_NODES = np.linspace(0.02, 0.98, 13)
_METRES = TableUnits(Unit("m", 1.0), Unit("m", 1.0))


def zone_ends(profile: CamProfile) -> FloatArray:
    """Where straight pieces begin or end inside the cycle: the ends of the sync zone of most machines."""
    straight = profile.within_degree(1)
    return np.asarray(profile.breaks[1:-1][straight[1:] != straight[:-1]])


def required_points(profile: CamProfile, zones: Sequence[float] | FloatArray) -> FloatArray:
    """Points that every table has: both ends of the cycle and the zones' ends, at breaks where breaks are meant."""
    found = [profile.start, profile.end]
    for at in zones:
        nearest = float(profile.breaks[np.abs(profile.breaks - at).argmin()])
        found.append(nearest if abs(nearest - at) <= _SAME * profile.length else float(at))
    return ascending(np.array(found))


def candidates(
    profile: CamProfile, target: Target, required: FloatArray, allowed: FloatArray, points: int | None
) -> Iterator[FloatArray]:
    """Positions of the points, few first.

    Parameters
    ----------
    profile
        One cycle, in SI units.
    target
        What the table is for.
    required
        Points that must be among them, shape ``(k,)``, from the start to the end of the cycle.
    allowed
        What position, ratio and ratio slope may be off; shape ``(3,)``.
    points
        Number of points, if the user insists.
    """
    limit = target.max_points or (MOST_LINE if target.law == "line" else MOST_SPLINE)
    most = points or min(limit, MOST_LINE if target.law == "line" else MOST_SPLINE)
    if target.spacing == "equidistant":
        yield from _even(profile, required, most, points)
    elif target.spacing == "pieces":
        yield from _pieces(profile, target, required, allowed, points)
    else:
        before = -1
        for gap in _GAPS:
            breaks = _thinned(profile, required, max(gap, target.least_step) * profile.length)
            if len(breaks) != before and len(breaks) <= most:
                for x in _subdivided(profile, breaks, most, points, spline=target.law == "spline"):
                    if len(x) >= target.min_points:
                        yield x
                if points is not None:
                    return
            before = len(breaks)


def _thinned(profile: CamProfile, required: FloatArray, gap: float) -> FloatArray:
    """Give the breaks and the required points, without breaks that lie nearer to another point than the gap."""
    kept = required.tolist()
    for at in profile.breaks.tolist():
        if min(abs(other - at) for other in kept) > gap:
            kept.append(at)
    return ascending(kept)


def _pieces(
    profile: CamProfile, target: Target, required: FloatArray, allowed: FloatArray, points: int | None
) -> Iterator[FloatArray]:
    """Give the breaks if quintics carry the pieces; else points from the zones' ends on, each where it is missed most."""
    most = points or min(target.max_points or MOST_PIECES, MOST_PIECES)
    least = target.least_step * profile.length
    x = ascending(np.concatenate([profile.breaks, required]))
    if profile.degree <= _EXACT_DEGREE and len(x) <= most and np.diff(x).min() >= least:
        while len(x) < (points or target.min_points):
            x = _inserted(profile, x, int(np.argmax(np.diff(x))))
        yield x
        if points is not None:
            return
    if len(required) <= most:
        yield from _grown(profile, target, required, allowed, points, most)


def _grown(
    profile: CamProfile, target: Target, x: FloatArray, allowed: FloatArray, points: int | None, most: int
) -> Iterator[FloatArray]:
    """Give more and more points, each next one where it is missed most, until they miss nothing or are the most."""
    least = target.least_step * profile.length
    may = float(allowed[0]), float(allowed[1]), float(allowed[2])
    missed = list(_missed(profile, tuple(x.tolist()), may))
    shown = 0
    while True:
        done = max(missed) <= 1.0 and points is None
        if len(x) >= target.min_points and (len(x) >= _GROWTH * shown or done or len(x) == most):
            shown = len(x)
            yield x
        room = max(4.0 * least, _CLOSEST * profile.length)  # where an acceleration jumps no point is near enough
        worst = int(np.argmax(np.where(np.diff(x) > room, missed, 0.0)))
        if len(x) >= most or np.diff(x)[worst] <= room:
            return
        x = _inserted(profile, x, worst, least)
        missed[worst : worst + 1] = _missed(profile, tuple(x[worst : worst + 3].tolist()), may)


def _inserted(profile: CamProfile, x: FloatArray, piece: int, least: float = 0.0) -> FloatArray:
    """Put a point into a span: on the break nearest to its middle, or at the middle if it holds none."""
    middle = 0.5 * (x[piece] + x[piece + 1])
    inner = profile.breaks[(profile.breaks > x[piece] + least) & (profile.breaks < x[piece + 1] - least)]
    at = inner[np.abs(inner - middle).argmin()] if len(inner) else middle
    return np.insert(x, piece + 1, at)


@lru_cache(maxsize=1024)  # each target with quintics asks for the same spans
def _missed(profile: CamProfile, knots: tuple[float, ...], allowed: tuple[float, float, float]) -> tuple[float, ...]:
    """By how many times the quintics between neighbouring points miss the profile more than they may, one a span."""
    x = np.array(knots)
    rebuilt = quintics(sample_profile(profile, x, _METRES))
    inside = profile.breaks[(profile.breaks > x[0]) & (profile.breaks < x[-1]) & ~np.isin(profile.breaks, x)]
    places = np.concatenate([(x[:-1, None] + np.diff(x)[:, None] * _NODES).ravel(), inside])
    off = [np.abs(rebuilt(places, order) - profile(places, order)) / allowed[order] for order in range(3)]
    worst = np.zeros(len(x) - 1)
    np.maximum.at(worst, np.searchsorted(x, places, side="right") - 1, np.max(off, axis=0))
    return tuple(worst.tolist())


def _subdivided(
    profile: CamProfile, breaks: FloatArray, most: int, points: int | None, *, spline: bool
) -> Iterator[FloatArray]:
    """Give the breaks and points between, closer and closer, or as many as are asked for.

    Pieces that the drive's law carries are not divided: straight ones by lines, cubics by a spline. A spline that must
    bend elsewhere needs points in the straight pieces too, for it rings on; they stand wider and wider apart.
    """
    piece = np.searchsorted(profile.breaks[1:-1], 0.5 * (breaks[1:] + breaks[:-1]), side="right")
    near = _SAME * profile.length
    whole = (profile.breaks[piece] <= breaks[:-1] + near) & (profile.breaks[piece + 1] >= breaks[1:] - near)
    straight = profile.within_degree(1)[piece] & whole
    carried = profile.within_degree(3 if spline else 1)[piece] & whole
    width = np.diff(breaks)
    reach = float(width[~straight].sum()) or profile.length

    def divided(divisions: float) -> FloatArray:
        step = reach / divisions
        counts = np.where(straight, 1, np.maximum(1, np.rint(width / step))).astype(np.int64)
        if not (spline and straight.any()):
            return np.concatenate([[profile.start], _evenly(breaks[:-1], breaks[1:], counts)])
        parts = [np.array([profile.start])]
        ends = np.flatnonzero(np.diff(straight, prepend=~straight[0], append=~straight[-1]))
        for first, last in pairwise(ends.tolist()):  # runs of pieces of one kind
            left, right = breaks[first:last], breaks[first + 1 : last + 1]
            if straight[first]:
                parts += [_graded(*span, step) for span in zip(left, right, strict=True)]
            else:
                parts.append(_evenly(left, right, counts[first:last]))
        return np.concatenate(parts)

    if points is not None:
        yield from _as_many(divided, points)
        return
    if carried.all():
        yield breaks
    divisions, before = 4.0, 0
    while len(x := divided(divisions)) <= most:
        if len(x) > before:
            yield x
        before = len(x)
        divisions *= _GROWTH


def _as_many(divided: Callable[[float], FloatArray], points: int) -> Iterator[FloatArray]:
    """Give the closest division that has no more than so many points, if there is one."""
    few, many = 1.0, 2.0 * points
    while many - few > 0.25:
        middle = 0.5 * (few + many)
        few, many = (middle, many) if len(divided(middle)) <= points else (few, middle)
    if len(divided(few)) <= points:
        yield divided(few)


def _evenly(left: FloatArray, right: FloatArray, counts: NDArray[np.int64]) -> FloatArray:
    """Even points of neighbouring pieces, so many a piece, without the left end of the first."""
    last = np.cumsum(counts)
    number = 1 + np.arange(last[-1]) - np.repeat(last - counts, counts)
    points = number * np.repeat((right - left) / counts, counts) + np.repeat(left, counts)
    points[last - 1] = right
    return np.asarray(points, dtype=np.float64)


def _graded(left: float, right: float, step: float) -> FloatArray:
    """Points of a straight piece without its left end, each twice as far from the nearer end as the one before."""
    half = 0.5 * (right - left)
    distances = []
    distance = step
    while distance < half - 0.25 * step:
        distances.append(distance)
        distance = 2.0 * distance if len(distances) > 3 else distance + step
    near = np.array(distances)
    return np.concatenate([left + near, right - near[::-1], [right]])


def _even(profile: CamProfile, required: FloatArray, most: int, points: int | None) -> Iterator[FloatArray]:
    """Evenly spaced points, the zones' ends among them where a spacing of a reasonable number of parts has them."""
    parts = (required - profile.start) / profile.length
    base = 1
    for count in range(1, _MOST_DIVISIONS + 1):
        if np.abs(parts * count - np.rint(parts * count)).max(initial=0.0) < 1e-9:
            base = count
            break
    if points is not None:
        yield np.linspace(profile.start, profile.end, points)
        return
    factor = max(1.0, 16 / base)
    while base * round(factor) + 1 <= most:
        yield np.linspace(profile.start, profile.end, base * round(factor) + 1)
        factor = max(round(factor) + 1.0, factor * _GROWTH)
