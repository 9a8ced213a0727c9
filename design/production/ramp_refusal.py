"""Why a machine cannot start or stop from a park, and what would work: a park or a line speed, each tried."""

from __future__ import annotations

import math

from camwright.design.production.ramps import (
    balanced,
    can_stand,
    can_start_and_stop,
    has_room,
    highest_that_works,
    least_arcs,
    zone_kept,
)
from camwright.profiles.errors import InfeasibleError, Suggestion
from camwright.profiles.machines import Machine
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
    text, values, excess = _reason(at, free=free)
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


def _reason(at: Stand, *, free: bool) -> tuple[str, dict[str, Value], float | None]:
    """Say what is missing, with its values and by how much the way is too short (mm or deg)."""
    values = {"speed": Value(at.task.cut.line_speed, "m/s", 6)}
    if not zone_kept(at):
        return "{@line_speed} = {speed}: the sync zone itself breaks a limit", values, None
    if not (at.run_up > 0 and (at.run_out > 0 or at.task.machine.guide is not None)):
        return *_within_zone(at, free=free), None
    if at.task.machine.guide is not None and not at.parked_within:
        return *_off_the_guide(at, at.task.machine.guide), None
    arcs, guided = least_arcs(at), at.task.machine.guide is not None
    up, out = (None if each is None else each.arc for each in (arcs.run_up, arcs.run_out))
    return (
        _short(at, values, at.run_up, up, ("starts", "before the sync zone", "the way into it"))
        or _short(
            at, values, at.room if guided else at.run_out, out, ("stops", "beyond the sync zone", "the way out of it")
        )
        or (f"the {at.task.machine.noun} cannot start and stop at {{speed}} from this park", values, None)
    )


def _short(
    at: Stand, values: dict[str, Value], way: float, least: float | None, words: tuple[str, str, str]
) -> tuple[str, dict[str, Value], float | None] | None:
    """Say that a way is too short, of what the slave does on it, where it is and what it is called; None if it is long enough."""
    machine, (verb, where, what) = at.task.machine, words
    if least is None:
        return f"{{@line_speed}} = {{speed}}: {what} breaks the limits, however long it is", values, None
    if way >= least:
        return None
    if machine.guide is not None and verb == "stops":
        text = f"{{@line_speed}} = {{speed}}: the {machine.noun} has {{way}} beyond the sync zone and cannot turn within it"
        return text, values | {"way": Value(way, machine.slave_unit, 6)}, None
    text = f"the {machine.noun} {verb} {{way}} {where} and needs {{least}} at {{speed}} within the limits"
    if verb == "starts" and way > 0:
        text += "; backing up first would do, but a ramp never runs backwards"
    values = values | {"way": Value(max(way, 0.0), machine.slave_unit, 6), "least": Value(least, machine.slave_unit, 6)}
    return text, values, (least - way) * _size(machine)


def _size(machine: Machine) -> float:
    """Size of the unit in which a place of the slave is told: mm or deg in its own unit."""
    return 1e3 if machine.slave_unit == "m" else math.degrees(1.0)


def _within_zone(at: Stand, *, free: bool) -> tuple[str, dict[str, Value]]:
    """Say that a park lies in the sync zone, or beyond its start where the slave comes back; as near to the zone as it is told."""
    unit, noun, option = at.task.machine.slave_unit, at.task.machine.noun, "" if free else "--park: "
    begins = Value(at.zone_start, unit, 6)
    if at.task.machine.guide is not None:
        text = f"{option}the {noun} stands at {{park}}, and must stand before the sync zone, which begins at {{begins}}"
        return text, {"park": Value(at.park, unit, 6), "begins": begins}
    park = at.park + at.task.machine.pitch if at.run_up > 0 else at.park
    text = f"{option}the {noun} stands at {{park}}, in the sync zone from {{begins}} to {{ends}}"
    return text, {"park": Value(park, unit, 6), "begins": begins, "ends": Value(at.zone_end, unit, 6)}


def _off_the_guide(at: Stand, guide: tuple[float, float]) -> tuple[str, dict[str, Value]]:
    """Say that a park lies where the guide is not."""
    unit = at.task.machine.slave_unit
    text = f"--park: the {at.task.machine.noun} stands at {{park}}, outside its stroke from {{low}} to {{high}}"
    values = {"park": at.park, "low": guide[0], "high": guide[1]}
    return text, {name: Value(value, unit, 6) for name, value in values.items()}


def _ways_out(at: Stand, *, free: bool) -> list[tuple[Suggestion, Value, str]]:
    """List changes that were tried and work: the nearest park, and the highest line speed."""
    found: list[tuple[Suggestion, Value, str]] = []
    unit = at.task.machine.slave_unit
    nearest = None if free else _nearest_park(at)
    if nearest is not None:
        park, earlier = nearest
        size, name = (1e3, "mm") if unit == "m" else (math.degrees(1.0), "deg")
        words = f"park {'earlier' if earlier else 'later'}, at {{offer}} (--park)"
        found.append((Suggestion("park", park * size, name), Value(park, unit, 7), words))
    speed = highest_that_works(at, can_stand if free else has_room)
    if speed is not None and speed < at.task.cut.line_speed:
        told = rounded_to(speed * 60, _DIGITS, up=False)
        slower = at.at_speed(told / 60)
        if can_start_and_stop(balanced(slower) if free else slower):
            value = Value(told / 60, "m/s", _DIGITS, toward="nearest", chosen=f"{told:.10g} m/min")
            found.append((Suggestion("line_speed", told, "m/min"), value, "{@line_speed} = {offer}"))
    return found


def _nearest_park(at: Stand) -> tuple[float, bool] | None:
    """Find the nearest park from which the machine can start and stop, and whether it is earlier; None if there is none."""
    arcs, machine = least_arcs(at), at.task.machine
    if arcs.run_up is None or arcs.run_out is None:
        return None
    latest = at.zone_start - arcs.run_up.arc
    earliest = at.zone_end - machine.pitch + arcs.run_out.arc if machine.guide is None else machine.guide[0]
    span = latest - earliest
    if span < 0:
        return None
    given = at.park
    if machine.guide is not None and given < earliest and can_start_and_stop(at.parked_at(earliest)):
        return earliest, False
    if machine.guide is None and given + machine.pitch - latest < earliest - given:
        given += machine.pitch  # the same place, nearer to the latest park
    inside = at.parked_at(min(max(given, earliest + _MARGIN * span), latest - _MARGIN * span))
    for digits in (6, 9):
        size = _size(machine)
        told = rounded_to(inside.park * size, digits, up=inside.park > given) / size if inside.park else 0.0
        if can_start_and_stop(at.parked_at(told)):
            return told, told < given
    return (inside.park, inside.park < given) if can_start_and_stop(inside) else None
