"""The command ``camwright envelope``."""

from __future__ import annotations

from typing import Annotated

import typer

from camwright.answers.measures import with_files
from camwright.cli.destination import destination
from camwright.cli.options import GivenJob, Json, NoFigures, Out, Quiet
from camwright.cli.views.parts import View, files_view, new_table, stacked
from camwright.figures.envelope import envelope_figure
from camwright.house.numbers import shown, unit_shown
from camwright.house.output import Voice
from camwright.jobs.job import load_job
from camwright.studies.envelope import EnvelopeAnswer, envelope_answer


def run(
    job: GivenJob,
    points: Annotated[
        int, typer.Option("--points", metavar="N", min=2, max=200, help="Number of cut lengths, and of line speeds.")
    ] = 15,
    out: Out = None,
    no_figures: NoFigures = False,
    as_json: Json = False,
    quiet: Quiet = False,
) -> int:
    """Map which cut lengths and line speeds are possible, with which return, and what binds."""
    asked = load_job(job)
    voice = Voice(as_json, quiet)
    with voice.progress((points + 2) * (points + 1) + 1) as step:
        answer = envelope_answer(asked, points, step)
    pictures = {} if no_figures else {"envelope": envelope_figure(answer)}
    files = destination("envelope", asked, job, out).write(answer.files(), pictures)
    voice.answer(lambda: with_files(answer.to_dict(), files), lambda: stacked(_view(answer), files_view(files)))
    return 0


def _view(answer: EnvelopeAnswer) -> View:
    """Show the highest line speed at each cut length."""
    units = answer.job.units
    heads = (f"cut length\n{unit_shown('m', units)}", "optimised", "in tolerance", "quintic", "linear", "binds")
    table = new_table(f"Highest line speed ({unit_shown('m/s', units)})", heads, ("binds",))
    for row in answer.envelope.rows:
        speeds = (row.optimised, answer.in_tolerance(row.length), row.quintic, row.linear)
        table.add_row(
            shown(row.length, "m", 5, units),
            *(shown(speed, "m/s", 5, units) for speed in speeds),
            row.binding,
        )
    return table
