"""The profile figure: travel, ratio, acceleration and jerk over the master, zones shaded, limits marked."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from camwright.figures.marks import blank_figure, line_mark, patch_mark
from camwright.figures.style import (
    LIMIT,
    LINES,
    SHEAR_COLOUR,
    SYNC_COLOUR,
    shade_zones,
    title,
)
from camwright.house.numbers import with_unit
from camwright.profiles.machines import Machine
from camwright.profiles.objective import OBJECTIVES
from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.profiles.task import Task
from camwright.studies.comparison import Comparison
from camwright.validation.motion import RATIO_JUMP, SLOPE_JUMP, slope_scale

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch


_POINTS = 48
"""Points drawn of a piece; the ends of pieces are drawn from both sides."""

_FAR = 4.0
"""A limit is drawn as a line if it is at most this many times the greatest value drawn, else named in words."""

_NOTHING = 1e-9
"""Values below this part of a limit are rounding: the limits alone are drawn."""

_ROOM = 1.18
"""Height of a panel, as a multiple of what it holds."""


def profile_figure(comparison: Comparison) -> Figure:
    """Draw the optimised profile beside the linear return and the quintic.

    Where a derivative is unbounded, arrows stand at the jump instead of a value; they point the way of the jump.

    Parameters
    ----------
    comparison
        Holds the job and the profiles; those of `camwright.figures.style.LINES` are drawn.
    """
    task = comparison.job.task
    cut, limits, machine = task.cut, task.limits, task.machine
    v = cut.line_speed
    figure = blank_figure(8.0)
    travel, ratio, acceleration, jerk = figure.subplots(4, 1, sharex=True)
    shown = {row.name: row.profile for row in comparison.rows if row.name in LINES}
    for axes in (travel, ratio, acceleration, jerk):
        shade_zones(axes, cut)
    for name, profile in shown.items():
        x, y = curve(profile, 0)
        travel.plot(x * 1e3, _travel(x, y, task), **LINES[name])
        for axes, order, factor in ((ratio, 1, 1.0), (acceleration, 2, v**2), (jerk, 3, v**3)):
            x, value = curve(profile, order)
            axes.plot(x * 1e3, value * factor, **LINES[name])
    _limits(ratio, (task.least_ratio, task.greatest_ratio))
    _limits(acceleration, (-limits.acceleration, limits.acceleration))
    _limits(jerk, (-limits.jerk, limits.jerk))
    for name, profile in shown.items():
        _arrows(acceleration, jerk, name, profile)
    if machine.guide is not None:
        for end in machine.guide:
            travel.axhline(end * 1e3, **LIMIT)
    travel.set_ylabel(_travel_label(machine))
    unit = machine.slave_unit
    ratio.set_ylabel("ratio k = dy/dx" if unit == "m" else "ratio dy/dx (rad/m)")
    acceleration.set_ylabel(f"acceleration ({unit}/s²)")
    jerk.set_ylabel(f"jerk ({unit}/s³)")
    jerk.set_xlabel("master position x (mm)")
    jerk.set_xlim(0.0, cut.length * 1e3)
    figure.align_ylabels()
    figure.suptitle(
        f"{comparison.job.name}: {with_unit(cut.length, 'm')} at {with_unit(v, 'm/s')}, "
        f"minimised: {OBJECTIVES[comparison.job.objective].words}",
        fontsize=9.5,
    )
    _legend(figure, shown)
    return figure


def _travel(x: FloatArray, y: FloatArray, task: Task) -> FloatArray:
    """Give what the first panel draws: the correction ``y - x`` (mm), a carriage's place (mm), or an angle minus an even turn (deg)."""
    machine = task.machine
    if machine.slave_unit == "rad":
        return np.asarray(np.degrees(y - machine.pitch / task.cut.length * x))
    if machine.turns_back:
        return np.asarray(task.slave_at_start + y - y[0]) * 1e3
    return (y - x) * 1e3


def _travel_label(machine: Machine) -> str:
    """Label of the first panel."""
    if machine.slave_unit == "rad":
        return "y − even turn (°)"
    return f"{machine.noun} y (mm)" if machine.turns_back else "y − x (mm)"


def curve(profile: CamProfile, order: int) -> tuple[FloatArray, FloatArray]:
    """Points of a derivative over the master (m), every piece from its first to its last break."""
    part = np.linspace(0.0, 1.0, _POINTS + 1)
    x = profile.breaks[:-1, None] + np.diff(profile.breaks)[:, None] * part
    x[:, -1] = profile.breaks[1:]
    value = profile(x, order)
    value[:, -1] = profile(x[:, -1], order, side="left")
    return x.ravel(), value.ravel()


def _limits(axes: Axes, bounds: tuple[float, float]) -> None:
    """Mark limits as lines, or name those that lie far beyond all that is drawn; leave room around the curves."""
    values = np.concatenate([np.asarray(line.get_ydata(), dtype=float) for line in axes.lines])
    least, greatest = float(values.min()), float(values.max())
    reach = max(abs(least), abs(greatest))
    if reach <= _NOTHING * bounds[1]:
        reach = bounds[1]
    drawn = [bound for bound in bounds if abs(bound) <= _FAR * reach]
    least, greatest = min([least, *drawn]), max([greatest, *drawn])
    middle, half = 0.5 * (least + greatest), 0.5 * (greatest - least) * _ROOM
    axes.set_ylim(middle - half, middle + half)
    for bound in drawn:
        axes.axhline(bound, **LIMIT)
    if bounds[1] > _FAR * reach:
        text = f"limit {bounds[1]:g}: off scale" if drawn else f"limits ±{bounds[1]:g}: off scale"
        axes.text(1.0, 1.015, text, transform=axes.transAxes, ha="right", va="bottom", fontsize=7)


def _arrows(acceleration: Axes, jerk: Axes, name: str, profile: CamProfile) -> None:
    """Mark where acceleration or jerk is unbounded: at jumps of the ratio, or of the ratio slope."""
    at = profile.breaks[1:] * 1e3
    ratio, slope = profile.jumps(1), profile.jumps(2)
    steep = np.abs(ratio) > RATIO_JUMP
    for x, up in zip(at[steep], ratio[steep] > 0, strict=True):
        _arrow(acceleration, name, float(x), up=bool(up))
    for x in at[steep | (np.abs(slope) > SLOPE_JUMP * slope_scale(profile))]:
        _arrow(jerk, name, float(x), up=True)
        _arrow(jerk, name, float(x), up=False)


def _arrow(axes: Axes, name: str, x: float, *, up: bool) -> None:
    """Draw one arrow from zero to the edge of the panel."""
    low, high = axes.get_ylim()
    line = LINES[name]
    axes.annotate(
        "",
        xy=(x, high if up else low),
        xytext=(x, 0.0),
        annotation_clip=False,
        arrowprops={
            "arrowstyle": "-|>",
            "color": line["color"],
            "linestyle": line["linestyle"],
            "linewidth": line["linewidth"],
            "shrinkA": 0,
            "shrinkB": 0,
        },
    )


def _legend(figure: Figure, shown: dict[str, CamProfile]) -> None:
    handles: list[Line2D | Patch] = [line_mark(label=title(name), **LINES[name]) for name in LINES if name in shown]
    handles += [
        line_mark(label="limit of the drive", **LIMIT),
        patch_mark(facecolor=SYNC_COLOUR, label="sync zone"),
        patch_mark(facecolor=SHEAR_COLOUR, edgecolor="#8c8c8c", hatch="////", linewidth=0, label="shear zone"),
    ]
    if "linear_return" in shown:
        line = LINES["linear_return"]
        handles.append(line_mark(color=line["color"], marker="^", linestyle="-", linewidth=1.2, label="unbounded"))
    figure.legend(handles=handles, loc="outside lower center", ncols=4)
