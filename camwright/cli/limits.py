"""The command ``camwright limits``."""

from __future__ import annotations

from camwright.answers.limits import limits_answer
from camwright.cli.options import GivenJob, Json, Quiet
from camwright.cli.views.lengths import lengths_view
from camwright.cli.views.line_ramps import line_ramps_view
from camwright.cli.views.parts import View, new_table, stacked
from camwright.house.numbers import Units, converted, unit_shown, with_unit
from camwright.house.output import Voice
from camwright.jobs.job import load_job
from camwright.studies.axis_lengths import AxisLengths
from camwright.studies.band_lengths import BandLengths
from camwright.studies.limits import LIMITS_STEPS, MachineLimits, limits


def run(job: GivenJob, as_json: Json = False, quiet: Quiet = False) -> int:
    """Say how fast and how short the machine of a job can cut, and which limit binds."""
    asked = load_job(job)
    voice = Voice(as_json, quiet)
    with voice.progress(LIMITS_STEPS) as step:
        found = limits(asked, step)

    voice.answer(lambda: limits_answer(found), lambda: _view(found))
    return 0


def _view(found: MachineLimits) -> View:
    """Show how fast and how short a job can be done, and what binds."""
    job, far, lengths, axis = found.job, found.far, found.lengths, found.axis
    units = job.units
    zone = with_unit(job.cut.sync_zone, "m", 4, units)
    heads = ("", "axis", "speed, length", "binds")
    table = new_table("How fast, how short", heads, heads, heads[2:3])
    fast = f"highest line speed at a cut length of {with_unit(job.cut.length, 'm', 4, units)}"
    short = f"shortest cut at {with_unit(job.cut.line_speed, 'm/s', units=units)} with a sync zone of {zone}"
    for axis_name, reached in (("perfect", far), ("in tolerance", found.within)):
        speed = with_unit(reached.max_line_speed, "m/s", units=units) if reached.max_line_speed else "none works"
        table.add_row(fast, axis_name, speed, reached.line_speed_binding)
    for axis_name, reached in (("perfect", far), ("in tolerance", found.within)):
        length = with_unit(reached.min_cut_length, "m", 4, units) if reached.min_cut_length else "none works"
        table.add_row(short, axis_name, length, reached.cut_length_binding)
    views: list[View] = [table]
    if lengths is not None:
        views.append(lengths_view(lengths, units))
    if axis is not None:
        views.append(_axis_view(axis, found.over_band, units))
    if found.ramps is not None:
        views.append(line_ramps_view(found.ramps))
    return stacked(*views)


def _axis_view(lengths: AxisLengths, band: BandLengths | None, units: Units) -> View:
    """Show how short a piece can be cut with the axis within the tolerance, the sync zone chosen best each time."""
    unit = unit_shown("m", units)
    heads = ["by", f"limits of the command\n{unit}", f"of the axis too\n{unit}"]
    if band is not None:
        low, high = (with_unit(speed, "m/s", units=units) for speed in band.line_speeds)
        heads.append(f"from {low} to {high}\n{unit}")
    table = new_table("Minimum cut length with the axis in sync", heads, heads[:1])
    rows = (
        ("linear return (limit of speed alone)", lengths.linear_return, ""),
        ("polynomial 3-4-5", lengths.poly_3_4_5, ""),
        ("servo-aware, command in sync", lengths.in_sync, _hundredths(units, lengths.in_sync_axis_limits)),
        ("servo-aware, command shaped", lengths.shaped, _hundredths(units, lengths.shaped_axis_limits)),
    )
    over: list[list[str]] = [[]] * len(rows)
    if band is not None:
        by = (band.linear_return, band.poly_3_4_5, band.in_sync, band.shaped)
        over = [[_hundredths(units, length)] for length in by]
    for (name, value, strict), also in zip(rows, over, strict=True):
        table.add_row(name, _hundredths(units, value), strict, *also)
    return table


def _hundredths(units: Units, length: float | None) -> str:
    """Write a length in the job's unit with two decimals."""
    return "none" if length is None else f"{converted(length, 'm', units):.2f}"
