"""Judging a cycle, or a file that holds one, by a job."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

from camwright.jobs.job import Job
from camwright.jobs.wording import in_job_words
from camwright.profiles.polynomial.profile import CamProfile
from camwright.stored.profile_files import read_cycle
from camwright.validation.report import ValidationReport, judge


@dataclass(frozen=True, eq=False)
class Judged:
    """A cycle that was judged.

    Parameters
    ----------
    job
        The job that it was judged by, its sync zone where the cycle has it.
    report
        What was found.
    notes
        What had to be assumed to read it, a sentence each.
    """

    profile: CamProfile
    job: Job
    report: ValidationReport
    notes: tuple[str, ...]


def validate(profile: CamProfile | str | Path, job: Job) -> ValidationReport:
    """Judge one cycle by a job's machine, limits and servo.

    Parameters
    ----------
    profile
        The cycle, or a file that holds one: a ``design.json`` or a ``cam.csv``, camwright's or anyone's.

    Raises
    ------
    InputError
        The file cannot be read, or the profile is not one cycle of the job.

    Examples
    --------
    >>> from camwright import load_job
    >>> from camwright.profiles.returns import baseline
    >>> job = load_job()
    >>> report = validate(baseline("poly_3_4_5", job.task), job)
    >>> report.motion.sync_ratio_error
    0.0
    """
    with in_job_words(job.units):
        if isinstance(profile, CamProfile):
            return judge(profile, job.task, job.servo, servo_aware=job.servo_aware, slowest=job.slowest)
    return validate_file(Path(profile), job).report


def validate_file(path: Path, job: Job, units: str | None = None, travel: str | None = None) -> Judged:
    """Judge the cycle of a file like `validate`, and keep what was judged; `units` and `travel` as of `read_cycle`."""
    with in_job_words(job.units):
        cycle, machine, notes = read_cycle(path, job, units, travel)
        placed = replace(job, machine=machine)
        return Judged(
            cycle, placed, judge(cycle, placed.task, job.servo, servo_aware=job.servo_aware, slowest=job.slowest), notes
        )
