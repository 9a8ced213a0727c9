"""One place of the sync zone for many cuts: where the one that suffers most suffers least."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from camwright.design.optimise import solve
from camwright.design.place import place_sync
from camwright.design.place_cost import cost_at, looks_of, place_for
from camwright.profiles.errors import InputError
from camwright.profiles.objective import CommandObjective
from camwright.profiles.task import Task

MOST = 7
"""Tasks that the place is chosen by, evenly out of all, first and last among them."""


@dataclass(frozen=True)
class CommonPlace:
    """A place of the sync zone for several tasks.

    Parameters
    ----------
    place
        Slave coordinate at mid sync zone (slave unit).
    cost
        By what share the objective is greater there than at the task's own best place, of the task where that is most; designed at both.
    at_length
        Cut length of that task (m).
    compared
        Tasks that were designed at both places.
    """

    place: float
    cost: float
    at_length: float
    compared: int


def common_place(tasks: Sequence[Task], objective: CommandObjective) -> CommonPlace:
    """Choose one place for several tasks of one machine and one sync zone.

    Parameters
    ----------
    tasks
        The tasks, their place free.
    objective
        What is made least.

    Raises
    ------
    InputError
        There is nothing to place, or the sync zone fits nowhere.
    InfeasibleError
        A task cannot be done at any place, or not at the common one.
    SolverError
        The solver failed.
    """
    if not tasks or tasks[0].machine.placed:
        raise InputError(
            "a common place is looked for where the machine leaves the place of its sync zone open; this one does not"
        )
    count = min(MOST, len(tasks))
    chosen = [tasks[round(k * (len(tasks) - 1) / max(1, count - 1))] for k in range(count)]
    own = [place_for(task, objective).cost for task in chosen]

    def worst(placed: Task) -> float:
        costs = (cost_at(task.placed_at(placed.machine.place), objective) for task in chosen)
        return max(cost / max(least, 1e-300) for cost, least in zip(costs, own, strict=True))

    found = place_sync(chosen[0], worst, *looks_of(objective))
    place = chosen[0].placed_midway().machine.place if found is None else found.task.machine.place
    increase, length = -math.inf, chosen[0].cut.length
    for task in chosen:
        here = solve(task.placed_at(place), objective, suggest=False).minimised
        best = solve(task, objective, suggest=False).minimised
        increase, length = max((increase, length), (here / best - 1.0 if best > 0.0 else 0.0, task.cut.length))
    return CommonPlace(place, increase, length, len(chosen))
