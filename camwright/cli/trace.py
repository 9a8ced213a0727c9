"""The command ``camwright trace``."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer

from camwright.answers.trace import trace_answer
from camwright.cli.destination import destination
from camwright.cli.options import Json, JudgedBy, NoFigures, Out, Quiet, TraceColumns, optional_quantity
from camwright.cli.views.checks import checks_view
from camwright.cli.views.parts import View, files_view, new_table, new_text, stacked
from camwright.figures.trace import trace_figure
from camwright.house.files import read_bytes
from camwright.house.numbers import Units, number, shown, unit_shown
from camwright.house.output import Voice
from camwright.jobs.job import Job, load_job
from camwright.jobs.wording import in_job_words
from camwright.profiles.errors import InputError
from camwright.profiles.polynomial.profile import CamProfile
from camwright.stored.profile_files import read_cycle
from camwright.studies.design import optimise
from camwright.studies.recording import MOST_BYTES, RecordedRun, recorded_run

_MOST_SHOWN = 12
"""Cuts that are listed; of more, the first and the last."""


def run(
    file: Annotated[
        Path,
        typer.Argument(
            metavar="FILE",
            help="Recording: CSV with time, command and actual, and master if it was recorded, with units.",
        ),
    ],
    job: JudgedBy,
    design: Annotated[
        Path | None,
        typer.Option(
            "--design", metavar="FILE", help="The cam that ran, design.json or a table; designed anew if left out."
        ),
    ] = None,
    line_speed: Annotated[
        str | None,
        typer.Option(
            "--line-speed", metavar="V", help="Line speed of a recording without master; found if left out: 40 m/min."
        ),
    ] = None,
    gear: Annotated[
        float | None,
        typer.Option(
            "--gear", metavar="N", help="Recorded turns or travel over the slave's, where another shaft was recorded."
        ),
    ] = None,
    columns: TraceColumns = None,
    out: Out = None,
    no_figures: NoFigures = False,
    as_json: Json = False,
    quiet: Quiet = False,
) -> int:
    """Lay a recorded run over its design: sync error of each cut, lengths, and whether it is offset, drift or scatter."""
    asked = load_job(job)
    speed = optional_quantity("--line-speed", line_speed, "speed", example="40 m/min")
    if gear is not None and not (abs(gear) > 1e-6 and abs(gear) < 1e6):
        raise InputError(
            f"--gear {gear:g}: it is recorded travel over the slave's, from 0.000001 to 1000000; below 0 where it is reversed"
        )
    voice = Voice(as_json, quiet)
    files: list[Path] = []
    with voice.progress(3) as step:
        step("finding the design")
        placed, profile = _cam(asked, design)
        step("laying the recording over it")
        with in_job_words(placed.units):
            found = recorded_run(
                read_bytes(file, "recording", MOST_BYTES), str(file), placed, profile, speed, gear, columns
            )
        if not no_figures:
            step("drawing")
            files = destination("trace", asked, job, out).draw({"trace": trace_figure(found)})
    voice.answer(lambda: trace_answer(found, file, files), lambda: _view(found, file, files))
    return 0 if found.passed else 1


def _cam(job: Job, design: Path | None) -> tuple[Job, CamProfile]:
    """Take the cam from its file, or design it; with it the job, the place of its sync zone chosen."""
    if design is None:
        made = optimise(job)
        return made.job, made.profile
    with in_job_words(job.units):
        profile, machine, _ = read_cycle(design, job)
    return replace(job, machine=machine), profile


def _view(found: RecordedRun, path: Path, files: list[Path]) -> View:
    """Show the cuts, the kinds of error, what they point to, and the verdict."""
    units = found.job.units
    causes = [new_text(f"- {cause}") for cause in found.causes] or [new_text("- no error worth a word")]
    notes = [new_text(f"Note: {note}") for note in found.notes]
    within = "within" if found.passed else "NOT within"
    verdict = f"{path}: {len(found.cuts)} cuts, {within} the sync tolerance"
    if found.kind:
        verdict += f"; mostly {found.kind}"
    return stacked(
        _cuts(found, units),
        _kinds(found, units),
        *causes,
        *notes,
        checks_view(found.checks, units),
        *([files_view(files)] if files else []),
        new_text(verdict),
    )


def _cuts(found: RecordedRun, units: Units) -> View:
    """List the cuts."""
    length, factor = unit_shown("m", units), units.shown["m"].factor
    heads = (
        "cut",
        f"line speed\n{unit_shown('m/s', units)}",
        f"sync error\n{length}",
        f"greatest\n{length}",
        f"command\n{length}",
        f"axis\n{length}",
        f"length\n{length}",
    )
    table = new_table("Cuts; a tool ahead of the material is positive", heads)
    half = _MOST_SHOWN // 2
    some = found.cuts if len(found.cuts) <= _MOST_SHOWN else (*found.cuts[:half], *found.cuts[-half:])
    for cut in some:
        if cut.number == len(found.cuts) - half + 1 and len(found.cuts) > _MOST_SHOWN:
            table.add_row("…", *[""] * 6)
        errors = (f"{off * factor:z.4f}".replace("-", "−") for off in (cut.error, cut.greatest, cut.command, cut.axis))
        table.add_row(
            str(cut.number),
            shown(cut.line_speed, "m/s", 4, units),
            *errors,
            "–" if cut.length is None else f"{cut.length * factor:.4f}",
        )
    return table


def _kinds(found: RecordedRun, units: Units) -> View:
    """Show offset, drift and scatter of all, of the command and of the axis, beside what the job's servo would do."""
    length, factor = unit_shown("m", units), units.shown["m"].factor
    heads = ("", "offset", "drift a cut", "95 %", "scatter (σ)", "range")
    table = new_table(f"Errors told apart ({length})", heads, heads[:1])

    def value(each: float | None) -> str:
        return number(None if each is None else each * factor, 4)

    for name, errors in (("tool", found.total), ("its command", found.command), ("axis less command", found.axis)):
        bounds = errors.drift_interval
        between = "–" if bounds is None else f"{value(bounds[0])} to {value(bounds[1])}"
        table.add_row(
            name, value(errors.offset), value(errors.drift), between, value(errors.scatter), value(errors.range)
        )
    if found.expected is not None:
        table.add_row("simulated servo", value(-found.expected.offset), "0", "", "", value(found.expected.variation))
    return table
