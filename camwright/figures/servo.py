"""The servo figure: the axis against the ideal sync line, and the sync error over the sync zone, at every phase."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence

import numpy as np

from camwright.figures.panel import (
    LEFT,
    NOTHING,
    RIGHT,
    WIDTH,
    across,
    band,
    first_frame,
    head,
    page,
    phase_lines,
    profile_line,
    stroked,
    wide_frame,
)
from camwright.figures.strokes import BLACK, COMMAND, LINES
from camwright.figures.style import broken_note, marked
from camwright.house.numbers import Units, converted, unit_shown, with_unit
from camwright.house.pictures import DrawnLine, DrawnMarks, Frame, Item, Note, Picture
from camwright.profiles.polynomial.profile import FloatArray
from camwright.studies.comparison import Comparison
from camwright.studies.measured import Measured
from camwright.validation.servo.axis_run import ServoRun
from camwright.validation.servo.response import sync_error

AXES = ("linear_return", "optimised")
"""Profiles whose axis is drawn."""

_BEFORE, _AFTER = 0.15, 0.6
"""Part of the sync zone drawn before and after its start, where the axis meets the line."""

_CLOSE = 6.0
"""Half height of the close view of the sync error, as a multiple of the sync tolerance."""

_ROOM = 0.05
"""Share of what a panel holds that is free above and below it."""

_MEETING, _ERROR = 168.0, 144.0
"""Heights of the upper two and the lower two panels (pt)."""

_HEADING, _BELOW, _BETWEEN = 24.0, 36.0, 60.0
"""Room above a panel with a title, below one with an x label, and between the upper two (pt)."""

_CROSSING, _SETTLED = 7.0, 8.0
"""Sizes of the marks (pt)."""

_PLACE = "master from the start of the sync zone"


def servo_figure(comparison: Comparison, runs: Mapping[str, ServoRun]) -> Picture:
    """Draw what the job's servo makes of the linear return and of the optimised profile.

    Parameters
    ----------
    comparison
        Holds the job, the profiles and their measured responses.
    runs
        The simulated responses, by the names in `AXES`.
    """
    job = comparison.job
    servo, units = job.servo, job.units
    heading = head(
        job.name,
        f"the servo at {with_unit(job.cut.line_speed, 'm/s', units=units)}, all {runs[AXES[0]].phases} sampling phases",
    )
    heading += (
        f"\nω = {servo.bandwidth:g} rad/s, ζ = {servo.damping:g}, K = {servo.position_gain:g} 1/s, "
        f"ΔT = {with_unit(servo.sample_time, 's')}, α = {servo.velocity_feedforward:g}"
    )
    heading += _worst_note(comparison)
    heading += broken_note(comparison[name] for name in AXES)
    top = first_frame(heading) + _HEADING
    upper = _meetings(comparison, runs, top)
    top += _MEETING + _BELOW + 2 * _HEADING
    lower = _errors(comparison, runs, top)
    tolerance = across(0.0, 0.0, 1.0, "sync tolerance")
    legend: list[Item] = [profile_line(name, NOTHING, f"axis, {marked(comparison[name])}") for name in AXES]
    legend += [
        DrawnLine(NOTHING, BLACK, 1.1, "ideal sync line"),
        stroked(COMMAND, NOTHING, "command"),
        DrawnMarks(NOTHING, "#444444", _CROSSING, "open", "crossing (latest phase)"),
        DrawnMarks(NOTHING, "#444444", _SETTLED, "diamond", "settled (latest phase)"),
        tolerance,
        band(0.0, 1.0, "shear zone", units),
    ]
    return page(heading, [*upper, *lower], legend)


def _worst_note(comparison: Comparison) -> str:
    """Say what the worst servo of the job's ranges makes of them, which is not drawn: a line of the heading, where there are ranges."""
    units, rows = comparison.job.units, [comparison[name] for name in AXES]
    told = [f"{marked(row)} {with_unit(row.worst_error, 'm', 4, units)}" for row in rows if row.worst_error is not None]
    return f"\nworst servo of its ranges, in the shear zone: {', '.join(told)}" if told else ""


def _meetings(comparison: Comparison, runs: Mapping[str, ServoRun], top: float) -> list[Frame]:
    """Draw both axes around the start of the sync zone, side by side on one scale."""
    job = comparison.job
    units = job.units
    both = [_meeting(comparison[name], comparison, runs[name]) for name in AXES]
    low, high = _room(*_extent([item for items in both for item in items]))
    width = 0.5 * (WIDTH - LEFT - RIGHT - _BETWEEN)
    length = unit_shown("m", units)
    beginning = DrawnLine(np.array([[0.0, low[1]], [0.0, high[1]]]), "#8c8c8c", 1.0)
    return [
        Frame(
            LEFT + number * (width + _BETWEEN),
            top,
            width,
            _MEETING,
            low,
            high,
            [beginning, *items],
            f"{_PLACE} ({length})",
            f"{'slave' if job.task.straight else 'tool'} from there ({length})" if number == 0 else "",
            marked(comparison[name]),
            grid=True,
            apart=24.0,
        )
        for number, (name, items) in enumerate(zip(AXES, both, strict=True))
    ]


def _meeting(row: Measured, comparison: Comparison, run: ServoRun) -> list[Item]:
    """Draw ideal line, command and axis at the tool around the start of the sync zone, from the material's point there."""
    job = comparison.job
    cut, factor = job.cut, converted(1.0, "m", job.units)
    start = cut.return_start + cut.return_zone
    first, last = max(-_BEFORE * cut.sync_zone, -cut.return_zone), _AFTER * cut.sync_zone
    tool = _tool(row, comparison)
    shown = (run.master >= start + first) & (run.master <= start + last)
    pieces = [np.nonzero(row_shown)[0] for row_shown in shown]
    ends = np.array([first, last])
    axes = [
        np.stack([run.master[phase, index] - start, tool(run.axis[phase, index])], axis=1) * factor
        for phase, index in enumerate(pieces)
    ]
    index = pieces[0]  # the command is the same at every phase
    command = np.stack([run.master[0, index] - start, tool(run.command[0, index])], axis=1) * factor
    items: list[Item] = [
        DrawnLine(np.stack([ends, cut.sync_ratio * ends], axis=1) * factor, BLACK, 1.1),
        stroked(COMMAND, command),
        *phase_lines(row.name, axes),
    ]
    crossing = row.response.crossing
    if crossing is not None and crossing <= last:
        there = (crossing * factor, crossing * cut.sync_ratio * factor)
        words = _length(crossing, job.units)
        items.append(DrawnMarks(np.array([there]), LINES[row.name].colour, _CROSSING, "open"))
        items.append(Note(there, words, "end", (-7.0, -9.0), 10.0))
    return items


def _tool(row: Measured, comparison: Comparison) -> Callable[[FloatArray], FloatArray]:
    """Give the tool's way (m) from where the material is at the start of the sync zone, of a slave position of the run."""
    cut, machine = comparison.job.cut, comparison.job.machine
    origin = float(row.profile(cut.return_start + cut.return_zone, outside="repeat"))
    there = comparison.job.task.slave_at_sync_start
    return lambda slave: np.asarray(machine.tool(there + slave - origin) - machine.tool(there))


def _errors(comparison: Comparison, runs: Mapping[str, ServoRun], top: float) -> list[Frame]:
    """Draw the sync error over the sync zone, whole and close to the tolerance."""
    job = comparison.job
    cut, factor, length = job.cut, converted(1.0, "m", job.units), unit_shown("m", job.units)
    end, tolerance = cut.sync_zone * factor, cut.sync_tolerance * factor
    shear = band(cut.shear_zone_at, cut.shear_zone_at + cut.shear_zone, "shear zone", job.units)
    items: list[Item] = [shear, *(across(sign * tolerance, 0.0, end) for sign in (-1.0, 1.0))]
    for name in AXES:
        items += _error(comparison[name], comparison, runs[name])
    low, high = _room(*_extent(items))
    low[0], high[0] = 0.0, end
    close = _CLOSE * tolerance
    findings = "\n".join(["axis minus ideal sync line", *(_finding(comparison[name], comparison) for name in AXES)])
    label = f"sync error ({length})"
    second = top + _ERROR + 12.0 + _HEADING
    return [
        wide_frame(top, _ERROR, low, high, items, "", label, findings),
        wide_frame(
            second,
            _ERROR,
            np.array([0.0, -close]),
            np.array([end, close]),
            items,
            f"{_PLACE} ({length})",
            label,
            "the same, close to the tolerance",
        ),
    ]


def _error(row: Measured, comparison: Comparison, run: ServoRun) -> list[Item]:
    """Draw the sync error of every phase, crossing and settling marked on the line of the axis."""
    job = comparison.job
    factor, colour = converted(1.0, "m", job.units), LINES[row.name].colour
    start = job.cut.return_start + job.cut.return_zone
    master, error, _ = sync_error(run, row.profile, job.task, start, start + job.cut.sync_zone)
    curves = [np.stack([x - start, y], axis=1) * factor for x, y in zip(master, error, strict=True)]
    items: list[Item] = [*phase_lines(row.name, curves)]
    crossing, settling = row.response.crossing, row.response.settling
    if crossing is not None:
        items.append(DrawnMarks(np.array([[crossing * factor, 0.0]]), colour, _CROSSING, "open"))
    if settling is not None:
        there = [float(np.interp(settling, x - start, y)) for x, y in zip(master, error, strict=True)]
        items.append(DrawnMarks(np.array([[settling, max(there, key=abs)]]) * factor, colour, _SETTLED, "diamond"))
    return items


def _extent(items: Sequence[Item]) -> tuple[FloatArray, FloatArray]:
    """Least and greatest of the points of lines, shape ``(2,)`` each."""
    points = np.concatenate([item.points for item in items if isinstance(item, DrawnLine)])
    return np.nanmin(points, axis=0), np.nanmax(points, axis=0)


def _room(low: FloatArray, high: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Leave room around what a panel holds."""
    room = _ROOM * (high - low)
    return low - room, high + room


def _finding(row: Measured, comparison: Comparison) -> str:
    """Write crossing, overshoot and settling length of a profile."""
    response, units = row.response, comparison.job.units
    crossing, settling = (
        without if place is None else f"{words} {_length(place, units)}"
        for place, words, without in (
            (response.crossing, "crossing", "no crossing in the zone"),
            (response.settling, "settled after", "not settled in the zone"),
        )
    )
    return f"{marked(row)}: {crossing}, overshoot {_length(response.overshoot, units, 1)}, {settling}"


def _length(length: float, units: Units, more: int = 0) -> str:
    """Write a length (m) to a tenth of a millimetre or finer, with so many decimals more."""
    factor = converted(1.0, "m", units)
    return f"{length * factor:.{math.ceil(4.0 - math.log10(factor)) + more}f} {unit_shown('m', units)}"
