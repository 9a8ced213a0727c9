"""The command ``camwright compare``: profiles side by side, or what every objective costs in the others."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any

import typer

from camwright.answers.measures import profiles_answer
from camwright.cli.destination import Destination, destination
from camwright.cli.options import GivenJob, Json, NoFigures, Out, Quiet
from camwright.cli.views.parts import files_view, stacked
from camwright.cli.views.profiles import profiles_view
from camwright.cli.views.tradeoff import tradeoff_view
from camwright.figures.comparison import bars_figure
from camwright.figures.tradeoff import tradeoff_figure
from camwright.house.output import Voice
from camwright.jobs.job import Job, load_job
from camwright.profiles.errors import InputError
from camwright.studies.comparison import Comparison, compare, law_names, require_laws
from camwright.studies.screw import require_screw, screw_carriage
from camwright.studies.tradeoff import step_count, trade_off, tradeoff_answer


def run(
    job: GivenJob,
    laws: Annotated[
        list[str] | None, typer.Option("--with", metavar="LAW", help="Compare with this law only; may be repeated.")
    ] = None,
    objectives: Annotated[
        bool, typer.Option("--objectives", help="Compare what every objective costs in the others instead.")
    ] = False,
    screw: Annotated[
        bool,
        typer.Option("--screw", help="Compare a crank with the same carriage on a screw, designed for the same cut."),
    ] = False,
    out: Out = None,
    as_json: Json = False,
    no_figures: NoFigures = False,
    quiet: Quiet = False,
) -> int:
    """Compare the optimal cam with the linear return and the standard motion laws."""
    asked = load_job(job)
    if objectives:
        if laws or screw:
            raise InputError(
                f"--objectives compares all laws of one machine; leave out {'--with' if laws else '--screw'}"
            )
        place = None if no_figures else destination("compare --objectives", asked, job, out)
        return compare_objectives(asked, place, Voice(as_json, quiet))
    names = tuple(dict.fromkeys(laws)) if laws else law_names(asked.task)
    require_laws(names, asked.task)
    if screw:
        require_screw(asked)
    voice = Voice(as_json, quiet)
    files: list[Path] = []
    with voice.progress(len(names) + 3 + screw) as step:
        step("solving")
        result = compare(asked, names=names, step=step)
        if screw:
            step("designing the carriage on a screw")
            result = replace(result, screw=screw_carriage(result.job, result["optimised"]))
        if not no_figures:
            step("writing files")
            files = destination("compare", asked, job, out).write({}, {"comparison": bars_figure(result)})

    voice.answer(lambda: compare_answer(result, files), lambda: stacked(profiles_view(result), files_view(files)))
    return 0


def compare_objectives(asked: Job, place: Destination | None, voice: Voice) -> int:
    """Solve a job for every objective, print the trade-off, and draw it.

    Parameters
    ----------
    place
        Where the figure goes, ``tradeoff.svg`` and ``tradeoff.png``; ``None`` for none.
    voice
        How to answer.

    Returns
    -------
    int
        Exit code: 0.
    """
    files: list[Path] = []
    with voice.progress(step_count(asked) + 1) as step:
        result = trade_off(asked, step)
        if place is not None:
            step("writing files")
            files = place.write({}, {"tradeoff": tradeoff_figure(result)})

    voice.answer(lambda: tradeoff_answer(result, files), lambda: stacked(tradeoff_view(result), files_view(files)))
    return 0


def compare_answer(comparison: Comparison, files: Sequence[Path]) -> dict[str, Any]:
    """Answer of ``camwright compare``: the profiles sorted by the job's objective, those that break a limit last."""
    return {
        "job": comparison.job.name,
        "sorted_by": comparison.job.objective,
        "profiles": profiles_answer(comparison),
        "files": [str(file) for file in files],
    }
