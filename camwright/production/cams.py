"""The cams that a cut list needs: one for each gap, at the highest line speed that it can do and that the job asks for."""

from __future__ import annotations

from dataclasses import dataclass, replace

from camwright.design.feasible.extremes import max_line_speed, placed_fastest
from camwright.design.line.refusal import can_ramp
from camwright.design.optimise import Solution
from camwright.design.production.drawn_in import solve_drawn_in, surely_bears
from camwright.design.production.transition import RunningCam
from camwright.jobs.job import Job
from camwright.jobs.wording import in_job_words
from camwright.profiles.cut import Cut
from camwright.profiles.errors import InfeasibleError
from camwright.profiles.line import STEADY, Line
from camwright.profiles.objective import of_command
from camwright.studies.axis_study import solve_job
from camwright.validation.report import ValidationReport, judge

_SLOWEST, _HALVINGS = 0.05, 10
"""Share of a line speed from which one that bears the line's ramps is looked for, and how closely."""

_INSIDE = 1e-9
"""Share by which a cam's line speed stays below what the perfect axis can do at most: rounding."""

_STRIDE, _STRIDES = 0.85, 8
"""Where the axis, too, must be in sync, the line is slowed down in such steps until a cam is found."""


@dataclass(frozen=True, eq=False)
class ListCam:
    """A cam of a cut list.

    Parameters
    ----------
    number
        Its number, from 1, in the order in which they are first needed.
    job
        The list's job for this gap: its cut length and line speed, its sync zone placed, the origin at the end of the zone.
    perfect
        Highest line speed of a perfect axis on a line that keeps its speed (m/s).
    solution
        The optimal cycle.
    report
        The checks on it.
    """

    number: int
    job: Job
    perfect: float
    solution: Solution
    report: ValidationReport

    @property
    def length(self) -> float:
        """Gap that it is for (m)."""
        return self.job.cut.length

    @property
    def line_speed(self) -> float:
        """Highest line speed at which it may run (m/s)."""
        return self.job.cut.line_speed

    @property
    def bears_ramps(self) -> bool:
        """Whether it was designed to bear the line's ramps up to its line speed."""
        return self.job.line.ramps

    @property
    def running(self) -> RunningCam:
        """The cam as it runs."""
        return RunningCam(self.job.task, self.solution.profile)


def list_job(job: Job) -> Job:
    """Give a job as a list takes it: zones that last a time are as long on the material as at the job's line speed, for all cams alike."""
    return replace(job, cut=replace(job.cut, sync_time=None, shear_time=None)) if job.cut.timed else job


def highest_for_gap(job: Job, length: float) -> float:
    """Highest line speed of a perfect axis for a gap, on a line that keeps its speed (m/s); 0 where none works."""
    task = job.task.from_return().with_length(length).with_line(STEADY)
    return (max_line_speed(placed_fastest(task)) or 0.0) * (1.0 - _INSIDE)


def ramping_speed(job: Job, length: float, top: float) -> float:
    """Highest line speed up to a given one at which a cam for a gap bears the line's ramps (m/s); 0 where none was found.

    Of a servo-aware job only its design tells: the given speed.
    """
    if job.servo_aware or not job.line.ramps:
        return top
    task = placed_fastest(job.task.from_return().with_length(length).at_speed(top).with_line(STEADY)).with_line(
        job.line
    )

    def bears(line_speed: float) -> bool:
        there = task.at_speed(line_speed)
        return surely_bears(there) or can_ramp(there)

    if bears(top):
        return top
    low = _SLOWEST * top
    if not bears(low):
        return 0.0
    high = top
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if bears(middle) else (low, middle)
    return low


def list_cam(number: int, job: Job, length: float, perfect: float, top: float, line: Line) -> ListCam:
    """Design the cam of a gap.

    Parameters
    ----------
    job
        The list's job.
    length
        The gap (m).
    perfect
        What `highest_for_gap` gives for it (m/s).
    top
        Line speed that it is designed for (m/s).
    line
        Ramps of the line that it is to bear.

    Raises
    ------
    InfeasibleError
        No cam does the gap at any line speed that is looked at.
    SolverError
        The solver failed.
    """
    for stride in range(_STRIDES):
        asked = replace(
            job, name=cam_name(number, length, job), cut=_cut(job, length, top * _STRIDE**stride), line=line
        )
        asked = replace(asked, slowest=min(1.0, job.line_speeds[0] / asked.cut.line_speed))
        try:
            solution = _quick(asked) or solve_job(asked, suggest=False)
        except InfeasibleError:
            if not job.servo_aware or stride == _STRIDES - 1:
                raise
            continue
        break
    placed = replace(asked, machine=solution.machine)
    report = judge(solution.profile, placed.task, job.servo, servo_aware=job.servo_aware, slowest=placed.slowest)
    return ListCam(number, placed, perfect, solution, report)


def _quick(job: Job) -> Solution | None:
    """Design a cam that bears the line's ramps by drawn-in limits, where the job allows that; ``None`` elsewhere."""
    if job.servo_aware or not job.line.ramps or job.limits.motor is not None or job.objective == "sync_error":
        return None
    with in_job_words(job.units):
        return solve_drawn_in(job.task, of_command(job.objective))


def _cut(job: Job, length: float, line_speed: float) -> Cut:
    """Make the cut of a gap, its origin at the end of the sync zone."""
    return replace(job.cut, length=length, line_speed=line_speed, origin="return")


def cam_name(number: int, length: float, job: Job) -> str:
    """Name a cam so that no two cams in a controller are called alike."""
    return f"K{number:03d} L{length * 1e3:.6g} {job.name}"[:60].rstrip(" .")
