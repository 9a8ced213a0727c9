"""How fast at this cut length, how short at this line speed: the same problem with that number as the unknown."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from design.feasibility import binding_limit, edge, is_feasible, needed_limits
from design.placement import MARGIN, PLACES
from profiles.cycle import Cut
from profiles.limits import Limits
from profiles.machines import CrankSlider, Machine

# Where feasibility is a closed form the edge is found to rounding, else to the accuracy of the optimisations that decide.
CLOSED = 1e-13
SOLVED = 1e-7
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
    """Find the highest line speed and the shortest cut length of a job."""
    speed = max_line_speed(machine, cut, limits)
    length = min_cut_length(machine, cut, limits)
    return Extremes(
        speed,
        _binding(machine, replace(cut, line_speed=speed or cut.line_speed), limits, line_speed=1 + BEYOND),
        length,
        _binding(machine, replace(cut, length=length or cut.length), limits, length=1 - BEYOND),
    )


def max_line_speed(machine: Machine, cut: Cut, limits: Limits) -> float | None:
    """Highest line speed at the job's cut length (m/s)."""

    def works(v: float) -> bool:
        return feasible_anywhere(machine, replace(cut, line_speed=v), limits)

    slow = cut.line_speed
    while not works(slow):
        slow *= 0.5
        if slow < 1e-6 * cut.line_speed:
            return None
    fast = slow
    while works(fast):
        fast *= 2.0
    return edge(works, slow, fast, _accuracy(machine, cut))


def min_cut_length(machine: Machine, cut: Cut, limits: Limits) -> float | None:
    """Shortest cut length at the job's line speed and sync zone (m)."""

    def works(length: float) -> bool:
        return feasible_anywhere(machine, replace(cut, length=length), limits)

    starts = [machine.pitch / cut.sync_ratio] if machine.slave_unit == "m" and machine.pitch > 0 else []
    factor = 1.0
    while factor <= LONGEST:
        starts.append(cut.length * factor)
        factor *= 2.0
    for start in starts:
        if start > cut.sync_zone and works(start):
            return edge(works, start, cut.sync_zone, _accuracy(machine, cut))
    return None


def feasible_anywhere(machine: Machine, cut: Cut, limits: Limits) -> bool:
    """Tell whether some motion keeps the limits; with a crank whose sync zone is free, at some place of it."""
    if cut.length <= cut.sync_zone:
        return False
    if not (isinstance(machine, CrankSlider) and math.isnan(machine.sync_at)):
        return is_feasible(machine, cut, limits)
    if cut.sync_ratio * cut.sync_zone >= machine.stroke:
        return False
    least, greatest = machine.sync_range(cut)
    margin = MARGIN * (greatest - least)
    places = np.linspace(least + margin, greatest - margin, PLACES)
    inner_first = sorted(places, key=lambda angle: abs(angle - 0.5 * (least + greatest)))
    return any(is_feasible(replace(machine, sync_at=float(angle)), cut, limits) for angle in inner_first)


def _accuracy(machine: Machine, cut: Cut) -> float:
    straight = machine.slave_unit == "m" and not machine.turns_back and _degree(machine, cut) == 1
    return CLOSED if straight else SOLVED


def _degree(machine: Machine, cut: Cut) -> int:
    return machine.sync_profile(cut).degree


def _binding(machine: Machine, cut: Cut, limits: Limits, line_speed: float = 1.0, length: float = 1.0) -> str:
    """Name what binds a little beyond an edge."""
    beyond = replace(cut, line_speed=cut.line_speed * line_speed, length=cut.length * length)
    if beyond.length <= beyond.sync_zone:
        return "sync_zone"
    if isinstance(machine, CrankSlider) and math.isnan(machine.sync_at):
        least, greatest = machine.sync_range(cut)
        machine = replace(machine, sync_at=0.5 * (least + greatest))
    return binding_limit(machine, beyond, limits, needed_limits(machine, beyond, limits))


__all__ = ["Extremes", "extremes", "feasible_anywhere", "max_line_speed", "min_cut_length"]
