"""Least root mean square of acceleration or jerk of any return of a task, whatever its ends and its stroke: by weak duality."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

from camwright.profiles.objective import OBJECTIVES, MotionObjective
from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.profiles.task import Task
from camwright.validation.bounds.bound import NONE, Bound
from camwright.validation.bounds.return_dual import DualTask, least_square_acceleration, least_square_jerk

INTERVALS = (300, 1200, 2400)
"""Intervals of the grids that are tried in turn while more than `ENOUGH` is left between bound and motion."""
ENOUGH = 5e-4
INSIDE = 12
"""Intervals that each piece of the motion is given at least; short pieces are where the jerk does its work."""
MOST_PIECES, FEW_INSIDE = 60, 2
"""A motion of more pieces than this is one on a mesh, and the intervals that each of these is given at least."""
DUAL = "weak duality, multipliers by an interior point"
NOTHING = Bound(0.0, NONE)


def mean_square_bound(profile: CamProfile, task: Task, objective: MotionObjective, known: Bound = NOTHING) -> Bound:
    """Bound of a root mean square over the return zone (slave unit per s² or s³).

    Parameters
    ----------
    profile
        One cycle over ``[0, x_c]``; its value tells when a finer grid is worth its time, and its breaks are nodes.
    task
        The job.
    objective
        ``"rms_acceleration"`` or ``"rms_jerk"``.
    known
        A bound that is known already; the better one is given.
    """
    cut, order = task.cut, OBJECTIVES[objective].order
    v = cut.line_speed
    own = _dual_task(task)
    start = cut.return_start
    back = profile.restrict(start, start + cut.return_zone)
    breaks = (back.breaks - back.start) / v
    value = math.sqrt(back.mean_square(order)) * v**order
    if value == 0.0:
        return Bound(0.0, DUAL)
    unit, least = (value, least_square_jerk) if order == 3 else (value / own.time, least_square_acceleration)
    best = known
    for intervals in INTERVALS:
        if best.value >= value * (1 - ENOUGH):
            break
        found = 2.0 * least(own, _nodes(breaks, own.time, intervals), unit) / own.time
        best = max(best, Bound(math.sqrt(max(found, 0.0)), DUAL), key=lambda bound: bound.value)
    return best


def _dual_task(task: Task) -> DualTask:
    """Return of a task over time, its position counted from where it starts."""
    cut, sync, limits = task.cut, task.sync, task.limits
    v = cut.line_speed
    (out, slope), (into, last) = ((float(sync(at, 1)) * v, float(sync(at, 2)) * v**2) for at in (sync.end, sync.start))
    positions = (-math.inf, math.inf)
    if task.machine.guide is not None:
        positions = (task.machine.guide[0] - task.slave_at_sync_end, task.machine.guide[1] - task.slave_at_sync_end)
    return DualTask(
        cut.return_zone / v,
        (out, slope),
        (task.height, into, last),
        (task.least_velocity, limits.speed),
        limits.acceleration,
        limits.jerk,
        positions,
    )


def _nodes(breaks: FloatArray, time: float, intervals: int) -> FloatArray:
    """Place nodes evenly on each piece of a motion, few at least on one of many pieces: its mesh is close where the motion bends."""
    least = INSIDE if len(breaks) <= MOST_PIECES else FEW_INSIDE
    parts = [
        np.linspace(low, high, max(least, math.ceil(intervals * (high - low) / time)) + 1)[:-1]
        for low, high in pairwise(breaks)
        if high - low > 1e-9 * time
    ]
    nodes = np.append(np.concatenate(parts), time)
    nodes[0] = 0.0
    return np.asarray(nodes[np.append(np.diff(nodes) > 1e-12 * time, True)])
