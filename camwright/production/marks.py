"""`Marks`: how early and how late a print mark may come, by what the controller can do, over the line speed; and the loop around it."""

from __future__ import annotations

from dataclasses import dataclass, replace

from camwright.design.feasible.feasibility import is_feasible
from camwright.design.production.marks import designed_ends, designs, redesigned
from camwright.house.progress import Step, ignore
from camwright.jobs.job import Job
from camwright.profiles.closed_forms.mark_loop import gain_without_overshoot, greatest_gain, noise_share
from camwright.profiles.mark_range import MarkRange
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.servo import spectral_radius
from camwright.profiles.task import Task
from camwright.studies.remedies import solve_or_advise
from camwright.validation.production.mark_shift import arc_range, held, offset_range, phase_range
from camwright.validation.servo.response import servo_response

STEPS = 4
"""Steps that `marks` tells."""

SHARES = tuple(k / 10 for k in range(1, 11))
"""Line speeds of the table, as shares of the job's."""

NONE = MarkRange(0.0, 0.0)
"""No correction at all."""

BEYOND = 0.01
"""Share of a correction by which it is taken further to see that it cannot be designed."""

_INSIDE = 1e-9
"""Share by which a correction at the edge is designed inside: rounding."""


@dataclass(frozen=True)
class ByMethod:
    """Corrections by what the controller does, at one line speed.

    Parameters
    ----------
    line_speed
        The line speed (m/s).
    redesign
        The next length changes, its return designed anew.
    master_phase
        The cam stays and its master is shifted over the return.
    slave_offset
        The cam stays and its slave is shifted over the return; ``None`` where that is not in sync.
    """

    line_speed: float
    redesign: MarkRange
    master_phase: MarkRange
    slave_offset: MarkRange | None

    @property
    def ranges(self) -> dict[str, MarkRange | None]:
        """The corrections by the names of what the controller does."""
        return {"redesign": self.redesign, "master_phase": self.master_phase, "slave_offset": self.slave_offset}


@dataclass(frozen=True, eq=False)
class Marks:
    """How far the marks of a job may be off.

    Parameters
    ----------
    job
        The job, its machine with everything that the design chose.
    cam
        The running cam.
    by_speed
        Corrections at shares of the line speed, the last at all of it.
    phase_alone, offset_alone
        By master phase and slave offset at the job's line speed if nothing but the acceleration were limited; a cam that uses its jerk
        limit up allows none otherwise.
    proved
        Whether cams at both ends were designed and keep the limits, and none was found `BEYOND` them.
    delay
        Cuts by which an error is known late.
    """

    job: Job
    cam: CamProfile
    by_speed: tuple[ByMethod, ...]
    phase_alone: MarkRange
    offset_alone: MarkRange | None
    proved: bool
    delay: int

    @property
    def here(self) -> ByMethod:
        """Corrections at the job's line speed."""
        return self.by_speed[-1]

    @property
    def greatest_gain(self) -> float:
        """Gain that the loop must stay below."""
        return greatest_gain(self.delay)

    @property
    def gain(self) -> float:
        """Greatest gain without overshoot."""
        return gain_without_overshoot(self.delay)

    @property
    def noise(self) -> float:
        """Variance of the cut over that of the sensor's noise, with that gain."""
        return noise_share(self.gain, self.delay)


def marks(job: Job, delay: int = 0, step: Step = ignore) -> Marks:
    """Find how early and how late a print mark may come for a cut to follow it.

    Parameters
    ----------
    delay
        Cuts between a cut and the first one that its error can correct.

    Raises
    ------
    InfeasibleError
        The cut itself cannot be done.

    Examples
    --------
    >>> from camwright import load_job
    >>> found = marks(load_job())
    >>> round(found.here.redesign.earliest * 1e3, 2), found.here.redesign.latest, found.proved      # mm
    (-263.38, None, True)
    """
    step("designing the running cam")
    solution = solve_or_advise(job)
    placed = replace(job, machine=solution.machine)
    step("finding what it bears at each line speed")
    by_speed = marks_at_speeds(solution.profile, placed)
    alone = held(placed.task, acceleration_alone=True)
    phase, offset = (find(solution.profile, placed.task, alone) for find in (phase_range, offset_range))
    assert phase is not None  # noqa: S101 - a phase of the master is in sync on every machine
    step("proving both ends")
    here = by_speed[-1]
    if not job.cut.shaped:
        here = replace(here, redesign=designed_ends(placed.task))
        by_speed = (*by_speed[:-1], here)
    proved = proven(placed.task, here.redesign)
    return Marks(placed, solution.profile, by_speed, phase, offset, proved, delay)


def marks_at_speeds(cam: CamProfile, job: Job) -> tuple[ByMethod, ...]:
    """Find what a cam bears at shares of the line speed; the job's machine is placed."""
    return tuple(at_speed(cam, job, share * job.cut.line_speed) for share in SHARES)


def next_lengths(job: Job, task: Task | None = None) -> MarkRange:
    """Find what a redesign of the return bears, of a placed machine; at the job's line speed, or that of a task of the same job.

    A shaped command may cut shorter than one in sync can: then the range of these is none.

    Raises
    ------
    InfeasibleError
        The cut itself cannot be done.
    """
    task = job.task if task is None else task
    return NONE if job.cut.shaped and not is_feasible(task) else redesigned(task)


def at_speed(cam: CamProfile, job: Job, line_speed: float) -> ByMethod:
    """Find what a cam bears at a line speed."""
    task = job.task.at_speed(line_speed)
    limits = held(task)
    offset = None if job.cut.shaped else offset_range(cam, task, limits)
    phase = NONE if job.cut.shaped else phase_range(cam, task, limits)
    return ByMethod(
        line_speed, next_lengths(job, task), phase, None if offset is None else offset.within(_arc(cam, job, task))
    )


def _arc(cam: CamProfile, job: Job, task: Task) -> MarkRange:
    """Room of the shear zone in the sync zone; none where the axis does not settle."""
    if not spectral_radius(job.servo) < 1.0:
        return NONE
    settling = servo_response(cam, task, job.servo).settling
    return NONE if settling is None else arc_range(task, settling)


def proven(task: Task, found: MarkRange) -> bool:
    """Whether cams with the corrections at both ends are designed within the limits, and none a hundredth beyond."""
    return all(
        designs(task, (1 - _INSIDE) * end) and not designs(task, (1 + BEYOND) * end)
        for end in (found.earliest, found.latest)
        if end
    )
