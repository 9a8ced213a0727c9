"""`LineRamps`: how hard the line of a cam may ramp, over its speed, and what binds."""

from __future__ import annotations

from dataclasses import dataclass

from camwright.jobs.job import Job
from camwright.profiles.errors import InfeasibleError, SolverError
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.servo import spectral_radius
from camwright.studies.axis_study import solve_job
from camwright.studies.reach import placed_as
from camwright.validation.production.line_ramp import (
    Allowed,
    LineRamp,
    by_acceleration_alone,
    line_ramp,
    ramp_curve,
)
from camwright.validation.production.ramped_servo import RampedSync, ramped_sync

LEAST_RAMP = 1e-3
"""Ramp (m/s²) below which none is told: what rounding leaves of a limit that is used up, and no line ramps so slowly."""


@dataclass(frozen=True)
class LineRamps:
    """How hard the line of a cam may ramp.

    Parameters
    ----------
    job
        The job, its sync zone placed.
    up_to
        What is allowed between standstill and the job's line speed: two numbers for the PLC, ``up_to.ramp`` both ways, and
        ``up_to.braking`` for the emergency stop.
    alone
        What the limit of acceleration alone would allow at the job's line speed.
    curve
        What is allowed at shares of the line speed, at that speed alone.
    sync
        The sync error while the line ramps as the job says; nothing where it says nothing, or the servo is unstable.
    """

    job: Job
    up_to: LineRamp
    alone: Allowed
    curve: tuple[LineRamp, ...]
    sync: RampedSync | None

    @property
    def stop_length(self) -> float | None:
        """Material that passes while the line stops from the job's speed as hard as the cam allows (m); nothing if it may hardly brake."""
        braking = self.up_to.braking.value
        return self.job.cut.line_speed**2 / (2.0 * braking) if braking >= LEAST_RAMP else None


def line_ramps(profile: CamProfile, job: Job) -> LineRamps:
    """Say how hard the line of a cam may ramp; the sync zone of the job placed.

    Examples
    --------
    >>> from camwright import load_job, optimise
    >>> job = load_job()
    >>> found = line_ramps(optimise(job).profile, job)
    >>> round(found.alone.value, 2), found.up_to.ramp.binds
    (21.15, 'jerk')
    """
    task = job.task
    sync = ramped_sync(profile, task, job.servo) if spectral_radius(job.servo) < 1.0 else None
    alone = by_acceleration_alone(profile, task)
    return LineRamps(job, line_ramp(profile, task), alone, ramp_curve(profile, task), sync)


def designed_ramps(job: Job) -> LineRamps | None:
    """Say it of the cam that a job's design is; nothing where there is none."""
    try:
        solution = solve_job(job, suggest=False)
    except (InfeasibleError, SolverError):
        return None
    return line_ramps(solution.profile, placed_as(job, job.task.with_machine(solution.machine)))
