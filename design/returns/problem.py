"""`ReturnProblem`: what has to be found, as numbers over the master."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

from camwright.profiles.objective import MotionObjective
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.task import Task


@dataclass(frozen=True)
class ReturnProblem:
    """The return between two sync zones, over the master.

    Find ``y`` on ``[0, length]`` with the given ends that keeps the limits and minimises the objective. Primes are derivatives over the
    master.

    Parameters
    ----------
    length
        Length of the return zone (m).
    height
        Slave travel ``y(length) - y(0)`` (slave unit).
    start_ratio, end_ratio
        ``y'`` at the two ends (slave unit per m).
    start_slope, end_slope
        ``y''`` at the two ends (slave unit per m²).
    least_ratio, greatest_ratio
        Limits of ``y'``.
    greatest_slope
        Limit of ``|y''|``.
    greatest_jerk
        Limit of ``|y'''|`` (slave unit per m³).
    objective
        What is minimised: the peak or the root mean square of ``y''`` or of ``y'''``.
    least_position, greatest_position
        Positions between which ``y - y(0)`` must stay (slave unit); infinite where there is no stroke to keep.
    """

    length: float
    height: float
    start_ratio: float
    end_ratio: float
    start_slope: float
    end_slope: float
    least_ratio: float
    greatest_ratio: float
    greatest_slope: float
    greatest_jerk: float
    objective: MotionObjective
    least_position: float = -math.inf
    greatest_position: float = math.inf


def return_problem(task: Task, objective: MotionObjective) -> ReturnProblem:
    """Put the return of a cutting machine into numbers: the sync zone's ends give the return's boundary values."""
    machine, ends = task.machine, _ends(task.sync)
    least, greatest = -math.inf, math.inf
    if machine.guide is not None:
        end = task.slave_at_sync_start + task.sync.advance
        least, greatest = machine.guide[0] - end, machine.guide[1] - end
    return ReturnProblem(
        length=task.cut.return_zone,
        height=task.height,
        start_ratio=ends[0],
        end_ratio=ends[1],
        start_slope=ends[2],
        end_slope=ends[3],
        least_ratio=task.least_ratio,
        greatest_ratio=task.greatest_ratio,
        greatest_slope=task.greatest_slope,
        greatest_jerk=task.greatest_jerk,
        objective=objective,
        least_position=least,
        greatest_position=greatest,
    )


@lru_cache(maxsize=256)
def _ends(sync: CamProfile) -> tuple[float, float, float, float]:
    """Ratio at the end and at the start of a sync zone, and the ratio slope there; kept with the sync zone."""
    return float(sync(sync.end, 1)), float(sync(sync.start, 1)), float(sync(sync.end, 2)), float(sync(sync.start, 2))
