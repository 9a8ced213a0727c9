"""The object that ``camwright validate --json`` prints."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from camwright.answers.axis import (
    lead_answer,
)
from camwright.answers.measures import checks_answer, measures_answer
from camwright.jobs.job import Job
from camwright.validation.report import ValidationReport


def validate_answer(job: Job, file: Path, report: ValidationReport, notes: Sequence[str] = ()) -> dict[str, Any]:
    """Answer of ``camwright validate``."""
    return {
        "job": job.name,
        "file": str(file),
        "notes": list(notes),
        "profile": measures_answer(report.motion, report.tool, report.motor, report.servo, job.machine.slave_unit),
        "checks": checks_answer(report.checks),
        "passed": report.passed,
        **lead_answer(job, report.length_errors),
    }
