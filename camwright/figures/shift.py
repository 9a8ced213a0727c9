"""The figure of a simulated shift: the line's speed, the sync error at each cut, and how the lengths spread."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from camwright.figures.panel import across, first_frame, head, page, profile_line, wide_frame
from camwright.figures.strokes import BLACK, LINES
from camwright.figures.style import title
from camwright.house.numbers import unit_shown
from camwright.house.pictures import APART, DrawnLine, DrawnMarks, Frame, Picture, Shape, Tick
from camwright.production.simulation import MOTIONS, ShiftStudy
from camwright.profiles.polynomial.profile import FloatArray

_DOTS = 600
"""Pieces drawn one by one; of more, the worst of each of so many stretches."""

_MARKS: dict[str, Shape] = {"optimised": "disc", "linear_return": "cross"}

_SPEED, _ERRORS, _SPREAD = 96.0, 144.0, 144.0
"""Heights of the panels (pt)."""

_FEW = 0.5
"""Number of pieces at which the axis of the histogram begins: below one."""


def shift_figure(study: ShiftStudy) -> Picture:
    """Draw speed and sync errors over time, and the histogram of the length errors."""
    planned = study.planned
    last = float(study.cut_times[-1])
    heading = head(planned.job.name, f"{planned.asked.pieces} pieces, {last:.5g} s")
    top = first_frame(heading)
    second = top + _SPEED + 18.0
    errors, marks = _errors(study, last, second)
    frames = [_speed(study, last, top), errors, _spread(study, second + _ERRORS + 48.0)]
    return page(heading, frames, [*marks, across(0.0, 0.0, 1.0, "sync tolerance")])


def _speed(study: ShiftStudy, last: float, top: float) -> Frame:
    """Draw the speed of the line."""
    units, line = study.planned.job.units, study.planned.line
    time = np.unique(np.concatenate([np.linspace(0.0, last, 2001), line.times]))
    time = time[time <= last]
    speeds = line.speed(time) * units.shown["m/s"].factor
    high = 1.08 * float(speeds.max()) or 1.0
    return wide_frame(
        top,
        _SPEED,
        np.zeros(2),
        np.array([last, high]),
        [DrawnLine(np.stack([time, speeds], axis=1), BLACK, 1.5)],
        "",
        f"line speed\n({unit_shown('m/s', units)})",
    )


def _errors(study: ShiftStudy, last: float, top: float) -> tuple[Frame, list[DrawnMarks]]:
    """Draw the sync error of each piece."""
    job = study.planned.job
    length = job.units.shown["m"].factor
    marks = []
    for motion in MOTIONS:
        at, error = _thinned(study.cut_times, study.runs[motion].nominal.sync_errors)
        points = np.stack([at, error * length], axis=1)
        marks.append(DrawnMarks(points, LINES[motion].colour, 4.0, _MARKS[motion], title(motion)))
    tolerance = job.cut.sync_tolerance * length
    high = 1.08 * max(tolerance, *(float(each.points[:, 1].max()) for each in marks))
    frame = wide_frame(
        top,
        _ERRORS,
        np.zeros(2),
        np.array([last, high]),
        [across(tolerance, 0.0, last), *marks],
        "time (s)",
        f"sync error of\neach piece ({unit_shown('m', job.units)})",
    )
    return frame, marks


def _spread(study: ShiftStudy, top: float) -> Frame:
    """Draw the histograms as outlines; the counts as powers of ten, so that the few bad pieces are seen."""
    units = study.planned.job.units
    edges = study.edges * units.shown["m"].factor
    lines = []
    for motion in MOTIONS:
        counts = np.log10(np.maximum(study.histogram(motion), _FEW))
        outline = np.stack([np.repeat(edges, 2)[1:-1], np.repeat(counts, 2)], axis=1)
        lines.append(replace(profile_line(motion, outline), width=1.5))
    low = math.log10(_FEW)
    high = max(float(line.points[:, 1].max()) for line in lines) + 0.15
    return wide_frame(
        top,
        _SPREAD,
        np.array([float(edges[0]), low]),
        np.array([float(edges[-1]), high]),
        lines,
        f"length less what was asked ({unit_shown('m', units)})",
        "pieces",
        yticks=[Tick(float(power), f"{10**power}") for power in range(math.floor(high) + 1)],
        apart=APART,
    )


def _thinned(time: FloatArray, error: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Of many pieces keep the worst of each stretch."""
    if len(time) <= _DOTS:
        return time, error
    firsts = np.linspace(0, len(time), _DOTS, endpoint=False).astype(np.intp)
    worst = np.array(
        [first + int(part.argmax()) for first, part in zip(firsts, np.split(error, firsts[1:]), strict=True)]
    )
    return time[worst], error[worst]
