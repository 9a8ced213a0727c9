"""The object that ``camwright validate --json`` prints."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from camwright.answers.axis import (
    lead_answer,
)
from camwright.answers.line_ramps import line_ramps_answer
from camwright.answers.measures import checks_answer, report_answer
from camwright.answers.speed_band import band_answer
from camwright.jobs.job import Job
from camwright.studies.line_ramps import LineRamps
from camwright.studies.speed_band import SpeedBand
from camwright.validation.report import ValidationReport


def validate_answer(
    job: Job, file: Path, report: ValidationReport, band: SpeedBand, ramps: LineRamps, notes: Sequence[str]
) -> dict[str, Any]:
    """Answer of ``camwright validate``."""
    return {
        "job": job.name,
        "file": str(file),
        "notes": list(notes),
        "profile": report_answer(report, job.machine.slave_unit),
        "checks": checks_answer(report.checks),
        "passed": report.passed,
        **band_answer(band),
        **lead_answer(job, report.length_errors),
        "line_ramp": line_ramps_answer(ramps),
    }
