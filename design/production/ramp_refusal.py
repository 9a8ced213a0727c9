"""Why a machine cannot start or stop from a park, and what would work: a park or a line speed, each tried."""

from __future__ import annotations

import math

from camwright.design.production.ramps import (
    balanced,
    can_stand,
    can_start_and_stop,
    fastest_line,
    has_room,
    least_arcs,
    zone_kept,
)
from camwright.profiles.errors import InfeasibleError, Suggestion
from camwright.profiles.message import Message, Value, rounded_to
from camwright.profiles.ramp import Stand

_DIGITS = 5
_MARGIN = 1e-9
"""Share of the way between the parks by which one is offered inside: the ends themselves hold to rounding only."""


def refused(at: Stand, *, free: bool) -> InfeasibleError:
    """Make the error of a start or stop that cannot be.

    Parameters
    ----------
    at
        The machine beside the park that does not work.
    free
        Whether the park was camwright's to choose, so that no other one works either.
    """
    text, values, excess = _reason(at)
    offers: list[str] = []
    suggestions: list[Suggestion] = []
    for suggestion, value, words in _ways_out(at, free=free):
        name = f"offer_{len(offers)}"
        offers.append(words.replace("{offer}", f"{{{name}}}"))
        values[name] = value
        suggestions.append(suggestion)
    works = (
        f"What works, each alone, tried: {'; '.join(offers)}"
        if offers
        else "No park and no line speed that was tried works"
    )
    message = Message(f"{text}. {works}", tuple(values.items()))
    unit = "mm" if at.task.machine.slave_unit == "m" else "deg"
    return InfeasibleError(
        message, "park" if not free else "acceleration", excess, unit if excess is not None else "", tuple(suggestions)
    )


def _reason(at: Stand) -> tuple[str, dict[str, Value], float | None]:
    """Say what is missing, with its values and by how much the way is too short (mm or deg)."""
    unit, noun = at.task.machine.slave_unit, at.task.machine.noun
    values = {"speed": Value(at.task.cut.line_speed, "m/s", 6)}
    if not zone_kept(at):
        return "{@line_speed} = {speed}: the sync zone itself breaks a limit", values, None
    if not (at.run_up > 0 and (at.run_out > 0 or at.task.machine.guide is not None)):
        return "{@line_speed} = {speed}: the park lies in the sync zone", values, None
    arcs = least_arcs(at)
    up, out = (None if each is None else each.arc for each in (arcs.run_up, arcs.run_out))
    size = 1e3 if unit == "m" else math.degrees(1.0)
    for way, least, names in (
        (at.run_up, up, ("starts", "before the sync zone", "the way into it")),
        (
            at.run_out if at.task.machine.guide is None else at.room,
            out,
            ("stops", "beyond the sync zone", "the way out of it"),
        ),
    ):
        verb, where, what = names
        if least is None:
            return f"{{@line_speed}} = {{speed}}: {what} breaks the limits, however long it is", values, None
        if at.task.machine.guide is not None and verb == "stops":
            if least <= way:
                continue
            values |= {"way": Value(way, unit, 6)}
            return (
                f"{{@line_speed}} = {{speed}}: the {noun} has {{way}} beyond the sync zone and cannot turn within it",
                values,
                None,
            )
        if way < least:
            values |= {"way": Value(max(way, 0.0), unit, 6), "least": Value(least, unit, 6)}
            text = f"the {noun} {verb} {{way}} {where} and needs {{least}} at {{speed}} within the limits" + (
                "; backing up first would do, but a ramp never runs backwards" if verb == "starts" and way > 0 else ""
            )
            return text, values, (least - way) * size
    return f"the {noun} cannot start and stop at {{speed}} from this park", values, None


def _ways_out(at: Stand, *, free: bool) -> list[tuple[Suggestion, Value, str]]:
    """List changes that were tried and work: the nearest park, and the highest line speed."""
    found: list[tuple[Suggestion, Value, str]] = []
    unit = at.task.machine.slave_unit
    park = None if free else _nearest_park(at)
    if park is not None:
        size, name = (1e3, "mm") if unit == "m" else (math.degrees(1.0), "deg")
        words = f"park {'earlier' if park < at.park else 'later'}, at {{offer}} (--park)"
        found.append((Suggestion("park", park * size, name), Value(park, unit, 7), words))
    speed = fastest_line(at, can_stand if free else has_room)
    if speed is not None and speed < at.task.cut.line_speed:
        told = rounded_to(speed * 60, _DIGITS, up=False)
        slower = at.at_speed(told / 60)
        if can_start_and_stop(balanced(slower) if free else slower):
            value = Value(told / 60, "m/s", _DIGITS, toward="nearest", chosen=f"{told:.10g} m/min")
            found.append((Suggestion("line_speed", told, "m/min"), value, "{@line_speed} = {offer}"))
    return found


def _nearest_park(at: Stand) -> float | None:
    """Find the park nearest to the given one from which the machine can start and stop; None if there is none."""
    arcs, machine = least_arcs(at), at.task.machine
    if arcs.run_up is None or arcs.run_out is None:
        return None
    latest = at.zone_start - arcs.run_up.arc
    earliest = at.zone_end - machine.pitch + arcs.run_out.arc if machine.guide is None else machine.guide[0]
    span = latest - earliest
    if span < 0:
        return None
    inside = at.parked_at(min(max(at.park, earliest + _MARGIN * span), latest - _MARGIN * span))
    for digits in (6, 9):
        size = 1e3 if machine.slave_unit == "m" else math.degrees(1.0)
        told = rounded_to(inside.park * size, digits, up=inside.park > at.park) / size if inside.park else 0.0
        if can_start_and_stop(at.parked_at(told)):
            return told
    return inside.park if can_start_and_stop(inside) else None
