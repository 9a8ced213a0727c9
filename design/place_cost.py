"""What a place of the sync zone costs, by the objective that the whole design has."""

from __future__ import annotations

import math

import numpy as np

from camwright.design.feasible.feasibility import is_feasible, least_limit, margin
from camwright.design.place import PEAK_PLACES, PEAK_RESOLUTION, PLACES, RESOLUTION, Placement, place_sync
from camwright.design.returns.curve_limits import motor_limits, motor_speed_limits
from camwright.design.returns.grids import grid_objective
from camwright.design.returns.possible import possible_rms
from camwright.design.returns.problem import return_problem
from camwright.design.torque.within_curve import load
from camwright.profiles.objective import CommandObjective, MotionObjective
from camwright.profiles.returns import baseline
from camwright.profiles.task import Task

MISSING = 1e30
"""Where limits are not enough the cost is this, far above any objective, times the factor on the limits that would be."""
FAR = 1e30
"""The same for limits of the slave over those of the motor."""
ANGLES = 721
"""Places of the cycle at which the torque of a stand-in is taken."""


def place_for(task: Task, objective: CommandObjective) -> Placement:
    """Place the sync zone where an objective is least, or, where the limits are not enough at any place, where least is missing.

    A peak is that of the whole cycle, for the sync zone can have a higher one than the return. Root mean squares are those of the return,
    on a grid.

    Raises
    ------
    InputError
        The sync zone fits nowhere.
    """
    found = place_sync(task, lambda placed: cost_at(placed, objective), *looks_of(objective))
    return Placement(task.placed_midway(), math.inf, 1) if found is None else found


def looks_of(objective: CommandObjective) -> tuple[int, float]:
    """How many places are looked at first for an objective, and how accurate the place is (rad)."""
    peak = objective == "peak_acceleration" or objective == "peak_jerk"
    return (PEAK_PLACES, PEAK_RESOLUTION) if peak else (PLACES, RESOLUTION)


def cost_at(placed: Task, objective: CommandObjective) -> float:
    """Objective at a place, or far above any what is missing of the limits there; of the torque a stand-in, as `place_for` has it."""
    if not is_feasible(placed):
        return MISSING * _missing(placed)
    match objective:
        case "peak_acceleration":
            return least_limit(placed, "acceleration")
        case "peak_jerk":
            return least_limit(placed, "jerk")
        case "rms_acceleration" | "rms_jerk":
            return _rms(placed, objective)
    return _torque(placed)


def _missing(task: Task) -> float:
    """How much is missing at a place: torque of the motor, told by the quintic, or far worse, what the slave itself may do."""
    limits = task.limits
    plain = motor_speed_limits(task.machine, limits)
    if limits.motor is not None and is_feasible(task.with_limits(plain)):
        return load(baseline("poly_3_4_5", task), task, limits.motor)
    return FAR * margin(task.with_limits(plain))


def _rms(task: Task, objective: MotionObjective) -> float:
    """Objective on the coarse grid within the best of the motor's limits, or, where the grid is too coarse for them, of any motion."""
    costs = []
    for each in motor_limits(task.machine, task.limits):
        if is_feasible(task.with_limits(each)):
            problem = return_problem(task.with_limits(each), objective)
            value = grid_objective(problem)
            costs.append(value if math.isfinite(value) else possible_rms(problem))
    return min(costs)


def _torque(task: Task) -> float:
    """Mean square torque of the quintic: a fast stand-in for the torque's own optimum.

    The place matters through the inertia's change in the sync zone and the speeds that the return must join, which both share.
    """
    task = task.from_return()
    machine = task.machine
    cycle = baseline("poly_3_4_5", task)
    x = np.linspace(cycle.start, cycle.end, ANGLES)
    y = task.slave_at_start + cycle(x)
    torque = machine.inertia(y) * cycle(x, 2) + machine.inertia_slope(y) * cycle(x, 1) ** 2 / 2
    return float(np.mean(torque**2))
