"""`AxisStudy`: what a servo-aware design promises of the axis, and what independent simulations say."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from camwright.job import Job
from profiles.servo import Servo

if TYPE_CHECKING:
    from design.optimise import Solution
    from profiles.polynomial import CamProfile

DRAWS = 10_000
"""Servos drawn from the ranges of a job's ``[servo.tolerance]``."""

SEED = 20160
"""Seed of the draws: the same job, the same servos."""


@dataclass(frozen=True)
class Robustness:
    """What a cam does when the servo is not quite the one assumed.

    Parameters
    ----------
    vertices
        Servos at the corners of the ranges, for which the tolerance was asked for.
    designed_worst
        Greatest sync error over the corners and the nominal servo that the design predicts (m); ``None`` where it did not look.
    worst
        Greatest sync error over the draws (m).
    draws
        Number of servos drawn uniformly from the ranges.
    """

    vertices: int
    designed_worst: float | None
    worst: float
    draws: int


@dataclass(frozen=True)
class AxisStudy:
    """The axis of a servo-aware design.

    Parameters
    ----------
    mode
        ``"in_sync"`` or ``"shaped"``.
    designed_error
        Sync error of the nominal servo in the shear zone that the design's linear rows predict (m).
    simulated_error
        The same by the validation's own simulation (m).
    phases
        Sampling phases for which both hold.
    axis_limits
        Whether the axis, too, keeps the limits of speed, acceleration and reversal.
    """

    mode: str
    designed_error: float
    simulated_error: float
    phases: int
    axis_limits: bool


def servos_of(job: Job) -> tuple[Servo, ...]:
    """Servos with which a servo-aware design must keep the tolerance: the nominal one, then the corners of its ranges."""
    if job.servo_tolerance is None or not job.servo_tolerance.varying:
        return (job.servo,)
    return (job.servo, *job.servo_tolerance.vertices(job.servo))


def solve_job(job: Job, *, suggest: bool = True) -> Solution:
    """Design the cycle of a job, servo-aware if it says so.

    Parameters
    ----------
    job
        The job.
    suggest
        As in `design.optimise.solve`.

    Raises
    ------
    InfeasibleError
        No motion keeps the limits, or none brings the axis into the tolerance.
    SolverError
        The solver failed.
    """
    if job.servo_aware:
        from design.axis_design import solve_axis

        objective = "sync_error" if job.minimise_sync_error else job.objective
        return solve_axis(job.machine, job.cut, job.limits, objective, job.command, servos_of(job))
    from design.optimise import solve

    return solve(job.machine, job.cut, job.limits, job.objective, suggest=suggest)


def axis_study(job: Job, solution: Solution) -> AxisStudy | None:
    """Compare what a servo-aware design predicts with an independent simulation; ``None`` for other designs."""
    from validation.response import servo_response

    if solution.axis is None:
        return None
    response = servo_response(solution.profile, solution.machine, job.cut, job.servo)
    axis = solution.axis
    return AxisStudy(job.command, axis.errors[0], response.shear_zone_error, response.phases, axis.axis_limits)


def robustness(job: Job, profile: CamProfile, solution: Solution | None = None) -> Robustness | None:
    """Draw servos from the ranges of a job and take the worst sync error; ``None`` if the job gives no ranges."""
    from validation.monte_carlo import shear_zone_errors

    ranges = job.servo_tolerance
    if ranges is None or not ranges.varying:
        return None
    drawn = ranges.draw(job.servo, DRAWS, SEED)
    worst = float(shear_zone_errors(profile, job.machine, job.cut, drawn).max())
    designed = solution.axis.error if solution is not None and solution.axis is not None else None
    return Robustness(len(ranges.vertices(job.servo)), designed, worst, DRAWS)
