"""Labels of points that stay clear of each other: each takes the nearest free place around its point."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from camwright.house.svg import text_width
from camwright.profiles.polynomial.profile import FloatArray

_DISTANCES = (5.0, 8.0, 11.5, 16.0, 22.0, 29.0, 38.0, 50.0, 64.0, 80.0, 100.0)
"""Distances of a label from its point that are tried (pt)."""

_DIRECTIONS = 24
"""Directions that are tried at each distance."""

_POINT = 4.5
"""Half width of what a point takes up (pt)."""

_GAP = 1.5
"""Free space around a label (pt)."""

_STEPS = 25
"""Points of a leading line that are held against what is taken."""

_NOTHING = 1e-3
"""Area that two boxes may share by rounding (pt²)."""

_LEADER = 12.0
"""Distance from which a line leads from the label to its point (pt)."""

_LINE = 1.2
"""Height of a line of text by its size."""

_LETTERS = 0.9
"""Width of a name of several words by the bound of its letters: none has wide letters alone."""


def label_points(
    panel: tuple[float, float],
    points: FloatArray,
    texts: Sequence[str],
    *,
    walls: Sequence[float] = (),
    size: float = 8.0,
) -> list[tuple[FloatArray, FloatArray | None]]:
    """Find places for labels beside points of a panel.

    Places are tried by growing distance from the point; the first at which a label meets neither points nor labels nor the panel's edge is
    taken, or else the one that meets least of them.

    Parameters
    ----------
    panel
        Its width and height (pt).
    points
        Places of the points in it (pt), shape ``(n, 2)``.
    texts
        One label each, in one or several lines.
    walls
        Places across the panel (pt) of lines that no label may cross.
    size
        Font size (pt).

    Returns
    -------
    list
        For each label the place of its middle (pt), and where a line from the point ends at it, ``None`` where none is needed.
    """
    edge = np.array([0.0, 0.0, *panel])
    taken = [np.array([*(place - _POINT), *(place + _POINT)]) for place in points]
    taken += [np.array([wall - 1.0, 0.0, wall + 1.0, panel[1]]) for wall in walls]
    found: dict[int, tuple[FloatArray, FloatArray | None]] = {}
    # crowded points choose first: they have the fewest free places
    apart = np.sort(np.hypot(*(points[:, None] - points[None]).transpose(2, 0, 1)), axis=1)
    for i in np.argsort(apart[:, : min(4, len(points))].sum(axis=1), kind="stable").tolist():
        half = label_size(texts[i], size) / 2
        offset = _free_offset(points, i, half + _GAP, np.array(taken), edge)
        middle = points[i] + offset
        taken.append(np.array([*(middle - half - _GAP), *(middle + half + _GAP)]))
        distance = _distances(points, middle, half)
        led = distance[i] > _LEADER or distance.min() < distance[i] - 1.0
        found[i] = middle, middle - offset + offset * _edge(offset, half) if led else None
    return [found[i] for i in range(len(points))]


def label_size(text: str, size: float) -> FloatArray:
    """Give width and height of a label (pt)."""
    lines = text.split("\n")
    return np.array([_LETTERS * max(text_width(line, size) for line in lines), _LINE * size * len(lines)])


def _edge(offset: FloatArray, half: FloatArray) -> float:
    """Share of the way from a point to its label's middle at which the label begins."""
    with np.errstate(divide="ignore"):
        return max(0.0, float(1.0 - np.min(half / np.abs(offset))))


def _distances(places: FloatArray, middle: FloatArray, half: FloatArray) -> FloatArray:
    """Distance of a label's box from every point (pt)."""
    away = np.maximum(np.abs(places - middle) - half, 0.0)
    return np.asarray(np.hypot(away[:, 0], away[:, 1]))


def _free_offset(places: FloatArray, i: int, half: FloatArray, taken: FloatArray, panel: FloatArray) -> FloatArray:
    """Offset of a label's middle from its point (pt): the nearest free place that is nearer to its point than to any other."""
    angles = 2 * np.pi * np.arange(_DIRECTIONS) / _DIRECTIONS
    best: FloatArray = np.zeros(2)
    least = np.inf
    for distance in _DISTANCES:
        for angle in angles:
            direction = np.array([np.cos(angle), np.sin(angle)])
            # beside the point at its left and right, else above and below it
            offset: FloatArray = (
                direction * distance + half * np.sign(np.round(direction, 6)) * np.abs(direction) ** 0.5
            )
            middle = places[i] + offset
            box = np.concatenate([middle - half, middle + half])
            met = float(4 * half.prod() - _common(box, panel) + _common(box, taken).sum())
            away = _distances(places, middle, half)
            if away.min() < away[i] - 1.0 or distance > _LEADER:
                met += _crossed(places[i], offset * _edge(offset, half), taken) if distance > _LEADER else 1.0
            if met <= _NOTHING:
                return offset
            if met < least:
                best, least = offset, met
    return best


def _crossed(place: FloatArray, way: FloatArray, taken: FloatArray) -> float:
    """How much of the line from a point to its label runs over what is taken, beyond the point's own surroundings (pt)."""
    others = taken[~_inside(place[None], taken)[0]]
    steps = place + way * np.linspace(0.0, 1.0, _STEPS)[:, None]
    return float(np.count_nonzero(_inside(steps, others))) * float(np.hypot(*way)) / _STEPS


def _inside(points: FloatArray, boxes: FloatArray) -> NDArray[np.bool_]:
    """Which points lie in which boxes, shape ``(points, boxes)``."""
    x, y = points[:, 0, None], points[:, 1, None]
    return np.asarray((boxes[:, 0] <= x) & (x <= boxes[:, 2]) & (boxes[:, 1] <= y) & (y <= boxes[:, 3]))


def _common(box: FloatArray, boxes: FloatArray) -> FloatArray:
    """Areas that a box shares with others (pt²); boxes are ``x0, y0, x1, y1``."""
    sides = np.minimum(box[2:], boxes[..., 2:]) - np.maximum(box[:2], boxes[..., :2])
    return np.asarray(np.maximum(sides, 0.0).prod(axis=-1))
