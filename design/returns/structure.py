"""Reading the structure of an optimum off a grid solution: which few pieces it is made of, and where they meet.

On a grid the switching points of the jerk fall between nodes. What a grid solution shows reliably is the *sequence* of its arcs; this
module turns that into a first guess with one piece for each arc, for the programme whose piece lengths are unknown.
"""

from __future__ import annotations

import itertools
import math

import numpy as np

from camwright.design.returns.bernstein import ScaledMotion, piece_coefficients, subdivision
from camwright.design.returns.scaling import ScaledProblem
from camwright.design.returns.transcription import SPLIT, Arc
from camwright.profiles.closed_forms.reach import (
    DoubleS,
    in_time,
    least_acceleration,
    least_jerk,
)
from camwright.profiles.objective import OBJECTIVES
from camwright.profiles.polynomial.profile import FloatArray

SEVEN_ARCS: tuple[Arc, ...] = ("free", "hold", "free", "cruise", "free", "hold", "free")
# An acceleration within this share of its peak counts as held.
LEVEL = 0.02
# A limit counts as active within this share of it; the grid is solved to 1e-8.
ACTIVE = 1e-4
# A piece shorter than this has vanished.
VANISHED = 1e-9
# End conditions missed by no more than this (scaled) are met: sums of so many numbers round no better.
ROUNDED = 1e-15
# Intervals that even the shortest arc gets on a grid made from an extreme motion.
LEAST_INTERVALS = 3
# A node that lies this close to the chord of its neighbours (as a share of the peak acceleration) is no corner.
NO_CORNER = 5e-9


def read_cubic(grid: ScaledMotion, problem: ScaledProblem) -> tuple[ScaledMotion, tuple[Arc, ...]]:
    """First guess of the seven arcs from a piecewise linear acceleration on a grid (degree 1).

    With constant limits every optimum of a peak or of the mean square of the acceleration has this structure or less: ramp, hold,
    ramp to no acceleration, cruise, and the same to the other side (arcs may vanish). The cruise lies where the ratio is at its
    limit, else where the acceleration changes sign; the holds lie where the acceleration is within `LEVEL` of its peak on
    their side. A ramp that the grid did not resolve gets the length that the jerk limit allows.
    """
    x = np.concatenate([[0.0], np.cumsum(grid.lengths)])
    a = grid.accelerations
    _, ratio = grid.nodes()
    step = float(grid.lengths.max())
    cruise_start, cruise_end = _cruise(x, a, ratio, problem)
    rise, hold, fall, level = _phase(x, a, cruise_start, step, problem.greatest_jerk)
    back = _phase(1.0 - x[::-1], a[::-1], 1.0 - cruise_end, step, problem.greatest_jerk)
    lengths = [rise, hold, fall, cruise_end - cruise_start, back[2], back[1], back[0]]
    levels = [float(a[0]), level, level, 0.0, 0.0, back[3], back[3], float(a[-1])]
    arcs = list(SEVEN_ARCS)
    # where the sync zone hands over an acceleration, its change of sign is a turn of the ratio and needs a node of its own
    for end in (-1, 0):
        if levels[end] != 0.0:
            _split_at_zero(lengths, levels, arcs, end)
    return ScaledMotion(np.array(lengths), np.array(levels), grid.objective), tuple(arcs)


def _split_at_zero(lengths: list[float], levels: list[float], arcs: list[Arc], end: int) -> None:
    """Split the ramp at one end where its acceleration changes sign, else in the middle."""
    outer, inner = (levels[0], levels[1]) if end == 0 else (levels[-1], levels[-2])
    share = outer / (outer - inner) if outer * inner < 0 else 0.5
    middle = outer + share * (inner - outer)
    whole = lengths[end]
    parts = [whole * share, whole * (1 - share)]
    if end == 0:
        lengths[:1], levels[1:1], arcs[:1] = parts, [middle], ["free", "free"]
    else:
        lengths[-1:], levels[-1:-1], arcs[-1:] = parts[::-1], [middle], ["free", "free"]


def _cruise(x: FloatArray, a: FloatArray, ratio: FloatArray, problem: ScaledProblem) -> tuple[float, float]:
    """Where the ratio rests on its limit; else, of no length, where the acceleration changes sign or is least."""
    span = problem.greatest_ratio - problem.least_ratio
    inner = np.arange(1, len(x) - 1)
    for gap in (problem.greatest_ratio - ratio, ratio - problem.least_ratio):
        at_limit = inner[gap[inner] <= ACTIVE * span]
        if len(at_limit) and (np.abs(ratio[at_limit]) > ACTIVE * span).all():
            return float(x[at_limit[0]]), float(x[at_limit[-1]])
    signs = np.nonzero(a[1:-2] * a[2:-1] < 0)[0] + 1
    if len(signs):
        i = int(signs[len(signs) // 2])
        at = float(x[i] + (x[i + 1] - x[i]) * a[i] / (a[i] - a[i + 1]))
    else:
        at = float(x[inner[int(np.argmin(np.abs(a[inner])))]])
    return at, at


def _phase(
    x: FloatArray, a: FloatArray, end: float, step: float, jerk_limit: float
) -> tuple[float, float, float, float]:
    """Lengths of rise, hold and fall between an end of the return and the cruise, and the level of the hold."""
    inside = np.nonzero((x > 0.0) & (x < end))[0]
    if len(inside) == 0:
        return end / 3, end / 3, end / 3, float(a[1])
    level = float(a[inside[int(np.argmax(np.abs(a[inside])))]])
    held = inside[np.abs(a[inside] - level) <= LEVEL * abs(level)]
    rise, fall = float(x[held[0]]), end - float(x[held[-1]])
    if rise <= 1.5 * step:
        rise = min(rise, abs(level - float(a[0])) / jerk_limit)
    if fall <= 2.5 * step:
        fall = min(fall, abs(level) / jerk_limit)
    return rise, max(0.0, end - rise - fall), fall, level


def read_quintic(grid: ScaledMotion, problem: ScaledProblem, touched: bool) -> tuple[ScaledMotion, tuple[Arc, ...]]:
    """Read runs of intervals with the same active limit (speed, acceleration, jerk, none), one piece each (degree 3).

    An optimum may touch a limit in a single point, or keep to it for less than an interval; there too the piece ends. With
    ``touched`` such an interval counts as active, without only one that keeps to the limit all along. Between two different
    limits a short free piece is put: it is there in the optimum, if often shorter than an interval.
    """
    p = grid.degree
    rows = piece_coefficients(grid.accelerations, p)
    _, ratio = grid.nodes()
    h = grid.lengths[:, None]
    paces = ratio[:-1, None] + h * np.pad(np.cumsum(rows, axis=1), ((0, 0), (1, 0))) / (p + 1)
    kinds = _active(paces, rows, p * np.diff(rows, axis=1) / h, problem, touched)
    x = np.concatenate([[0.0], np.cumsum(grid.lengths)])
    a = grid.accelerations
    breaks = [0.0]
    arcs: list[Arc] = []
    for i, kind in enumerate(kinds):
        if i > 0 and kind != kinds[i - 1]:
            if "none" not in (kind, kinds[i - 1]):  # a free arc between them may be too short for this grid
                breaks.append(float(x[i] - grid.lengths[i - 1] / 3))
                arcs.append("free")
                breaks.append(float(x[i] + grid.lengths[i] / 3))
            else:
                breaks.append(float(x[i]))
            arcs.append(_ARC_OF_LIMIT[kind])
        elif i == 0:
            arcs.append(_ARC_OF_LIMIT[kind])
    breaks.append(1.0)
    coefficients = [float(a[0])]
    for left, right in itertools.pairwise(breaks):
        # Bernstein coefficients that interpolate the grid's acceleration at the piece's ends and thirds
        third = _values(x, rows, left + (right - left) * np.arange(4) / 3)
        coefficients += (_THROUGH_THIRDS @ third).tolist()
    return ScaledMotion(np.diff(breaks), np.array(coefficients), grid.objective), tuple(arcs)


def readings_of(grid: ScaledMotion, problem: ScaledProblem) -> list[tuple[ScaledMotion, tuple[Arc, ...]]]:
    """Ways to read a quintic grid, each once: a cruise no longer than an interval may be a point where the speed is touched."""
    found: dict[tuple[Arc, ...], ScaledMotion] = {}
    strict, loose = (read_quintic(grid, problem, touched) for touched in (False, True))
    step = float(grid.lengths.max())
    for start, arcs in (_without_short_cruise(*strict, step), _without_short_cruise(*loose, step), strict, loose):
        found.setdefault(arcs, start)
    return [(start, arcs) for arcs, start in found.items()]


def _without_short_cruise(
    start: ScaledMotion, arcs: tuple[Arc, ...], step: float
) -> tuple[ScaledMotion, tuple[Arc, ...]]:
    """Make a free arc, a short cruise and a free arc two free arcs that meet at the greatest speed."""
    p = start.degree
    for i in range(1, len(arcs) - 1):
        if arcs[i - 1 : i + 2] == ("free", "cruise", "free") and start.lengths[i] <= 1.5 * step:
            lengths = np.delete(start.lengths, i)
            lengths[i - 1 : i + 1] += start.lengths[i] / 2
            a = np.delete(start.accelerations, np.arange(i * p, (i + 1) * p))
            return ScaledMotion(lengths, a, start.objective), (*arcs[: i - 1], "fall", *arcs[i + 1 :])
    return start, arcs


_ARC_OF_LIMIT: dict[str, Arc] = {
    "none": "free",
    "speed": "cruise",
    "+slope": "hold",
    "-slope": "hold",
    "+jerk": "ramp",
    "-jerk": "ramp",
}


def _active(paces: FloatArray, rows: FloatArray, steps: FloatArray, problem: ScaledProblem, touched: bool) -> list[str]:
    """Name the limit that each interval reaches: all along it, or if ``touched`` somewhere on it. One row an interval."""
    reached = np.any if touched else np.all
    kinds = np.full(len(rows), "none", dtype="<U6")
    # what is named last wins: speed over jerk over acceleration
    for name, values, limit in (("slope", rows, problem.greatest_slope), ("jerk", steps, problem.greatest_jerk)):
        kinds[reached(values <= -limit * (1 - ACTIVE), axis=1)] = f"-{name}"
        kinds[reached(values >= limit * (1 - ACTIVE), axis=1)] = f"+{name}"
    kinds[reached(paces >= problem.greatest_ratio - ACTIVE, axis=1)] = "speed"
    kinds[reached(paces <= problem.least_ratio + ACTIVE, axis=1)] = "speed"
    return kinds.tolist()


def _values(x: FloatArray, rows: FloatArray, at: FloatArray) -> FloatArray:
    """Evaluate Bernstein pieces of degree 3."""
    i = np.clip(np.searchsorted(x, at, side="right") - 1, 0, len(rows) - 1)
    s = (at - x[i]) / (x[i + 1] - x[i])
    weight = np.stack([(1 - s) ** 3, 3 * s * (1 - s) ** 2, 3 * s**2 * (1 - s), s**3], axis=1)
    return np.asarray((weight * rows[i]).sum(axis=1))


_THROUGH_THIRDS = np.array([[-5.0, 18.0, -9.0, 2.0], [2.0, -9.0, 18.0, -5.0], [0.0, 0.0, 0.0, 6.0]]) / 6
"""Last three Bernstein coefficients of the cubic through values at the ends and thirds; the first is the first value."""


def extreme_motion(problem: ScaledProblem) -> DoubleS | None:
    """Rest-to-rest motion of the least peak jerk (for jerk objectives) or peak acceleration (else) within the other limits.

    None if the job is not from rest to rest, or confined to a stroke that this motion does not know of.
    """
    if problem.confined or not problem.rest_to_rest:
        return None
    height, speed = problem.height, problem.greatest_ratio
    if OBJECTIVES[problem.objective].order == 3:
        jerk = least_jerk(height, 1.0, speed, problem.greatest_slope)
        return in_time(height, 1.0, speed, problem.greatest_slope, jerk)
    acceleration = least_acceleration(height, 1.0, speed, problem.greatest_jerk)
    return in_time(height, 1.0, speed, acceleration, problem.greatest_jerk)


def subdivide(arcs: FloatArray, count: int) -> FloatArray:
    """Grid of ``count`` intervals that shares the ends of arcs: every arc gets a few, the rest go by length.

    On a grid with the corners of a feasible motion a job is feasible, however short that motion's ramps.

    Parameters
    ----------
    arcs
        Lengths of the arcs, their sum 1; arcs of no length are left out.
    count
        Number of intervals; more if that is less than `LEAST_INTERVALS` for each arc.
    """
    arcs = arcs[arcs > 0]
    count = max(count, LEAST_INTERVALS * len(arcs))
    wanted = LEAST_INTERVALS + (count - LEAST_INTERVALS * len(arcs)) * arcs / arcs.sum()
    parts = np.floor(wanted).astype(int)
    parts[np.argsort(parts - wanted)[: count - int(parts.sum())]] += 1  # largest remainders first
    return np.concatenate([np.full(n, length / n) for length, n in zip(arcs, parts, strict=True)])


def from_extreme(motion: DoubleS) -> ScaledMotion:
    """Write an extreme motion in the programme's coordinates (degree 1)."""
    arcs = [motion.ramp, motion.hold, motion.ramp, motion.cruise, motion.ramp, motion.hold, motion.ramp]
    top = motion.acceleration
    return ScaledMotion(np.array(arcs), np.array([0.0, top, top, 0.0, 0.0, -top, -top, 0.0]), math.nan)


def tidy(motion: ScaledMotion, problem: ScaledProblem, *, corners: bool = True) -> ScaledMotion:
    """Drop corners that are none, keep short ramps within the jerk limit, and meet the end conditions to rounding.

    The solver leaves residuals of about 1e-11. A ramp as short as that would break the jerk limit by them, so every piece is made at
    least as long as its rise needs; the longest piece gives. Last, the accelerations are corrected by the smallest amount that
    makes ratio and position end where they must; both are linear in them. ``corners`` is whether corners that are none are dropped.
    """
    lengths, a = motion.lengths, motion.accelerations
    p = motion.degree
    lengths, a = _without_vanished(lengths, a, p)
    if p == 1 and corners:
        lengths, a = without_false_corners(lengths, a)
    for _ in range(3):  # each pass takes out what the one before left, down to rounding
        rise = p * np.abs(np.diff(a).reshape(len(lengths), p) @ subdivision(p - 1, SPLIT).T).max(axis=1)
        lengths = np.maximum(lengths, rise / (problem.greatest_jerk * (1 - 1e-10)))
        lengths[int(np.argmax(lengths))] -= lengths.sum() - 1.0
        q, v = ScaledMotion(lengths, a, 0.0).nodes()
        gap = np.array([problem.end_ratio - v[-1], problem.height - q[-1]])
        if np.abs(gap).max() <= ROUNDED:
            break
        a = a.copy()
        a[1:-1] += np.linalg.lstsq(_end_response(lengths, p)[:, 1:-1], gap, rcond=None)[0]
    return ScaledMotion(lengths, a, motion.objective)


def without_false_corners(lengths: FloatArray, a: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Drop nodes of a broken line that lie on the chord of their neighbours."""
    x, level = [0.0], [float(a[0])]
    position = np.cumsum(lengths)
    scale = NO_CORNER * float(np.abs(a).max())
    for i in range(1, len(a)):
        here = float(position[i - 1])
        while len(x) > 1:
            span = here - x[-2]
            chord = level[-2] + (a[i] - level[-2]) * (x[-1] - x[-2]) / span if span > 0 else level[-1]
            if abs(chord - level[-1]) > scale:
                break
            x.pop()
            level.pop()
        x.append(here)
        level.append(float(a[i]))
    return np.diff(x), np.array(level)


def _without_vanished(lengths: FloatArray, a: FloatArray, p: int) -> tuple[FloatArray, FloatArray]:
    """Drop pieces of no length; the little that the acceleration does on them goes to the piece that follows."""
    rise = np.abs(np.diff(a)).reshape(len(lengths), p).max(axis=1)
    kept = (lengths > VANISHED) | (rise > 1e-6 * float(np.abs(a).max()))
    points = np.concatenate([[True], np.repeat(kept, p)])
    return lengths[kept], a[points]


def _end_response(lengths: FloatArray, p: int) -> FloatArray:
    """Linear map from the acceleration coefficients to (ratio, position) at the end, shape ``(2, M p + 1)``."""
    remaining = 1.0 - np.cumsum(lengths)
    k = np.arange(p + 1)
    ratio = np.broadcast_to(lengths[:, None] / (p + 1), (len(lengths), p + 1))
    position = lengths[:, None] ** 2 * (p + 1 - k) / ((p + 1) * (p + 2)) + ratio * remaining[:, None]
    matrix = np.zeros((2, len(lengths) * p + 1))
    for row, parts in zip(matrix, (ratio, position), strict=True):
        row[:-1] += parts[:, :-1].ravel()
        row[p::p] += parts[:, -1]
    return matrix
