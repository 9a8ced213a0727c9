"""The figure of line speeds: the sync error in the shear zone over the speed of the line, and where the cam is released."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from camwright.figures.panel import (
    across,
    first_frame,
    head,
    page,
    profile_line,
    thin_line,
    wide_frame,
)
from camwright.figures.strokes import GREY, Stroke
from camwright.figures.style import broken_note, marked
from camwright.house.numbers import unit_shown, with_unit
from camwright.house.pictures import APART, Band, DrawnLine, Item, Picture, Tick
from camwright.jobs.job import Job
from camwright.jobs.servos import servos_of
from camwright.profiles.polynomial.profile import FloatArray
from camwright.studies.axis_study import cam_for_one_speed
from camwright.studies.design import Design
from camwright.validation.servo.line_speeds import line_speed_errors

SHOWN = ("optimised", "linear_return")
"""Profiles whose error is drawn."""

POINTS = 121
SLOWEST = 0.02
"""Share of the highest speed drawn at which the curves begin."""

_BEYOND = 1.15
"""Factor on the highest released speed, or the job's, up to which is drawn."""

DEEPEST = 1e-3
"""Least part of the tolerance that is drawn: below it is rounding and no drive resolves it."""

_PANEL = 168.0
"""Height of the panel (pt)."""

_ALONE = Stroke("#7a4fa3", 1.1, (2.5, 2.5))
"""How the cam that was designed for the job's line speed alone is drawn."""


def speed_band_figure(design: Design) -> Picture:
    """Draw the sync error over the line speed, by powers of ten, the tolerance as a line, the released speeds shaded.

    Parameters
    ----------
    design
        A design whose servo is stable; one for several line speeds has the same job's design for its own alone beside it.
    """
    job, band, units = design.job, design.band, design.job.units
    length, speed = units.shown["m"].factor, units.shown["m/s"].factor
    top = _BEYOND * max([job.cut.line_speed, *(high for _, high in band.parts)])
    speeds: FloatArray = np.unique([*np.linspace(SLOWEST * top, top, POINTS), job.cut.line_speed])
    tolerance = job.cut.sync_tolerance * length
    servos = servos_of(job)
    curves: list[DrawnLine] = []
    for name in SHOWN:
        called = marked(design.comparison[name])
        errors = line_speed_errors(design.comparison[name].profile, job.task, servos, speeds) * length
        floored = np.log10(np.maximum(errors, DEEPEST * tolerance))
        curves.append(profile_line(name, np.stack([speeds * speed, floored[0]], axis=1), called))
        if len(servos) > 1:
            worst = np.stack([speeds * speed, floored.max(axis=0)], axis=1)
            curves.append(thin_line(name, worst, f"{called}, worst servo of its ranges"))
    alone = cam_for_one_speed(job)
    if alone is not None:
        errors = line_speed_errors(*alone, servos[:1], speeds)[0] * length
        points = np.stack([speeds * speed, np.log10(np.maximum(errors, DEEPEST * tolerance))], axis=1)
        own_speed = with_unit(job.cut.line_speed, "m/s", units=units)
        curves.append(DrawnLine(points, _ALONE.colour, _ALONE.width, f"designed for {own_speed} alone", _ALONE.dash))
    bands = [
        Band(start * speed, end * speed, "green", "every check of the optimised cam passes")
        for start, end in band.parts
    ]
    heading = head(job.name, "one cam at every line speed") + broken_note(design.comparison[name] for name in SHOWN)
    return over_speeds(job, heading, top, curves, bands)


def over_speeds(job: Job, heading: str, top: float, curves: Sequence[DrawnLine], bands: Sequence[Band]) -> Picture:
    """Draw the sync error over the line speed by powers of ten, with the tolerance and the job's own line speed.

    Parameters
    ----------
    heading
        Above the figure.
    top
        Highest line speed drawn (m/s).
    curves
        Logarithms of the errors over the line speed, in the units shown.
    bands
        Line speeds that are shaded.
    """
    units, speed = job.units, job.units.shown["m/s"].factor
    tolerance = job.cut.sync_tolerance * units.shown["m"].factor
    low = math.log10(0.7 * DEEPEST * tolerance)
    high = max(math.log10(tolerance), *(float(line.points[:, 1].max()) for line in curves)) + 0.15
    own = job.cut.line_speed * speed
    marks = [
        across(math.log10(tolerance), 0.0, top * speed, "sync tolerance"),
        DrawnLine(np.array([[own, low], [own, high]]), GREY, 1.1, "line speed of the job"),
    ]
    items: list[Item] = [*bands, *marks, *reversed(curves)]
    frame = wide_frame(
        first_frame(heading),
        _PANEL,
        np.array([0.0, low]),
        np.array([top * speed, high]),
        items,
        f"line speed ({unit_shown('m/s', units)})",
        f"sync error in the\nshear zone ({unit_shown('m', units)})",
        yticks=[Tick(float(power), f"{10.0**power:g}") for power in range(math.ceil(low), math.floor(high) + 1)],
        apart=APART,
    )
    return page(heading, [frame], [*curves, *marks, *bands])
