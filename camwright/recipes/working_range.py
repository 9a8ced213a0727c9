"""How far a machine can go at a job's other numbers: cut lengths and line speeds, and what binds at either end."""

from __future__ import annotations

import math

from camwright.design.feasible.extremes import extremes
from camwright.design.feasible.feasibility import binding_limit, edge, feasible_lengths, needed_limits
from camwright.design.returns.curve_limits import motor_limits
from camwright.jobs.job import Job
from camwright.profiles.limits import Limits
from camwright.profiles.task import Task
from camwright.recipes.model import Edge, WorkingRange
from camwright.studies.reach import reach

LONGEST = 4.0
"""Cut lengths up to this multiple of the job's are looked at where the slave cannot wait at rest."""

NO_END = "none"
"""What binds where nothing ends a range."""

NOT_FOUND = "not_found"
"""What binds where no end was found up to `LONGEST`."""

LIMITS = ("speed", "acceleration", "jerk", "reversal", "stroke", "sync_zone", "motor", "line_ramp")
AXIS = "axis"
"""What binds by the limits, and the name of what binds where the axis leaves its tolerance."""

_ACCURACY = 1e-6
"""Accuracy of a greatest cut length, relative to it."""

_BEYOND = 1e-3
"""What binds is asked this far beyond the edge."""


def working_range(job: Job) -> WorkingRange:
    """Find the shortest and longest cut at the job's line speed, and the highest line speed at its cut length.

    Both with the axis in tolerance, for a cam designed anew: what `camwright design` would pass. There is no lowest line speed: slower
    asks for less of everything.

    Parameters
    ----------
    job
        The job, a crank's sync zone where the design chose it.
    """
    within = reach(job, extremes(job.task))
    return WorkingRange(
        min_length=Edge(within.min_cut_length, _binding(within.cut_length_binding)),
        max_length=longest_cut(job.task),
        min_line_speed=Edge(None, NO_END),
        max_line_speed=Edge(within.max_line_speed, _binding(within.line_speed_binding)),
    )


def _binding(name: str) -> str:
    """Name what binds as a sheet does: a limit, or the axis, whatever check of it fails."""
    return name if name in LIMITS else AXIS


def longest_cut(task: Task) -> Edge:
    """Find the longest cut at a line speed.

    A slave that can come to rest between two sync zones can wait there for any length. One that must not run backwards and has no
    room to stop can be slowed down by so much only.
    """
    cut = task.cut
    if can_rest(task):
        return Edge(None, NO_END)

    works, far = feasible_lengths(task), LONGEST * cut.length
    if works(far) or not works(cut.length):
        return Edge(None, NOT_FOUND)
    found = edge(works, cut.length, far, _ACCURACY)
    beyond = task.with_length((found or cut.length) * (1 + _BEYOND))
    return Edge(found, binding_limit(beyond, needed_limits(beyond)))


def can_rest(task: Task) -> bool:
    """Whether the slave can come to rest after a sync zone, and from rest into the next: enough room for both, or reversal allowed."""
    machine, limits = task.machine, task.limits
    if limits.motor is not None:
        return any(can_rest(task.with_limits(each)) for each in motor_limits(machine, limits))
    sync, v = task.sync, task.cut.line_speed
    after = stopping_distance(
        v * float(sync(sync.end, 1, side="left")), v * v * float(sync(sync.end, 2, side="left")), limits
    )
    before = stopping_distance(v * float(sync(0.0, 1)), -v * v * float(sync(0.0, 2)), limits)  # run backwards in time
    travel = float(sync(sync.end))
    if machine.guide is not None:
        start = task.slave_at_sync_start
        return before <= start - machine.guide[0] and after <= machine.guide[1] - start - travel
    return task.reverses or before + after <= machine.pitch - travel


def stopping_distance(speed: float, acceleration: float, limits: Limits) -> float:
    """Distance in which a slave can come to rest (slave unit); exact from steady motion, else not below the least one.

    The acceleration is brought to zero first. From steady motion the deceleration rises and falls evenly, so the mean speed is half
    the speed at first, over ``w/a + a/j``, or ``2 sqrt(w/j)`` where the deceleration stays below its limit ``a``.

    Parameters
    ----------
    speed, acceleration
        At first, the acceleration in the direction of motion (slave unit over s, s²).
    limits
        Limits of acceleration ``a`` and jerk ``j``.

    Examples
    --------
    >>> round(stopping_distance(2.0, 0.0, Limits(speed=5.0, acceleration=4.0, jerk=8.0)), 12)
    1.0
    """
    a, j = limits.acceleration, limits.jerk
    easing = abs(acceleration) / j
    steady = max(speed, speed + 0.5 * acceleration * easing)
    time = steady / a + a / j if steady * j >= a * a else 2.0 * math.sqrt(steady / j)
    return steady * (easing + 0.5 * time)
