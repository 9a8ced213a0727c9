"""Least energy where the inertia is constant and nothing rubs: the speed is changed as little as the time allows.

What is drawn is what the kinetic energy gains where it rises. Between two sync zones of the same speed the slave must fall to some lowest
velocity, or rise to some highest speed, and come back; what that costs depends on this velocity alone. So the motion that is least far off
the speed in sync draws least, and whether limits leave any motion is known in closed form. Of all these motions the one of least RMS
acceleration is taken.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

import numpy as np

from camwright.design.returns.possible import is_possible
from camwright.design.returns.problem import ReturnProblem
from camwright.design.returns.scaling import resolved
from camwright.design.returns.solver import solve_return
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.task import Task

_Ratio = Literal["least_ratio", "greatest_ratio"]

HALVINGS = 60
# Places of a return at which its speed is looked at, besides its breaks.
LOOKS = 4001
EASED = 2e-5
"""Share of the change of speed that is given away for a smoother motion."""


def least_speed(problem: ReturnProblem) -> tuple[CamProfile, int]:
    """Give the return whose speed differs least from that in sync, and the iterations of the solver.

    Raises
    ------
    SolverError
        No grid gave an answer.
    """
    eased = replace(problem, objective="rms_acceleration")
    if problem.height > problem.start_ratio * problem.length:
        at = max(problem.start_ratio, problem.end_ratio)
        found = _nearest(problem, "greatest_ratio", at)
        eased = replace(eased, greatest_ratio=min(found + EASED * (found - at), problem.greatest_ratio))
    else:
        at = min(problem.start_ratio, problem.end_ratio)
        found = _nearest(problem, "least_ratio", at)
        eased = replace(eased, least_ratio=max(found - EASED * (at - found), problem.least_ratio))
    back, _, iterations = solve_return(eased)
    return back, iterations


def drawn_power(back: CamProfile, task: Task) -> float:
    """Mean power that a return draws at the slave, where the inertia is constant and nothing rubs (W): the rises of the kinetic energy."""
    turns = np.unique(np.concatenate([back.breaks, back.roots(1), back.roots(2)]))
    x = np.unique(np.concatenate([turns, np.linspace(back.start, back.end, LOOKS)]))
    speed = task.cut.line_speed * back(x, 1)
    energy = 0.5 * float(task.machine.inertia(task.slave_at_sync_end)) * speed**2
    return float(np.maximum(np.diff(energy), 0.0).sum()) / (back.length / task.cut.line_speed)


def _nearest(problem: ReturnProblem, name: _Ratio, none: float) -> float:
    """Limit of the ratio nearest to one that leaves no motion with which there still is one."""
    far, near = float(getattr(problem, name)), none
    for _ in range(HALVINGS):
        middle = 0.5 * (far + near)
        if is_possible(resolved(_within(problem, name, middle))):
            far = middle
        else:
            near = middle
    return far


def _within(problem: ReturnProblem, name: _Ratio, limit: float) -> ReturnProblem:
    if name == "least_ratio":
        return replace(problem, least_ratio=limit)
    return replace(problem, greatest_ratio=limit)
