"""What the numbers of a job must be for its machine: room for the sync zone, and the speed that it needs."""

from __future__ import annotations

import math

from camwright.house.numbers import typed
from camwright.house.units import KINDS
from camwright.jobs.fields import Known
from camwright.jobs.wording import words
from camwright.profiles.cut import Cut
from camwright.profiles.machines import Machine
from camwright.profiles.machines.fields import Quantity, fields_of
from camwright.profiles.message import rounded_to
from camwright.profiles.objective import OBJECTIVES, ObjectiveName


def machine_conflicts(known: Known, machine: Machine | None) -> list[str]:
    """Check the machine, its sync zone and the speed that it needs; nothing to check where the machine is not known."""
    own = [] if machine is None else [words(fault, known.units) for fault in machine.faults()]
    if own:
        return own
    zone, ratio = known.numbers.get("cut.sync_zone"), known.numbers.get("cut.sync_ratio")
    line_speed, speed = known.numbers.get("cut.line_speed"), known.numbers.get("limits.speed")
    if ratio is None:
        return []
    faults: list[str] = []
    pace = None if known.turns else ratio  # at least; more where the tool does not move like its slave
    if machine is not None and zone is not None:
        cut = Cut(2.0 * zone, 1.0, zone, 0.0, 0.0, 1e-4, sync_ratio=ratio)
        faults += [
            words(fault, known.units) for fault in machine.zone_faults(cut, known.indirect.angles.get("cut.sync_zone"))
        ]
        pace = pace if faults else machine.sync_pace(cut)
        faults += [] if faults else _too_long(known, machine.longest_cut(zone))
    if pace and line_speed and speed and pace * line_speed > speed * (1 + 1e-12):
        faults.append(_slow(known, pace, machine))
    return faults


def _too_long(known: Known, longest: float) -> list[str]:
    """Refuse a cut that no cam over the master is for."""
    length, units = known.numbers.get("cut.length"), known.units
    if length is None or length <= longest:
        return []
    return [
        (
            f"[cut] length = {typed(length, 'm', units=units)}: above {typed(longest, 'm', 6, units)}, the longest that a cam over the "
            f"master is for on this machine with [cut] sync_zone = {typed(known.numbers['cut.sync_zone'], 'm', 6, units)}; cut shorter "
            "or lengthen the sync zone; a machine that waits between cuts starts for each piece with the one-shot cam of camwright "
            "ramps, which does not depend on the length"
        )
    ]


def moved_by_nothing(machine: Machine, objective: ObjectiveName, *, with_curve: bool) -> list[str]:
    """Say what is missing where the objective or the motor's curve asks for torque and the machine gives nothing to move."""
    loads = [
        f'{each.key} = "{each.about.usual or each.about.example or KINDS[each.about.kind].example}"'
        for each in fields_of(type(machine))
        if each.load and isinstance(each.about, Quantity)
    ]
    reason = f"the motor's torque depends on what it moves, which [machine] does not say; add e.g. {' or '.join(loads)}"
    faults = []
    if not machine.moves_something and OBJECTIVES[objective].of == "motor":
        faults.append(f'[objective] minimise = {objective!r}: {reason}, or minimise "rms_acceleration"')
    if not machine.moves_something and with_curve:
        faults.append(f"[limits] motor: {reason}, or leave the motor's curve out")
    return faults


def _slow(known: Known, pace: float, made: Machine | None) -> str:
    """Say that the slave may not run as fast as the sync zone needs."""
    limit, line_speed = known.numbers["limits.speed"], known.numbers["cut.line_speed"]
    units, shown = known.units, known.units.shown["m/s"]
    line = f"[cut] line_speed = {typed(line_speed, 'm/s', units=units)}"
    slower = f"{rounded_to(limit / pace * shown.factor, 6, up=False):.10g} {shown.printed}"
    way_out = f"run the line at {slower} at most or raise the limit"
    machine = known.machine
    noun, place = ("slave", "") if machine is None else (machine.noun, machine.place_name)
    by_angle = made is not None and made.slave_turn is not None and "limits.speed" in known.indirect.angles
    if known.turns or by_angle:
        rpm = 60.0 / made.slave_turn if by_angle and made is not None and made.slave_turn else 30.0 / math.pi
        given = place and f"machine.{place}" in known.numbers
        where = f", at this {place}," if given else f", wherever it lies on the {noun}," if place else ""
        return (
            f"[limits] speed = {limit * rpm:.10g} rpm: below the {pace * line_speed * rpm:.6g} rpm that the {noun} needs in the sync zone"
            f"{where} at {line}; {way_out}"
        )
    if pace == 1.0:
        why = f"below {line}, at which the {noun} runs in the sync zone"
    else:
        needed = typed(pace * line_speed, "m/s", 6, units)
        why = f"below the {needed} at which the {noun} runs in the sync zone ({line}, times {pace:.6g})"
    return f"[limits] speed = {typed(limit, 'm/s', units=units)}: {why}; {way_out}"
