"""How fast at this cut length, how short at this line speed: the same problem with that number as the unknown."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

from camwright.design.feasible.feasibility import (
    binding_limit,
    edge,
    is_feasible,
    margin,
    needed_limits,
    slowdown,
)
from camwright.design.place import place_sync
from camwright.profiles.cut import Cut
from camwright.profiles.limits import Limits
from camwright.profiles.machines import CrankSlider, Machine

# Edges are found to rounding; to this share while a place on the crank is looked for.
EDGE = 1e-13
COARSE = 1e-6
# What binds is asked this far beyond the edge.
BEYOND = 1e-3
# Cut lengths up to this multiple of the job's are looked at.
LONGEST = 64.0


@dataclass(frozen=True)
class Extremes:
    """How far a machine can go at a job's other numbers.

    Parameters
    ----------
    max_line_speed
        Highest line speed at the job's cut length (m/s); None if no line speed works.
    line_speed_binding
        What binds there: a limit, ``"reversal"``, ``"stroke"`` or ``"sync_zone"``.
    min_cut_length
        Shortest cut length at the job's line speed and sync zone (m); None if none works.
    cut_length_binding
        What binds there.
    """

    max_line_speed: float | None
    line_speed_binding: str
    min_cut_length: float | None
    cut_length_binding: str


def extremes(machine: Machine, cut: Cut, limits: Limits) -> Extremes:
    """Find the highest line speed and the shortest cut length of a job, and what binds there.

    A crank whose sync zone is free has it, for each of the two, at the place that lets it go farthest.
    """
    speed, speed_binding = fastest_line(machine, cut, limits)
    placed = _placed(machine, cut, limits, lambda there: min_cut_length(there, cut, limits, COARSE) or math.inf)
    length = min_cut_length(placed, cut, limits)
    beyond = replace(cut, length=(length or cut.length) * (1 - BEYOND))
    return Extremes(speed, speed_binding, length, _binding(placed, beyond, limits))


def fastest_line(machine: Machine, cut: Cut, limits: Limits) -> tuple[float | None, str]:
    """Highest line speed at the job's cut length (m/s), None if no line speed works, and what binds there."""
    placed = placed_fastest(machine, cut, limits)
    speed = max_line_speed(placed, cut, limits)
    beyond = replace(cut, line_speed=(speed or cut.line_speed) * (1 + BEYOND))
    return speed, _binding(placed, beyond, limits)


def placed_fastest(machine: Machine, cut: Cut, limits: Limits) -> Machine:
    """Place the sync zone of a crank that leaves it free where the line can run fastest."""
    return _placed(machine, cut, limits, lambda there: -slowdown(there, cut, limits, COARSE) or math.inf)


def _placed(machine: Machine, cut: Cut, limits: Limits, cost: Callable[[CrankSlider], float]) -> Machine:
    """Place the sync zone of a crank that leaves it free where a cost is least, or, where nothing works, where most room is left."""
    if not (isinstance(machine, CrankSlider) and math.isnan(machine.sync_at)):
        return machine
    placement = place_sync(machine, cut, cost)
    return roomiest(machine, cut, limits) if placement is None else placement.machine


def roomiest(machine: CrankSlider, cut: Cut, limits: Limits) -> CrankSlider:
    """Place the sync zone on the crank where the limits leave most room.

    Raises
    ------
    InputError
        The sync zone is longer than the crank's stroke.
    """
    placement = place_sync(machine, cut, lambda placed: margin(placed, cut, limits))
    if placement is not None:
        return placement.machine
    least, greatest = machine.sync_range(cut)
    return replace(machine, sync_at=0.5 * (least + greatest))


def max_line_speed(machine: Machine, cut: Cut, limits: Limits) -> float | None:
    """Highest line speed at the job's cut length (m/s); None if no line speed works."""
    return slowdown(machine, cut, limits, EDGE) * cut.line_speed or None


def min_cut_length(machine: Machine, cut: Cut, limits: Limits, tolerance: float = EDGE) -> float | None:
    """Shortest cut length at the job's line speed and sync zone (m); None if no cut length works."""

    def works(length: float) -> bool:
        return length > cut.sync_zone and is_feasible(machine, replace(cut, length=length), limits)

    starts = [machine.pitch / cut.sync_ratio] if machine.slave_unit == "m" and machine.pitch > 0 else []
    factor = 1.0
    while factor <= LONGEST:
        starts.append(cut.length * factor)
        factor *= 2.0
    start = next((start for start in starts if works(start)), None)
    return None if start is None else edge(works, start, cut.sync_zone, tolerance)


def _binding(machine: Machine, beyond: Cut, limits: Limits) -> str:
    """Name what binds a little beyond an edge."""
    if beyond.length <= beyond.sync_zone:
        return "sync_zone"
    return binding_limit(machine, beyond, limits, needed_limits(machine, beyond, limits))
