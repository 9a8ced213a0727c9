"""The command ``camwright limits``."""

from __future__ import annotations

from rich.console import Group, RenderableType
from rich.table import Table

from camwright.answers.studies import limits_answer
from camwright.cli.options import GivenJob, Json, Quiet
from camwright.cli.views.lengths import axis_lengths_view, lengths_view
from camwright.cli.views.numbers import millimetres, number
from camwright.design.feasible.extremes import Extremes, extremes
from camwright.house.output import Voice
from camwright.jobs.job import Job, load_job
from camwright.studies.axis_lengths import AxisLengths, axis_lengths
from camwright.studies.cut_lengths import CutLengths, cut_lengths


def run(job: GivenJob, as_json: Json = False, quiet: Quiet = False) -> int:
    """Say how fast and how short the machine of a job can cut, and which limit binds."""
    asked = load_job(job)
    voice = Voice(as_json, quiet)
    with voice.progress(3) as step:
        step("finding the highest line speed and the shortest cut")
        far = extremes(asked.task)
        step("finding minimum cut lengths")
        lengths = cut_lengths(asked)
        step("finding minimum cut lengths with the axis in sync")
        axis = axis_lengths(asked)

    voice.answer(lambda: limits_answer(asked, far, lengths, axis), lambda: _view(asked, far, lengths, axis))
    return 0


def _view(job: Job, far: Extremes, lengths: CutLengths | None, axis: AxisLengths | None) -> RenderableType:
    """Show how fast and how short a job can be done, and what binds."""
    speed = f"{number(far.max_line_speed * 60)} m/min" if far.max_line_speed else "none works"
    length = f"{millimetres(far.min_cut_length)} mm" if far.min_cut_length else "none works"
    table = Table(title="How fast, how short", title_justify="left")
    for name in ("", "", "binds"):
        table.add_column(name)
    table.add_row(
        f"highest line speed at a cut length of {millimetres(job.cut.length)} mm", speed, far.line_speed_binding
    )
    table.add_row(
        f"shortest cut length at {number(job.cut.line_speed * 60)} m/min with a sync zone of {millimetres(job.cut.sync_zone)} mm",
        length,
        far.cut_length_binding,
    )
    views: list[RenderableType] = [table]
    if lengths is not None:
        views.append(lengths_view(lengths))
    if axis is not None:
        views.append(axis_lengths_view(axis))
    return Group(*views)
