"""`Reach`: how fast and how short with the axis in tolerance: what `design` would pass, redesigned at each line speed and cut length."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

from camwright.design.feasible.extremes import Extremes
from camwright.design.optimise import motion_objective, solve
from camwright.design.returns.curve_limits import motor_limits
from camwright.design.servo_aware.axis_problem import AxisProblem
from camwright.design.servo_aware.programme import AxisProgramme
from camwright.jobs.job import Job
from camwright.jobs.servos import between_of, servos_of
from camwright.profiles.errors import InfeasibleError, InputError, SolverError
from camwright.profiles.objective import MotionObjective, of_command, of_motion
from camwright.profiles.task import Task
from camwright.validation.report import judge

ACCURACY, SERVO_AWARE_ACCURACY = 1e-4, 5e-3
"""Accuracy of an edge, relative to it; of servo-aware jobs, whose every step is a design of a second."""

STRIDE = 0.9
"""The edge of the perfect axis is left in steps of this factor until a design passes."""

BESIDE, GROWTH = 2.0, 4.0
"""First step from where an edge is expected, in accuracies of the edge, and the factor by which each further one is longer."""

SLOWEST, LONGEST = 0.02, 4.0
"""Line speeds down to this share of the perfect axis' highest, and cut lengths up to this multiple of its shortest, are looked at."""

_INSIDE = 1e-6
"""What the perfect axis' own edge is asked with, relative to it: solvers need room."""

RAMP = "line_ramp"
"""What binds where no cam bears the ramps of the line: the check that would fail."""

TOLERANCE = "sync_tolerance"
"""What binds where no servo-aware command brings the axis into the tolerance."""


@dataclass(frozen=True)
class Reach:
    """How far a machine can go at a job's other numbers with its axis in tolerance.

    Parameters
    ----------
    max_line_speed
        Highest line speed at the job's cut length (m/s); ``None`` if none was found.
    line_speed_binding
        What fails beyond: a check, or what binds the perfect axis.
    min_cut_length
        Shortest cut at the job's line speed (m); ``None`` if none was found.
    cut_length_binding
        What fails below it.
    """

    max_line_speed: float | None
    line_speed_binding: str
    min_cut_length: float | None
    cut_length_binding: str


def reach(job: Job, far: Extremes) -> Reach:
    """Find how far a job's machine can go with its axis in tolerance.

    Parameters
    ----------
    job
        The job; a crank's sync zone placed.
    far
        The same for the perfect axis, which is the end of the search.
    """
    speed, too_fast = highest_speed(job, far.max_line_speed)
    length, too_short = shortest_cut(job, far.min_cut_length)
    return Reach(speed, too_fast or far.line_speed_binding, length, too_short or far.cut_length_binding)


def highest_speed(
    job: Job, perfect: float | None, near: float | None = None, accuracy: float = ACCURACY
) -> tuple[float | None, str]:
    """Find the highest line speed at the job's cut length that passes, and what fails beyond.

    Parameters
    ----------
    job
        The job.
    perfect
        Highest line speed of the perfect axis (m/s), ``None`` where none works.
    near
        Line speed (m/s) near which the edge is expected; without it the search comes from the perfect axis' edge.
    accuracy
        Of the line speed, relative to it; of a servo-aware job no finer than `SERVO_AWARE_ACCURACY`.

    Returns
    -------
    (speed, failed)
        The line speed (m/s), ``None`` where none works; and what fails beyond, empty where the perfect axis ends there.
    """
    if perfect is None:
        return None, ""
    objective = stand_in(job)
    found, failed = _edge(
        lambda share: fails(job, job.task.designed_at(perfect * share), objective),
        SLOWEST,
        max(accuracy, _accuracy(job)),
        None if near is None else near / perfect,
    )
    return (None if found is None else perfect if not failed else perfect * found), failed


def shortest_cut(job: Job, perfect: float | None) -> tuple[float | None, str]:
    """Shortest cut at the job's line speed that passes (m), and what fails below it, empty where the perfect axis ends there."""
    if perfect is None:
        return None, ""
    objective = stand_in(job)
    found, failed = _edge(
        lambda share: fails(job, job.task.with_length(perfect / share), objective), 1.0 / LONGEST, _accuracy(job)
    )
    return (None if found is None else perfect if not failed else perfect / found), failed


def stand_in(job: Job) -> MotionObjective:
    """Objective that redesigns are made for: the job's, or that of the motion which stands for it."""
    if job.objective == "sync_error":
        return "peak_acceleration"
    objective = of_command(job.objective)
    return motion_objective(job.machine, objective) or of_motion(objective)


def fails(job: Job, task: Task, objective: MotionObjective) -> str:
    """Design a task as the job would and judge it.

    Returns
    -------
    str
        The first check that fails, or what makes a design impossible; empty where it passes.
    """
    if job.servo_aware:
        return "" if _reaches(job, task) else TOLERANCE
    try:
        solution = solve(task, objective, suggest=False, thorough=False)
    except InfeasibleError as error:
        return RAMP if error.binding.startswith("line.") else error.binding
    except (InputError, SolverError):
        return "design"
    report = judge(solution.profile, task.with_machine(solution.machine), job.servo, servo_aware=job.servo_aware)
    return next((check.name for check in report.checks if not check.passed), "")


def _reaches(job: Job, task: Task) -> bool:
    """Whether a servo-aware command within the limits brings the axis into the tolerance, its own limits kept."""
    try:
        return any(
            AxisProgramme(
                AxisProblem(
                    task.with_limits(limits), job.command, servos_of(job), axis_limits=True, between=between_of(job)
                )
            ).reaches()
            for limits in motor_limits(task.machine, task.limits)
        )
    except (InputError, SolverError):
        return False


def _accuracy(job: Job) -> float:
    return SERVO_AWARE_ACCURACY if job.servo_aware else ACCURACY


def _edge(
    failing: Callable[[float], str], least: float, accuracy: float, near: float | None = None
) -> tuple[float | None, str]:
    """Find the greatest share of the perfect axis' edge that passes: enclosed from where it is expected, or from above, then bisected.

    Returns
    -------
    (share, failed)
        The share, ``None`` if none passes, and what fails beyond it; nothing where the edge itself passes.
    """
    top = 1.0 - _INSIDE
    low, high, failed = 0.0, top, ""
    stride, longer = STRIDE, 1.0
    if near is not None:
        stride, longer = 1.0 / (1.0 + BESIDE * accuracy), GROWTH
        if near < top * stride:
            low, high, failed = _upwards(failing, near, top, accuracy)
    if not failed:
        failed = failing(top)
        if not failed:
            return 1.0, ""
        high = top
    while not low:
        tried = high * stride
        stride = max(stride**longer, STRIDE)
        if tried < least:
            return None, failed
        found = failing(tried)
        if found:
            high, failed = tried, found
        else:
            low = tried
    while high / low - 1.0 > accuracy:
        middle = math.sqrt(high * low)
        found = failing(middle)
        if found:
            high, failed = middle, found
        else:
            low = middle
    return low, failed


def _upwards(failing: Callable[[float], str], near: float, top: float, accuracy: float) -> tuple[float, float, str]:
    """Go up from a share in steps that grow until one fails.

    Returns
    -------
    (low, high, failed)
        The highest share that passes, 0 where the first fails; the share that fails, and what fails there, empty where all pass.
    """
    low, high, step = 0.0, near, BESIDE * accuracy
    while high < top:
        failed = failing(high)
        if failed:
            return low, high, failed
        low, high, step = high, high * (1.0 + step), GROWTH * step
    return low, top, ""


def placed_as(job: Job, task: Task) -> Job:
    """Give a job the machine of a task, whose sync zone is placed."""
    return replace(job, machine=task.machine)
