"""The figure of a recorded run: command and axis on the design, both beside it, the sync error of each cut, and what the cuts add up to."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from camwright.figures.panel import (
    NOTHING,
    across,
    band,
    first_frame,
    head,
    page,
    stroked,
    wide_frame,
    zone_bands,
)
from camwright.figures.strokes import BLACK, Stroke
from camwright.house.numbers import converted, unit_shown, with_unit
from camwright.house.pictures import DrawnLine, DrawnMarks, Frame, Item, Picture
from camwright.profiles.polynomial.profile import FloatArray
from camwright.studies.recording import RecordedRun
from camwright.validation.recording.cut_errors import sync_parts

_MOST_POINTS = 20_000
"""Points drawn of a curve over all cycles."""

_MOST_CUTS = 60
"""Cuts whose sync error is drawn."""

_DESIGN, _COMMAND, _AXIS = Stroke(BLACK, 1.2), Stroke("#d55e00", 1.2), Stroke("#0072b2", 1.2)
_LINE = Stroke("#007a5a", 1.6)

_PANEL = 126.0
"""Height of a panel (pt)."""


def trace_figure(found: RecordedRun) -> Picture:
    """Draw a recorded run over its design."""
    job = found.job
    words = f"{len(found.cuts)} recorded cuts at {with_unit(found.run.line_speed, 'm/s', units=job.units)}"
    heading = head(job.name, words)
    top = first_frame(heading) + 24.0
    beside = top + _PANEL + 36.0
    zones = beside + _PANEL + 60.0
    frames = [_positions(found, top), _beside(found, beside), _zones(found, zones), _cuts(found, zones + _PANEL + 60.0)]
    legend: list[Item] = [
        stroked(_DESIGN, NOTHING, "design"),
        stroked(_COMMAND, NOTHING, "command"),
        stroked(_AXIS, NOTHING, "axis"),
        across(0.0, 0.0, 1.0, "sync tolerance"),
        stroked(_LINE, NOTHING, "offset and drift"),
        band(0.0, 1.0, "sync zone", job.units),
        band(0.0, 1.0, "shear zone", job.units),
    ]
    return page(heading, frames, legend)


def _folded(found: RecordedRun) -> tuple[FloatArray, FloatArray]:
    """Master position within the cycle (m), not a number where a cycle ends, and the cycle's number."""
    length = found.job.cut.length
    cycle = np.floor(found.run.master / length)
    place = found.run.master - cycle * length
    place[1:][np.diff(cycle) != 0.0] = np.nan
    return place, cycle


def _curve(found: RecordedRun, place: FloatArray, values: FloatArray, stroke: Stroke) -> DrawnLine:
    """Draw a curve of the slave over the master, in the units of the job."""
    units = found.job.units
    scale = [converted(1.0, "m", units), converted(1.0, found.job.machine.slave_unit, units)]
    return stroked(stroke, np.stack([_thin(place), _thin(values)], axis=1) * scale)


def _panel(found: RecordedRun, top: float, items: Sequence[Item], words: tuple[str, str, str]) -> Frame:
    """Draw a panel over the cycle; words are those below, beside and above it."""
    job = found.job
    points = np.concatenate([item.points for item in items if isinstance(item, DrawnLine)])
    low, high = float(np.nanmin(points[:, 1])), float(np.nanmax(points[:, 1]))
    room = 0.05 * (high - low) or 1.0
    end = converted(job.cut.length, "m", job.units)
    return wide_frame(
        top,
        _PANEL,
        np.array([0.0, low - room]),
        np.array([end, high + room]),
        [*zone_bands(job.cut, job.units), *items],
        *words,
    )


def _positions(found: RecordedRun, top: float) -> Frame:
    """Draw command and axis over the master, all cycles over one another, on the design."""
    place, cycle = _folded(found)
    grid = np.linspace(found.profile.start, found.profile.end, 801)
    lines = [
        _curve(found, place, signal - cycle * found.profile.advance, stroke)
        for signal, stroke in ((found.run.command, _COMMAND), (found.run.axis, _AXIS))
    ]
    lines.append(_curve(found, grid, found.profile(grid), _DESIGN))
    return _panel(found, top, lines, ("", f"slave ({_slave(found)})", "command and axis over the master, all cycles"))


def _beside(found: RecordedRun, top: float) -> Frame:
    """Draw command and axis less the design."""
    place, _ = _folded(found)
    design = found.profile(found.run.master, outside="repeat")
    lines = [
        _curve(found, place, signal - design, replace(stroke, width=0.8))
        for signal, stroke in ((found.run.command, _COMMAND), (found.run.axis, _AXIS))
    ]
    words = (f"off the design ({_slave(found)})", "command and axis less the design")
    return _panel(found, top, lines, (f"master ({unit_shown('m', found.job.units)})", *words))


def _zones(found: RecordedRun, top: float) -> Frame:
    """Draw the sync error of each cut over the sync zone."""
    job, cut = found.job, found.job.cut
    factor, length = converted(1.0, "m", job.units), unit_shown("m", job.units)
    parts = sync_parts(found.run, found.profile, job.task, 0.0, cut.sync_zone)
    lines = [
        stroked(replace(_AXIS, width=0.7), np.stack([part.along.ravel(), part.error.ravel()], axis=1) * factor)
        for _, part in parts[:: max(1, -(-len(parts) // _MOST_CUTS))]
    ]
    size = 1.4 * factor * max([abs(each.greatest) for each in found.cuts] + [cut.sync_tolerance])
    end = cut.sync_zone * factor
    shear = band(cut.shear_zone_at, min(cut.shear_zone_at + cut.shear_zone, cut.sync_zone), "shear zone", job.units)
    return wide_frame(
        top,
        _PANEL,
        np.array([0.0, -size]),
        np.array([end, size]),
        [shear, *_tolerance(found, 0.0, end), *lines],
        f"master from the start of the sync zone ({length})",
        f"sync error ({length})",
        "tool less material in the sync zone, every cut",
    )


def _cuts(found: RecordedRun, top: float) -> Frame:
    """Draw the error of each cut, and the line of offset and drift through them."""
    total, units = found.total, found.job.units
    factor = converted(1.0, "m", units)
    numbers = np.array([cut.number for cut in found.cuts], dtype=np.float64)
    errors = np.array([cut.error for cut in found.cuts]) * factor
    middle = numbers - numbers.mean()
    line = (total.offset + (total.drift or 0.0) * middle) * factor
    tolerance = found.job.cut.sync_tolerance * factor
    size = 1.2 * max(tolerance, float(np.abs(errors).max()), float(np.abs(line).max()))
    ends = float(numbers.min()) - 0.5, float(numbers.max()) + 0.5
    return wide_frame(
        top,
        _PANEL,
        np.array([ends[0], -size]),
        np.array([ends[1], size]),
        [
            *_tolerance(found, *ends),
            stroked(_LINE, np.stack([numbers, line], axis=1)),
            DrawnMarks(np.stack([numbers, errors], axis=1), _AXIS.colour, 4.0, "disc"),
        ],
        "cut",
        f"sync error ({unit_shown('m', units)})",
        "mean over the shear zone, cut by cut",
    )


def _tolerance(found: RecordedRun, start: float, end: float) -> list[DrawnLine]:
    tolerance = converted(found.job.cut.sync_tolerance, "m", found.job.units)
    return [across(sign * tolerance, start, end) for sign in (-1.0, 1.0)]


def _slave(found: RecordedRun) -> str:
    """Name the unit of the slave as it is drawn."""
    return unit_shown(found.job.machine.slave_unit, found.job.units)


def _thin(values: FloatArray) -> FloatArray:
    return values[:: max(1, len(values) // _MOST_POINTS)]
