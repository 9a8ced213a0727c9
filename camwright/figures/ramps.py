"""The figure of start and stop: one piece on demand over the master, and what the axis makes of it in the sync zone."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from camwright.figures.marks import blank_figure, line_mark, patch_mark
from camwright.figures.style import LIMIT, LINES, SHEAR_COLOUR, SYNC_COLOUR, shade_shear_zone
from camwright.house.numbers import Units, unit_shown, with_unit
from camwright.production.ramps import Ramps, one_shot_cycle, waiting
from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.profiles.servo import spectral_radius
from camwright.validation.servo.response import sync_error
from camwright.validation.servo.simulation import simulate

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

AIMS = {
    "peak_acceleration": "peak acceleration",
    "rms_acceleration": "heat of one start",
    "shortest": "master that a ramp takes",
}
"""What was made least, in words."""

_POINTS = 400
_MATERIAL = "#6b6b6b"
_PHASES = 16


def ramps_figure(found: Ramps) -> Figure:
    """Draw the one-shot cam with its limits, and the sync error of the axis from rest at every sampling phase."""
    job, units, at = found.job, found.job.units, found.stand
    v, limits, unit = job.cut.line_speed, job.limits, job.machine.slave_unit
    cam = found.one_shot
    zone = found.ramp_in.profile.end, found.zone_end
    figure = blank_figure(7.6)
    travel, speed, acceleration, error = figure.subplots(4, 1, height_ratios=(1.2, 1.0, 1.0, 0.9))
    length = units.shown["m"].factor
    for axes in (travel, speed, acceleration):
        axes.axvspan(zone[0] * length, zone[1] * length, color=SYNC_COLOUR, linewidth=0, zorder=0)
        axes.set_xlim(0.0, cam.end * length)
    shear = zone[0] + job.cut.shear_zone_at
    for order, axes, name in ((0, travel, unit), (1, speed, f"{unit}/s"), (2, acceleration, f"{unit}/s^2")):
        shown = units.shown[name]
        x, value = _curve(cam, order)
        start = at.park if order == 0 else 0.0
        axes.plot(x * length, (value * v**order + start) * shown.factor, **LINES["optimised"])
        axes.set_ylabel(f"{('place', 'velocity', 'acceleration')[order]} ({shown.printed})")
        _shear(axes, shear, job.cut.shear_zone, units)
    inside = np.linspace(*zone, 50)
    met = at.zone(np.linspace(at.zone.start, at.zone.end, 50)) * units.shown[unit].factor
    travel.plot(inside * length, met, color=_MATERIAL, linewidth=4.0, alpha=0.35, zorder=3)
    for axes, limit in ((speed, limits.speed), (acceleration, limits.acceleration)):
        name = f"{unit}/s" if axes is speed else f"{unit}/s^2"
        low, high = axes.get_ylim()
        for sign in (-1.0, 1.0):
            line = sign * limit * units.shown[name].factor
            if 2.5 * low <= line <= 2.5 * high:
                axes.axhline(line, **LIMIT)
    acceleration.set_xlabel(f"master from where the slave leaves its park ({unit_shown('m', units)})")
    _error(error, found, units)
    figure.align_ylabels()
    figure.suptitle(
        f"{job.name}: start, sync zone and stop at {with_unit(v, 'm/s', units=units)}, minimised: {AIMS[found.aim]}\n"
        f"start {with_unit(found.ramp_in.master, 'm', units=units)} of material in {with_unit(found.ramp_in.time, 's')}, "
        f"stop {with_unit(found.ramp_out.master, 'm', units=units)}, whole {with_unit(cam.length, 'm', units=units)}",
        fontsize=9,
    )
    figure.legend(
        handles=[
            line_mark(label="slave", **LINES["optimised"]),
            line_mark(color=_MATERIAL, linewidth=4.0, alpha=0.35, label="in sync"),
            patch_mark(facecolor=SYNC_COLOUR, label="sync zone"),
            patch_mark(facecolor=SHEAR_COLOUR, edgecolor="#8c8c8c", hatch="////", linewidth=0, label="shear zone"),
            line_mark(label="limit or tolerance", **LIMIT),
        ],
        loc="outside lower center",
        ncols=5,
    )
    return figure


def _curve(profile: CamProfile, order: int) -> tuple[FloatArray, FloatArray]:
    """Give master positions and values of a derivative, both sides of every break."""
    x = np.union1d(np.linspace(profile.start, profile.end, _POINTS), profile.breaks)
    doubled = np.repeat(x, 2)
    value = np.column_stack([profile(x, order, side="left"), profile(x, order)]).ravel()
    return doubled, value


def _shear(axes: Axes, start: float, length: float, units: Units) -> None:
    """Shade the shear zone in the job's unit."""
    size = units.shown["m"].factor * 1e-3
    shade_shear_zone(axes, start * size, (start + length) * size)


def _error(axes: Axes, found: Ramps, units: Units) -> None:
    """Draw the sync error of the axis that comes from rest, over the sync zone."""
    job = found.job
    axes.set_ylabel(f"sync error\nof the axis ({unit_shown('m', units)})")
    axes.set_xlabel(f"master from the start of the sync zone ({unit_shown('m', units)})")
    length = units.shown["m"].factor
    axes.set_xlim(0.0, job.cut.sync_zone * length)
    _shear(axes, job.cut.shear_zone_at, job.cut.shear_zone, units)
    if not spectral_radius(job.servo) < 1.0:
        axes.text(0.5, 0.5, "the servo is unstable", transform=axes.transAxes, ha="center")
        return
    cycle, task = one_shot_cycle(found.stand, found.one_shot, found.zone_end, waiting(job))
    start = task.cut.return_zone
    run = simulate(cycle, task.cut, job.servo)
    master, error, _ = sync_error(run, cycle, task, start, start + task.cut.sync_zone)
    for phase in range(run.phases):
        axes.plot(
            (master[phase] - start) * length, error[phase] * length, color=LINES["optimised"]["color"], linewidth=0.5
        )
    tolerance = job.cut.sync_tolerance * length
    for sign in (-1.0, 1.0):
        axes.axhline(sign * tolerance, **LIMIT)
    greatest = float(np.abs(error).max()) * length
    axes.set_ylim(-min(1.1 * greatest, 8 * tolerance) - tolerance, min(1.1 * greatest, 8 * tolerance) + tolerance)
    axes.set_title(
        f"the axis from rest, all {run.phases} sampling phases, at {with_unit(math.fabs(job.cut.line_speed), 'm/s', units=units)}"
    )
