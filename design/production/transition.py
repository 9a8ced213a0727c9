"""From one cam into another that does not meet it: a cycle in between that leaves the one and ends in the other's sync zone.

A seam lies at the end of the sync zone. Cams of one machine whose command is in sync there have the same state at that place, and need
nothing. Shaped commands, and cranks whose sync zone lies elsewhere, do not: there the first return after the change starts in the state
in which the cam before it ends, and from its sync zone on it is the new cam's own motion.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from camwright.design.feasible.feasibility import edge
from camwright.design.returns.possible import is_possible
from camwright.design.returns.problem import ReturnProblem, return_problem
from camwright.design.returns.scaling import resolved
from camwright.design.returns.solver import solve_return
from camwright.profiles.objective import MotionObjective
from camwright.profiles.polynomial.profile import CamProfile, join
from camwright.profiles.returns import baseline
from camwright.profiles.task import Task

_SLOWEST = 1e-3
"""Share of a line speed down to which a transition is looked for."""

_TRIFLE = 1e-9
_EDGE = 1e-6
_ROOM = 1e-3
"""Share of its highest line speed by which a transition at the edge of what is possible stays below: a solver needs room."""


@dataclass(frozen=True, eq=False)
class RunningCam:
    """A cam that runs, its master zero at the end of the sync zone.

    Parameters
    ----------
    task
        Machine with everything chosen, cut and limits.
    profile
        One cycle over ``[0, x_c]``.
    """

    task: Task
    profile: CamProfile

    @property
    def zero(self) -> float:
        """Slave coordinate of the machine at the profile's slave zero (slave unit)."""
        return self.task.slave_zero(self.profile)

    @property
    def zone_start(self) -> float:
        """Master position where its sync zone begins (m): a break of the profile where one lies there but for rounding."""
        zone = self.task.cut.return_zone
        nearest = float(self.profile.breaks[np.abs(self.profile.breaks - zone).argmin()])
        return nearest if abs(nearest - zone) <= 1e-12 * self.profile.length else zone

    @property
    def last(self) -> tuple[float, float, float]:
        """Slave coordinate, a cycle's travel taken off, ratio and ratio slope where a cycle ends."""
        end, profile = self.profile.end, self.profile
        position = self.zero + float(profile(end)) - self.task.machine.pitch
        return position, float(profile(end, 1)), float(profile(end, 2))


def in_sync(cam: RunningCam) -> RunningCam:
    """Give a cam of the same cut whose command is in sync throughout its zone; of its return only the ends count.

    Every cam in sync ends in that state. A change between shaped commands that no motion makes at once may be made through it.
    """
    task = cam.task.with_cut(replace(cam.task.cut, shaped=False))
    return RunningCam(task, baseline("poly_3_4_5", task))


def transition_problem(
    before: RunningCam, after: RunningCam, line_speed: float, objective: MotionObjective
) -> ReturnProblem:
    """Put the return of a transition into numbers.

    Parameters
    ----------
    before, after
        The cam that runs, and the one that is to run.
    line_speed
        Line speed at which its limits are to hold (m/s), and at every lower one.
    objective
        What it minimises.

    Notes
    -----
    Where the line ramps, limits are drawn in by what its ramp can add to any motion within them: ``A' = A - a k`` and
    ``J' = J - 3 A' a / v - j k`` with the greatest ratio ``k`` that is allowed. That is enough, and more than needed. The state at
    either end is given, whatever the ramp would ask for there.
    """
    place, ratio, slope = before.last
    end_slope = float(after.profile(after.zone_start, 2))
    task = within_ramps(after.task.at_speed(line_speed), max(abs(slope), abs(end_slope)) * line_speed**2)
    start, zone = place - after.zero, after.zone_start
    least, greatest = (limit - place for limit in task.machine.guide or (-math.inf, math.inf))
    return replace(
        return_problem(task, objective),
        length=zone,
        height=float(after.profile(zone)) - start,
        start_ratio=ratio,
        end_ratio=float(after.profile(zone, 1)),
        start_slope=slope,
        end_slope=end_slope,
        least_position=least,
        greatest_position=greatest,
    )


def within_ramps(task: Task, needed: float) -> Task:
    """Take from the limits what the line's ramps can add; what the ends need is left, and of the jerk a trifle, which allows nothing.

    Parameters
    ----------
    needed
        Acceleration at the ends (slave unit/s²).
    """
    line, limits = task.line, task.limits
    if not line.ramps:
        return task
    most = task.greatest_ratio
    acceleration = max(limits.acceleration - line.hardest * most, min(needed, limits.acceleration))
    jerk = limits.jerk - 3.0 * acceleration * line.hardest / task.cut.line_speed - line.known_jerk * most
    return task.with_limits(replace(limits, acceleration=acceleration, jerk=max(jerk, _TRIFLE * limits.jerk)))


def transition_speed(before: RunningCam, after: RunningCam) -> float | None:
    """Highest line speed up to that of both cams at which some transition keeps the limits (m/s); ``None`` if there is none."""
    top = min(before.task.cut.line_speed, after.task.cut.line_speed)

    def works(line_speed: float) -> bool:
        return is_possible(resolved(transition_problem(before, after, line_speed, "peak_acceleration")))

    if works(top):
        return top
    found = edge(works, _SLOWEST * top, top, _EDGE)
    return None if found is None else (1.0 - _ROOM) * found


def design_transition(
    before: RunningCam, after: RunningCam, line_speed: float, objective: MotionObjective
) -> CamProfile:
    """Design a transition.

    Parameters
    ----------
    before, after, objective
        As in `transition_problem`.
    line_speed
        What `transition_speed` gives, or less (m/s).

    Returns
    -------
    CamProfile
        One cycle over the master period of the cam after it, counted like that one: it begins where the cam before it ends.

    Raises
    ------
    SolverError
        The solver failed.
    """
    back = solve_return(transition_problem(before, after, line_speed, objective))[0]
    back = back.shift(slave=before.last[0] - after.zero).over(0.0, after.zone_start)
    return join(back, after.profile.restrict(after.zone_start, after.profile.end))
