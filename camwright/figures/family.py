"""The figure of a family: the sync error of each cam over the line speed, its band shaded."""

from __future__ import annotations

import math

import numpy as np

from camwright.figures.panel import across, first_frame, head, page, wide_frame
from camwright.figures.strokes import GREY, LINES, Stroke
from camwright.house.numbers import unit_shown
from camwright.house.pictures import APART, Band, Item, Line, Picture, Tick
from camwright.jobs.servos import servos_of
from camwright.production.family import Family
from camwright.profiles.polynomial.profile import FloatArray
from camwright.validation.servo.line_speeds import line_speed_errors

_POINTS = 121
_SLOWEST, _BEYOND = 0.02, 1.1
"""Shares of the job's line speed between which is drawn."""

_DEEPEST, _HIGHEST = 1e-3, 1e2
"""Parts of the tolerance between which is drawn."""

_PANEL = 168.0
"""Height of the panel (pt)."""

_STROKES = (*LINES.values(), Stroke("#7a4fa3", 1.5, (2.5, 2.5)))
"""How the cams are drawn in turn."""


def family_figure(family: Family) -> Picture:
    """Draw the greatest sync error of all servos over the line speed, cam by cam, by powers of ten, and where two bands overlap."""
    job = family.found.job
    length, speed = job.units.shown["m"].factor, job.units.shown["m/s"].factor
    own, tolerance = job.cut.line_speed, job.cut.sync_tolerance * length
    ends = [end for cam in family.cams for end in cam.line_speeds]
    speeds: FloatArray = np.unique([*np.linspace(_SLOWEST * own, _BEYOND * own, _POINTS), *ends])
    curves: list[Line] = []
    for cam in family.cams:
        errors = line_speed_errors(cam.solution.profile, cam.job.task, servos_of(job), speeds).max(axis=0) * length
        inside = np.clip(errors, _DEEPEST * tolerance, _HIGHEST * tolerance)
        stroke = _STROKES[(cam.number - 1) % len(_STROKES)]
        points = np.stack([speeds * speed, np.log10(inside)], axis=1)
        curves.append(Line(points, stroke.colour, stroke.width, f"cam {cam.number}", stroke.dash))
    low = math.log10(0.7 * _DEEPEST * tolerance)
    high = max(math.log10(tolerance), *(float(line.points[:, 1].max()) for line in curves)) + 0.15
    bands = [
        *(
            Band(low * speed, high * speed, "green", "a cam of the family passed every check")
            for low, high in (cam.line_speeds for cam in family.cams if cam.passed)
        ),
        *(
            Band(each.down * speed, each.up * speed, "hatched", "between switching down and up")
            for each in family.switchings
        ),
    ]
    marks = [
        across(math.log10(tolerance), 0.0, _BEYOND * own * speed, "sync tolerance"),
        Line(np.array([[own * speed, low], [own * speed, high]]), GREY, 1.1, "line speed of the job"),
    ]
    items: list[Item] = [*bands, *marks, *reversed(curves)]
    heading = head(job.name, "a family of cams")
    frame = wide_frame(
        first_frame(heading),
        _PANEL,
        np.array([0.0, low]),
        np.array([_BEYOND * own * speed, high]),
        items,
        f"line speed ({unit_shown('m/s', job.units)})",
        f"sync error in the\nshear zone ({unit_shown('m', job.units)})",
        yticks=[Tick(float(power), f"{10.0**power:g}") for power in range(math.ceil(low), math.floor(high) + 1)],
        apart=APART,
    )
    return page(heading, [frame], [*curves, *marks, *bands])
