"""How fast at this cut length, how short at this line speed: the same problem with that number as the unknown."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

from design.feasibility import binding_limit, edge, is_feasible, margin, margin_edge, needed_limits
from design.placement import place_sync
from profiles.cycle import Cut
from profiles.limits import Limits
from profiles.machines import CrankSlider, Machine

# Where feasibility is a closed form the edge is found to rounding.
CLOSED = 1e-13
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

    A crank whose sync zone is free gets the place that leaves most room: chosen at the job's own numbers, then again at the
    edge found with it.
    """
    speed, at_speed = _refined(
        machine, cut, limits, max_line_speed, lambda found: replace(cut, line_speed=found), lambda new, old: new > old
    )
    length, at_length = _refined(
        machine, cut, limits, min_cut_length, lambda found: replace(cut, length=found), lambda new, old: new < old
    )
    return Extremes(
        speed,
        _binding(at_speed, replace(cut, line_speed=speed or cut.line_speed), limits, line_speed=1 + BEYOND),
        length,
        _binding(at_length, replace(cut, length=length or cut.length), limits, length=1 - BEYOND),
    )


def _refined(
    machine: Machine,
    cut: Cut,
    limits: Limits,
    find: Callable[[Machine, Cut, Limits], float | None],
    at: Callable[[float], Cut],
    better: Callable[[float, float], bool],
) -> tuple[float | None, Machine]:
    """Find an edge; for a crank whose sync zone is free, with its place chosen."""
    if not (isinstance(machine, CrankSlider) and math.isnan(machine.sync_at)):
        return find(machine, cut, limits), machine
    placed = roomiest(machine, cut, limits)
    found = find(placed, cut, limits)
    if found is None:
        return None, placed
    again = roomiest(machine, at(found), limits)
    other = find(again, cut, limits)
    return (other, again) if other is not None and better(other, found) else (found, placed)


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
    """Highest line speed at the job's cut length (m/s)."""

    def works(v: float) -> bool:
        return is_feasible(machine, replace(cut, line_speed=v), limits)

    slow = cut.line_speed
    while not works(slow):
        slow *= 0.5
        if slow < 1e-6 * cut.line_speed:
            return None
    fast = slow
    while works(fast):
        fast *= 2.0
    if _closed(machine, cut):
        return edge(works, slow, fast, CLOSED)
    return margin_edge(lambda v: margin(machine, replace(cut, line_speed=v), limits), slow, fast)


def min_cut_length(machine: Machine, cut: Cut, limits: Limits) -> float | None:
    """Shortest cut length at the job's line speed and sync zone (m)."""

    def works(length: float) -> bool:
        return length > cut.sync_zone and is_feasible(machine, replace(cut, length=length), limits)

    starts = [machine.pitch / cut.sync_ratio] if machine.slave_unit == "m" and machine.pitch > 0 else []
    factor = 1.0
    while factor <= LONGEST:
        starts.append(cut.length * factor)
        factor *= 2.0
    for start in starts:
        if works(start):
            if _closed(machine, cut):
                return edge(works, start, cut.sync_zone, CLOSED)
            return margin_edge(
                lambda x: margin(machine, replace(cut, length=x), limits), start, cut.sync_zone * (1 + BEYOND)
            )
    return None


def _closed(machine: Machine, cut: Cut) -> bool:
    """Whether feasibility is a closed form, so that edges can be found to rounding."""
    return machine.slave_unit == "m" and machine.sync_profile(cut).degree == 1


def _binding(machine: Machine, cut: Cut, limits: Limits, line_speed: float = 1.0, length: float = 1.0) -> str:
    """Name what binds a little beyond an edge."""
    beyond = replace(cut, line_speed=cut.line_speed * line_speed, length=cut.length * length)
    if beyond.length <= beyond.sync_zone:
        return "sync_zone"
    return binding_limit(machine, beyond, limits, needed_limits(machine, beyond, limits))
