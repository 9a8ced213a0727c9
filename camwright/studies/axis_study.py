"""`AxisStudy`: what a servo-aware design promises of the axis, and what independent simulations say."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from camwright.design.optimise import Solution, solve
from camwright.design.optimise_axis import may_keep, solve_axis
from camwright.house.threads import one_thread
from camwright.jobs.job import Job
from camwright.jobs.servos import between_of, servos_of
from camwright.jobs.wording import in_job_words
from camwright.profiles.errors import InfeasibleError, InputError, SolverError
from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.profiles.servo import Servo
from camwright.profiles.servo_tolerance import ServoTolerance
from camwright.profiles.task import Task
from camwright.validation.servo.line_speeds import line_speed_errors, worst_line_speed_error
from camwright.validation.servo.monte_carlo import worst_shear_zone_error
from camwright.validation.servo.response import shear_zone_error
from camwright.validation.servo.simulation import simulate

DRAWS = 10_000
"""Servos drawn from the ranges of a job's ``[servo.tolerance]``."""

SEED = 20160
"""Seed of the draws: the same job, the same servos."""

_LOOKED = 42
"""Line speeds that a design looks at first, over a band from standstill to the job's; half as far apart where that matters."""

_BAND_DRAWS, _BAND_POINTS = 200, 81
"""Servos drawn for a `RobustBand`, and its places."""


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
        Greatest sync error over the draws (m), each at a line speed of its own where the job has a band of them.
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
        Greatest sync error of the nominal servo in the shear zone that the design's linear rows predict (m), over the line speeds that it
        looked at.
    simulated_error
        The same by the validation's own simulation (m), at the same line speeds.
    phases
        Sampling phases for which both hold.
    axis_limits
        Whether the axis, too, keeps the limits of speed, acceleration and reversal.
    line_speeds
        Least and greatest line speed (m/s).
    used
        Line speeds that carry the design (m/s), ascending.
    """

    mode: str
    designed_error: float
    simulated_error: float
    phases: int
    axis_limits: bool
    line_speeds: tuple[float, float]
    used: tuple[float, ...]


def shares_of(slowest: float) -> tuple[float, ...]:
    """Line speeds that a servo-aware design looks at first, as shares of the job's, from the full one down."""
    return (
        (1.0,)
        if slowest == 1.0
        else tuple(np.linspace(1.0, slowest, 3 + math.ceil(_LOOKED * (1.0 - slowest))).tolist())
    )


def solve_job(job: Job, *, suggest: bool = True, proved: bool = True) -> Solution:
    """Design the cycle of a job, servo-aware if it says so.

    Parameters
    ----------
    suggest
        As in `camwright.design.optimise.solve`.
    proved
        As in `camwright.design.optimise_axis.solve_axis`.

    Raises
    ------
    InfeasibleError
        No motion keeps the limits, or none brings the axis into the tolerance.
    SolverError
        The solver failed.
    """
    with in_job_words(job.units), one_thread():
        if job.servo_aware:
            servos, between, shares = servos_of(job), between_of(job), shares_of(job.slowest)
            return solve_axis(
                job.task, job.objective, job.command, servos, between, shares, suggest=suggest, proved=proved
            )
        if job.objective == "sync_error":
            raise InputError(
                '[objective] minimise = "sync_error": for servo-aware designs only; add servo_aware = true or minimise '
                'e.g. "peak_acceleration"'
            )
        return solve(job.task, job.objective, suggest=suggest)


def beyond_reach(job: Job) -> bool:
    """Whether it is proved that no design of a job keeps its tolerance and the limits of the axis; quicker than to design it."""
    if not job.servo_aware or job.command != "shaped" or not job.machine.placed or job.limits.motor is not None:
        return False
    with one_thread():
        return not may_keep(job.task, servos_of(job), shares_of(job.slowest))


def cam_for_one_speed(job: Job) -> tuple[CamProfile, Task] | None:
    """Design a job of several line speeds for its own alone, to be shown beside; ``None`` for other jobs, and where that cannot be."""
    if not job.servo_aware or job.slowest == 1.0:
        return None
    try:
        solution = solve_job(replace(job, slowest=1.0), suggest=False)
    except (InfeasibleError, SolverError):
        return None
    return solution.profile, job.task.with_machine(solution.machine)


def greatest_sync_error(profile: CamProfile, job: Job) -> float | None:
    """Greatest sync error of the axis in the shear zone (m) with a job's servo and at the corners of its ranges; ``None`` without bound.

    A servo-aware job's line speeds count too.
    """
    speeds = np.array(shares_of(job.slowest)) * job.cut.line_speed
    worst = worst_line_speed_error(profile, job.task, servos_of(job), speeds)
    return worst if math.isfinite(worst) else None


def axis_study(job: Job, solution: Solution) -> AxisStudy | None:
    """Compare what a servo-aware design predicts with an independent simulation; ``None`` for other designs."""
    if solution.axis is None:
        return None
    axis, v = solution.axis, job.cut.line_speed
    speeds = np.array(list(axis.by_speed)) * v
    task = job.task.with_machine(solution.machine)
    simulated = float(line_speed_errors(solution.profile, task, [job.servo], speeds, axis.phases).max())
    used = tuple(sorted(share * v for share in axis.shares))
    return AxisStudy(job.command, axis.errors[0], simulated, axis.phases, axis.axis_limits, job.line_speeds, used)


def robustness(job: Job, profile: CamProfile, solution: Solution | None = None) -> Robustness | None:
    """Draw servos from the ranges of a job and take the worst sync error; ``None`` if the job gives no ranges."""
    ranges = job.servo_tolerance
    if ranges is None or not ranges.varying:
        return None
    worst = worst_shear_zone_error(profile, job.task, _drawn(ranges, job.servo, job.slowest))
    designed = solution.axis.error if solution is not None and solution.axis is not None else None
    return Robustness(len(ranges.vertices(job.servo)), designed, worst, DRAWS)


@lru_cache(maxsize=2)  # all cams of a book are for the same servos
def _drawn(ranges: ServoTolerance, servo: Servo, slowest: float) -> tuple[Servo, ...]:
    """Draw the servos of `Robustness`, each at a line speed of its own where there is a band of them."""
    drawn = ranges.draw(servo, DRAWS, SEED)
    if slowest == 1.0:
        return drawn
    shares = np.random.default_rng(SEED).uniform(slowest, 1.0, DRAWS).tolist()
    return tuple(each.at_speed(share) for each, share in zip(drawn, shares, strict=True))


@dataclass(frozen=True, eq=False)
class RobustBand:
    """Sync error over the ranges of a servo, by place in the shear zone.

    Parameters
    ----------
    master
        Master from the start of the sync zone (m).
    low, high
        Least and greatest sync error at every sampling phase of every servo (m).
    nominal
        Sync error of the job's own servo, mean over its phases (m).
    servos
        Servos drawn at random, beside those at the corners.
    """

    master: FloatArray
    low: FloatArray
    high: FloatArray
    nominal: FloatArray
    servos: int


def robust_band(job: Job, profile: CamProfile) -> RobustBand | None:
    """Simulate servos drawn from a job's ranges and those at the corners; ``None`` if the job gives no ranges."""
    ranges, cut = job.servo_tolerance, job.cut
    if ranges is None or not ranges.varying:
        return None
    start = cut.return_start + cut.return_zone
    master = cut.shear_zone_at + np.linspace(0.0, cut.shear_zone, _BAND_POINTS)
    low, high = np.full(_BAND_POINTS, np.inf), np.full(_BAND_POINTS, -np.inf)

    def errors(servo: Servo) -> FloatArray:
        place, error, _ = shear_zone_error(simulate(profile, cut, servo), profile, job.task.with_cut(cut))
        return np.array([np.interp(master, x - start, y) for x, y in zip(place, error, strict=True)])

    for servo in (*ranges.vertices(job.servo), *ranges.draw(job.servo, _BAND_DRAWS, SEED)):
        found = errors(servo)
        low, high = np.minimum(low, found.min(axis=0)), np.maximum(high, found.max(axis=0))
    return RobustBand(master, low, high, errors(job.servo).mean(axis=0), _BAND_DRAWS)
