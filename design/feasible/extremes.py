"""How fast at this cut length, how short at this line speed: the same problem with that number as the unknown."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from camwright.design.feasible.feasibility import (
    binding_limit,
    edge,
    is_feasible,
    margin,
    needed_limits,
    slowdown,
)
from camwright.design.place import place_sync
from camwright.profiles.task import Task

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


def extremes(task: Task) -> Extremes:
    """Find the highest line speed and the shortest cut length of a job, and what binds there.

    A crank whose sync zone is free has it, for each of the two, at the place that lets it go farthest.
    """
    speed, speed_binding = fastest_line(task)
    placed = _at_best_place(task, lambda there: min_cut_length(there, COARSE) or math.inf)
    length = min_cut_length(placed)
    beyond = placed.with_length((length or task.cut.length) * (1 - BEYOND))
    return Extremes(speed, speed_binding, length, _binding(beyond))


def fastest_line(task: Task) -> tuple[float | None, str]:
    """Highest line speed at the job's cut length (m/s), None if no line speed works, and what binds there."""
    placed = placed_fastest(task)
    speed = max_line_speed(placed)
    return speed, _binding(placed.designed_at((speed or task.cut.line_speed) * (1 + BEYOND)))


def placed_fastest(task: Task) -> Task:
    """Place the sync zone of a crank that leaves it free where the line can run fastest."""
    return _at_best_place(task, lambda there: -slowdown(there, COARSE) or math.inf)


def _at_best_place(task: Task, cost: Callable[[Task], float]) -> Task:
    """Place the sync zone of a crank that leaves it free where a cost is least, or, where nothing works, where most room is left."""
    if task.machine.placed:
        return task
    placement = place_sync(task, cost)
    return roomiest(task) if placement is None else placement.task


def roomiest(task: Task) -> Task:
    """Place the sync zone where the limits leave most room.

    Raises
    ------
    InputError
        The sync zone fits nowhere.
    """
    placement = place_sync(task, margin)
    return task.placed_midway() if placement is None else placement.task


def max_line_speed(task: Task) -> float | None:
    """Highest line speed at the job's cut length (m/s); None if no line speed works."""
    return slowdown(task, EDGE) * task.cut.line_speed or None


def min_cut_length(task: Task, tolerance: float = EDGE) -> float | None:
    """Shortest cut length at the job's line speed and sync zone (m); None if no cut length works."""
    machine, cut = task.machine, task.cut

    def works(length: float) -> bool:
        return length > cut.sync_zone and is_feasible(task.with_length(length))

    starts = [machine.pitch / cut.sync_ratio] if machine.slave_unit == "m" and machine.pitch > 0 else []
    factor = 1.0
    while factor <= LONGEST:
        starts.append(cut.length * factor)
        factor *= 2.0
    start = next((start for start in starts if works(start)), None)
    return None if start is None else edge(works, start, cut.sync_zone, tolerance)


def _binding(beyond: Task) -> str:
    """Name what binds a little beyond an edge."""
    if beyond.cut.length <= beyond.cut.sync_zone:
        return "sync_zone"
    return binding_limit(beyond, needed_limits(beyond, COARSE))
