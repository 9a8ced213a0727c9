"""The command ``camwright audit``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from camwright.cli.destination import destination
from camwright.cli.options import Json, NoFigures, Out, Quiet, StoredTravel, StoredUnits
from camwright.cli.views.checks import checks_view
from camwright.cli.views.line_ramps import plc_words
from camwright.cli.views.parts import View, files_view, new_table, new_text, stacked
from camwright.drives.audit import MEASURES, Audit, audit, audit_answer
from camwright.figures.audit import audit_figure
from camwright.house.numbers import number
from camwright.house.output import Voice
from camwright.jobs.job import load_job
from camwright.studies.line_ramps import line_ramps


def run(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="A cam table in the layout of any target.")],
    job: Annotated[Path, typer.Option("--job", metavar="JOB", help="Job file (TOML) that the cam is run for.")],
    target: Annotated[
        str | None, typer.Option("--target", metavar="NAME", help="Layout; recognised if left out.")
    ] = None,
    units: StoredUnits = None,
    travel: StoredTravel = None,
    slopes: Annotated[
        str | None,
        typer.Option(
            "--slopes", metavar="A,B", help="Ratios at the ends that MCCP is given, for a CAM tag without them."
        ),
    ] = None,
    out: Out = None,
    no_figures: NoFigures = False,
    as_json: Json = False,
    quiet: Quiet = False,
) -> int:
    """Judge a cam that runs today as its drive runs it, and set it beside the optimum of the same job."""
    asked = load_job(job)
    voice = Voice(as_json, quiet)
    files: list[Path] = []
    with voice.progress(4) as step:
        result = audit(file, asked, target, units, travel, slopes, step)
        if not no_figures:
            step("writing files")
            files = destination("audit", asked, job, out).draw({"audit": audit_figure(result)})
    voice.answer(lambda: audit_answer(result, file, files), lambda: _view(result, file, files))
    return 0 if result.judgement.passed else 1


def _view(result: Audit, file: Path, files: list[Path]) -> View:
    """Show the cam beside the optimum of the same job, and its checks."""
    what = f"{file}: {result.target.title}, {result.table.points} points"
    table = new_table(what, ("", "this cam", "optimum", "saving"), left=("",))
    unit, units = result.job.machine.slave_unit, result.job.units
    for (measure, title), power in zip(MEASURES.items(), ("/s", "/s^2", "/s^2", "/s^3", "/s^3"), strict=True):
        (own, best), saving = result.pair(measure), result.saving(measure)
        mark, shown = " *" if result.is_sampled(measure) else "", units.measure(unit + power)
        table.add_row(
            f"{title} ({shown.printed}){mark}",
            number(own * shown.factor),
            number(best * shown.factor),
            "–" if saving is None else f"{round(saving * 100, 1) + 0.0:.1f} %",
        )
    reports = (result.report, result.optimum_report)
    slips = [number(1e6 * report.motion.sync_ratio_error, 4) for report in reports]
    table.add_row("sync error of the tool's speed (1e-6)", *slips, "")
    servos, length = [report.servo for report in reports], units.shown["m"]
    for title, name in (("following error", "peak_following_error"), ("shear-zone error", "shear_zone_error")):
        values = ["unstable" if servo is None else number(length.factor * getattr(servo, name), 4) for servo in servos]
        table.add_row(f"{title} of the servo ({length.printed})", *values, "")
    notes = [new_text(f"Note: {note}") for note in result.notes]
    if any(result.is_sampled(measure) for measure in MEASURES):
        time = result.job.servo.sample_time * 1e3
        why = "in counts" if result.counted else "unbounded"
        notes.insert(
            0,
            new_text(f"* {why}; by differences of the positions at the sample time of {time:g} ms, for both"),
        )
    ramps = new_text(plc_words(line_ramps(result.cycle, result.job)))
    return stacked(table, checks_view(result.judgement.checks, result.job.units), ramps, *notes, files_view(files))
