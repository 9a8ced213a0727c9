"""`Design`: everything that a job leads to; making it, and judging profiles of anyone's."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from camwright.comparison import Comparison, compare
from camwright.cut_lengths import CutLengths, cut_lengths
from camwright.job import Job
from camwright.profile_files import read_profile
from camwright.progress import Step, ignore
from profiles.polynomial import CamProfile

if TYPE_CHECKING:
    from design.optimise import Solution
    from validation.optimality import Bound
    from validation.report import ValidationReport

STEPS = 4
"""Steps that `design` tells beside the measuring of each profile."""


@dataclass(frozen=True, eq=False)
class Design:
    """An optimal cam, proved and compared.

    Parameters
    ----------
    job
        What was asked for.
    solution
        The optimal cycle, its objective, and how the solver ended.
    bound
        What the objective cannot go below, found on an independent road.
    report
        The checks on the optimal cycle.
    comparison
        The optimal cycle beside the baselines.
    lengths
        How short the machine can cut.
    """

    job: Job
    solution: Solution
    bound: Bound
    report: ValidationReport
    comparison: Comparison
    lengths: CutLengths

    @property
    def profile(self) -> CamProfile:
        """The optimal cycle over the master period ``[0, x_c]``."""
        return self.solution.profile

    @property
    def gap(self) -> float:
        """How far the objective lies above its lower bound, as a part of the objective."""
        value = self.solution.objective
        return (value - self.bound.value) / value if value > 0.0 else 0.0

    @property
    def passed(self) -> bool:
        """Whether every check passed."""
        return self.report.passed


def design(job: Job, step: Step = ignore) -> Design:
    """Find the optimal cam of a job, prove it, and compare it with the baselines.

    Parameters
    ----------
    job
        The job.
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
    >>> result = design(load_job())
    >>> result.passed, round(result.solution.objective, 2)
    (True, 9.07)
    """
    from design.optimise import solve
    from validation.optimality import lower_bound
    from validation.report import validate as judge

    step("solving")
    solution = solve(job.machine, job.cut, job.limits, job.objective)
    step("bounding the objective from below")
    bound = lower_bound(solution.profile, job.machine, job.cut, job.limits, job.objective)
    step("checking")
    report = judge(solution.profile, job.machine, job.cut, job.limits, job.servo)
    comparison = compare(job, solution.profile, step=step)
    step("finding minimum cut lengths")
    return Design(job, solution, bound, report, comparison, cut_lengths(job))


def validate(profile: CamProfile | str | Path, job: Job) -> ValidationReport:
    """Judge one cycle by a job's machine, limits and servo.

    Parameters
    ----------
    profile
        The cycle, or a file that holds one: a ``design.json`` or a ``cam.csv``, camwright's or anyone's.
    job
        The job to judge it by.

    Raises
    ------
    InputError
        The file cannot be read, or the profile is not one cycle of the job.

    Examples
    --------
    >>> from camwright import load_job
    >>> from profiles.returns import baseline
    >>> job = load_job()
    >>> report = validate(baseline("poly_3_4_5", job.machine, job.cut), job)
    >>> report.motion.sync_ratio_error
    0.0
    """
    from validation.report import validate as judge

    cycle = profile if isinstance(profile, CamProfile) else read_profile(Path(profile), job)
    return judge(cycle, job.machine, job.cut, job.limits, job.servo)
