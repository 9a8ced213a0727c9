"""The object that ``camwright check --json`` prints."""

from __future__ import annotations

from typing import Any

from camwright.jobs.doubts import doubts
from camwright.jobs.job import Job
from camwright.jobs.numbers import job_numbers


def check_answer(job: Job) -> dict[str, Any]:
    """Answer of ``camwright check``: the job in SI numbers, and what is worth a second look."""
    found = doubts(job)
    return {
        "job": job.name,
        "sha256": job.sha256,
        "si": job_numbers(job),
        "warnings": list(found.warnings),
        "missing": list(found.missing),
    }
