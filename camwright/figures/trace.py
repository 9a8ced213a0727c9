"""The figure of a recorded run: command and axis on the design, both beside it, the sync error of each cut, and what the cuts add up to."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from camwright.figures.marks import blank_figure, line_mark, patch_mark
from camwright.figures.style import LIMIT, SHEAR_COLOUR, SYNC_COLOUR, shade_shear_zone, shade_zones
from camwright.house.numbers import with_unit
from camwright.profiles.polynomial.profile import FloatArray
from camwright.studies.recording import RecordedRun
from camwright.validation.recording.cut_errors import sync_parts

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_MOST_POINTS = 20_000
"""Points drawn of a curve over all cycles."""

_MOST_CUTS = 60
"""Cuts whose sync error is drawn."""

_DESIGN: dict[str, Any] = {"color": "black", "linewidth": 0.9, "zorder": 3}
_COMMAND: dict[str, Any] = {"color": "#d55e00", "linewidth": 0.9, "zorder": 2}
_AXIS: dict[str, Any] = {"color": "#0072b2", "linewidth": 0.9, "zorder": 2.5}
_CUT: dict[str, Any] = {"color": "#0072b2", "linestyle": "none", "marker": "o", "markersize": 3.0, "zorder": 3}
_LINE: dict[str, Any] = {"color": "#007a5a", "linewidth": 1.2, "zorder": 2}


def trace_figure(found: RecordedRun) -> Figure:
    """Draw a recorded run over its design."""
    job = found.job
    figure = blank_figure(9.2)
    whole, apart, zone, cuts = figure.subplots(4, 1)
    _positions(whole, found)
    _beside(apart, found)
    for axes in (whole, apart):
        shade_zones(axes, job.cut)
        axes.set_xlim(0.0, job.cut.length * 1e3)
    apart.set_xlabel("master (mm)")
    _zones(zone, found)
    _cuts(cuts, found)
    figure.suptitle(
        f"{job.name}: {len(found.cuts)} recorded cuts at {with_unit(found.run.line_speed, 'm/s')}",
        fontsize=9,
    )
    handles: list[Any] = [
        line_mark(label="design", **_DESIGN),
        line_mark(label="command", **_COMMAND),
        line_mark(label="axis", **_AXIS),
        line_mark(label="sync tolerance", **LIMIT),
        line_mark(label="offset and drift", **_LINE),
        patch_mark(facecolor=SYNC_COLOUR, label="sync zone"),
        patch_mark(facecolor=SHEAR_COLOUR, edgecolor="#8c8c8c", hatch="////", linewidth=0, label="shear zone"),
    ]
    figure.legend(handles=handles, loc="outside lower center", ncols=4)
    return figure


def _folded(found: RecordedRun) -> tuple[FloatArray, FloatArray]:
    """Master position within the cycle (m), not a number where a cycle ends, and the cycle's number."""
    length = found.job.cut.length
    cycle = np.floor(found.run.master / length)
    place = found.run.master - cycle * length
    place[1:][np.diff(cycle) != 0.0] = np.nan
    return place, cycle


def _positions(axes: Axes, found: RecordedRun) -> None:
    """Draw command and axis over the master, all cycles over one another, on the design."""
    factor, unit = _slave(found)
    place, cycle = _folded(found)
    grid = np.linspace(found.profile.start, found.profile.end, 801)
    axes.plot(grid * 1e3, found.profile(grid) * factor, **_DESIGN)
    for signal, look in ((found.run.command, _COMMAND), (found.run.axis, _AXIS)):
        values = signal - cycle * found.profile.advance
        axes.plot(_thin(place) * 1e3, _thin(values) * factor, **look)
    axes.set_ylabel(f"slave ({unit})")
    axes.set_title("command and axis over the master, all cycles")


def _beside(axes: Axes, found: RecordedRun) -> None:
    """Draw command and axis less the design."""
    factor, unit = _slave(found)
    place, _ = _folded(found)
    design = found.profile(found.run.master, outside="repeat")
    for signal, look in ((found.run.axis, _AXIS), (found.run.command, _COMMAND)):
        axes.plot(_thin(place) * 1e3, _thin(signal - design) * factor, **{**look, "linewidth": 0.6})
    axes.set_ylabel(f"off the design ({unit})")
    axes.set_title("command and axis less the design")


def _zones(axes: Axes, found: RecordedRun) -> None:
    """Draw the sync error of each cut over the sync zone."""
    job, cut = found.job, found.job.cut
    parts = sync_parts(found.run, found.profile, job.task, 0.0, cut.sync_zone)
    for _, part in parts[:: max(1, -(-len(parts) // _MOST_CUTS))]:
        axes.plot(part.along * 1e3, part.error * 1e3, **{**_AXIS, "linewidth": 0.5})
    shade_shear_zone(axes, cut.shear_zone_at, min(cut.shear_zone_at + cut.shear_zone, cut.sync_zone))
    _tolerance(axes, found)
    size = max([abs(each.greatest) for each in found.cuts] + [cut.sync_tolerance])
    axes.set_ylim(-1.4e3 * size, 1.4e3 * size)
    axes.set_xlim(0.0, cut.sync_zone * 1e3)
    axes.set_xlabel("master from the start of the sync zone (mm)")
    axes.set_ylabel("sync error (mm)")
    axes.set_title("tool less material in the sync zone, every cut")


def _cuts(axes: Axes, found: RecordedRun) -> None:
    """Draw the error of each cut, and the line of offset and drift through them."""
    total = found.total
    numbers = np.array([cut.number for cut in found.cuts], dtype=np.float64)
    axes.plot(numbers, [cut.error * 1e3 for cut in found.cuts], **_CUT)
    middle = numbers - numbers.mean()
    axes.plot(numbers, (total.offset + (total.drift or 0.0) * middle) * 1e3, **_LINE)
    _tolerance(axes, found)
    axes.set_xlabel("cut")
    axes.set_ylabel("sync error (mm)")
    axes.set_title("mean over the shear zone, cut by cut")
    axes.locator_params(axis="x", integer=True)


def _tolerance(axes: Axes, found: RecordedRun) -> None:
    for sign in (-1.0, 1.0):
        axes.axhline(sign * found.job.cut.sync_tolerance * 1e3, **LIMIT)


def _slave(found: RecordedRun) -> tuple[float, str]:
    """Factor and unit of the slave as it is drawn."""
    return (1e3, "mm") if found.job.machine.slave_unit == "m" else (180.0 / np.pi, "°")


def _thin(values: FloatArray) -> FloatArray:
    return values[:: max(1, len(values) // _MOST_POINTS)]
