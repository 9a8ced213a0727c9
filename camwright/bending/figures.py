"""Figures: the bent rule over the drawing, and the time table beside the paper's."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from camwright.bending.program_file import BentOutline
from design.moves import TimeTable
from profiles.bender.outline import Outline
from profiles.polynomial import FloatArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_BENDS_SHOWN = 6
_PER_MOVE = 60
_FINENESS = 3000
"""A view's width over the coarseness of arcs drawn in it."""

MOST_VECTORS = 50_000
"""Sides of the rule from which on the lines of the whole view are drawn as pixels."""

_STYLE: dict[Any, Any] = {
    "axes.titley": 1.0,
    "font.size": 9.0,
    "path.simplify": True,
    "svg.fonttype": "path",
    "svg.hashsalt": "camwright",
}
_DPI = 150
_COMPRESSION = 3
"""Effort of the PNG's compression, 0 to 9."""

_WIDTH = 9.0
_LEFT, _BETWEEN, _RIGHT, _BOTTOM, _TOP = 0.75, 0.75, 0.15, 0.85, 0.6
_WIDEST, _TALLEST = 5.0, 5.6
"""Width of the figure, its margins, and the greatest width and height of the whole view (in)."""

_PLAIN = 1e4
"""Coordinates (mm) up to which the close view's ticks show all their digits."""

_DRAWN, _BENT, _WORST = "#b9c4d0", "#11304f", "#c1121f"


def draw(outline: BentOutline, directory: Path, name: str) -> None:
    """Write both figures of an outline as SVG and PNG: ``<name>-proof`` and ``<name>-times``."""
    import matplotlib as mpl

    with mpl.rc_context(_STYLE):
        for kind, figure in (("proof", _proof_figure(outline)), ("times", _times_figure(outline))):
            figure.savefig(directory / f"{name}-{kind}.svg", metadata={"Date": None, "Creator": None}, dpi=_DPI)
            figure.savefig(
                directory / f"{name}-{kind}.png",
                metadata={"Software": None},
                dpi=_DPI,
                pil_kwargs={"compress_level": _COMPRESSION},
            )


def drawn_as_pixels(outline: BentOutline) -> bool:
    """Tell whether the rule has too many sides for lines in the whole view."""
    return outline.plan.bends >= MOST_VECTORS


def outline_path(outline: Outline, coarseness: float | FloatArray) -> FloatArray:
    """Return points along an outline (m), arcs as chords within a distance of them (m), one for all or one a segment."""
    radius = np.where(outline.arcs, outline.radii, 1.0)
    widest = 2 * np.arccos(1 - np.minimum(coarseness / radius, 0.5))
    steps = np.maximum(1, np.ceil(np.abs(outline.included) / widest)).astype(np.int64)
    segment = np.repeat(np.arange(len(steps)), steps)
    inner = np.arange(len(segment)) - np.repeat(np.cumsum(steps) - steps, steps)
    turn = outline.included[segment] * inner / steps[segment]
    centre = np.where(outline.arcs[:, None], outline.centres, 0.0)[segment]
    out = outline.points[segment] - centre
    cos, sin = np.cos(turn), np.sin(turn)
    turned = centre + np.stack([cos * out[:, 0] - sin * out[:, 1], sin * out[:, 0] + cos * out[:, 1]], axis=1)
    return np.vstack([turned, outline.points[-1:]])


def _proof_figure(outline: BentOutline) -> Figure:
    bent, worst, deviation = 1e3 * outline.proof.points, 1e3 * outline.proof.worst, 1e3 * outline.proof.deviation
    drawn = 1e3 * outline_path(outline.plan.outline, 1e-3 * float(np.ptp(bent, axis=0).max()) / _FINENESS)
    size = np.ptp(drawn, axis=0)
    half = 0.56 * np.maximum(size, 0.35 * size.max())  # a straight line gets some room beside it
    figure, whole, near = _panels(float(half[1] / half[0]))
    reach = _window(outline, worst)
    seen = _seen(outline.plan.outline, worst, reach)
    fine = 1e3 * outline_path(outline.plan.outline, 1e-3 * np.where(seen, reach, np.inf) / _FINENESS)
    close = [_inside(points, worst, reach) for points in (fine, bent)]
    pixels = drawn_as_pixels(outline)
    for axes, (under, over), width, raster in ((whole, (drawn, bent), 3.5, pixels), (near, close, 6.0, False)):
        axes.plot(*under.T, color=_DRAWN, linewidth=width, label="drawing", solid_joinstyle="round",
                  solid_capstyle="butt", rasterized=raster)  # fmt: skip
        axes.plot(*over.T, color=_BENT, linewidth=0.9, label="bent rule", rasterized=raster)
    bends = bent[1:-1][(np.abs(bent[1:-1] - worst) <= reach).all(axis=1)]
    near.plot(*bends.T, linestyle="none", marker="o", markersize=3.0, color=_BENT, label="bends")
    whole.plot(*bent[0], linestyle="none", marker="s", markersize=6, color="#2a9d3a", label="start")
    for axes in (whole, near):
        axes.plot(*worst, linestyle="none", marker="o", markersize=13, markerfacecolor="none", color=_WORST,
                  markeredgewidth=1.5, label=f"largest deviation {deviation:.4f} mm")  # fmt: skip
    middle = 0.5 * (drawn.min(axis=0) + drawn.max(axis=0))
    for axes, centre, around in ((whole, middle, half), (near, worst, np.full(2, reach))):
        axes.set_xlim(centre[0] - around[0], centre[0] + around[0])
        axes.set_ylim(centre[1] - around[1], centre[1] + around[1])
    near.locator_params(nbins=5)
    near.ticklabel_format(useOffset=bool(np.abs(worst).max() > _PLAIN))
    near.set_title("at the largest deviation")
    closing = outline.proof.closing_error
    ends = "open" if closing is None else f"closing error {1e3 * closing:.4f} mm"
    title = (
        f"{outline.program.name}: {outline.plan.bends} bends, {1e3 * outline.proof.rule_length:.1f} mm of rule, {ends}"
    )
    figure.text(_LEFT / _WIDTH, 1 - 0.22 / figure.get_figheight(), title, fontsize="large", va="center")
    handles, labels = near.get_legend_handles_labels()
    start = [(h, t) for h, t in zip(*whole.get_legend_handles_labels(), strict=True) if t == "start"]
    figure.legend(
        [*handles, *(h for h, _ in start)],
        [*labels, *(t for _, t in start)],
        loc="lower center",
        ncols=5,
        frameon=False,
    )
    return figure


def _panels(tall: float) -> tuple[Figure, Axes, Axes]:
    """Place the view of the whole, ``tall`` times as high as wide, and the square close view beside it.

    All places are known beforehand, those of titles and labels too: asking matplotlib to find them takes as long as drawing.
    """
    from matplotlib.figure import Figure

    width = min(_WIDEST, _TALLEST / tall)
    square = min(_WIDTH - width - _LEFT - _BETWEEN - _RIGHT, _TALLEST)
    content = max(width * tall, square)
    height = _BOTTOM + content + _TOP
    figure = Figure(figsize=(_WIDTH, height))
    axes = []
    for left, across, up in ((_LEFT, width, width * tall), (_LEFT + width + _BETWEEN, square, square)):
        low = _BOTTOM + 0.5 * (content - up)
        box = figure.add_axes((left / _WIDTH, low / height, across / _WIDTH, up / height))
        box.set_xlabel("x (mm)")
        box.xaxis.set_label_coords(0.5, -0.3 / up)
        axes.append(box)
    axes[0].set_ylabel("y (mm)")
    axes[0].yaxis.set_label_coords(-0.55 / width, 0.5)
    return figure, axes[0], axes[1]


def _seen(outline: Outline, centre: FloatArray, reach: float) -> NDArray[np.bool_]:
    """Tell which segments may be seen in a square (mm)."""
    points = 1e3 * outline.points - centre
    # an arc stays this near to its chord
    rise = np.where(outline.arcs, 0.5e3 * np.hypot(*outline.chords.T) * np.maximum(1.0, np.abs(outline.bulges)), 0.0)
    low, high = np.minimum(points[:-1], points[1:]) - rise[:, None], np.maximum(points[:-1], points[1:]) + rise[:, None]
    return np.asarray(((low <= reach) & (high >= -reach)).all(axis=1))


def _inside(points: FloatArray, centre: FloatArray, reach: float) -> FloatArray:
    """Those sides of a polyline that may be seen in a square, NaN between stretches."""
    start, end = points[:-1] - centre, points[1:] - centre
    seen = ((np.minimum(start, end) <= reach) & (np.maximum(start, end) >= -reach)).all(axis=1)
    keep = np.concatenate([seen, [False]]) | np.concatenate([[False], seen])
    shown = np.where(keep[:, None], points, np.nan)
    return np.asarray(shown[keep | np.roll(keep, -1)], dtype=np.float64)


def _window(outline: BentOutline, worst: FloatArray) -> float:
    """Half width of the close view (mm): a few sides of the rule."""
    sides = 1e3 * outline.plan.feeds
    at = int(np.argmin(np.hypot(*(1e3 * outline.proof.points - worst).T)))
    near = sides[max(0, at - 1) : at + 1]
    extent = float(np.ptp(1e3 * outline.proof.points, axis=0).max())
    return float(np.clip(1.2 * near.min(initial=extent), 1.0, 0.3 * extent + 1.0))


def _times_figure(outline: BentOutline) -> Figure:
    from matplotlib.figure import Figure

    bent = outline.plan.bends > 0
    height = 5.4 if bent else 3.2
    figure = Figure(figsize=(9.0, height))
    figure.subplots_adjust(left=0.075, right=0.985, bottom=0.5 / height, top=1 - 0.35 / height, hspace=0.08)
    panels = figure.subplots(2 if bent else 1, 1, sharex=True, squeeze=False)[:, 0]
    top = panels[0]
    rows = (
        ("paper, sequential trapezoids", outline.paper_times, "#8d99a6", "--"),
        ("jerk-limited, overlapped", outline.times, _BENT, "-"),
    )
    signs = np.sign(outline.moulds)
    for label, table, colour, dash in rows:
        _plot(top, *_feed_track(table), f"{label}: {table.total:.2f} s in all", colour, dash)
        for axes in panels[1:]:
            _plot(axes, *_mould_track(table, signs), label, colour, dash)
    shown = min(_BENDS_SHOWN, outline.plan.bends)
    part = "" if shown == outline.plan.bends else f", first {shown} bends of {outline.plan.bends}"
    part = part if bent else ", no bends"
    top.set_title(f"{outline.program.name}: time table{part}")
    top.set_ylabel("rule fed (mm)")
    for axes in panels[1:]:
        axes.set_ylabel("mould angle (°)")
    panels[-1].set_xlabel("time (s)")
    top.legend(frameon=False, loc="upper left")
    panels[-1].margins(x=0.01)
    for axes in panels:
        axes.grid(color="#e3e7ec", linewidth=0.6)
        axes.axhline(0, color="#b0b8c0", linewidth=0.6)
    return figure


def _plot(axes: Axes, t: FloatArray, y: FloatArray, label: str, colour: str, dash: str) -> None:
    axes.plot(t, y, dash, color=colour, linewidth=1.4, label=label)


def _feed_track(table: TimeTable) -> tuple[FloatArray, FloatArray]:
    times, values, fed = [], [], 0.0
    for k in range(min(_BENDS_SHOWN + 1, len(table.feed_start))):
        move = table.feeds.take(np.array([k]))
        t = np.linspace(0.0, float(move.time[0]), _PER_MOVE)
        times.append(table.feed_start[k] + t)
        values.append(1e3 * (fed + move.position(t[None, :])[0]))
        fed += float(move.distance[0])
    return np.concatenate(times), np.concatenate(values)


def _mould_track(table: TimeTable, signs: FloatArray) -> tuple[FloatArray, FloatArray]:
    times, values = [np.zeros(1)], [np.zeros(1)]
    for k in range(min(_BENDS_SHOWN, len(table.bend_start))):
        move = table.bends.take(np.array([k]))
        t = np.linspace(0.0, float(move.time[0]), _PER_MOVE)
        angle = signs[k] * np.degrees(move.position(t[None, :])[0])
        times += [table.bend_start[k] + t, table.return_start[k] + t]
        values += [angle, angle[-1] - angle]
    return np.concatenate(times), np.concatenate(values)
