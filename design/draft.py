"""A cycle at once: what is shown while a hand drags, not what is released."""

from __future__ import annotations

from dataclasses import dataclass

from camwright.design.feasible.refusal import require_feasible
from camwright.design.line.forms import keeps_ramp
from camwright.design.returns.measures import objective_value
from camwright.design.returns.problem import return_problem
from camwright.design.returns.solver import draft_return
from camwright.profiles.line import STEADY
from camwright.profiles.objective import OBJECTIVES, MotionObjective
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.returns import assemble
from camwright.profiles.task import Task


@dataclass(frozen=True, eq=False)
class Draft:
    """A cycle that keeps the limits, and is the optimum or near it.

    Parameters
    ----------
    profile
        The whole cycle over the master period ``[0, x_c]``.
    value
        What is minimised, over time at the job's line speed: m/s² or m/s³ (rad for m with a crank), root mean squares over the return zone.
    exact
        Whether it is the optimum that `camwright.design.optimise.solve` gives.
    """

    profile: CamProfile
    value: float
    exact: bool


def draft(task: Task, objective: MotionObjective) -> Draft:
    """Draw a cycle for an objective of the motion, the sync zone placed, on a line that keeps its speed.

    Raises
    ------
    InfeasibleError
        No motion keeps the limits.
    InputError
        The machine cannot be in sync over the zone.
    SolverError
        The solver failed on a job that has an answer.

    Examples
    --------
    >>> from camwright.profiles.cut import Cut
    >>> from camwright.profiles.limits import Limits
    >>> from camwright.profiles.machines import RotaryKnife
    >>> cut = Cut(0.6, 80 / 60, 0.2, 0.04, 0.16, 1e-4)
    >>> found = draft(Task(RotaryKnife(circumference=0.4), cut, Limits(200 / 60, 30.0, 3000.0)), "peak_acceleration")
    >>> round(found.value, 3), found.exact
    (9.072, True)
    """
    task.machine.sync_start(task.cut)
    require_feasible(task, suggest=False)
    back, exact = draft_return(return_problem(task.with_line(STEADY), objective))
    of, profile = OBJECTIVES[objective], assemble(back, task)
    value = of.over_time(objective_value(back, objective), task.cut.line_speed)
    if of.form == "peak":
        zone = task.sync.peak(of.order)
        value = max(value, of.over_time(zone, task.cut.line_speed))
    return Draft(profile, value, exact and keeps_ramp(profile, task))
