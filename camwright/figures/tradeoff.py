"""The trade-off figure: what each objective and each law costs, peak acceleration over torque and over jerk."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from camwright.figures.labels import label_points
from camwright.figures.marks import blank_figure, line_mark
from camwright.figures.saving import written
from camwright.figures.style import (
    LINES,
    SYNC_COLOUR,
    title,
)
from camwright.profiles.objective import CommandObjective
from camwright.studies.tradeoff import Row, TradeOff, words

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure


_SAME = 2e-3
"""Share of the panel within which points count as one and share a label."""

_WIDE = 4.0
"""Greatest over least value from which an axis is logarithmic."""

_ROOM = 0.12
"""Room at both ends of an axis, as a part of what it spans."""

_STRIP = 0.27
"""Width of the strip of unbounded values, as a part of the rest."""

_STYLES: dict[str, dict[str, Any]] = {
    "objective": {"marker": "o", "color": LINES["optimised"]["color"], "label": "optimum of an objective"},
    "baseline": {"marker": "s", "color": "#8c8c8c", "markersize": 6.5, "label": "baseline"},
    "beyond": {"marker": "x", "color": "#555555", "label": "baseline that breaks a limit"},
}


def tradeoff_figures(result: TradeOff, directory: Path) -> list[Path]:
    """Write the figure of a trade-off: ``tradeoff.svg`` and ``tradeoff.png`` in an existing directory."""
    return written(lambda: tradeoff_figure(result), directory, "tradeoff")


def tradeoff_figure(result: TradeOff) -> Figure:
    """Draw all profiles of a trade-off as points: peak acceleration over RMS torque, or RMS acceleration, and over peak jerk.

    Profiles of unbounded jerk stand beyond a line at the right edge; those of unbounded acceleration are named below.

    Parameters
    ----------
    result
        The trade-off.
    """
    bounded = [row for row in result.rows if row.values["peak_acceleration"] is not None]
    figure = blank_figure(7.6)
    upper, lower = figure.subplots(2, 1, sharey=True)
    heating: CommandObjective = "rms_torque" if "rms_torque" in result.measures else "rms_acceleration"
    panels: list[tuple[Axes, CommandObjective]] = [(upper, heating), (lower, "peak_jerk")]
    for axes, measure in panels:
        _scales(axes, [row.values[measure] for row in bounded], [row.values["peak_acceleration"] for row in bounded])
        axes.set_xlabel(f"{words(measure)} ({_unit(result, measure)})")
        axes.set_ylabel(f"peak acceleration ({_unit(result, 'peak_acceleration')})")
    figure.suptitle(f"{result.job.name}: what each objective costs", fontsize=9.5)
    unbounded = [_label(row) for row in result.rows if row.values["peak_acceleration"] is None]
    if unbounded:
        lower.set_xlabel(f"{lower.get_xlabel()}\nnot drawn, with an unbounded acceleration: {', '.join(unbounded)}")
    kinds = [kind for kind in _STYLES if any(_kind(row) == kind for row in bounded)]
    figure.legend(handles=[line_mark(**_marker(kind)) for kind in kinds], loc="outside lower center", ncols=3)
    for axes, measure in panels:
        _draw(axes, bounded, measure)
    return figure


def _unit(result: TradeOff, measure: CommandObjective) -> str:
    return result.unit(measure).replace("^2", "²").replace("^3", "³").replace(" ", "·")


def _kind(row: Row) -> str:
    return row.kind if row.within_limits or row.kind == "objective" else "beyond"


def _marker(kind: str) -> dict[str, Any]:
    """Look of a point: filled circles, open squares and crosses differ without colour."""
    style = _STYLES[kind]
    filled = style["color"] if kind == "objective" else "none"
    return {"linestyle": "none", "markersize": 4.5, "markerfacecolor": filled, **style}


def _label(row: Row) -> str:
    """Name of a point: what is least in it, or the law."""
    if row.kind == "objective":
        return f"minimised {words(row.name)}"
    return title(row.name).split(" (")[0].split(",")[0]


def _scales(axes: Axes, x: Sequence[float | None], y: Sequence[float | None]) -> None:
    """Set scales and limits of a panel, with room for labels; unbounded values get a strip of their own at the right."""
    finite = [value for value in x if value is not None]
    low, high, wide = _range(finite)
    bottom, top, tall = _range([value for value in y if value is not None])
    low, high = _widened(low, high, wide)
    if tall:
        axes.set_yscale("log")
        _plain(axes.yaxis, np.inf)
    if wide:
        axes.set_xscale("log")
        _plain(axes.xaxis, high)
    axes.set_ylim(*_widened(bottom, top, tall))
    if len(finite) < len(x):
        edge = high
        high = high * (high / low) ** _STRIP if wide else high + _STRIP * (high - low)
        axes.axvspan(edge, high, facecolor=SYNC_COLOUR, edgecolor="none", zorder=1)
        axes.axvline(edge, color="black", linewidth=0.8)
        axes.text(0.99, 0.985, "unbounded", transform=axes.transAxes, ha="right", va="top", fontsize=7)
    axes.set_xlim(low, high)


def _plain(axis: Axis, last: float) -> None:
    """Write the numbers of a logarithmic axis plainly, none beyond the last."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

    axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0), numticks=40))
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}" if value <= last else ""))
    axis.set_minor_locator(NullLocator())


def _widened(low: float, high: float, logarithmic: bool) -> tuple[float, float]:
    """Limits with room for points and labels at both ends."""
    if logarithmic:
        factor = (high / low) ** _ROOM
        return low / factor, high * factor
    return low - _ROOM * (high - low), high + _ROOM * (high - low)


def _range(values: Sequence[float]) -> tuple[float, float, bool]:
    """Least and greatest value, apart where all are the same, and whether they need a logarithmic scale."""
    least, greatest = min(values, default=0.9), max(values, default=1.1)
    if greatest - least <= 1e-3 * greatest:
        spread = 0.1 * greatest or 1.0
        return least - spread, greatest + spread, False
    return least, greatest, least > 0.0 and greatest > _WIDE * least


def _draw(axes: Axes, rows: Sequence[Row], measure: CommandObjective) -> None:
    """Draw the points of a panel and label them; those at one place share a label."""
    figure = axes.get_figure(root=True)
    assert figure is not None  # noqa: S101 - axes belong to a figure
    figure.draw_without_rendering()  # settles the layout, and with it what points and labels cover
    strip = axes.transData.inverted().transform(axes.transAxes.transform((1.0 - 0.5 * _STRIP / (1.0 + _STRIP), 0.0)))[0]
    groups: list[tuple[np.ndarray, np.ndarray, list[str]]] = []
    for row in rows:
        value = row.values[measure]
        point = np.array([strip if value is None else value, row.values["peak_acceleration"]], dtype=float)
        axes.plot(*point, **{**_marker(_kind(row)), "label": None, "zorder": 5 if row.kind == "objective" else 4})
        place = axes.transAxes.inverted().transform(axes.transData.transform(point))
        near = next((group for group in groups if np.abs(group[1] - place).max() <= _SAME), None)
        if near is None:
            groups.append((point, place, [_label(row)]))
        else:
            near[2].append(_label(row))
    walls = [
        float(np.asarray(line.get_xdata())[0]) for line in axes.lines if list(np.asarray(line.get_ydata())) == [0, 1]
    ]
    label_points(
        axes, np.array([point for point, _, _ in groups]), ["\n".join(names) for _, _, names in groups], walls=walls
    )
