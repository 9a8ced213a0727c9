"""The figure of line speeds: the sync error in the shear zone over the speed of the line, and where the cam is released."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from camwright.figures.marks import blank_figure, patch_mark
from camwright.figures.style import LIMIT, LINES, title
from camwright.house.numbers import unit_shown
from camwright.profiles.polynomial.profile import FloatArray
from camwright.studies.axis_study import servos_of
from camwright.studies.design import Design
from camwright.validation.servo.line_speeds import line_speed_errors

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SHOWN = ("optimised", "linear_return")
"""Profiles whose error is drawn."""

_POINTS = 121
_SLOWEST = 0.02
"""Share of the highest speed drawn at which the curves begin."""

_BEYOND = 1.15
"""Factor on the highest released speed, or the job's, up to which is drawn."""

_DEEPEST = 1e-3
"""Least part of the tolerance that is drawn: below it is rounding and no drive resolves it."""

_RELEASED = "#d9ead3"


def speed_band_figure(design: Design) -> Figure:
    """Draw the sync error over the line speed, the tolerance as a line, the released speeds shaded.

    Parameters
    ----------
    design
        A design whose servo is stable.
    """
    job, band, units = design.job, design.band, design.job.units
    length, speed = units.shown["m"].factor, units.shown["m/s"].factor
    top = _BEYOND * max([job.cut.line_speed, *(high for _, high in band.parts)])
    speeds: FloatArray = np.unique([*np.linspace(_SLOWEST * top, top, _POINTS), job.cut.line_speed])
    figure = blank_figure(3.4)
    axes = figure.add_subplot()
    for low, high in band.parts:
        axes.axvspan(low * speed, high * speed, color=_RELEASED, linewidth=0, zorder=0)
    tolerance = job.cut.sync_tolerance * length
    servos = servos_of(job)
    for name in SHOWN:
        errors = line_speed_errors(design.comparison[name].profile, job.task, servos, speeds) * length
        look: dict[str, Any] = LINES[name]
        axes.plot(speeds * speed, np.maximum(errors[0], _DEEPEST * tolerance), label=title(name), **look)
        if len(servos) > 1:
            worst = np.maximum(errors.max(axis=0), _DEEPEST * tolerance)
            thin = {**look, "linewidth": 0.7}
            axes.plot(speeds * speed, worst, label=f"{title(name)}, worst servo of its ranges", **thin)
    axes.axhline(tolerance, label="sync tolerance", **LIMIT)
    axes.axvline(job.cut.line_speed * speed, color="#6b6b6b", linewidth=0.9, label="line speed of the job")
    axes.set_yscale("log")
    axes.set_xlim(0.0, top * speed)
    axes.set_ylim(bottom=0.7 * _DEEPEST * tolerance)
    axes.set_xlabel(f"line speed ({unit_shown('m/s', units)})")
    axes.set_ylabel(f"sync error in the shear zone ({unit_shown('m', units)})")
    figure.suptitle(f"{job.name}: one cam at every line speed", fontsize=9.5)
    handles = axes.get_legend_handles_labels()[0]
    if band.parts:
        handles.append(patch_mark(facecolor=_RELEASED, label="every check of the optimised cam passes"))
    figure.legend(handles=handles, loc="outside lower center", ncols=2)
    return figure
