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
_STYLE: dict[Any, Any] = {"svg.hashsalt": "camwright", "svg.fonttype": "path", "font.size": 9.0}
_DRAWN, _BENT, _WORST = "#b9c4d0", "#11304f", "#c1121f"


def draw(outline: BentOutline, directory: Path, name: str) -> None:
    """Write both figures of an outline as SVG and PNG: ``<name>-proof`` and ``<name>-times``."""
    import matplotlib as mpl

    with mpl.rc_context(_STYLE):
        for kind, figure in (("proof", _proof_figure(outline)), ("times", _times_figure(outline))):
            figure.draw_without_rendering()
            figure.set_layout_engine("none")  # laid out once for both files
            figure.savefig(directory / f"{name}-{kind}.svg", metadata={"Date": None, "Creator": None})
            figure.savefig(directory / f"{name}-{kind}.png", dpi=150, metadata={"Software": None})


def outline_path(outline: Outline) -> FloatArray:
    """Return points along an outline, arcs in steps of 3° or less (m)."""
    parts = [outline.points[:1]]
    centres, included = outline.centres, outline.included
    for i in range(len(outline.bulges)):
        steps = max(1, int(np.ceil(abs(included[i]) / np.radians(3.0))))
        if steps > 1:
            turn = included[i] * np.arange(1, steps) / steps
            out = outline.points[i] - centres[i]
            cos, sin = np.cos(turn), np.sin(turn)
            parts.append(centres[i] + np.stack([cos * out[0] - sin * out[1], sin * out[0] + cos * out[1]], axis=1))
        parts.append(outline.points[i + 1 : i + 2])
    return np.vstack(parts)


def _proof_figure(outline: BentOutline) -> Figure:
    from matplotlib.figure import Figure

    drawn, bent, worst = 1e3 * outline_path(outline.plan.outline), 1e3 * outline.proof.points, 1e3 * outline.proof.worst
    deviation = 1e3 * outline.proof.deviation
    size = np.ptp(drawn, axis=0)
    tall = float(np.clip(size[1] / max(size[0], 1e-9), 0.45, 1.1))
    figure = Figure(figsize=(9.0, 1.3 + 5.2 * tall), layout="constrained")
    whole, near = figure.subplots(1, 2, width_ratios=(2, 1))
    for axes, width in ((whole, 3.5), (near, 6.0)):
        axes.plot(*drawn.T, color=_DRAWN, linewidth=width, label="drawing", solid_joinstyle="round")
        axes.plot(*bent.T, color=_BENT, linewidth=0.9, label="bent rule")
        axes.set_aspect("equal", adjustable="box")
        axes.set_xlabel("x (mm)")
    near.plot(*bent[1:-1].T, linestyle="none", marker="o", markersize=3.0, color=_BENT, label="bends")
    whole.plot(*bent[0], linestyle="none", marker="s", markersize=6, color="#2a9d3a", label="start")
    for axes in (whole, near):
        axes.plot(*worst, linestyle="none", marker="o", markersize=13, markerfacecolor="none", color=_WORST,
                  markeredgewidth=1.5, label=f"largest deviation {deviation:.4f} mm")  # fmt: skip
    reach = _window(outline, worst)
    near.set_xlim(worst[0] - reach, worst[0] + reach)
    near.set_ylim(worst[1] - reach, worst[1] + reach)
    near.ticklabel_format(useOffset=False)
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


def _window(outline: BentOutline, worst: FloatArray) -> float:
    """Half width of the close view (mm): a few sides of the rule."""
    sides = 1e3 * outline.plan.feeds
    at = int(np.argmin(np.hypot(*(1e3 * outline.proof.points - worst).T)))
    near = sides[max(0, at - 1) : at + 1]
    extent = float(np.ptp(1e3 * outline.proof.points, axis=0).max())
    return float(np.clip(1.2 * near.min(initial=extent), 1.0, 0.3 * extent + 1.0))


def _times_figure(outline: BentOutline) -> Figure:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9.0, 5.4), layout="constrained")
    top, bottom = figure.subplots(2, 1, sharex=True)
    rows = (
        ("paper: sequential trapezoids", outline.paper_times, "#8d99a6", "--"),
        ("jerk-limited, overlapped", outline.times, _BENT, "-"),
    )
    signs = np.sign(outline.moulds)
    for label, table, colour, dash in rows:
        _plot(top, *_feed_track(table), f"{label}: {table.total:.2f} s in all", colour, dash)
        _plot(bottom, *_mould_track(table, signs), label, colour, dash)
    shown = min(_BENDS_SHOWN, outline.plan.bends)
    part = "" if shown == outline.plan.bends else f", first {shown} bends of {outline.plan.bends}"
    top.set_title(f"{outline.program.name}: time table{part}")
    top.set_ylabel("rule fed (mm)")
    bottom.set_ylabel("mould angle (°)")
    bottom.set_xlabel("time (s)")
    top.legend(frameon=False, loc="upper left")
    bottom.margins(x=0.01)
    for axes in (top, bottom):
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
