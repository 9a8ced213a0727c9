"""How far a print mark may move a cut, by a redesign of the return: the next length is shorter or longer."""

from __future__ import annotations

import math

from camwright.design.feasible.feasibility import edge, is_feasible
from camwright.design.feasible.refusal import require_feasible
from camwright.design.production.ramps import can_stand
from camwright.profiles.mark_range import MarkRange
from camwright.profiles.ramp import stand
from camwright.profiles.task import Task

FARTHEST = 64.0
"""Cut lengths up to this multiple of the job's are looked at where the slave cannot come to rest between two cuts."""

_STRIDE = 2.0


def redesigned(task: Task) -> MarkRange:
    """Find the shortest and the longest next length, less the one that is expected: whatever lies between can be designed.

    Whether a return is possible is a closed form for every machine, so both ends are found to rounding. A job whose own length cannot be
    done is refused.

    Raises
    ------
    InfeasibleError
        The cut itself cannot be done.
    """
    require_feasible(task)
    length, zone = task.cut.length, task.cut.sync_zone

    def works(each: float) -> bool:
        return each > zone and is_feasible(task.with_length(each))

    rests = can_stand(stand(task))  # then it can wait as long as it must
    shortest = edge(works, length, zone)
    far, bad = length, math.inf
    while not rests and far < FARTHEST * length:
        if not works(far * _STRIDE):
            bad = far * _STRIDE
            break
        far *= _STRIDE
    longest = None if math.isinf(bad) else edge(works, far, bad)
    return MarkRange(min((shortest or length) - length, 0.0), None if longest is None else max(longest - length, 0.0))
