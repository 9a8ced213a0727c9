"""Limits of a line that keeps its speed that stand for those of its ramps: sharp ones on a slow line.

The ramps bind the slave's ratio at once, by what the line's own acceleration and jerk take of the limits. What the motion's own
acceleration adds to that is next to nothing on a slow line, and an arc at the limit of the jerk lasts microseconds of an hour: no mesh
has it.
"""

from __future__ import annotations

from dataclasses import replace

from camwright.profiles.line import STEADY
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.task import Task

SHORT = 1e-5
"""Share of a return up to which an arc at the limit of the jerk is next to nothing."""

ROOM = 1.01
"""What the peak acceleration is left, over that of the motion that it is reckoned from."""

JERK_LEFT = 1e-3
"""Share of the limit of the jerk that the line's own jerk leaves at least."""


def is_slow(back: CamProfile, task: Task) -> bool:
    """Whether an arc of a return's own at the limit of the jerk is next to nothing."""
    return back.peak(2) <= SHORT * task.greatest_jerk * back.length


def at_most(task: Task) -> Task:
    """Limits that every cam keeps that bears the line's ramps: of its ratio alone, which the forms' mean leaves."""
    return _within(task, task.limits.acceleration, task.limits.jerk, task.limits.acceleration, task.limits.jerk)


def at_least(task: Task, back: CamProfile) -> Task | None:
    """Limits within which every cam bears the line's ramps, for a motion of about the peak acceleration of a return; or none."""
    slope, v = ROOM * back.peak(2), task.cut.line_speed
    acceleration = slope * v**2
    jerk = task.limits.jerk - 3.0 * v * task.line.hardest * slope
    if acceleration >= task.limits.acceleration or jerk <= 0.0:
        return None
    within = _within(task, task.limits.acceleration - acceleration, (1.0 - JERK_LEFT) * jerk, acceleration, jerk)
    left = jerk - task.line.known_jerk * within.greatest_ratio
    return within.with_limits(replace(within.limits, jerk=left))


def _within(task: Task, from_ramp: float, from_jerk: float, acceleration: float, jerk: float) -> Task:
    """Limits with so much of acceleration and jerk for what the line's own take, and so much for the motion's."""
    v, line = task.cut.line_speed, task.line
    speed = task.limits.speed
    for room, taken in ((from_ramp, line.hardest), (from_jerk, line.known_jerk)):
        speed = min(speed, room / taken * v) if taken else speed
    return replace(task, limits=replace(task.limits, speed=speed, acceleration=acceleration, jerk=jerk), line=STEADY)
