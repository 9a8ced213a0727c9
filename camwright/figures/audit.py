"""The audit figure: ratio and acceleration of a running cam beside the optimum, and what the optimum saves."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from camwright.drives.audit import MEASURES, Audit
from camwright.figures.panel import (
    NOTHING,
    RIGHT,
    WIDTH,
    across,
    first_frame,
    head,
    page,
    stroked,
    wide_frame,
    zone_bands,
)
from camwright.figures.strokes import BLACK, LINES, Stroke
from camwright.house.numbers import converted, number, unit_shown
from camwright.house.pictures import Bar, DrawnLine, Frame, Item, Note, Picture, Tick, ticks
from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.validation.differences import differences

_THIS = replace(LINES["linear_return"], width=1.4, dash=())
_BEST = LINES["optimised"]
_POINTS = 3000
_ROOM = 1.15
_FAR = 4.0
"""A limit is drawn as a line if it is at most this many times the greatest value drawn, else named in words."""

_FARTHEST = 100.0
"""Bars of measures of which the optimum takes more are cut off here (%)."""

_LEAST_AXIS = 10.0
"""Least reach of the axis of savings (%)."""

_RATIO, _ACCELERATION, _ROW, _NAMES = 144.0, 180.0, 22.0, 130.0
"""Heights of both panels and of a bar's row, and room for the names of the measures (pt)."""

_POWERS = ("/s", "/s^2", "/s^2", "/s^3", "/s^3")
"""Powers of time of the measures."""


def audit_figure(audit: Audit) -> Picture:
    """Draw a running cam beside the optimum: what it asks of the drive, and the savings as bars.

    Where the cam's acceleration is unbounded, its differences at the servo's sample time are drawn, and those of the
    optimum with them.
    """
    job = audit.job
    heading = head(job.name, f"a running cam ({audit.target.name}, {audit.table.points} points) beside the optimum")
    top = first_frame(heading)
    second = top + _RATIO + 18.0
    frames = [_ratio(audit, top), _over_time(audit, second), _savings(audit, second + _ACCELERATION + 48.0)]
    legend: list[Item] = [
        stroked(_THIS, NOTHING, "running cam"),
        stroked(_BEST, NOTHING, "optimum"),
        across(0.0, 0.0, 1.0, "limit of the drive"),
        *zone_bands(job.cut, job.units),
    ]
    return page(heading, frames, legend)


def _ratio(audit: Audit, top: float) -> Frame:
    """Draw the ratio of both cams."""
    limits, v = audit.job.limits, audit.job.cut.line_speed
    lines = [stroked(stroke, _scaled(audit, x, profile(x, 1), 1.0)) for profile, stroke, x in _both(audit)]
    label = "ratio dy/dx" if audit.job.machine.slave_unit == "m" else "ratio dy/dx (rad/m)"
    return _frame(audit, lines, limits.speed / v, label, top, _RATIO)


def _over_time(audit: Audit, top: float) -> Frame:
    """Draw the acceleration of both cams."""
    measure = audit.job.units.measure(f"{audit.job.machine.slave_unit}/s^2")
    lines = [
        stroked(stroke, _scaled(audit, x, _acceleration(audit, profile, x), measure.factor))
        for profile, stroke, x in _both(audit)
    ]
    how = "\nby differences" if audit.is_sampled("peak_acceleration") else ""
    limit = audit.job.limits.acceleration * measure.factor
    frame = _frame(audit, lines, limit, f"acceleration{how} ({measure.printed})", top, _ACCELERATION)
    return replace(frame, xlabel=f"master position x ({unit_shown('m', audit.job.units)})")


def _both(audit: Audit) -> list[tuple[CamProfile, Stroke, FloatArray]]:
    """Give the cams, their strokes, and the places at which they are drawn."""
    return [(audit.cycle, _THIS, _places(audit.cycle)), (audit.optimum, _BEST, _places(audit.optimum))]


def _scaled(audit: Audit, x: FloatArray, y: FloatArray, factor: float) -> FloatArray:
    """Put a curve over the master into the units shown, shape ``(n, 2)``."""
    return np.stack([x * converted(1.0, "m", audit.job.units), y * factor], axis=1)


def _places(profile: CamProfile) -> FloatArray:
    """Master positions (m) of the curves: even, and at the ends of few pieces; many say no more than even ones do."""
    even = np.linspace(profile.start, profile.end, _POINTS)
    return np.union1d(even, profile.breaks) if profile.pieces < _POINTS else even


def _acceleration(audit: Audit, profile: CamProfile, x: FloatArray) -> FloatArray:
    """Acceleration over time at master positions; by differences centred there where the cam's own is unbounded."""
    cut, servo = audit.job.cut, audit.job.servo
    if not audit.is_sampled("peak_acceleration"):
        return np.asarray(profile(x, 2) * cut.line_speed**2)
    return differences(profile, x - cut.line_speed * servo.sample_time, 2, cut, servo)


def _frame(audit: Audit, lines: Sequence[DrawnLine], limit: float, label: str, top: float, height: float) -> Frame:
    """Mark limits that lie near the curves, name those that do not, and leave room around what is drawn."""
    end = converted(audit.job.cut.length, "m", audit.job.units)
    values = np.concatenate([line.points[:, 1] for line in lines])
    least, greatest = float(values.min()), float(values.max())
    reach = max(abs(least), abs(greatest)) or limit
    drawn = [b for b in (limit, -limit) if limit <= _FAR * reach and (b > 0 or least < 0)]
    low, high = min([least, *drawn]), max([greatest, *drawn])
    middle, half = 0.5 * (low + high), 0.5 * (high - low) * _ROOM or 1.0
    items: list[Item] = [*zone_bands(audit.job.cut, audit.job.units), *(across(b, 0.0, end) for b in drawn), *lines]
    if not drawn:
        items.append(Note((end, middle + half), f"limit {number(limit, 4)}: off scale", "end", (0.0, -6.0)))
    return wide_frame(top, height, np.array([0.0, middle - half]), np.array([end, middle + half]), items, "", label)


def _savings(audit: Audit, top: float) -> Frame:
    """Draw what the optimum saves of each measure (%), the values of both beside it; a bar cut off is hatched."""
    unit, units = audit.job.machine.slave_unit, audit.job.units
    savings = [100.0 * (audit.saving(name) or 0.0) for name in MEASURES]
    low, high = max(min(0.0, *savings), -_FARTHEST), max(0.0, *savings)
    room = max(high - low, _LEAST_AXIS)
    start, end = low - (0.04 * room if low < 0 else 0.0), high + 0.95 * room
    items: list[Item] = []
    for i, (name, power, saving) in enumerate(zip(MEASURES, _POWERS, savings, strict=True)):
        own, best = audit.pair(name)
        measure = units.measure(unit + power)
        colour = _BEST.colour if saving >= 0 else _THIS.colour
        far = saving < -_FARTHEST
        items.append(Bar((0.0, -i - 0.31), (max(saving, -_FARTHEST), 0.31 - i), colour, "lines" if far else ""))
        values = " → ".join(number(value if value is None else value * measure.factor, 4) for value in (own, best))
        percent = f"{round(saving, 1) + 0.0:+.1f}".replace("-", "−")
        words = f"{percent} %: {values} {measure.printed}"
        words += ", by differences" if audit.is_sampled(name) else ""
        items.append(Note((max(saving, 0.0), float(-i)), words, "start", (5.0, 0.0)))
    bottom = 0.4 - len(savings)
    items.append(DrawnLine(np.array([[0.0, bottom], [0.0, 0.6]]), BLACK, 0.8))
    chosen = [Tick(*each) for each in zip(*ticks(start, end, 10), strict=True)]
    return Frame(
        _NAMES,
        top,
        WIDTH - _NAMES - RIGHT,
        _ROW * (len(savings) + 0.2),
        np.array([start, bottom]),
        np.array([end, 0.6]),
        items,
        "saved by the optimum (% of the running cam)",
        edges=False,
        xticks=[tick for tick in chosen if low - 1e-9 <= tick.value <= high + 0.1 * room],
        yticks=[Tick(float(-i), words) for i, words in enumerate(MEASURES.values())],
    )
