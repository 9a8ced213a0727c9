"""The command ``camwright cutlist``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from camwright.answers.measures import with_files
from camwright.cli.destination import destination
from camwright.cli.options import (
    CommonPlace,
    GivenJob,
    Json,
    NoFigures,
    Quiet,
    TableTargets,
    optional_quantity,
    out_folder,
)
from camwright.cli.views.parts import View, files_view, new_table, new_text, stacked
from camwright.cli.views.seams import seams_view
from camwright.drives.options import chosen_targets
from camwright.figures.line_plan import line_plan_figure
from camwright.house.numbers import number, shown, unit_shown, with_unit
from camwright.house.output import Voice, complain
from camwright.jobs.job import load_job
from camwright.production.common_place import placed_alike
from camwright.production.cut_list import ListStudy, line_of, study_list
from camwright.production.list_answer import list_answer, list_files
from camwright.production.list_file import read_cut_list

_STEPS = 6
_MOST_SHOWN = 12
"""Changes that are shown on the screen; all stand in ``changes.csv``."""

_HOW = {
    "direct": "directly",
    "slow_down": "directly, but first slow down",
    "transition": "through a transition of one piece",
    "sync_cycle": "through a cycle in sync, two pieces",
    "stop": "only at a standstill",
}


def run(
    job: GivenJob,
    cut_list: Annotated[Path, typer.Argument(metavar="LIST", help="Cut list (CSV): length, quantity and kind.")],
    targets: TableTargets = None,
    line_acceleration: Annotated[
        str | None,
        typer.Option(
            "--line-acceleration",
            metavar="A",
            help='Ramp of the line, e.g. "0.5 m/s^2"; else [line] acceleration of the job.',
        ),
    ] = None,
    common_place: CommonPlace = False,
    out: Annotated[Path | None, out_folder("-cutlist")] = None,
    no_figures: NoFigures = False,
    as_json: Json = False,
    quiet: Quiet = False,
) -> int:
    """Work a cut list out: cams, changes, the fastest line speed, tables whose seams are run, and a table for the PLC."""
    given = load_job(job)
    ramp = optional_quantity("--line-acceleration", line_acceleration, "acceleration", example="0.5 m/s^2")
    asked, rows = line_of(given, ramp), read_cut_list(cut_list)
    place = placed_alike(asked, rows) if common_place else None
    voice = Voice(as_json, quiet)
    with voice.progress(_STEPS) as step:
        study = study_list(asked if place is None else place.job, rows, chosen_targets(targets, given), step)
    place_out = destination("cutlist", given, job, out, "-cutlist")
    files = place_out.write(list_files(study), {} if no_figures else {"line-plan": line_plan_figure(study)})
    files += [file for table in study.tables for file in table.write(place_out.directory, place_out.work, complain)]

    common = {} if place is None else {"common_place": place.answer()}
    said = [] if place is None else [new_text(place.words())]
    voice.answer(
        lambda: with_files({**list_answer(study), **common}, files),
        lambda: stacked(*_views(study), *said, files_view(files)),
    )
    return 0 if study.passed else 1


def _views(study: ListStudy) -> list[View]:
    """Show cams, changes, time and seams."""
    planned = study.planned
    units = planned.job.units
    speed = unit_shown("m/s", units)
    heads = ("cam", f"length\n{unit_shown('m', units)}", "pieces", f"highest speed\n{speed}", "bears ramps", "checks")
    title = f"{planned.job.name}: {len(planned.cams)} cams for {planned.asked.pieces} pieces"
    cams = new_table(title, heads, left=("checks",))
    for cam in planned.cams:
        failed = [check.name for check in cam.report.checks if not check.passed]
        cams.add_row(
            str(cam.number),
            shown(cam.length, "m", 6, units),
            str(int((planned.of == cam.number - 1).sum())),
            shown(cam.line_speed, "m/s", 5, units),
            "yes" if cam.bears_ramps else "no",
            new_text(f"FAILED: {', '.join(failed)}", "bold red") if failed else new_text("passed", "green"),
        )
    made = [change for change in planned.changes.values() if change.times]
    changes = new_table("Changes", ("from", "to", "how", f"line speed\n{speed}", "times"), left=("how",))
    for change in made[:_MOST_SHOWN]:
        at = shown(change.line_speed, "m/s", 5, units)
        changes.add_row(str(change.before), str(change.after), _HOW[change.how], at, str(change.times))
    return [cams, *([changes] if made else []), seams_view(study.tables, units), new_text(_said(study, len(made)))]


def _said(study: ListStudy, changes: int) -> str:
    """Say the time, the scrap, and what the servo makes of it."""
    planned = study.planned
    units, plan = planned.job.units, planned.line
    line = planned.job.line
    jerk = "" if line.jerk is None else f" and {with_unit(line.jerk, 'm/s^3', 4, units)}"
    lines = [
        f"{number(plan.time)} s on a line that ramps with {with_unit(line.acceleration or 0.0, 'm/s^2', 4, units)}{jerk}",
        f"{number(planned.time_at_slowest)} s at the slowest piece's speed",
        f"scrap {with_unit(planned.asked.scrap, 'm', 5, units)}",
    ]
    if changes > _MOST_SHOWN:
        lines.append(f"{changes - _MOST_SHOWN} more changes stand in changes.csv")
    worst, tolerance = float(study.run.sync_errors.max()), planned.job.cut.sync_tolerance
    lines.append(
        f"servo: off by {with_unit(worst, 'm', 4, units)} at most in the shear zone, "
        f"{study.off} of {planned.asked.pieces} pieces outside {with_unit(tolerance, 'm', 4, units)}"
    )
    if study.off:
        lines.append(
            "a gentler ramp of the line helps where that is while it ramps; camwright simulate shows each piece"
        )
    return "\n".join(lines)
