"""`Comparison`: the optimised profile beside the baselines, all measured alike."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from camwright.house.progress import Step, ignore
from camwright.jobs.job import Job
from camwright.profiles.cross_cutter import QUINTIC_RATIO, quintic_return
from camwright.profiles.errors import InputError
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.returns import (
    BASELINES,
    assemble,
    baseline,
    baseline_names,
)
from camwright.profiles.task import Task
from camwright.studies.measured import Measured, measured
from camwright.studies.remedies import solve_or_advise
from camwright.studies.screw import ScrewCarriage

QUINTIC = "quintic"
"""The return of S2; where the polynomial 3-4-5 would run backwards it decelerates, perhaps stands, and accelerates."""

_LEAST_MEAN_RATIO = 1e-9
# Below this mean ratio of the return S2's curve would stand still but for rounding.


@dataclass(frozen=True, eq=False)
class Comparison:
    """Profiles of one job, measured alike.

    Parameters
    ----------
    job
        The job, its machine with everything that the design chose.
    rows
        The profiles, sorted by the job's objective, those that break a limit of the job below those that keep all.
    screw
        The same cut by a carriage on a screw, another machine beside the rows; where it was asked for.
    """

    job: Job
    rows: tuple[Measured, ...]
    screw: ScrewCarriage | None = None

    def __getitem__(self, name: str) -> Measured:
        """Return the profile of that name."""
        return next(row for row in self.rows if row.name == name)


def law_names(task: Task) -> tuple[str, ...]:
    """Names of all baselines of a machine: those of `camwright.profiles.returns`, and the return of S2 where it is another one.

    Examples
    --------
    >>> from camwright import load_job
    >>> job = load_job()
    >>> "quintic" in law_names(job.task), "cycloid" in law_names(job.task)
    (False, True)
    """
    if not task.machine.placed:
        task = task.placed_midway()  # the names are the same at every place
    cut, names = task.cut, baseline_names(task)
    if not task.straight:
        return names
    mean = (task.machine.pitch - cut.sync_ratio * cut.sync_zone) / (cut.sync_ratio * cut.return_zone)
    return (*names, QUINTIC) if _LEAST_MEAN_RATIO < mean < QUINTIC_RATIO else names


def require_laws(names: Sequence[str], task: Task) -> None:
    """Refuse names of baselines that do not exist for a machine, all at once.

    Raises
    ------
    InputError
        With one message for each.
    """
    import difflib

    known = law_names(task)
    faults = []
    for name in names:
        if name not in known:
            near = [] if name in BASELINES else difflib.get_close_matches(name[:50], known, n=1)
            advice = f"did you mean {near[0]}?" if near else f"the laws are {', '.join(known)}"
            here = " for this machine" if name in BASELINES else ""
            faults.append(f"--with {name[:50]!r}: there is no such law{here}; {advice}")
    if faults:
        raise InputError(*faults)


def compare(
    job: Job, optimised: CamProfile | None = None, names: Sequence[str] | None = None, step: Step = ignore
) -> Comparison:
    """Measure the optimised profile of a job and baselines.

    Parameters
    ----------
    job
        The job; with an optimised cycle of its own the place of its sync zone is chosen.
    optimised
        Its optimised cycle; the job is designed if it is not given.
    names
        Names of baselines, from `law_names`; all of them if not given.

    Raises
    ------
    InputError
        There is no such baseline.
    InfeasibleError
        No motion keeps the limits of the job.
    SolverError
        The solver failed.

    Examples
    --------
    >>> from camwright import compare, load_job
    >>> rows = compare(load_job(), names=["poly_3_4_5", "linear_return"]).rows
    >>> [row.name for row in rows]                     # by peak acceleration; that of the linear return is unbounded
    ['optimised', 'poly_3_4_5', 'linear_return']
    """
    if optimised is None:
        solution = solve_or_advise(job)
        job, optimised = replace(job, machine=solution.machine), solution.profile
    chosen = law_names(job.task) if names is None else names
    require_laws(chosen, job.task)
    profiles = {"optimised": optimised, **{name: law_profile(name, job.task) for name in chosen}}
    rows = []
    for name, profile in profiles.items():
        step(f"measuring {name}")
        rows.append(measured(name, profile, job))
    rows.sort(key=lambda row: _rank(row, job))
    return Comparison(job, tuple(rows))


def _rank(row: Measured, job: Job) -> tuple[bool, float, float]:
    """Rank a profile by the job's objective: what keeps the limits first; by peak acceleration where they are alike."""
    value, peak = row.value(job.objective), row.motion.peak_acceleration
    return not row.within_limits, math.inf if value is None else value, math.inf if peak is None else peak


def law_profile(name: str, task: Task) -> CamProfile:
    """Make one cycle of a baseline."""
    cut = task.cut
    if name != QUINTIC:
        return baseline(name, task)
    height = task.machine.pitch / cut.sync_ratio - cut.sync_zone  # S2 has ratio 1 in sync
    return assemble(quintic_return(cut.return_zone, height).scale(slave=cut.sync_ratio), task)
