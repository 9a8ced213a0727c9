"""What the numbers of a job must be for its machine: room for the sync zone, and the speed that it needs."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from camwright.jobs.fields import TURNING, Known
from camwright.profiles.cut import Cut
from camwright.profiles.machines import (
    CrankSlider,
    LinearCarriage,
    Machine,
    RotaryKnife,
)
from camwright.profiles.machines.rotary_knife import GREATEST_ANGLE
from camwright.profiles.objective import OBJECTIVES, ObjectiveName

_BISECTIONS = 60


def sync_zone_of(known: Known, machine: Machine | None) -> float | None:
    """Length of the sync zone on the master (m), also where it is written as an angle; nothing if it cannot be told.

    An angle is that by which the blade turns in the zone: ``l_s = angle r / s`` in tangential sync, ``l_s = 2 r sin(angle / 2) / s`` in
    horizontal sync, with the sync ratio ``s``.
    """
    length, angle = known.numbers.get("sync_zone"), known.numbers.get("sync_angle")
    ratio = known.numbers.get("sync_ratio")
    if length is not None or angle is None or ratio is None or not isinstance(machine, RotaryKnife):
        return length
    chord = angle if machine.sync == "tangential" else 2 * math.sin(min(0.5 * angle, GREATEST_ANGLE))
    return machine.radius * chord / ratio


def machine_conflicts(known: Known, machine: Machine | None) -> list[str]:
    """Check the machine, its sync zone and the speed that it needs; nothing to check where the machine is not known."""
    if isinstance(machine, CrankSlider) and machine.rod <= machine.crank + abs(machine.offset):
        return [_short_rod(machine)]
    zone, ratio = sync_zone_of(known, machine), known.numbers.get("sync_ratio")
    line_speed, speed = known.numbers.get("line_speed"), known.numbers.get("speed")
    if ratio is None:
        return []
    faults: list[str] = []
    pace = None if known.kind in TURNING else ratio  # at least; more in horizontal sync
    if machine is not None and zone is not None:
        cut = Cut(2.0 * zone, 1.0, zone, 0.0, 0.0, 1e-4, sync_ratio=ratio)
        faults += _room(machine, cut, known.numbers.get("sync_angle"))
        pace = pace if faults else sync_pace(machine, cut)
    if pace and line_speed and speed and pace * line_speed > speed * (1 + 1e-12):
        faults.append(_slow(known, pace))
    return faults


def moved_by_nothing(machine: Machine, objective: ObjectiveName, *, with_curve: bool) -> list[str]:
    """Say what is missing where the objective or the motor's curve asks for torque and the machine gives nothing to move."""
    if isinstance(machine, CrankSlider):
        missing = machine.crank_inertia == machine.carriage_mass == 0.0
        keys = 'crank_inertia = "0.5 kg m^2" or carriage_mass = "20 kg"'
    elif isinstance(machine, LinearCarriage):
        missing, keys = machine.mass == 0.0, 'mass = "20 kg"'
    else:
        missing = float(machine.inertia(0.0)) == machine.friction == 0.0
        keys = 'inertia = "0.05 kg m^2" or friction = "2 N m"'
    reason = f"the motor's torque depends on what it moves, which [machine] does not say; add e.g. {keys}"
    faults = []
    if missing and OBJECTIVES[objective].of == "motor":
        faults.append(f'[objective] minimise = {objective!r}: {reason}, or minimise "rms_acceleration"')
    if missing and with_curve:
        faults.append(f"[limits] motor: {reason}, or leave the motor's curve out")
    return faults


def _mm(value: float) -> str:
    """Write a length in millimetres."""
    return f"{value * 1e3:.10g} mm"


def _below(value: float) -> str:
    """Write a length that must not be reached, rounded so that it works as it is printed."""
    step = 10.0 ** (math.floor(math.log10(value)) - 5)
    return _mm((math.ceil(value / step - 1e-6) - 1) * step)


def _above(value: float) -> str:
    """Write a length that must be exceeded, rounded so that it works as it is printed."""
    step = 10.0 ** (math.floor(math.log10(value)) - 5)
    return _mm((math.floor(value / step + 1e-6) + 1) * step)


def _short_rod(machine: CrankSlider) -> str:
    """Say that the crank cannot turn all the way round."""
    least = machine.crank + abs(machine.offset)
    longest = machine.rod - abs(machine.offset)
    shorter = f", or shorten the crank to {_below(longest)} at most" if longest > 0 else ""
    return (
        f"[machine] rod = {_mm(machine.rod)}: not above [machine] crank + |offset| = {_mm(least)}, so the crank could not turn all the "
        f"way round; lengthen the rod to {_above(least)} at least{shorter}"
    )


def _room(machine: Machine, cut: Cut, angle: float | None) -> Iterator[str]:
    """Check that the machine can be in sync over the zone."""
    zone, travel = cut.sync_zone, cut.sync_ratio * cut.sync_zone
    where = f"[cut] sync_zone = {_mm(zone)}" + ("" if angle is None else f" ({math.degrees(angle):.6g} deg)")
    if isinstance(machine, RotaryKnife):
        yield from _knife_room(machine, cut, where, angle)
    elif isinstance(machine, LinearCarriage) and travel >= machine.stroke:
        yield (
            f"[machine] stroke = {_mm(machine.stroke)}: not above the {_mm(travel)} that the carriage travels in the sync zone; lengthen "
            f"it to {_above(travel)} at least, or shorten [cut] sync_zone to {_below(machine.stroke / cut.sync_ratio)} at most"
        )
    elif isinstance(machine, CrankSlider):
        if travel >= machine.stroke:
            yield (
                f"{where}: the carriage would travel {_mm(travel)}, not below the crank's stroke of {_mm(machine.stroke)}; shorten the "
                f"sync zone to {_below(machine.stroke / cut.sync_ratio)} at most, or take a longer crank"
            )
        elif not math.isnan(machine.sync_at):
            least, greatest = machine.sync_range(cut)
            if not least < machine.sync_at < greatest:
                yield (
                    f"[machine] sync_at = {math.degrees(machine.sync_at):.10g} deg: leaves no room for the sync zone of {_mm(zone)} "
                    f"between the dead centres; place it between {math.degrees(least) + 5e-4:.3f} deg and "
                    f"{math.degrees(greatest) - 5e-4:.3f} deg, or leave it out, and the design chooses"
                )


def _knife_room(machine: RotaryKnife, cut: Cut, where: str, angle: float | None) -> Iterator[str]:
    """Check that one blade is in sync at a time, and in horizontal sync that it stays near the cut point."""
    travel = cut.sync_ratio * cut.sync_zone
    half = 0.5 * machine.pitch / machine.radius
    longest = machine.pitch / cut.sync_ratio
    if machine.sync == "horizontal":
        bound = machine.greatest_sync_zone(cut.sync_ratio)
        beyond = cut.sync_zone > bound if angle is None else 0.5 * angle > GREATEST_ANGLE
        if beyond:
            degrees = math.degrees(GREATEST_ANGLE)
            at_most = _below(bound) if angle is None else f"{2 * degrees:.6g} deg"
            yield (
                f"{where}: takes the blade beyond ±{degrees:.0f}° from the cut point, where horizontal sync ends; shorten it to "
                f"{at_most} at most"
            )
            return
        travel = 2 * machine.radius * math.asin(min(1.0, 0.5 * travel / machine.radius))
        longest = 2 * machine.radius * math.sin(min(half, GREATEST_ANGLE)) / cut.sync_ratio
    if travel < machine.pitch:
        return
    if machine.blades == 1 and cut.sync_ratio == 1.0:
        room = f"[machine] circumference = {_mm(machine.circumference)}, so the knife would turn a whole turn in sync"
    else:
        room = (
            f"the {_mm(longest)} that [machine] circumference = {_mm(machine.circumference)}, blades = {machine.blades} and [cut] "
            f"sync_ratio = {cut.sync_ratio:.6g} leave to one blade, so no return zone is left"
        )
    yield f"{where}: not below {room}; shorten the sync zone to {_below(longest)} at most"


def _slow(known: Known, pace: float) -> str:
    """Say that the slave may not run as fast as the sync zone needs."""
    limit, line_speed = known.numbers["speed"], known.numbers["line_speed"]
    line = f"[cut] line_speed = {line_speed * 60:.10g} m/min"
    way_out = f"run the line at {_down(limit / pace * 60)} m/min at most or raise the limit"
    if known.kind in TURNING:
        rpm = 30.0 / math.pi
        place = "at this sync_at" if "sync_at" in known.numbers else "wherever it lies on the crank"
        return (
            f"[limits] speed = {limit * rpm:.10g} rpm: below the {pace * line_speed * rpm:.6g} rpm that the crank needs in the sync zone, "
            f"{place}, at {line}; {way_out}"
        )
    name = "carriage" if known.kind == "linear_carriage" else "knife"
    if pace == 1.0:
        words = f"below {line}, at which the {name} runs in the sync zone"
    else:
        words = f"below the {pace * line_speed * 60:.6g} m/min at which the {name} runs in the sync zone ({line}, times {pace:.6g})"
    return f"[limits] speed = {limit * 60:.10g} m/min: {words}; {way_out}"


def _down(value: float) -> str:
    """Write a number with six digits, rounded down."""
    step = 10.0 ** (math.floor(math.log10(value)) - 5)
    return f"{math.floor(value / step + 1e-6) * step:.10g}"


def sync_pace(machine: Machine, cut: Cut) -> float:
    """Greatest slave speed over line speed in the sync zone; of a crank whose sync zone is free the least such, over its places.

    The tool ratio has one maximum in the forward stroke, so it is least at one of the zone's ends; and a crank needs least speed where
    it is the same at both.
    """
    if not isinstance(machine, CrankSlider):
        return cut.sync_ratio / float(machine.tool_ratio(machine.sync_start(cut)))
    if not math.isnan(machine.sync_at):
        return cut.sync_ratio / min(_end_ratios(machine, cut))
    low, high = machine.sync_range(cut)
    for _ in range(_BISECTIONS):
        middle = 0.5 * (low + high)
        first, last = _end_ratios(replace(machine, sync_at=middle), cut)
        if first < last:  # slower at the start: move on
            low = middle
        else:
            high = middle
    return cut.sync_ratio / min(first, last)


def _end_ratios(machine: CrankSlider, cut: Cut) -> tuple[float, float]:
    """Tool ratio at both ends of the sync zone (m/rad)."""
    half = 0.5 * cut.sync_ratio * cut.sync_zone
    middle = float(machine.tool(machine.sync_at))
    first, last = machine.tool_ratio(machine.angle_at(np.array([middle - half, middle + half])))
    return float(first), float(last)
