"""The profile figure: travel, ratio, acceleration and jerk over the master, zones shaded, limits marked."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from camwright.figures.panel import (
    NOTHING,
    across,
    first_frame,
    head,
    page,
    profile_line,
    wide_frame,
    zone_bands,
)
from camwright.figures.strokes import LINES
from camwright.figures.style import broken_note, marked
from camwright.house.numbers import Units, converted, number, unit_shown, with_unit
from camwright.house.pictures import Arrow, DrawnLine, Frame, Item, Note, Picture
from camwright.jobs.job import Job
from camwright.profiles.objective import OBJECTIVES
from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.profiles.task import Task
from camwright.studies.comparison import Comparison
from camwright.validation.motion import RATIO_JUMP, SLOPE_JUMP, slope_scale

_POINTS = 48
"""Points drawn of a piece; the ends of pieces are drawn from both sides."""

_FAR = 4.0
"""A limit is drawn as a line if it is at most this many times the greatest value drawn, else named in words."""

_NOTHING = 1e-9
"""Values below this part of a limit are rounding: the limits alone are drawn."""

_ROOM = 1.18
"""Height of a panel, as a multiple of what it holds."""

_PANEL, _GAP = 144.0, 18.0
"""Height of a panel, and room between two (pt)."""


def profile_figure(comparison: Comparison) -> Picture:
    """Draw the optimised profile beside the linear return and the quintic.

    Where a derivative is unbounded, arrows stand at the jump instead of a value; they point the way of the jump.

    Parameters
    ----------
    comparison
        Holds the job and the profiles; those of `camwright.figures.style.LINES` are drawn.
    """
    job = comparison.job
    rows = {row.name: row for row in comparison.rows if row.name in LINES}
    shown = {name: row.profile for name, row in rows.items()}
    words = (
        f"{with_unit(job.cut.length, 'm', units=job.units)} at {with_unit(job.cut.line_speed, 'm/s', units=job.units)}, "
        f"minimised: {OBJECTIVES[job.objective].words}"
    )
    heading = head(job.name, words) + broken_note(rows.values())
    top = first_frame(heading)
    frames = [_frame(job, shown, order, top + order * (_PANEL + _GAP)) for order in range(4)]
    legend: list[Item] = [profile_line(name, NOTHING, marked(rows[name])) for name in LINES if name in rows]
    legend += [across(0.0, 0.0, 1.0, "limit of the drive"), *zone_bands(job.cut, job.units)]
    if "linear_return" in shown:
        legend.append(_arrow("linear_return", 0.0, 1.0, "unbounded"))
    return page(heading, frames, legend)


def _frame(job: Job, shown: dict[str, CamProfile], order: int, top: float) -> Frame:
    """Draw the panel of the travel or of a derivative."""
    units, task = job.units, job.task
    end = converted(job.cut.length, "m", units)
    lines = [profile_line(name, _points(profile, order, job)) for name, profile in shown.items()]
    limits = _limits(task, order, units)
    low, high, drawn = _range(lines, limits) if order else _whole(lines, limits)
    items: list[Item] = [*zone_bands(job.cut, units), *(across(bound, 0.0, end) for bound in drawn), *reversed(lines)]
    if order and limits[-1] not in drawn:
        bound = number(limits[-1])
        words = f"limit {bound}: off scale" if drawn else f"limits ±{bound}: off scale"
        items.append(Note((end, high), words, "end", (0.0, -6.0)))
    if order >= 2:
        for name, profile in shown.items():
            items += _arrows(name, profile, order, units, (low, high))
    label = "master position x (" + unit_shown("m", units) + ")" if order == 3 else ""
    return wide_frame(
        top, _PANEL, np.array([0.0, low]), np.array([end, high]), items, label, _label(task, order, units)
    )


def _points(profile: CamProfile, order: int, job: Job) -> FloatArray:
    """Points of a curve in the units shown, shape ``(n, 2)``."""
    x, y = curve(profile, order)
    units, task = job.units, job.task
    value = _travel(x, y, task, units) if order == 0 else y * job.cut.line_speed**order * _factor(task, order, units)
    return np.stack([x * converted(1.0, "m", units), value], axis=1)


def _factor(task: Task, order: int, units: Units) -> float:
    """Factor from a derivative over time to what is shown; the ratio is one over the master."""
    unit = task.machine.slave_unit
    if order == 1:
        return 1.0 / task.cut.line_speed
    return units.measure(f"{unit}/s^{order}").factor


def _limits(task: Task, order: int, units: Units) -> tuple[float, ...]:
    """Limits of a panel in the units shown: the carriage's stroke, or those of the drive."""
    limits, guide = task.limits, task.machine.guide
    if order == 0:
        return () if guide is None else tuple(converted(end, "m", units) for end in guide)
    if order == 1:
        return task.least_ratio, task.greatest_ratio
    greatest = (limits.acceleration if order == 2 else limits.jerk) * _factor(task, order, units)
    return -greatest, greatest


def _travel(x: FloatArray, y: FloatArray, task: Task, units: Units) -> FloatArray:
    """Give what the first panel draws: the correction ``y - x``, a carriage's place, or an angle minus an even turn (deg)."""
    machine, factor = task.machine, converted(1.0, "m", units)
    if machine.slave_unit == "rad":
        return np.asarray(np.degrees(y - machine.pitch / task.cut.length * x))
    if machine.turns_back:
        return np.asarray(task.slave_at_start + y - y[0]) * factor
    return (y - x) * factor


def _label(task: Task, order: int, units: Units) -> str:
    """Label of a panel."""
    machine = task.machine
    unit = machine.slave_unit
    if order == 0:
        if unit == "rad":
            return "y − even turn (°)"
        return f"{f'{machine.noun} y' if machine.turns_back else 'y − x'} ({unit_shown('m', units)})"
    if order == 1:
        return "ratio k = dy/dx" if unit == "m" else "ratio dy/dx (rad/m)"
    return f"{'acceleration' if order == 2 else 'jerk'} ({units.measure(f'{unit}/s^{order}').printed})"


def curve(profile: CamProfile, order: int) -> tuple[FloatArray, FloatArray]:
    """Points of a derivative over the master (m), every piece from its first to its last break."""
    part = np.linspace(0.0, 1.0, _POINTS + 1)
    x = profile.breaks[:-1, None] + np.diff(profile.breaks)[:, None] * part
    x[:, -1] = profile.breaks[1:]
    value = profile(x, order)
    value[:, -1] = profile(x[:, -1], order, side="left")
    return x.ravel(), value.ravel()


def _whole(lines: Sequence[DrawnLine], limits: tuple[float, ...]) -> tuple[float, float, tuple[float, ...]]:
    """Give least and greatest of a panel that holds its curves and all limits, with room around, and the limits."""
    values = np.concatenate([*(line.points[:, 1] for line in lines), limits])
    least, greatest = float(values.min()), float(values.max())
    room = 0.05 * (greatest - least) if greatest > least else 1.0
    return least - room, greatest + room, limits


def _range(lines: Sequence[DrawnLine], limits: tuple[float, ...]) -> tuple[float, float, tuple[float, ...]]:
    """Give least and greatest of a panel with room around its curves, and those limits that do not lie far beyond all that is drawn."""
    values = np.concatenate([line.points[:, 1] for line in lines])
    least, greatest = float(values.min()), float(values.max())
    reach = max(abs(least), abs(greatest))
    if reach <= _NOTHING * limits[1]:
        reach = limits[1]
    drawn = tuple(bound for bound in limits if abs(bound) <= _FAR * reach)
    least, greatest = min([least, *drawn]), max([greatest, *drawn])
    middle, half = 0.5 * (least + greatest), 0.5 * (greatest - least) * _ROOM
    return middle - half, middle + half, drawn


def _arrows(name: str, profile: CamProfile, order: int, units: Units, reach: tuple[float, float]) -> list[Arrow]:
    """Mark where acceleration or jerk is unbounded: at jumps of the ratio, or of the ratio slope."""
    at = profile.breaks[1:] * converted(1.0, "m", units)
    ratio, slope = profile.jumps(1), profile.jumps(2)
    steep = np.abs(ratio) > RATIO_JUMP
    if order == 2:
        return [_arrow(name, x, reach[int(up)]) for x, up in zip(at[steep].tolist(), ratio[steep] > 0, strict=True)]
    sudden = steep | (np.abs(slope) > SLOPE_JUMP * slope_scale(profile))
    return [_arrow(name, x, tip) for x in at[sudden].tolist() for tip in reversed(reach)]


def _arrow(name: str, x: float, tip: float, label: str = "") -> Arrow:
    """Draw one arrow from zero to the edge of the panel."""
    line = profile_line(name, NOTHING)
    return Arrow(x, 0.0, tip, line.colour, line.width, label, line.dash)
