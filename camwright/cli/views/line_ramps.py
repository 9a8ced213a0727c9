"""How hard the line may ramp on a cam."""

from __future__ import annotations

import math

from camwright.cli.views.parts import View, new_table, new_text, stacked
from camwright.house.numbers import Units, converted, inside, number, unit_shown, with_unit
from camwright.studies.line_ramps import LEAST_RAMP, LineRamps
from camwright.validation.production.line_ramp import Allowed

_EVERY = 5
"""Of the curve's line speeds each of this number is shown."""


def line_ramps_view(found: LineRamps) -> View:
    """Show what the line may do at some speeds, and the two numbers for the PLC."""
    units = found.job.units
    speed, ramp = unit_shown("m/s", units), unit_shown("m/s^2", units)
    heads = (f"line speed\n{speed}", f"speeding up\n{ramp}", f"braking\n{ramp}", "binds")
    table = new_table("How hard the line may ramp, at any phase", heads, left=("binds",))
    for each in found.curve[_EVERY - 1 :: _EVERY]:
        speed = number(converted(each.line_speed, "m/s", units), 4)
        table.add_row(speed, ramp_words(each.speeding, units), ramp_words(each.braking, units), each.ramp.binds)
    return stacked(table, new_text(plc_words(found)))


def plc_words(found: LineRamps) -> str:
    """Word the two numbers for the PLC, and what the acceleration alone would allow."""
    units, unit = found.job.units, unit_shown("m/s^2", found.job.units)
    ramp, stop = ramp_words(found.up_to.ramp, units), ramp_words(found.up_to.braking, units)
    within = "" if found.stop_length is None else f", within {with_unit(found.stop_length, 'm', 4, units)}"
    text = f"for the PLC, from standstill to {with_unit(found.job.cut.line_speed, 'm/s', 5, units)}: ramps up to {ramp} {unit} "
    text += f"({found.up_to.ramp.binds}), emergency stop up to {stop} {unit}{within}"
    if found.up_to.ramp.binds == "jerk":
        text += f"; acceleration alone would allow {ramp_words(found.alone, units)} {unit}"
        text += " (give [line] acceleration and a design leaves it room)" if not found.job.line.ramps else ""
    return f"{text}{sync_words(found)}"


def sync_words(found: LineRamps) -> str:
    """Word what the axis is off the material while the line ramps as the job says; nothing where that is not known."""
    if found.sync is None:
        return ""
    units = found.job.units
    error, speed, way = found.sync.worst
    beyond = (
        ""
        if error <= found.job.cut.sync_tolerance
        else ", beyond the tolerance: what is cut meanwhile is scrap or a lead for it is needed"
    )
    at = with_unit(speed, "m/s", 4, units)
    return f"; sync error while it ramps as the job says: {with_unit(error, 'm', 4, units)} at most ({way}, at {at}){beyond}"


def ramp_words(allowed: Allowed, units: Units) -> str:
    """Write a ramp that is allowed without its unit, rounded to the safe side."""
    if math.isinf(allowed.value):
        return "any"
    if allowed.value < LEAST_RAMP:
        return "0"
    return number(inside(converted(allowed.value, "m/s^2", units), 4, up=False), 4)
