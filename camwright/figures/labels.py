"""Labels of points that stay clear of each other: each takes the nearest free place around its point."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from camwright.profiles.polynomial.profile import FloatArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes


_DISTANCES = (5.0, 8.0, 11.5, 16.0, 22.0, 29.0, 38.0, 50.0, 64.0)
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
"""Area that two boxes may share by rounding (px²)."""

_LEADER = 12.0
"""Distance from which a line leads from the label to its point (pt)."""


def label_points(
    axes: Axes, points: FloatArray, texts: Sequence[str], *, walls: Sequence[float] = (), size: float = 6.5
) -> None:
    """Write labels beside points of a panel; the figure's layout is settled first.

    Places are tried by growing distance from the point; the first at which a label meets neither points nor labels nor the panel's edge is
    taken, or else the one that meets least of them.

    Parameters
    ----------
    axes
        The panel, its limits and scales set; its figure has a size.
    points
        Shape ``(n, 2)``, in data coordinates.
    texts
        One label each.
    walls
        Abscissas of lines across the panel that no label may cross.
    size
        Font size (pt).
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    figure = axes.get_figure(root=True)
    assert figure is not None  # noqa: S101 - axes belong to a figure
    FigureCanvasAgg(figure)
    figure.draw_without_rendering()
    pixels = figure.dpi / 72.0
    panel = axes.get_window_extent()
    places: FloatArray = np.asarray(axes.transData.transform(points))
    taken = [np.array([*(place - _POINT * pixels), *(place + _POINT * pixels)]) for place in places]
    across = np.asarray(axes.transData.transform([(wall, axes.get_ylim()[0]) for wall in walls])).reshape(-1, 2)[:, 0]
    taken += [np.array([wall - pixels, panel.y0, wall + pixels, panel.y1]) for wall in across]
    # crowded points choose first: they have the fewest free places
    apart = np.sort(np.hypot(*(places[:, None] - places[None]).transpose(2, 0, 1)), axis=1)
    for i in np.argsort(apart[:, : min(4, len(places))].sum(axis=1), kind="stable"):
        label = axes.annotate(
            texts[i],
            points[i],
            xytext=(0, 0),
            textcoords="offset points",
            ha="center",
            va="center",
            fontsize=size,
            zorder=8,
        )
        label.set_in_layout(False)
        box = label.get_window_extent()
        half = 0.5 * np.array([box.width, box.height])
        offset = _free_offset(places, int(i), half + _GAP * pixels, np.array(taken), np.array(panel.extents), pixels)
        label.set_position(tuple(offset / pixels))
        taken.append(np.array(label.get_window_extent().padded(_GAP * pixels).extents))
        distance = _distances(places, places[i] + offset, half)
        if distance[i] > _LEADER * pixels or distance.min() < distance[i] - pixels:
            tip = places[i] + offset * _edge(offset, half)
            ends = axes.transData.inverted().transform([places[i], tip])
            axes.plot(*ends.T, color="#8c8c8c", linewidth=0.5, zorder=3.5, scalex=False, scaley=False)


def _edge(offset: FloatArray, half: FloatArray) -> float:
    """Share of the way from a point to its label's middle at which the label begins."""
    with np.errstate(divide="ignore"):
        return max(0.0, float(1.0 - np.min(half / np.abs(offset))))


def _distances(places: FloatArray, middle: FloatArray, half: FloatArray) -> FloatArray:
    """Distance of a label's box from every point (px)."""
    away = np.maximum(np.abs(places - middle) - half, 0.0)
    return np.asarray(np.hypot(away[:, 0], away[:, 1]))


def _free_offset(
    places: FloatArray, i: int, half: FloatArray, taken: FloatArray, panel: FloatArray, pixels: float
) -> FloatArray:
    """Offset of a label's middle from its point (px): the nearest free place that is nearer to its point than to any other."""
    angles = 2 * np.pi * np.arange(_DIRECTIONS) / _DIRECTIONS
    best: FloatArray = np.zeros(2)
    least = np.inf
    for distance in _DISTANCES:
        for angle in angles:
            direction = np.array([np.cos(angle), np.sin(angle)])
            # beside the point at its left and right, else above and below it
            offset: FloatArray = (
                direction * distance * pixels + half * np.sign(np.round(direction, 6)) * np.abs(direction) ** 0.5
            )
            middle = places[i] + offset
            box = np.concatenate([middle - half, middle + half])
            met = float(4 * half.prod() - _common(box, panel) + _common(box, taken).sum())
            away = _distances(places, middle, half)
            if away.min() < away[i] - pixels or distance > _LEADER:
                met += _crossed(places[i], offset * _edge(offset, half), taken) if distance > _LEADER else 1.0
            if met <= _NOTHING:
                return offset
            if met < least:
                best, least = offset, met
    return best


def _crossed(place: FloatArray, way: FloatArray, taken: FloatArray) -> float:
    """How much of the line from a point to its label runs over what is taken, beyond the point's own surroundings (px)."""
    others = taken[~_inside(place[None], taken)[0]]
    steps = place + way * np.linspace(0.0, 1.0, _STEPS)[:, None]
    return float(np.count_nonzero(_inside(steps, others))) * float(np.hypot(*way)) / _STEPS


def _inside(points: FloatArray, boxes: FloatArray) -> NDArray[np.bool_]:
    """Which points lie in which boxes, shape ``(points, boxes)``."""
    x, y = points[:, 0, None], points[:, 1, None]
    return np.asarray((boxes[:, 0] <= x) & (x <= boxes[:, 2]) & (boxes[:, 1] <= y) & (y <= boxes[:, 3]))


def _common(box: FloatArray, boxes: FloatArray) -> FloatArray:
    """Areas that a box shares with others (px²); boxes are ``x0, y0, x1, y1``."""
    sides = np.minimum(box[2:], boxes[..., 2:]) - np.maximum(box[:2], boxes[..., :2])
    return np.asarray(np.maximum(sides, 0.0).prod(axis=-1))
