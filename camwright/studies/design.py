"""`Design`: everything that a job leads to; making it, and judging profiles of anyone's."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

from camwright.design.optimise import Solution
from camwright.design.returns.ipopt import SolveStatus
from camwright.house.progress import Step, ignore
from camwright.house.threads import one_thread
from camwright.jobs.job import Job
from camwright.profiles.objective import OBJECTIVES
from camwright.profiles.polynomial.profile import CamProfile
from camwright.studies.axis_study import AxisStudy, Robustness, axis_study, robustness
from camwright.studies.comparison import Comparison, compare
from camwright.studies.cut_lengths import CutLengths, cut_lengths
from camwright.studies.remedies import solve_or_advise
from camwright.studies.speed_band import SpeedBand, failed_checks, job_band
from camwright.validation.bounds.bound import Bound
from camwright.validation.bounds.optimality import lower_bound
from camwright.validation.report import ValidationReport, judge

PROVED = 1e-3
"""An objective within this share of its bound is proved to be optimal."""

STEPS = 4
"""Steps that `optimise` tells."""


@dataclass(frozen=True, eq=False)
class Design:
    """An optimal cam, proved, and what it is compared with.

    Parameters
    ----------
    job
        What was asked for, its machine with everything that the design chose.
    solution
        The optimal cycle, its objective, and how the solver ended.
    bound
        What the objective cannot go below, found on an independent road.
    report
        The checks on the optimal cycle.
    axis
        What a servo-aware design promises of the axis; ``None`` for a servo-blind one.
    robust
        The sync error over the ranges of the servo's parameters; ``None`` if the job gives none.
    band
        Line speeds at which the cam passes every check.

    Examples
    --------
    >>> from camwright import Design, load_job, optimise
    >>> result = optimise(load_job())
    >>> isinstance(result, Design), result.passed, result.gap < 1e-8
    (True, True, True)
    """

    job: Job
    solution: Solution
    bound: Bound
    report: ValidationReport
    axis: AxisStudy | None
    robust: Robustness | None
    band: SpeedBand

    @property
    def profile(self) -> CamProfile:
        """The optimal cycle over the master period ``[0, x_c]``."""
        return self.solution.profile

    @cached_property
    def comparison(self) -> Comparison:
        """The optimal cycle beside the baselines, measured when it is asked for: the proof needs none of it."""
        return compare(self.job, self.profile)

    @cached_property
    def lengths(self) -> CutLengths | None:
        """How short the machine can cut, when it is asked for; ``None`` for machines that the published equations are not about."""
        return cut_lengths(self.job)

    @property
    def objective(self) -> float:
        """The objective at the job's line speed: m/s² or m/s³ (rad for m with a crank), N·m or J at the motor, m of sync error."""
        if OBJECTIVES[self.job.objective].of != "motor":
            return self.solution.minimised
        value: float | None = getattr(self.report.motor, self.job.objective)
        return math.inf if value is None else value

    @property
    def gap(self) -> float | None:
        """How far the objective lies above its lower bound, as a part of the objective; ``None`` without a bound."""
        if math.isnan(self.bound.value):
            return None
        return (self.objective - self.bound.value) / self.objective if self.objective > 0.0 else 0.0

    @property
    def failed(self) -> list[str]:
        """Names of the checks that failed at the job's line speed, the ranges of its servo among them."""
        return failed_checks(self.report, self.band, self.job.cut.line_speed)

    @property
    def passed(self) -> bool:
        """Whether every check passed, with every servo of the job's ranges."""
        return not self.failed


def optimise(job: Job, step: Step = ignore) -> Design:
    """Find the optimal cam of a job and prove it; what it is compared with is measured when that is asked for.

    Parameters
    ----------
    step
        Told what begins now, for a display of progress.

    Raises
    ------
    InfeasibleError
        No motion keeps the limits of the job.
    SolverError
        The solver failed.

    Examples
    --------
    >>> from camwright import load_job
    >>> result = optimise(load_job())
    >>> result.passed, round(result.objective, 2)
    (True, 9.07)
    """
    with one_thread():
        return _optimised(job, step)


def _optimised(job: Job, step: Step) -> Design:
    """Find, prove and compare, as `optimise` says."""
    step("solving")
    solution = solve_or_advise(job)
    placed = replace(job, machine=solution.machine)
    step("bounding the objective from below")
    bound = Bound(math.nan, "none")
    if not job.cut.shaped:  # what bounds a return does not bound the whole cycle
        bound = lower_bound(solution.profile, placed.task, job.objective)
    step("checking")
    report = judge(solution.profile, placed.task, job.servo, servo_aware=job.servo_aware, slowest=job.slowest)
    aware, robust = axis_study(placed, solution), robustness(placed, solution.profile, solution)
    step("finding its line speeds")
    band = job_band(solution.profile, placed, report)
    design = Design(placed, solution, bound, report, aware, robust, band)
    # a bound is that of the place which was chosen, so it proves nothing of other places
    proved = job.machine.placed and design.gap is not None and design.gap <= PROVED
    return replace(design, solution=replace(solution, status=SolveStatus.OPTIMAL if proved else SolveStatus.BEST_FOUND))
