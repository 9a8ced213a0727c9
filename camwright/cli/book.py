"""The command ``camwright book``."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated

import typer

from camwright.book.cluster import cluster_crew
from camwright.book.plan import plan_book
from camwright.book.run import BookAnswer, Told, make_book, nothing
from camwright.book.workers import default_jobs, local_crew
from camwright.cli.options import CommonPlace, GivenJob, Json, Quiet, TableTargets, out_folder
from camwright.cli.views.parts import View, files_view, new_table, new_text, stacked
from camwright.house.output import Voice, complain
from camwright.jobs.job import load_job
from camwright.production.common_place import placed_for


def run(
    job: GivenJob,
    length: Annotated[
        str,
        typer.Option(
            "--length", metavar="START:STOP:STEP", help="Cut lengths, mm (in an inch job in) unless with units."
        ),
    ],
    line_speed: Annotated[
        str,
        typer.Option(
            "--line-speed",
            metavar="START:STOP:STEP",
            help="Line speeds, m/min (ft/min) unless with units.",
        ),
    ],
    objective: Annotated[
        list[str] | None,
        typer.Option("--objective", metavar="NAME", help="Objective; may be repeated; the job's if left out."),
    ] = None,
    targets: TableTargets = None,
    common_place: CommonPlace = False,
    resume: Annotated[bool, typer.Option("--resume", help="Go on with the book in the output directory.")] = False,
    jobs: Annotated[
        int | None, typer.Option("--jobs", metavar="N", min=1, max=512, help="Processes; one a processor if left out.")
    ] = None,
    cluster: Annotated[
        str | None, typer.Option("--cluster", metavar="ADDRESS", help="Scheduler of a Dask cluster, tcp://host:8786.")
    ] = None,
    out: Annotated[Path | None, out_folder("-book")] = None,
    as_json: Json = False,
    quiet: Quiet = False,
) -> int:
    """Design every combination of cut lengths, line speeds and objectives, check it, write its tables, and an index."""
    asked = load_job(job)
    plan = plan_book(asked, length, line_speed, objective or (), targets)
    place = placed_for(asked, plan.tasks(asked)) if common_place else None
    if place is not None and place.found is not None:
        plan = plan_book(place.job, length, line_speed, objective or (), targets)
    directory = Path("out") / f"{asked.name}-book" if out is None else out
    here = local_crew(min(jobs or default_jobs(), len(plan)))
    crews = contextlib.nullcontext(here) if cluster is None else cluster_crew(cluster)
    try:
        with crews as crew, progress(len(plan), quiet=quiet) as told:
            answer = make_book(plan, directory, crew, resume=resume, told=told)
    except KeyboardInterrupt:
        complain(f"camwright: interrupted; what is done lies in {directory}, --resume goes on with it")
        raise
    Voice(as_json, quiet).answer(
        lambda: answer.to_dict() | ({} if place is None else {"common_place": place.answer()}),
        lambda: _view(answer) if place is None else stacked(new_text(place.words()), _view(answer)),
    )
    return answer.exit_code


def _view(answer: BookAnswer) -> View:
    """Show how many combinations ended how, and where the book is."""
    counts, ends = answer.counts, ("passed", "a check failed", "infeasible", "solver failed")
    table = new_table(f"{answer.book.name}: a book of {counts.designs} designs", ends)
    table.add_row(*map(str, (counts.passed, counts.check_failed, counts.infeasible, counts.failed)))
    made = counts.designs - answer.resumed
    speed = f"{made} made at {answer.rate:.3g} a second, {answer.resumed} done before"
    return stacked(table, new_text(f"{speed}; peak memory {answer.peak_rss / 2**20:.0f} MB"), files_view(answer.files))


@contextlib.contextmanager
def progress(total: int, *, quiet: bool) -> Iterator[Told]:
    """Show a progress bar with rate and remaining time, if standard error is a terminal; gives what to tell it."""
    if quiet or not sys.stderr.isatty():
        yield nothing
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, ProgressColumn, Task, TimeRemainingColumn
    from rich.text import Text

    class Rate(ProgressColumn):
        """Designs a second, over the last seconds."""

        def render(self, task: Task) -> Text:
            """Write the rate."""
            return Text("" if task.speed is None else f"{task.speed:.1f} designs/s")

    columns = (BarColumn(), MofNCompleteColumn(), Rate(), TimeRemainingColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as display:
        task = display.add_task("", total=total)
        begun = False

        def told(done: int) -> None:
            nonlocal begun
            if begun:
                display.update(task, completed=done)
            else:  # what was done before is no measure of the speed
                display.reset(task, completed=done, total=total)
            begun = True

        yield told
