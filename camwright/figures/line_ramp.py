"""The figure of a line that ramps: how hard it may over its speed, and what the axis is off the material meanwhile."""

from __future__ import annotations

import math

import numpy as np

from camwright.figures.panel import across, first_frame, head, page, wide_frame
from camwright.house.numbers import converted, unit_shown
from camwright.house.pictures import APART, DrawnLine, DrawnMarks, Frame, Item, Picture
from camwright.profiles.polynomial.profile import FloatArray
from camwright.studies.line_ramps import LineRamps

COLOURS = {"speeding": "#4477aa", "braking": "#ee6677"}
"""Colours of the two ways; the marks differ in shape too."""

_WORDS = {"speeding": "speeding up", "braking": "braking"}
_PANEL, _BETWEEN = 150.0, 46.0
"""Height of a panel and what is free below it (pt)."""


def line_ramp_figure(ramps: LineRamps) -> Picture:
    """Draw what the cam allows over the line speed, and below it the sync error of each cut while the line ramps as the job says.

    Parameters
    ----------
    ramps
        How hard the line may ramp, and the servo meanwhile.
    """
    job, units = ramps.job, ramps.job.units
    speeds = np.array([converted(each.line_speed, "m/s", units) for each in ramps.curve])
    top = 1.03 * float(speeds[-1])
    legend: list[Item] = []
    allowed: list[Item] = []
    for way in COLOURS:
        values = np.array([getattr(each, way).value for each in ramps.curve])
        shown = np.array([converted(value, "m/s^2", units) if math.isfinite(value) else math.nan for value in values])
        line = DrawnLine(
            np.stack([speeds, shown], axis=1)[np.isfinite(shown)],
            COLOURS[way],
            2.0,
            f"allowed, {_WORDS[way]}",
            () if way == "speeding" else (8.0, 2.6),
        )
        allowed.append(line)
        asked = job.line.speeding if way == "speeding" else job.line.braking
        if asked:
            limit = converted(asked, "m/s^2", units)
            allowed.append(
                DrawnLine(
                    np.array([[0.0, limit], [top, limit]]), COLOURS[way], 1.1, f"asked, {_WORDS[way]}", (1.3, 2.0)
                )
            )
    highest = max(
        (float(item.points[:, 1].max(initial=0.0)) for item in allowed if isinstance(item, DrawnLine)), default=1.0
    )
    heading = head(job.name, "a line that ramps")
    first = first_frame(heading)
    speed, ramp = f"line speed ({unit_shown('m/s', units)})", unit_shown("m/s^2", units)
    frames = [_frame(first, top, 1.08 * max(highest, 1e-9), allowed, speed, f"ramp of the\nline ({ramp})")]
    legend += allowed
    if ramps.sync is not None:
        tolerance = converted(job.cut.sync_tolerance, "m", units)
        items: list[Item] = []
        highest = tolerance
        for way, passed, errors in zip(ramps.sync.ways, ramps.sync.line_speeds, ramps.sync.errors, strict=True):
            points: FloatArray = np.stack(
                [converted(1.0, "m/s", units) * passed, converted(1.0, "m", units) * errors], axis=1
            )
            highest = max(highest, float(points[:, 1].max()))
            items.append(
                DrawnMarks(
                    points, COLOURS[way], 4.0, "disc" if way == "speeding" else "diamond", f"cut while {_WORDS[way]}"
                )
            )
        items.append(across(tolerance, 0.0, top, "sync tolerance"))
        words = f"sync error in the\nshear zone ({unit_shown('m', units)})"
        frames.append(_frame(first + _PANEL + _BETWEEN, top, 1.08 * highest, items, speed, words))
        legend += items
    return page(heading, frames, legend)


def _frame(above: float, right: float, highest: float, items: list[Item], xlabel: str, ylabel: str) -> Frame:
    """Make a panel over the line speed, from zero."""
    return wide_frame(
        above, _PANEL, np.array([0.0, 0.0]), np.array([right, highest]), items, xlabel, ylabel, apart=APART
    )
