"""The figure of a family: the sync error of each cam over the line speed, its band shaded."""

from __future__ import annotations

import numpy as np

from camwright.figures.panel import head
from camwright.figures.speed_band import DEEPEST, POINTS, SLOWEST, over_speeds
from camwright.figures.strokes import LINES, Stroke
from camwright.house.pictures import Band, DrawnLine, Picture
from camwright.jobs.servos import servos_of
from camwright.production.family import Family
from camwright.profiles.polynomial.profile import FloatArray
from camwright.validation.servo.line_speeds import line_speed_errors

_BEYOND = 1.1
"""Share of the job's line speed up to which is drawn."""

_HIGHEST = 1e2
"""Greatest part of the tolerance that is drawn."""

_STROKES = (*LINES.values(), Stroke("#7a4fa3", 1.5, (2.5, 2.5)))
"""How the cams are drawn in turn."""


def family_figure(family: Family) -> Picture:
    """Draw the greatest sync error of all servos over the line speed, cam by cam, by powers of ten, and where two bands overlap."""
    job = family.found.job
    length, speed = job.units.shown["m"].factor, job.units.shown["m/s"].factor
    own, tolerance = job.cut.line_speed, job.cut.sync_tolerance * length
    ends = [end for cam in family.cams for end in cam.line_speeds]
    speeds: FloatArray = np.unique([*np.linspace(SLOWEST * own, _BEYOND * own, POINTS), *ends])
    curves: list[DrawnLine] = []
    for cam in family.cams:
        errors = line_speed_errors(cam.solution.profile, cam.job.task, servos_of(job), speeds).max(axis=0) * length
        inside = np.clip(errors, DEEPEST * tolerance, _HIGHEST * tolerance)
        stroke = _STROKES[(cam.number - 1) % len(_STROKES)]
        points = np.stack([speeds * speed, np.log10(inside)], axis=1)
        curves.append(DrawnLine(points, stroke.colour, stroke.width, f"cam {cam.number}", stroke.dash))
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
    return over_speeds(job, head(job.name, "a family of cams"), _BEYOND * own, curves, bands)
