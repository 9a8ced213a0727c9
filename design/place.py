"""Where the sync zone should lie: the one number that a machine such as a crank leaves open."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from camwright.profiles.errors import InputError
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.task import Task

PLACES = 9
"""Places looked at first, evenly over the range that leaves room for the sync zone."""
MARGIN = 0.02
"""Share of that range kept free at both ends: at a dead centre the crank would need infinite speed."""
RESOLUTION = 2e-3
"""Accuracy of the place (rad), 0.1°; about a round valley the objective changes with its square."""
PEAK_PLACES, PEAK_RESOLUTION = 41, 1e-5
"""The same for a peak: where that of the sync zone meets that of the return it has a corner, not a round valley."""
BESIDE = 0.12
"""Step to either side of a place that is good already (rad): so far may it be from the best for another cost."""
MOST_DEEP = 3
"""Valleys that are gone down, the deepest first."""
_GOLDEN = (math.sqrt(5) - 1) / 2


@dataclass(frozen=True)
class Placement:
    """A chosen place and what is known about the choice.

    Parameters
    ----------
    task
        The task, the machine with its sync zone placed.
    cost
        Objective there.
    valleys
        Local minima found among the places looked at first.
    back
        The best return there as far as the search for the place knows it; None where it looked at none, or where it is no good start.
    """

    task: Task
    cost: float
    valleys: int
    back: CamProfile | None = None


def place_sync(
    task: Task, cost: Callable[[Task], float], places: int = PLACES, resolution: float = RESOLUTION
) -> Placement | None:
    """Choose the slave coordinate at mid sync zone that makes a cost least, by a scan and golden sections around its best places.

    Returns None if no place has a finite cost.

    Parameters
    ----------
    task
        The task, its place free.
    cost
        What is made least.
    places
        Places looked at first.
    resolution
        Accuracy of the place (rad).

    Raises
    ------
    InputError
        The sync zone fits nowhere.
    """
    least, greatest = task.machine.place_range(task.cut)
    margin = MARGIN * (greatest - least)
    angles = np.linspace(least + margin, greatest - margin, places)

    def at(angle: float) -> float:
        placed = task.placed_at(angle)
        return cost(placed) if can_be_carried(placed) else math.inf

    costs = [at(float(angle)) for angle in angles]
    if not any(math.isfinite(value) for value in costs):
        return None
    around = [math.inf, *costs, math.inf]
    # of places side by side that cost the same the first counts
    valleys = [i for i, value in enumerate(costs) if value < around[i] and value <= around[i + 2]]
    best = (math.inf, 0.0)
    for i in sorted(valleys, key=lambda i: costs[i])[:MOST_DEEP]:
        low, high = float(angles[max(0, i - 1)]), float(angles[min(places - 1, i + 1)])
        best = min(best, _golden(at, low, high, (costs[i], float(angles[i])), resolution))
    return Placement(task.placed_at(best[1]), best[0], len(valleys))


def place_beside(placed: Task, cost: Callable[[Task], float], rounds: int) -> Task:
    """Improve a place that is good already: by what costs least of it, a step to either side, and where a parabola through these is least.

    Each round takes a quarter of the step of the one before. For a cost that takes too long for a search.
    """

    def at(place: float) -> tuple[float, Task]:
        task = placed.placed_at(place)
        return cost(task), task

    best, step = (cost(placed), placed), BESIDE
    for _ in range(rounds):
        middle = best[1].machine.place
        found = [best, at(middle - step), at(middle + step)]
        here, before, after = (value for value, _ in found)
        bend = before + after - 2.0 * here
        if math.isfinite(bend) and bend > 0.0:
            found.append(at(middle + step * min(max(0.5 * (before - after) / bend, -2.0), 2.0)))
        best, step = min(found, key=lambda each: each[0]), 0.25 * step
    return best[1]


def can_be_carried(placed: Task) -> bool:
    """Tell whether the sync zone of a place can be carried as polynomials: beside a dead centre a crank's is too abrupt."""
    try:
        return math.isfinite(placed.slave_at_sync_end)
    except InputError:
        return False


def _golden(
    at: Callable[[float], float], low: float, high: float, best: tuple[float, float], resolution: float
) -> tuple[float, float]:
    left, right = high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)
    cost_left, cost_right = at(left), at(right)
    while high - low > resolution:
        best = min(best, (cost_left, left), (cost_right, right))
        if cost_left <= cost_right:
            high, right, cost_right = right, left, cost_left
            left = high - _GOLDEN * (high - low)
            cost_left = at(left)
        else:
            low, left, cost_left = left, right, cost_right
            right = low + _GOLDEN * (high - low)
            cost_right = at(right)
    return min(best, (cost_left, left), (cost_right, right))
