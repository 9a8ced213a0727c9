"""The servo figure: the axis against the ideal sync line, and the sync error over the sync zone, at every phase."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from camwright.figures.marks import blank_figure, line_mark, patch_mark
from camwright.figures.style import (
    LIMIT,
    LINES,
    SHEAR_COLOUR,
    shade_shear_zone,
    title,
)
from camwright.house.numbers import with_unit
from camwright.profiles.polynomial.profile import FloatArray
from camwright.studies.comparison import Comparison
from camwright.studies.measured import Measured
from camwright.validation.servo.axis_run import ServoRun
from camwright.validation.servo.response import ServoResponse, sync_error

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch


AXES = ("linear_return", "optimised")
"""Profiles whose axis is drawn."""

_MOST_POINTS = 4000
"""Points drawn of a sampling phase; far more than a printed line shows."""

_BEFORE, _AFTER = 0.15, 0.6
"""Part of the sync zone drawn before and after its start, where the axis meets the line."""

_CLOSE = 6.0
"""Half height of the close view of the sync error, as a multiple of the sync tolerance."""

_CROSSING: dict[str, Any] = {"marker": "o", "markerfacecolor": "white", "markersize": 5, "zorder": 6}
_SETTLING: dict[str, Any] = {"marker": "D", "markersize": 4.5, "zorder": 6}


def servo_figure(comparison: Comparison, runs: Mapping[str, ServoRun]) -> Figure:
    """Draw what the job's servo makes of the linear return and of the optimised profile.

    Parameters
    ----------
    comparison
        Holds the job, the profiles and their measured responses.
    runs
        The simulated responses, by the names in `AXES`.
    """
    job = comparison.job
    figure = blank_figure(8.2)
    grid = figure.add_gridspec(3, 2, height_ratios=(1.15, 1.0, 1.0))
    left = figure.add_subplot(grid[0, 0])
    right = figure.add_subplot(grid[0, 1], sharex=left, sharey=left)
    whole = figure.add_subplot(grid[1, :])
    close = figure.add_subplot(grid[2, :], sharex=whole)
    for axes, name in zip((left, right), AXES, strict=True):
        _meeting(axes, comparison[name], comparison, runs[name])
        axes.set_title(title(name))
        axes.set_xlabel("master from the start of the sync zone (mm)")
    left.set_ylabel(f"{'slave' if job.task.straight else 'tool'} from there (mm)")
    zone, shear = job.cut.sync_zone, (job.cut.shear_zone_at, job.cut.shear_zone_at + job.cut.shear_zone)
    for axes in (whole, close):
        shade_shear_zone(axes, *shear)
        for name in AXES:
            _errors(axes, comparison[name], comparison, runs[name])
        for sign in (-1.0, 1.0):
            axes.axhline(sign * job.cut.sync_tolerance * 1e3, **LIMIT)
        axes.set_ylabel("sync error (mm)")
    whole.set_title(
        "axis minus ideal sync line\n" + _findings([(title(name), comparison[name].response) for name in AXES])
    )
    close.set_title("the same, close to the tolerance")
    close.set_ylim(-_CLOSE * job.cut.sync_tolerance * 1e3, _CLOSE * job.cut.sync_tolerance * 1e3)
    close.set_xlim(0.0, zone * 1e3)
    close.set_xlabel("master from the start of the sync zone (mm)")
    servo = job.servo
    figure.suptitle(
        f"{job.name}: the servo at {with_unit(job.cut.line_speed, 'm/s')}, all {runs[AXES[0]].phases} sampling phases\n"
        f"(ω = {servo.bandwidth:g} rad/s, ζ = {servo.damping:g}, K = {servo.position_gain:g} 1/s, "
        f"ΔT = {with_unit(servo.sample_time, 's')}, α = {servo.velocity_feedforward:g})",
        fontsize=8.5,
    )
    _legend(figure)
    return figure


def _phases(axes: Axes, name: str, curves: Sequence[tuple[FloatArray, FloatArray]]) -> None:
    """Draw the curve of each sampling phase: the first in the profile's own line, the others thin beside it.

    The others are one line with gaps: every line is clipped by itself, which costs more than to draw it.
    """
    axes.plot(*map(_stride, curves[0]), **LINES[name])
    gap = np.array([np.nan])
    parts = [np.concatenate([part for curve in curves[1:] for part in (_stride(curve[i]), gap)]) for i in (0, 1)]
    axes.plot(*parts, **{**LINES[name], "linestyle": "-", "linewidth": 0.4})


def _meeting(axes: Axes, row: Measured, comparison: Comparison, run: ServoRun) -> None:
    """Draw ideal line, command and axis at the tool around the start of the sync zone, from the material's point there."""
    cut, machine = comparison.job.cut, comparison.job.machine
    start = cut.return_start + cut.return_zone
    first = max(-_BEFORE * cut.sync_zone, -cut.return_zone)
    last = _AFTER * cut.sync_zone
    origin = float(row.profile(start, outside="repeat"))
    there = comparison.job.task.slave_at_sync_start

    def tool(slave: FloatArray) -> FloatArray:
        return np.asarray(machine.tool(there + slave - origin) - machine.tool(there)) * 1e3

    shown = (run.master >= start + first) & (run.master <= start + last)
    pieces = [np.nonzero(row_shown)[0] for row_shown in shown]
    line = cut.sync_ratio * 1e3
    axes.plot([first * 1e3, last * 1e3], [first * line, last * line], color="black", linewidth=0.9, zorder=1)
    _phases(
        axes,
        row.name,
        [
            ((run.master[phase, index] - start) * 1e3, tool(run.axis[phase, index]))
            for phase, index in enumerate(pieces)
        ],
    )
    index = pieces[0]  # the command is the same at every phase
    axes.plot(
        _stride((run.master[0, index] - start) * 1e3),
        _stride(tool(run.command[0, index])),
        color="#6b6b6b",
        linestyle=(0, (1, 1)),
        linewidth=1.3,
        zorder=1.5,
    )
    crossing = row.response.crossing
    if crossing is not None and crossing <= last:
        at = crossing * 1e3
        there_on_line = (at, at * cut.sync_ratio)
        axes.plot(*there_on_line, color=LINES[row.name]["color"], linestyle="none", **_CROSSING)
        axes.annotate(f"{at:.1f} mm", there_on_line, xytext=(-6, 6), textcoords="offset points", ha="right", fontsize=8)
    axes.axvline(0.0, color="#8c8c8c", linewidth=0.8, zorder=0.5)


def _stride(values: FloatArray) -> FloatArray:
    """Take as many points as a line needs."""
    return values[:: max(1, len(values) // _MOST_POINTS)]


def _errors(axes: Axes, row: Measured, comparison: Comparison, run: ServoRun) -> None:
    """Draw the sync error of every phase, crossing and settling marked on the line of the axis."""
    job = comparison.job
    start = job.cut.return_start + job.cut.return_zone
    master, error, _ = sync_error(run, row.profile, job.task, start, start + job.cut.sync_zone)
    _phases(axes, row.name, [((master[phase] - start) * 1e3, error[phase] * 1e3) for phase in range(run.phases)])
    colour = LINES[row.name]["color"]
    crossing, settling = row.response.crossing, row.response.settling
    if crossing is not None:
        axes.plot([crossing * 1e3], [0.0], color=colour, linestyle="none", **_CROSSING)
    if settling is not None:
        there = [float(np.interp(settling, x - start, y)) for x, y in zip(master, error, strict=True)]
        axes.plot([settling * 1e3], [max(there, key=abs) * 1e3], color=colour, linestyle="none", **_SETTLING)


def _findings(rows: list[tuple[str, ServoResponse]]) -> str:
    """Write crossing, overshoot and settling length of each profile, one a line."""
    lines = []
    for name, response in rows:
        crossing, settling = response.crossing, response.settling
        lines.append(
            f"{name}: "
            + ("no crossing in the zone" if crossing is None else f"crossing {crossing * 1e3:.1f} mm")
            + f", overshoot {response.overshoot * 1e3:.2f} mm, "
            + ("not settled in the zone" if settling is None else f"settled after {settling * 1e3:.1f} mm")
        )
    return "\n".join(lines)


def _legend(figure: Figure) -> None:
    handles: list[Line2D | Patch] = [line_mark(label=f"axis, {title(name)}", **LINES[name]) for name in AXES]
    handles += [
        line_mark(color="black", linewidth=0.9, label="ideal sync line"),
        line_mark(color="#6b6b6b", linestyle=(0, (1, 1)), linewidth=1.3, label="command"),
        line_mark(color="#444444", linestyle="none", label="crossing (latest phase)", **_CROSSING),
        line_mark(color="#444444", linestyle="none", label="settled (latest phase)", **_SETTLING),
        line_mark(label="sync tolerance", **LIMIT),
        patch_mark(facecolor=SHEAR_COLOUR, edgecolor="#8c8c8c", hatch="////", linewidth=0, label="shear zone"),
    ]
    figure.legend(handles=handles, loc="outside lower center", ncols=4)
