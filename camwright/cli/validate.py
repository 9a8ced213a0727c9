"""The command ``camwright validate``."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from camwright.answers.validate import validate_answer
from camwright.cli.options import Json, JudgedBy, Quiet
from camwright.cli.views.checks import checks_view
from camwright.cli.views.lead import lead_view
from camwright.cli.views.parts import new_text, stacked
from camwright.house.output import Voice
from camwright.jobs.job import Job, load_job
from camwright.stored.judge import validate_file
from camwright.validation.report import ValidationReport

if TYPE_CHECKING:
    from rich.console import RenderableType


def run(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="A design.json, or a table with x and y as CSV.")],
    job: JudgedBy,
    as_json: Json = False,
    quiet: Quiet = False,
) -> int:
    """Judge a cam, camwright's or anyone's, by a job's machine, limits and servo."""
    asked = load_job(job)
    voice = Voice(as_json, quiet)
    with voice.progress(1) as step:
        step("checking")
        report, notes = validate_file(file, asked)

    voice.answer(lambda: validate_answer(asked, file, report, notes), lambda: _view(asked, file, report, notes))
    return 0 if report.passed else 1


def _view(job: Job, file: Path, report: ValidationReport, notes: Sequence[str]) -> RenderableType:
    """Show the checks on a file and the verdict."""
    failed = [check.name for check in report.checks if not check.passed]
    verdict = f"{len(failed)} checks failed: {', '.join(failed)}" if failed else "every check passed"
    told = [new_text(f"Note: {note}") for note in notes]
    return stacked(
        checks_view(report.checks, job.units),
        lead_view(job, report.length_errors),
        *told,
        new_text(f"{file}: {verdict}"),
    )
