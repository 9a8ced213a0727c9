"""The figures of a design."""

from __future__ import annotations

from camwright.figures.axis import AXES as SHOWN_AXES
from camwright.figures.axis import axis_figure
from camwright.figures.comparison import bars_figure
from camwright.figures.crank import crank_figure
from camwright.figures.line_ramp import line_ramp_figure
from camwright.figures.profile import profile_figure
from camwright.figures.servo import AXES, servo_figure
from camwright.figures.speed_band import speed_band_figure
from camwright.house.pictures import Picture
from camwright.studies.axis_study import robust_band
from camwright.studies.design import Design
from camwright.studies.line_ramps import line_ramps
from camwright.validation.servo.simulation import simulate


def design_figures(design: Design) -> dict[str, Picture]:
    """Draw the figures of a design, by their names.

    They are ``profile``, ``servo``, ``comparison`` and ``speed_band``; for a tool that turns back also ``crank``, for a servo-aware design
    ``axis``, for a line that ramps ``line_ramp``.
    """
    job, comparison = design.job, design.comparison
    runs = {name: simulate(comparison[name].profile, job.cut, job.servo) for name in AXES}
    pictures = {
        "profile": profile_figure(comparison),
        "servo": servo_figure(comparison, runs),
        "comparison": bars_figure(comparison),
        "speed_band": speed_band_figure(design),
    }
    if job.machine.dead_centres is not None:
        pictures["crank"] = crank_figure(comparison)
    if design.axis is not None:
        names = {row.name for row in comparison.rows}
        axes = {name: simulate(comparison[name].profile, job.cut, job.servo) for name in SHOWN_AXES if name in names}
        pictures["axis"] = axis_figure(design, axes, robust_band(job, design.profile))
    if job.line.ramps:
        pictures["line_ramp"] = line_ramp_figure(line_ramps(design.profile, job))
    return pictures
