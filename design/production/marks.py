"""How far a print mark may move a cut, by a redesign of the return: the next length is shorter or longer.

Whether a return is possible is a closed form for every machine, so both ends are found to rounding. On a line that ramps it is not: there
a length is sure that is possible within limits from which the most is taken that the line's ramps can add, and the end itself is found by
designs; so it is with a motor's torque-speed curve.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

from camwright.design.feasible.feasibility import edge, feasible_lengths, shortest_length
from camwright.design.feasible.refusal import require_feasible
from camwright.design.line.forms import keeps_ramp
from camwright.design.optimise import solve
from camwright.design.production.ramps import can_stand
from camwright.design.returns.curve_limits import motor_speed_limits
from camwright.profiles.errors import InfeasibleError, SolverError
from camwright.profiles.limits import Limits
from camwright.profiles.line import STEADY
from camwright.profiles.mark_range import MarkRange
from camwright.profiles.ramp import stand
from camwright.profiles.task import Task

FARTHEST = 64.0
"""Cut lengths up to this multiple of the job's are looked at where the slave cannot come to rest between two cuts."""

DESIGNED = 1e-3
"""Share of a correction to which its end is found by designs."""

_STRIDE = 2.0
_RATIOS = (1.0, 0.9, 0.8, 0.7, 0.6, 0.5, 0.4)
_PEAKS = (1.0, 0.95, 0.9, 0.8, 0.65, 0.5, 0.3, 0.15)
"""Shares of the greatest ratio and of the acceleration that are tried: the less is used, the more the line leaves."""


def redesigned(task: Task) -> MarkRange:
    """Find the shortest and the longest next length, less the one that is expected: whatever lies between can be designed.

    On a line that ramps, and with a motor's curve, of which rectangles are kept, the ends are sure and may lie inside: `designed_ends`
    finds them by designs.

    Raises
    ------
    InfeasibleError
        The cut itself cannot be done, whatever torque the motor gives.
    """
    # a motion within the motor's curve need not lie in one of its rectangles: then no other length is sure
    require_feasible(task.with_limits(motor_speed_limits(task.machine, task.limits)))
    if not task.line.ramps:
        return _ends(task, feasible_lengths(task), shortest_length(task))
    if not keeps_ramp(task.sync, task):
        return MarkRange(0.0, 0.0)
    return _ends(task, feasible_lengths(*_reserved(task)))


def designed_ends(task: Task) -> MarkRange:
    """Find the same ends on a line that ramps, or of a motor with a curve, by designs: to `DESIGNED`.

    They lie between those that are sure and those of a steady line and a motor of any torque.

    Raises
    ------
    InfeasibleError
        The cut itself cannot be done.
    """
    sure = redesigned(task)
    if not task.line.ramps and task.limits.motor is None:
        return sure
    free = redesigned(task.with_line(STEADY).with_limits(motor_speed_limits(task.machine, task.limits)))

    def between(good: float | None, bad: float | None) -> float | None:
        if bad is None and good == 0.0 and designs(task, (FARTHEST - 1.0) * task.cut.length):
            return None  # the slave can wait, though not in a rectangle of the motor's curve
        if good is None or bad is None or good == bad:
            return good
        found = edge(lambda shift: shift == good or designs(task, shift), good, bad, DESIGNED)
        return good if found is None else found

    return MarkRange(between(sure.earliest, free.earliest), between(sure.latest, free.latest))


def designs(task: Task, shift: float) -> bool:
    """Whether a cam of least peak acceleration is designed for a length that is so much off (m)."""
    length = task.cut.length + shift
    if length <= task.cut.sync_zone:
        return False
    try:
        solve(task.with_length(length), "peak_acceleration", suggest=False)
    except (InfeasibleError, SolverError):
        return False
    return True


def _ends(task: Task, works: Callable[[float], bool], known: float | None = None) -> MarkRange:
    """Find the ends of what works; the shortest length is looked for where none is known that is no longer than the job's."""
    length, zone = task.cut.length, task.cut.sync_zone
    if not works(length):
        return MarkRange(0.0, 0.0)
    shortest = (edge(works, length, zone) or length) if known is None or known > length else known
    early = min(shortest - length, 0.0)
    if can_stand(stand(task)):
        return MarkRange(early, None)  # it can wait as long as it must
    far = length
    while far < FARTHEST * length:
        if not works(far * _STRIDE):
            return MarkRange(early, max((edge(works, far, far * _STRIDE) or far) - length, 0.0))
        far *= _STRIDE
    return MarkRange(early, None)


def _reserved(task: Task) -> Iterator[Task]:
    """Give the task on a steady line within limits that leave room for its ramps, for ratios and peaks of several sizes."""
    line, limits, v = task.line, task.limits, task.cut.line_speed
    a, j = line.hardest, line.known_jerk
    for share in _RATIOS:
        ratio = share * task.greatest_ratio
        left = limits.acceleration - a * ratio
        for part in _PEAKS:
            jerk = limits.jerk - 3.0 * part * left * a / v - j * ratio
            if left > 0 and jerk > 0:
                drawn: Limits = replace(limits, speed=ratio * v, acceleration=part * left, jerk=jerk)
                yield task.with_line(STEADY).with_limits(drawn)
