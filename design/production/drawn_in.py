"""Cams that bear the line's ramps by limits that are drawn in: quick, and a trifle above the least.

What a ramp ``a`` of jerk ``j`` can add to a cam of greatest ratio ``k`` and peak acceleration ``p`` at line speed ``v`` is ``a k`` of
acceleration and ``3 p a / v + j k`` of jerk. A cam within limits less that bears the ramp whatever its phase. Its own ``k`` and ``p`` come
from the cam before, so it is done again until they agree. A peak of the acceleration is a little above that of a cam which knows the ramp
at each place (`camwright.design.line`; 0.01 to 0.9 % on the knife of the paper) and takes a tenth of its time: for lists of many cams.
"""

from __future__ import annotations

from dataclasses import replace

from camwright.design.feasible.feasibility import is_feasible
from camwright.design.line.forms import keeps_ramp
from camwright.design.optimise import Solution, solve
from camwright.design.returns.ipopt import SolveStatus
from camwright.profiles.errors import InfeasibleError
from camwright.profiles.limits import Limits
from camwright.profiles.line import STEADY
from camwright.profiles.objective import CommandObjective
from camwright.profiles.task import Task

_ROUNDS = 4
_SPARE = 1.0 + 1e-6
"""By this factor a cam's peaks are taken greater, so that rounds end."""


def drawn_in(task: Task, ratio: float, acceleration: float) -> Limits | None:
    """Take from a task's limits what its line's ramps can add; ``None`` where nothing is left.

    Parameters
    ----------
    task
        Cut, limits and line.
    ratio
        Greatest ratio of the cam, a magnitude (slave unit per m).
    acceleration
        Its peak acceleration (slave unit/s²).
    """
    line, limits = task.line, task.limits
    left = limits.acceleration - line.hardest * ratio
    jerk = limits.jerk - 3.0 * min(acceleration, left) * line.hardest / task.cut.line_speed - line.known_jerk * ratio
    return replace(limits, acceleration=left, jerk=jerk) if min(left, jerk) > 0.0 else None


def surely_bears(task: Task) -> bool:
    """Whether some cam bears the line's ramps for sure: within limits that are drawn in for the greatest ratio allowed."""
    limits = drawn_in(task, task.greatest_ratio, task.limits.acceleration)
    there = task.with_line(STEADY)
    return limits is not None and keeps_ramp(task.sync, task) and is_feasible(there.with_limits(limits))


def solve_drawn_in(task: Task, objective: CommandObjective) -> Solution | None:
    """Design a cam that bears the line's ramps by limits that are drawn in; ``None`` where none was found so.

    Parameters
    ----------
    task, objective
        The job, without a motor's curve.

    Raises
    ------
    SolverError
        The solver failed.
    """
    steady = task.with_line(STEADY)
    try:
        found = solve(steady, objective, suggest=False)
        for _ in range(_ROUNDS):
            if keeps_ramp(found.profile, task.with_machine(found.machine)):
                return replace(found, status=SolveStatus.BEST_FOUND)
            ratio, slope = (_SPARE * found.profile.peak(order) for order in (1, 2))
            limits = drawn_in(task, ratio, slope * task.cut.line_speed**2)
            if limits is None:
                return None
            found = solve(steady.with_limits(limits), objective, suggest=False)
    except InfeasibleError:
        return None
    return None
