"""The figure of start and stop: one piece on demand over the master, and what the axis makes of it in the sync zone."""

from __future__ import annotations

import numpy as np

from camwright.figures.panel import (
    NOTHING,
    across,
    band,
    first_frame,
    head,
    page,
    profile_line,
    thin_line,
    wide_frame,
)
from camwright.house.numbers import converted, unit_shown, with_unit
from camwright.house.pictures import DrawnLine, Frame, Item, Note, Picture
from camwright.production.ramps import Ramps, one_shot_cycle, waiting
from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.profiles.servo import spectral_radius
from camwright.validation.servo.response import sync_error
from camwright.validation.servo.simulation import simulate

AIMS = {
    "peak_acceleration": "peak acceleration",
    "rms_acceleration": "heat of one start",
    "shortest": "master that a ramp takes",
}
"""What was made least, in words."""

_POINTS = 400
_PANELS = (144.0, 120.0, 120.0)
"""Heights of the panels of place, velocity and acceleration (pt)."""

_ERROR = 108.0
"""Height of that of the sync error (pt)."""

_FAR = 2.5
"""A limit is drawn if it is at most this many times the least or greatest value."""

_IN_SYNC = 5.0
"""Width of the line of the material (pt)."""


def ramps_figure(found: Ramps) -> Picture:
    """Draw the one-shot cam with its limits, and the sync error of the axis from rest at every sampling phase."""
    job, units = found.job, found.job.units
    heading = head(
        job.name,
        f"start, sync zone and stop at {with_unit(job.cut.line_speed, 'm/s', units=units)}, minimised: {AIMS[found.aim]}",
    )
    heading += (
        f"\nstart {with_unit(found.ramp_in.master, 'm', units=units)} of material in {with_unit(found.ramp_in.time, 's')}, "
        f"stop {with_unit(found.ramp_out.master, 'm', units=units)}, whole {with_unit(found.one_shot.length, 'm', units=units)}"
    )
    top = first_frame(heading)
    frames = []
    for order, height in enumerate(_PANELS):
        frames.append(_motion(found, order, top, height))
        top += height + 18.0
    frames.append(_error(found, top + 48.0))
    legend: list[Item] = [
        profile_line("optimised", NOTHING, "slave"),
        DrawnLine(NOTHING, "#c0c0c0", _IN_SYNC, "in sync"),
        band(0.0, 1.0, "sync zone", units),
        band(0.0, 1.0, "shear zone", units),
        across(0.0, 0.0, 1.0, "limit or tolerance"),
    ]
    return page(heading, frames, legend)


def _motion(found: Ramps, order: int, top: float, height: float) -> Frame:
    """Draw place, velocity or acceleration over the master."""
    job, units, cam, at = found.job, found.job.units, found.one_shot, found.stand
    unit = job.machine.slave_unit
    shown = units.shown[(unit, f"{unit}/s", f"{unit}/s^2")[order]]
    length = converted(1.0, "m", units)
    x, value = _curve(cam, order)
    start = at.park if order == 0 else 0.0
    curve = np.stack([x * length, (value * job.cut.line_speed**order + start) * shown.factor], axis=1)
    low, high = float(curve[:, 1].min()), float(curve[:, 1].max())
    limit = (None, job.limits.speed, job.limits.acceleration)[order]
    bounds = [] if limit is None else [sign * limit * shown.factor for sign in (-1.0, 1.0)]
    drawn = [bound for bound in bounds if _FAR * low <= bound <= _FAR * high]
    low, high = min([low, *drawn]), max([high, *drawn])
    room = 0.06 * (high - low) or 1.0
    zone = found.ramp_in.profile.end, found.zone_end
    shear = zone[0] + job.cut.shear_zone_at
    items: list[Item] = [
        band(*zone, "sync zone", units),
        band(shear, shear + job.cut.shear_zone, "shear zone", units),
        *(across(bound, 0.0, cam.end * length) for bound in drawn),
    ]
    if order == 0:
        met = at.zone(np.linspace(at.zone.start, at.zone.end, 50)) * shown.factor
        items.append(DrawnLine(np.stack([np.linspace(*zone, 50) * length, met], axis=1), "#c0c0c0", _IN_SYNC))
    items.append(profile_line("optimised", curve))
    return wide_frame(
        top,
        height,
        np.array([0.0, low - room]),
        np.array([cam.end * length, high + room]),
        items,
        f"master from where the slave leaves its park ({unit_shown('m', units)})" if order == 2 else "",
        f"{('place', 'velocity', 'acceleration')[order]} ({shown.printed})",
    )


def _curve(profile: CamProfile, order: int) -> tuple[FloatArray, FloatArray]:
    """Give master positions and values of a derivative, both sides of every break."""
    x = np.union1d(np.linspace(profile.start, profile.end, _POINTS), profile.breaks)
    doubled = np.repeat(x, 2)
    value = np.column_stack([profile(x, order, side="left"), profile(x, order)]).ravel()
    return doubled, value


def _error(found: Ramps, top: float) -> Frame:
    """Draw the sync error of the axis that comes from rest, over the sync zone."""
    job, units = found.job, found.job.units
    length, end = converted(1.0, "m", units), converted(job.cut.sync_zone, "m", units)
    tolerance = job.cut.sync_tolerance * length
    shear = job.cut.shear_zone_at
    items: list[Item] = [band(shear, shear + job.cut.shear_zone, "shear zone", units)]
    half, words = 2.0 * tolerance, ""
    if spectral_radius(job.servo) < 1.0:
        cycle, task = one_shot_cycle(found.stand, found.one_shot, found.zone_end, waiting(job))
        start = task.cut.return_zone
        run = simulate(cycle, task.cut, job.servo)
        master, error, _ = sync_error(run, cycle, task, start, start + task.cut.sync_zone)
        items += [
            thin_line("optimised", np.stack([x - start, y], axis=1) * length)
            for x, y in zip(master, error, strict=True)
        ]
        half = min(1.1 * float(np.abs(error).max()) * length, 8 * tolerance) + tolerance
        words = f"the axis from rest, all {run.phases} sampling phases, at {with_unit(job.cut.line_speed, 'm/s', units=units)}"
    else:
        items.append(Note((0.5 * end, 0.5 * tolerance), "the servo is unstable", "middle"))
    items += [across(sign * tolerance, 0.0, end) for sign in (-1.0, 1.0)]
    return wide_frame(
        top,
        _ERROR,
        np.array([0.0, -half]),
        np.array([end, half]),
        items,
        f"master from the start of the sync zone ({unit_shown('m', units)})",
        f"sync error\nof the axis ({unit_shown('m', units)})",
        words,
    )
