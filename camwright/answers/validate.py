"""The object that ``camwright validate --json`` prints."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from camwright.answers.axis import (
    lead_answer,
)
from camwright.answers.measures import checks_answer, report_answer
from camwright.answers.speed_band import band_answer
from camwright.stored.judge import Judged
from camwright.studies.speed_band import SpeedBand


def validate_answer(judged: Judged, band: SpeedBand, file: Path) -> dict[str, Any]:
    """Answer of ``camwright validate``."""
    job, report = judged.job, judged.report
    return {
        "job": job.name,
        "file": str(file),
        "notes": list(judged.notes),
        "profile": report_answer(report, job.machine.slave_unit),
        "checks": checks_answer(report.checks),
        "passed": report.passed,
        **band_answer(band),
        **lead_answer(job, report.length_errors),
    }
