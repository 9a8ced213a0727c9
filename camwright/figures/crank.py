"""The crank figure, after S3: crank to carriage, master to carriage, and the servo curve of the optimum and of the table."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from camwright.figures.marks import blank_figure, line_mark, patch_mark
from camwright.figures.profile import curve
from camwright.figures.style import (
    LINES,
    SHEAR_COLOUR,
    SYNC_COLOUR,
    shade_zones,
    title,
)
from camwright.jobs.machine_words import machine_words
from camwright.profiles.task import Task
from camwright.studies.comparison import Comparison

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch


TABULATED = "crank_tabulated"

STYLES: dict[str, dict[str, Any]] = {
    "optimised": LINES["optimised"],
    TABULATED: {"color": "#a0522d", "linestyle": (0, (3, 1.5)), "linewidth": 1.2, "zorder": 3},
}
"""Look of the two profiles drawn."""

_ANGLES = 721
"""Points drawn of the crank's turn."""


def crank_figure(comparison: Comparison) -> Figure:
    """Draw the maps of a crank and the running curve of its servo.

    Parameters
    ----------
    comparison
        Profiles of a job whose machine is a crank with its sync zone placed; the optimised one and the tabulated one are drawn.

    Raises
    ------
    TypeError
        The machine's tool has no dead centres.
    """
    job = comparison.job
    machine, cut = job.machine, job.cut
    if machine.dead_centres is None:
        raise TypeError(f"the crank figure is about a tool that turns back, not a {type(machine).__name__}")
    shown = {row.name: row.profile for row in comparison.rows if row.name in STYLES}
    figure = blank_figure(7.6)
    grid = figure.add_gridspec(3, 2, height_ratios=(1.15, 1.0, 1.0))
    turn, travel = figure.add_subplot(grid[0, 0]), figure.add_subplot(grid[0, 1])
    speed = figure.add_subplot(grid[1, :])
    acceleration = figure.add_subplot(grid[2, :], sharex=speed)
    _turn(turn, job.task, machine.dead_centres)
    for axes in (travel, speed, acceleration):
        shade_zones(axes, cut)
        axes.set_xlim(0.0, cut.length * 1e3)
    rpm, radians = machine.motor_ratio * cut.line_speed * 30 / np.pi, machine.motor_ratio * cut.line_speed**2
    start = job.task.slave_at_start
    back = float(machine.tool(machine.dead_centres[0]))
    for name in (name for name in STYLES if name in shown):
        profile = shown[name]
        x, y = curve(profile, 0)
        place = machine.tool(start + y - float(profile(profile.start))) - back
        travel.plot(x * 1e3, place * 1e3, **STYLES[name])
        x, ratio = curve(profile, 1)
        speed.plot(x * 1e3, rpm * ratio, **STYLES[name])
        x, slope = curve(profile, 2)
        acceleration.plot(x * 1e3, radians * slope, **STYLES[name])
    speed.axhline(0.0, color="black", linewidth=0.8)
    speed.set_ylim(bottom=min(0.0, speed.get_ylim()[0]) - 0.04 * speed.get_ylim()[1])
    travel.set_title("master to carriage")
    travel.set_xlabel("master position x (mm)")
    travel.set_ylabel("carriage position (mm)")
    speed.set_title("servo curve")
    speed.set_ylabel("servo speed (rpm)")
    acceleration.set_ylabel("servo acceleration (rad/s²)")
    acceleration.set_xlabel("master position x (mm)")
    figure.align_ylabels([speed, acceleration])
    figure.suptitle(
        f"{job.name}: {machine_words(machine, digits=6)}, gear {machine.motor_ratio:g}",
        fontsize=9.5,
    )
    handles: list[Line2D | Patch] = [line_mark(label=title(name), **STYLES[name]) for name in STYLES if name in shown]
    handles += [
        patch_mark(facecolor=SYNC_COLOUR, label="sync zone"),
        patch_mark(facecolor=SHEAR_COLOUR, edgecolor="#8c8c8c", hatch="////", linewidth=0, label="shear zone"),
    ]
    figure.legend(handles=handles, loc="outside lower center", ncols=4)
    return figure


def _turn(axes: Axes, task: Task, dead_centres: tuple[float, float]) -> None:
    """Draw the carriage over one turn of the crank from its back dead centre, with the zones on the crank and their ends."""
    machine, cut = task.machine, task.cut
    back, front = dead_centres
    angle = np.linspace(back, back + 2 * np.pi, _ANGLES)
    lowest = float(machine.tool(back))
    axes.plot(np.degrees(angle), (machine.tool(angle) - lowest) * 1e3, color="black", linewidth=1.3)
    sync, start = task.sync, task.slave_at_sync_start
    shear = (cut.shear_zone_at, min(cut.shear_zone_at + cut.shear_zone, cut.sync_zone))
    ends = start + sync(np.array([0.0, cut.sync_zone, *shear]))
    first, last, cut_first, cut_last = np.degrees(ends)
    axes.axvspan(first, last, color=SYNC_COLOUR, linewidth=0, zorder=0)
    if cut_last > cut_first:
        axes.axvspan(
            cut_first, cut_last, facecolor=SHEAR_COLOUR, edgecolor="#8c8c8c", hatch="////", linewidth=0, zorder=0.5
        )
    places = (machine.tool(ends[:2]) - lowest) * 1e3
    axes.plot([first, last], places, linestyle="none", marker="o", color="black", markersize=4)
    axes.axvline(np.degrees(front), color="#8c8c8c", linewidth=0.8, zorder=0.5)
    axes.set_xlim(np.degrees(back), np.degrees(back) + 360)
    axes.set_xticks(np.arange(0, 361, 60))
    axes.set_title("crank to carriage")
    axes.set_xlabel(
        f"crank angle (°)\nsync zone {first:.1f}° to {last:.1f}°, carriage {places[0]:.1f} to {places[1]:.1f} mm"
    )
    axes.set_ylabel("carriage position (mm)")
