"""The command ``camwright family``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from camwright.answers.measures import with_files
from camwright.cli.destination import Destination, destination
from camwright.cli.options import GivenJob, Json, NoFigures, Quiet, TableTargets, out_folder
from camwright.cli.views.parts import View, files_view, new_table, new_text, stacked
from camwright.cli.views.seams import seams_view
from camwright.drives.options import chosen_targets
from camwright.figures.family import family_figure
from camwright.house.files import fill
from camwright.house.json_text import to_json
from camwright.house.language import Language
from camwright.house.numbers import shown, unit_shown, with_unit
from camwright.house.output import Voice, complain
from camwright.house.owned import owned
from camwright.house.picture_files import write_pictures
from camwright.jobs.job import load_job
from camwright.production.family import Family, family
from camwright.production.family_answer import family_answer, family_files, family_record
from camwright.profiles.errors import InputError
from camwright.recipes.family_sheet import FAMILY_FILE, family_sheets
from camwright.recipes.manifest import MANIFEST_FILE, manifest_text
from camwright.recipes.model import Origin
from camwright.studies.covering import FOUND_TO
from camwright.studies.family_bands import OVERLAP

_STEPS = 8
_LEAST, _MOST = 0.01, 0.5
"""Range of an overlap."""

_HOW = {
    "direct": "directly",
    "transition": "through a transition of one cycle",
    "stop": "only at a standstill",
}


def run(
    job: GivenJob,
    overlap: Annotated[
        str,
        typer.Option(
            "--overlap", metavar="SHARE", help="How far neighbouring bands overlap, a share of the line speed."
        ),
    ] = f"{100 * OVERLAP:g} %",
    targets: TableTargets = None,
    out: Annotated[Path | None, out_folder("-family")] = None,
    language: Annotated[Language, typer.Option("--language", help="Language of the sheet.")] = "en",
    no_figures: NoFigures = False,
    as_json: Json = False,
    quiet: Quiet = False,
) -> int:
    """Cover a job's line speeds with several cams, as few as are found, and lead from each to the next in the sync zone."""
    share = _share(overlap)
    asked = load_job(job)
    names = chosen_targets(targets, asked)
    voice = Voice(as_json, quiet)
    with voice.progress(_STEPS) as step:
        found = family(asked, names, share, step)
    files = write_family(found, destination("family", asked, job, out, "-family"), language, figures=not no_figures)

    voice.answer(lambda: with_files(family_answer(found), files), lambda: stacked(*_views(found), files_view(files)))
    return 0 if found.passed else 1


def _share(text: str) -> float:
    """Read a share: a percentage."""
    digits, _, rest = text.strip().partition("%")
    try:
        share = float(digits) / 100 if not rest and "%" in text else float("nan")
    except ValueError:
        share = float("nan")
    if not _LEAST <= share <= _MOST:
        raise InputError(f"--overlap takes {100 * _LEAST:g} % to {100 * _MOST:g} %, e.g. 5 %; got {text[:40]!r}")
    return share


def write_family(found: Family, place: Destination, language: Language, *, figures: bool) -> list[Path]:
    """Write the sheet and the controller's files, and the tables of each target into a folder of its own."""
    record = family_record(found, language)
    data = {name: text.encode() for name, text in {**family_files(found), FAMILY_FILE: to_json(record)}.items()}
    data |= family_sheets(record)
    tables = {f"{table.name}/{name}": text.encode() for table in found.tables for name, text in table.files.items()}
    libraries = record["provenance"]["libraries"]
    origin = Origin(record["provenance"]["camwright"], record["provenance"]["job_sha256"], libraries)
    with owned(place.directory, place.work, complain) as aside:
        fill(aside, data)
        drawn = write_pictures({"family": family_figure(found)}, aside) if figures else []
        listed = {**data, **tables, **{file.name: file.read_bytes() for file in drawn}}
        (aside / MANIFEST_FILE).write_text(manifest_text(listed, origin), encoding="utf-8")
        files = [place.directory / name for name in sorted(file.name for file in aside.iterdir())]
    return files + [file for table in found.tables for file in table.write(place.directory, place.work, complain)]


def _views(found: Family) -> list[View]:
    """Show cams, changes, seams, and what was proved of their number."""
    units = found.found.job.units
    speed, error = unit_shown("m/s", units), unit_shown("m", units)
    heads = ("cam", f"from\n{speed}", f"to\n{speed}", f"sync error\n{error}", "checks")
    cams = new_table(f"{found.found.job.name}: {_count(found)}", heads, left=("checks",))
    for cam in found.cams:
        low, top = cam.line_speeds
        failed = [check.name for check in cam.report.checks if not check.passed]
        if not cam.passed and not failed:
            failed = ["servo_tolerance"]
        cams.add_row(
            str(cam.number),
            shown(low, "m/s", 5, units),
            shown(top, "m/s", 5, units),
            shown(max(cam.errors), "m", units=units),
            new_text(f"FAILED: {', '.join(failed)}", "bold red") if failed else new_text("passed", "green"),
        )
    return [
        cams,
        *([_switching_view(found)] if found.switchings else []),
        seams_view(found.tables, units),
        new_text(_said(found)),
    ]


def _count(found: Family) -> str:
    """Say how many cams there are, and what is proved of that."""
    low, high = (with_unit(each, "m/s", 4, found.found.job.units) for each in found.found.job.line_speeds)
    many = len(found.cams)
    cams = "one cam does" if many == 1 else f"{many} cams"
    proved = "" if many == 1 else ", the fewest" if found.found.fewest else f", at least {found.found.at_least} needed"
    return f"{cams}{proved}, from {low} to {high}"


def _switching_view(found: Family) -> View:
    """Show where the controller switches, and how."""
    units = found.found.job.units
    speed = unit_shown("m/s", units)
    heads = ("between", f"up above\n{speed}", f"down below\n{speed}", "how", "")
    table = new_table("Switching", heads, left=("between", "how", ""))
    for each in found.switchings:
        failed = sorted({check.name for checks in each.checks for check in checks if not check.passed})
        table.add_row(
            f"{each.changes[0].before} and {each.changes[0].after}",
            shown(each.up, "m/s", 5, units),
            shown(each.down, "m/s", 5, units),
            _HOW[each.how],
            new_text("passed", "green") if each.passed else new_text(f"FAILED: {', '.join(failed)}", "bold red"),
        )
    return table


def _said(found: Family) -> str:
    """Say what the bands are found to, and what the line does while a cam is changed."""
    job, cams = found.found.job, found.found
    lines = [f"lower ends of bands found to {100 * FOUND_TO:g} %"] if found.switchings else []
    if not cams.fewest and job.objective != "sync_error":
        lines.append('fewer cams are not excluded: minimise = "sync_error" asks nothing of the axis but its tolerance')
    if found.switchings and cams.holds_line:
        why = "its ramps would leave the bands" if job.line.ramps else "the job says of no ramp, [line] acceleration"
        lines.append(f"the line must keep its speed until a change is over: {why}")
    elif found.switchings:
        lines.append("the line may ramp as the job says while a cam is changed")
    lines.append(f"{job.name}: {'passed every check' if found.passed else 'FAILED'}")
    return "\n".join(lines)
