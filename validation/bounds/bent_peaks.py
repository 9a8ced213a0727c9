"""Least peaks of a return whose ends are not at rest relative to the material: closed form, by bisection.

With the acceleration limited to ``a``, or the jerk to ``j``, the ways motions cover from end to end in a given time are an interval
(`camwright.profiles.closed_forms.transfer`), so whether the return is possible is known; the least ``a`` at which it is bounds every
motion.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from camwright.profiles.closed_forms.transfer import Bounds, State, farthest, nearest
from camwright.profiles.halving import halved
from camwright.profiles.task import Task

ROUNDING = 1e-9
"""Share by which a bound is lowered, and of the way by which a return may miss its end: rounding."""

HALVINGS = 60


def least_bent_acceleration(task: Task) -> float:
    """Least peak acceleration of any return of a task (slave unit/s²); infinite if none keeps the task's limits."""
    limits = task.limits
    return _least(task, lambda peak: _bounds(task, peak, limits.jerk), limits.acceleration)


def least_bent_jerk(task: Task) -> float:
    """Least peak jerk of any return of a task (slave unit/s³); infinite if none keeps the task's limits."""
    limits = task.limits
    return _least(task, lambda peak: _bounds(task, limits.acceleration, peak), limits.jerk)


def _bounds(task: Task, acceleration: float, jerk: float) -> Bounds:
    return Bounds(task.least_velocity, task.limits.speed, acceleration, jerk)


def _least(task: Task, bounds: Callable[[float], Bounds], most: float) -> float:
    """Greatest peak up to a limit that is proved to be too low."""
    cut, sync = task.cut, task.sync
    v, time = cut.line_speed, cut.return_zone / cut.line_speed
    start, end = (State(float(sync(at, 1)) * v, float(sync(at, 2)) * v**2) for at in (sync.end, sync.start))
    spare = ROUNDING * max(abs(task.height), time * max(abs(start.velocity), abs(end.velocity)))

    def possible(peak: float) -> bool:
        if peak <= 0.0:
            return False
        within = bounds(peak)
        far, near = farthest(time, start, end, within), nearest(time, start, end, within)
        return far is not None and near is not None and near.distance - spare <= task.height <= far.distance + spare

    high = most * (1 + ROUNDING)
    return halved(possible, high, 0.0, most=HALVINGS)[1] * (1 - ROUNDING) if possible(high) else math.inf
