"""The axis figure of a servo-aware design: command and axis about the shear zone, sync error at every phase, robustness as a band."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from camwright.figures.panel import (
    NOTHING,
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
from camwright.figures.strokes import COMMAND
from camwright.figures.style import broken_note, marked
from camwright.house.numbers import Units, converted, number, unit_shown, with_unit
from camwright.house.pictures import Area, Frame, Item, Picture, Tick
from camwright.profiles.polynomial.profile import FloatArray
from camwright.studies.axis_study import RobustBand
from camwright.studies.design import Design
from camwright.validation.servo.axis_run import ServoRun
from camwright.validation.servo.response import sync_error

AXES = ("linear_return", "poly_3_4_5", "optimised")
"""Profiles whose axis is drawn, where they exist."""

_AROUND = 0.75
"""Part of the shear zone drawn before it; where it has no length, of the sync zone."""

_CLOSE = 1.6
"""Half height of the close views, as a multiple of the sync tolerance."""

_LINEAR = 1.5
"""Height of the tolerance where what lies beyond it is logarithmic, in powers of ten."""

_PANEL, _GAP = 156.0, 36.0
"""Height of a panel, and room for the title of the next (pt)."""

_RANGES = "#9ecae8"


def axis_figure(design: Design, runs: Mapping[str, ServoRun], ranges: RobustBand | None) -> Picture:
    """Draw what a servo-aware design makes of the axis.

    Parameters
    ----------
    runs
        Simulated responses of profiles, by name.
    ranges
        Sync error over the servo's ranges; ``None`` if the job gives none.
    """
    job, cut = design.job, design.job.cut
    shear = (cut.shear_zone_at, cut.shear_zone_at + cut.shear_zone)
    around = _AROUND * (cut.shear_zone or 0.2 * cut.sync_zone)
    part = max(0.0, shear[0] - around), min(cut.sync_zone, shear[1] + around)
    heading = head(job.name, f"the axis at {with_unit(cut.line_speed, 'm/s', units=job.units)}")
    heading += broken_note(design.comparison[name] for name in AXES if name in runs)
    top = first_frame(heading) + 24.0
    frames = [_meeting(design, runs["optimised"], part, top), _errors(design, runs, part, top + _PANEL + _GAP)]
    if ranges is not None:
        frames.append(_ranges(design, ranges, part, top + 2 * (_PANEL + _GAP)))
    legend: list[Item] = [
        profile_line(name, NOTHING, f"axis, {marked(design.comparison[name])}") for name in AXES if name in runs
    ]
    legend += [
        stroked(COMMAND, NOTHING, "command, optimised"),
        across(0.0, 0.0, 1.0, "sync tolerance"),
        band(0.0, 1.0, "shear zone", job.units),
    ]
    if ranges is not None:
        legend.append(Area(NOTHING, _RANGES, "dots", "servo's ranges"))
    frames[-1] = replace(frames[-1], xlabel=f"master from the start of the sync zone ({unit_shown('m', job.units)})")
    return page(heading, frames, legend)


def _panel(
    design: Design, part: tuple[float, float], top: float, half: float, items: list[Item], words: str,
    tolerance: float, yticks: list[Tick] | None = None,
) -> Frame:  # fmt: skip
    """Draw a panel about the material; the tolerance in the units of the panel, half its height too."""
    job, cut = design.job, design.job.cut
    first, last = (converted(end, "m", job.units) for end in part)
    return wide_frame(
        top,
        _PANEL,
        np.array([first, -half]),
        np.array([last, half]),
        [
            band(cut.shear_zone_at, cut.shear_zone_at + cut.shear_zone, "shear zone", job.units),
            *(across(sign * tolerance, first, last) for sign in (-1.0, 1.0)),
            *items,
        ],
        "",
        f"off the material ({unit_shown('m', job.units)})",
        words,
        yticks=yticks,
    )


def _curves(design: Design, name: str, run: ServoRun, part: tuple[float, float]) -> list[FloatArray]:
    """Sync error over the master from the start of the sync zone, in the units shown: of each phase an array ``(n, 2)``."""
    job = design.job
    start = job.cut.return_start + job.cut.return_zone
    master, error, _ = sync_error(run, design.comparison[name].profile, job.task, start + part[0], start + part[1])
    factor = converted(1.0, "m", job.units)
    return [np.stack([x - start, y], axis=1) * factor for x, y in zip(master, error, strict=True)]


def _meeting(design: Design, run: ServoRun, part: tuple[float, float], top: float) -> Frame:
    """Draw command and axis of the optimised profile, both less the material: the command leads by far more than the axis is off."""
    job = design.job
    tolerance = converted(job.cut.sync_tolerance, "m", job.units)
    as_axis = ServoRun(run.master, run.command, run.command, run.axis_ratio)
    command = _squeezed(_curves(design, "optimised", as_axis, part)[0], tolerance)
    axis = [_squeezed(each, tolerance) for each in _curves(design, "optimised", run, part)]
    half = 1.1 * max(float(np.abs(each[:, 1]).max()) for each in (command, *axis, np.array([[0.0, _LINEAR]])))
    study = design.axis
    found = "" if study is None else f": at most {study.simulated_error * 1e6:.3g} µm off in the shear zone"
    words = f"command and axis, {job.command.replace('_', ' ')}{found}; logarithmic beyond the tolerance"
    items: list[Item] = [stroked(COMMAND, command), *phase_lines("optimised", axis)]
    return _panel(design, part, top, half, items, words, _LINEAR, _powers(half, tolerance))


def _squeezed(points: FloatArray, tolerance: float) -> FloatArray:
    """Lay heights out linear up to the tolerance, and logarithmic beyond it."""
    size = np.abs(points[:, 1]) / tolerance
    height = np.where(size <= 1.0, _LINEAR * size, _LINEAR + np.log10(np.maximum(size, 1.0)))
    return np.stack([points[:, 0], np.sign(points[:, 1]) * height], axis=1)


def _powers(half: float, tolerance: float) -> list[Tick]:
    """Choose ticks where heights are squeezed: zero, and the tolerance times powers of ten."""
    values = [tolerance * 10.0**power for power in range(int(max(half - _LINEAR, 0.0)) + 1)]
    up = [(_LINEAR + power, number(value, 4)) for power, value in enumerate(values)]
    return [
        *(Tick(-height, f"−{text}") for height, text in reversed(up)),
        Tick(0.0, "0"),
        *(Tick(*each) for each in up),
    ]


def _errors(design: Design, runs: Mapping[str, ServoRun], part: tuple[float, float], top: float) -> Frame:
    """Draw the sync error of each profile at every phase."""
    tolerance = converted(design.job.cut.sync_tolerance, "m", design.job.units)
    shown = [name for name in AXES if name in runs]
    items: list[Item] = [line for name in shown for line in phase_lines(name, _curves(design, name, runs[name], part))]
    words = f"axis of each profile, all {runs['optimised'].phases} sampling phases, close to the tolerance"
    return _panel(design, part, top, _CLOSE * tolerance, items, words, tolerance)


def _ranges(design: Design, ranges: RobustBand, part: tuple[float, float], top: float) -> Frame:
    """Draw the sync error over the servo's ranges as a band, and that of the nominal servo."""
    units = design.job.units
    low, high, nominal = (_scaled(ranges.master, each, units) for each in (ranges.low, ranges.high, ranges.nominal))
    tolerance = converted(design.job.cut.sync_tolerance, "m", units)
    worst = max(float(np.abs(low[:, 1]).max()), float(np.abs(high[:, 1]).max()), tolerance)
    words = f"optimised, over the ranges of the servo: {ranges.servos} random servos and the corners, every phase"
    items: list[Item] = [Area(np.concatenate([low, high[::-1]]), _RANGES, "dots"), profile_line("optimised", nominal)]
    return _panel(design, part, top, 1.25 * worst, items, words, tolerance)


def _scaled(x: FloatArray, y: FloatArray, units: Units) -> FloatArray:
    """Put a curve in m into the units shown, shape ``(n, 2)``."""
    return np.stack([x, y], axis=1) * converted(1.0, "m", units)
