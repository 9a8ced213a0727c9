"""The axis figure of a servo-aware design: command and axis about the shear zone, sync error at every phase, robustness as a band."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from camwright.figures.marks import blank_figure, line_mark, patch_mark
from camwright.figures.style import (
    LIMIT,
    LINES,
    SHEAR_COLOUR,
    shade_shear_zone,
    title,
)
from camwright.house.numbers import with_unit
from camwright.profiles.polynomial.profile import FloatArray
from camwright.studies.axis_study import RobustBand
from camwright.studies.design import Design
from camwright.validation.servo.axis_run import ServoRun
from camwright.validation.servo.response import sync_error

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch


AXES = ("linear_return", "poly_3_4_5", "optimised")
"""Profiles whose axis is drawn, where they exist."""

_AROUND = 0.75
"""Part of the shear zone drawn before it; where it has no length, of the sync zone."""

_CLOSE = 1.6
"""Half height of the close views, as a multiple of the sync tolerance."""

_COMMAND: dict[str, Any] = {"color": "#6b6b6b", "linestyle": (0, (1, 1)), "linewidth": 1.3}


def axis_figure(design: Design, runs: Mapping[str, ServoRun], band: RobustBand | None) -> Figure:
    """Draw what a servo-aware design makes of the axis.

    Parameters
    ----------
    design
        A servo-aware design.
    runs
        Simulated responses of profiles, by name.
    band
        Sync error over the servo's ranges; ``None`` if the job gives none.
    """
    job, cut = design.job, design.job.cut
    panels = 2 if band is None else 3
    figure = blank_figure(1.2 + 2.4 * panels)
    axes = figure.subplots(panels, 1, sharex=True, squeeze=False)[:, 0]
    shear = (cut.shear_zone_at, cut.shear_zone_at + cut.shear_zone)
    around = _AROUND * (cut.shear_zone or 0.2 * cut.sync_zone)
    first, last = max(0.0, shear[0] - around), min(cut.sync_zone, shear[1] + around)
    for each in axes:
        shade_shear_zone(each, *shear)
        for sign in (-1.0, 1.0):
            each.axhline(sign * cut.sync_tolerance * 1e3, **LIMIT)
        each.set_ylabel("off the material (mm)")
    _meeting(axes[0], design, runs["optimised"], first, last)
    study = design.axis
    found = "" if study is None else f": at most {study.simulated_error * 1e6:.3g} µm off in the shear zone"
    axes[0].set_title(f"command and axis, {job.command.replace('_', ' ')}{found}; logarithmic beyond the tolerance")
    for name in AXES:
        if name in runs:
            _errors(axes[1], design, name, runs[name], first, last)
    axes[1].set_ylim(-_CLOSE * cut.sync_tolerance * 1e3, _CLOSE * cut.sync_tolerance * 1e3)
    axes[1].set_title(f"axis of each profile, all {runs['optimised'].phases} sampling phases, close to the tolerance")
    if band is not None:
        _band(axes[2], band, cut.sync_tolerance)
    axes[-1].set_xlim(first * 1e3, last * 1e3)
    axes[-1].set_xlabel("master from the start of the sync zone (mm)")
    figure.suptitle(f"{job.name}: the axis at {with_unit(cut.line_speed, 'm/s')}", fontsize=8.5)
    _legend(figure, [name for name in AXES if name in runs], band is not None)
    return figure


def _errors_of(design: Design, name: str, run: ServoRun, first: float, last: float) -> tuple[FloatArray, FloatArray]:
    """Master from the start of the sync zone and sync error (m), for every phase."""
    job = design.job
    start = job.cut.return_start + job.cut.return_zone
    master, error, _ = sync_error(run, design.comparison[name].profile, job.task, start + first, start + last)
    return master - start, error


def _meeting(axes: Axes, design: Design, run: ServoRun, first: float, last: float) -> None:
    """Draw command and axis of the optimised profile, both less the material."""
    job = design.job
    as_axis = ServoRun(run.master, run.command, run.command, run.axis_ratio)
    master, lead = _errors_of(design, "optimised", as_axis, first, last)
    axes.plot(master[0] * 1e3, lead[0] * 1e3, **_COMMAND)
    master, error = _errors_of(design, "optimised", run, first, last)
    for phase in range(run.phases):
        style = LINES["optimised"] if phase == 0 else {**LINES["optimised"], "linewidth": 0.4}
        axes.plot(master[phase] * 1e3, error[phase] * 1e3, **style)
    axes.set_yscale(
        "symlog", linthresh=job.cut.sync_tolerance * 1e3, linscale=1.5
    )  # the command leads by far more than the axis is off


def _errors(axes: Axes, design: Design, name: str, run: ServoRun, first: float, last: float) -> None:
    """Draw the sync error of a profile at every phase."""
    master, error = _errors_of(design, name, run, first, last)
    for phase in range(run.phases):
        style = LINES[name] if phase == 0 else {**LINES[name], "linestyle": "-", "linewidth": 0.4}
        axes.plot(master[phase] * 1e3, error[phase] * 1e3, **style)


def _band(axes: Axes, band: RobustBand, tolerance: float) -> None:
    """Draw the sync error over the servo's ranges as a band, and that of the nominal servo."""
    x = band.master * 1e3
    axes.fill_between(
        x, band.low * 1e3, band.high * 1e3, facecolor="#9ecae8", edgecolor="#0072b2", hatch="....", linewidth=0.6
    )
    axes.plot(x, band.nominal * 1e3, **LINES["optimised"])
    worst = max(float(np.abs(band.low).max()), float(np.abs(band.high).max()), tolerance)
    axes.set_ylim(-1.25 * worst * 1e3, 1.25 * worst * 1e3)
    axes.set_title(f"optimised, over the ranges of the servo: {band.servos} random servos and the corners, every phase")


def _legend(figure: Figure, names: list[str], with_band: bool) -> None:
    handles: list[Line2D | Patch] = [line_mark(label=f"axis, {title(name)}", **LINES[name]) for name in names]
    handles += [
        line_mark(label="command, optimised", **_COMMAND),
        line_mark(label="sync tolerance", **LIMIT),
        patch_mark(facecolor=SHEAR_COLOUR, edgecolor="#8c8c8c", hatch="////", linewidth=0, label="shear zone"),
    ]
    if with_band:
        handles.append(
            patch_mark(facecolor="#9ecae8", edgecolor="#0072b2", hatch="....", linewidth=0.6, label="servo's ranges")
        )
    figure.legend(handles=handles, loc="outside lower center", ncols=4)
