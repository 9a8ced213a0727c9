"""The command ``camwright validate``."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import typer

from camwright.answers.axis import (
    lead_answer,
)
from camwright.answers.line_ramps import line_ramps_answer
from camwright.answers.measures import band_answer, checks_answer, report_answer
from camwright.cli.options import Json, JudgedBy, Quiet, StoredTravel, StoredUnits
from camwright.cli.views.checks import checks_view
from camwright.cli.views.lead import lead_view
from camwright.cli.views.line_ramps import plc_words
from camwright.cli.views.parts import View, new_text, stacked
from camwright.cli.views.speed_band import band_view
from camwright.house.output import Voice
from camwright.jobs.job import Job, load_job
from camwright.stored.judge import Judged, validate_file
from camwright.studies.line_ramps import LineRamps, line_ramps
from camwright.studies.speed_band import SpeedBand, failed_checks, failed_words, job_band
from camwright.validation.report import ValidationReport


def run(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="A design.json, or a table with x and y as CSV.")],
    job: JudgedBy,
    units: StoredUnits = None,
    travel: StoredTravel = None,
    as_json: Json = False,
    quiet: Quiet = False,
) -> int:
    """Judge a cam, camwright's or anyone's, by a job's machine, limits and servo."""
    asked = load_job(job)
    voice = Voice(as_json, quiet)
    with voice.progress(3) as step:
        step("checking")
        found = validate_file(file, asked, units, travel)
        step("finding its line speeds")
        band = job_band(found.profile, found.job, found.report)
        step("finding how hard the line may ramp")
        ramps = line_ramps(found.profile, found.job)

    voice.answer(
        lambda: validate_answer(found.job, file, found.report, band, ramps, found.notes),
        lambda: _view(found, band, ramps, file),
    )
    return 1 if failed_checks(found.report, band, found.job.cut.line_speed) else 0


def _view(found: Judged, band: SpeedBand, ramps: LineRamps, file: Path) -> View:
    """Show the checks on a file, its line speeds and the verdict."""
    job, report = found.job, found.report
    verdict = failed_words(failed_checks(report, band, job.cut.line_speed))
    told = [new_text(f"Note: {note}") for note in found.notes]
    return stacked(
        checks_view(report.checks, job.units),
        lead_view(job, report.length_errors),
        *told,
        band_view(band, job.units),
        new_text(plc_words(ramps)),
        new_text(f"{file}: {verdict}"),
    )


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
        "passed": not failed_checks(report, band, job.cut.line_speed),
        **band_answer(band),
        **lead_answer(job, report.length_errors),
        "line_ramp": line_ramps_answer(ramps),
    }
