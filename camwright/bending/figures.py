"""Figures: the bent rule over the drawing, and the time table beside the paper's."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

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

MOST_VECTORS = 5000
"""Sides of the rule from which on the lines of the whole view are drawn as pixels."""

_STYLE: dict[Any, Any] = {"svg.hashsalt": "camwright", "svg.fonttype": "path", "font.size": 9.0}
_DRAWN, _BENT, _WORST = "#b9c4d0", "#11304f", "#c1121f"


def draw(outline: BentOutline, directory: Path, name: str) -> None:
    """Write both figures of an outline as SVG and PNG: ``<name>-proof`` and ``<name>-times``."""
    import matplotlib as mpl

    with mpl.rc_context(_STYLE):
        for kind, figure in (("proof", _proof_figure(outline)), ("times", _times_figure(outline))):
            if figure.get_layout_engine() is not None:
                figure.draw_without_rendering()
                figure.set_layout_engine("none")  # laid out once for both files
            figure.savefig(directory / f"{name}-{kind}.svg", metadata={"Date": None, "Creator": None}, dpi=150)
            figure.savefig(directory / f"{name}-{kind}.png", dpi=150, metadata={"Software": None})


def drawn_as_pixels(outline: BentOutline) -> bool:
    """Tell whether the rule has too many sides for lines in the whole view."""
    return outline.plan.bends >= MOST_VECTORS


def outline_path(outline: Outline, coarseness: float) -> FloatArray:
    """Return points along an outline (m), arcs as chords within a distance of them (m)."""
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
    from matplotlib.figure import Figure

    bent, worst, deviation = 1e3 * outline.proof.points, 1e3 * outline.proof.worst, 1e3 * outline.proof.deviation
    drawn = 1e3 * outline_path(outline.plan.outline, 1e-3 * float(np.ptp(bent, axis=0).max()) / _FINENESS)
    size = np.ptp(drawn, axis=0)
    tall = float(np.clip(size[1] / max(size[0], 1e-9), 0.45, 1.1))
    figure = Figure(figsize=(9.0, 1.3 + 5.2 * tall), layout="constrained")
    whole, near = figure.subplots(1, 2, width_ratios=(2, 1))
    reach = _window(outline, worst)
    fine = 1e3 * outline_path(outline.plan.outline, 1e-3 * reach / _FINENESS)
    close = [_inside(points, worst, reach) for points in (fine, bent)]
    pixels = drawn_as_pixels(outline)
    for axes, (under, over), width, raster in ((whole, (drawn, bent), 3.5, pixels), (near, close, 6.0, False)):
        axes.plot(*under.T, color=_DRAWN, linewidth=width, label="drawing", solid_joinstyle="round",
                  solid_capstyle="butt", rasterized=raster, in_layout=False)  # fmt: skip
        axes.plot(*over.T, color=_BENT, linewidth=0.9, label="bent rule", rasterized=raster, in_layout=False)
        axes.set_aspect("equal", adjustable="box")
        axes.set_xlabel("x (mm)")
    bends = bent[1:-1][(np.abs(bent[1:-1] - worst) <= reach).all(axis=1)]
    near.plot(*bends.T, linestyle="none", marker="o", markersize=3.0, color=_BENT, label="bends")
    whole.plot(*bent[0], linestyle="none", marker="s", markersize=6, color="#2a9d3a", label="start")
    for axes in (whole, near):
        axes.plot(*worst, linestyle="none", marker="o", markersize=13, markerfacecolor="none", color=_WORST,
                  markeredgewidth=1.5, label=f"largest deviation {deviation:.4f} mm")  # fmt: skip
    near.set_xlim(worst[0] - reach, worst[0] + reach)
    near.set_ylim(worst[1] - reach, worst[1] + reach)
    near.ticklabel_format(useOffset=False)
    near.locator_params(nbins=5)
    near.set_title("at the largest deviation")
    whole.set_ylabel("y (mm)")
    middle = 0.5 * (drawn.min(axis=0) + drawn.max(axis=0))
    half = 0.56 * np.maximum(size, 0.35 * size.max())  # a straight line gets some room beside it
    whole.set_xlim(middle[0] - half[0], middle[0] + half[0])
    whole.set_ylim(middle[1] - half[1], middle[1] + half[1])
    closing = outline.proof.closing_error
    ends = "open" if closing is None else f"closing error {1e3 * closing:.4f} mm"
    whole.set_title(
        f"{outline.program.name}: {outline.plan.bends} bends, {1e3 * outline.proof.rule_length:.1f} mm of rule, {ends}"
    )
    handles, labels = near.get_legend_handles_labels()
    start = [(h, t) for h, t in zip(*whole.get_legend_handles_labels(), strict=True) if t == "start"]
    figure.legend(
        [*handles, *(h for h, _ in start)],
        [*labels, *(t for _, t in start)],
        loc="outside lower center",
        ncols=5,
        frameon=False,
    )
    return figure


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
