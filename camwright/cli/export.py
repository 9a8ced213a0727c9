"""The command ``camwright export``."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from camwright.cli.options import Json, Quiet, To, option_quantity
from camwright.cli.views.parts import View, new_table, new_text, stacked
from camwright.cli.views.speed_tables import speed_tables_view
from camwright.drives.export import export_answer
from camwright.drives.options import chosen_targets, parse_targets
from camwright.drives.speed_tables import named, speed_tables, speed_tables_answer
from camwright.drives.table_files import TableFiles, export
from camwright.house.files import read_text
from camwright.house.numbers import number
from camwright.house.output import Voice, complain
from camwright.house.owned import Work, write_owned
from camwright.jobs.job import Job
from camwright.jobs.table_units import parse_units
from camwright.profiles.errors import InputError
from camwright.profiles.tables.knots import Accuracy
from camwright.stored.design_file import MOST_BYTES, StoredDesign, parse_design


def run(
    design: Annotated[Path, typer.Argument(metavar="DESIGN", help="A design.json that camwright design wrote.")],
    to: To = None,
    points: Annotated[
        int | None, typer.Option("--points", metavar="N", help="Number of points; chosen if left out.")
    ] = None,
    units: Annotated[
        str | None,
        typer.Option(
            "--units",
            metavar="M,S",
            help="Units of master and slave: mm,deg; or counts: mm,9.25 um or mm,36000/rev. mm if left out.",
        ),
    ] = None,
    max_error: Annotated[str, typer.Option("--max-error", metavar="LENGTH", help="Greatest position error.")] = "1 um",
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="Output directory; tables beside DESIGN.")
    ] = None,
    force: Annotated[
        bool, typer.Option("--force", help="Write tables that break a limit, too; their head says so.")
    ] = False,
    by_speed: Annotated[
        bool,
        typer.Option(
            "--speed-tables",
            help="Tables of a smooth return that the controller adds, each times a power of the line speed, for every line speed.",
        ),
    ] = False,
    as_json: Json = False,
    quiet: Quiet = False,
) -> int:
    """Write a design for drives; every file is read back and judged as the drive will run it."""
    if to is not None:
        parse_targets(to)  # a wrong name is told before the file is read
    accuracy = Accuracy(position=option_quantity("--max-error", max_error, "length", example="1 um"))
    stored = _design(design)
    names = chosen_targets(to, stored.job)
    wanted = None if units is None else parse_units(units, stored.job.task)
    directory = design.parent / "tables" if out is None else out
    voice = Voice(as_json, quiet)
    if by_speed:
        return _by_speed(stored.job, names, directory, voice)
    with voice.progress(len(names) + 1) as step:
        written = export(
            stored,
            names if to is None else to,
            directory,
            units=wanted,
            accuracy=accuracy,
            points=points,
            force=force,
            step=step,
            told=complain,
        )
    voice.answer(
        lambda: {**export_answer(written.results), "set_aside": written.older}, lambda: _view(written, directory)
    )
    return 0 if written.passed else 1


def _by_speed(job: Job, names: Sequence[str], directory: Path, voice: Voice) -> int:
    """Write tables that are added by powers of the line speed."""
    with voice.progress(len(names)) as step:
        found = []
        for target in named(names):
            step(f"tables for {target.name}")
            found.append(speed_tables(job, target))
    texts = {name: text for each in found for name, text in each.files.items()}
    if texts:
        write_owned(directory, Work("export", job.name, job.sha256, adds=True), texts, complain)
    files = [directory / name for name in sorted(texts)]
    voice.answer(lambda: speed_tables_answer(found), lambda: speed_tables_view(found, files, job.units))
    return 0 if all(each.passed for each in found) else 1


def _design(path: Path) -> StoredDesign:
    """Read a design; of a job say how to make one."""
    text = read_text(path, "design file", MOST_BYTES)
    if not text.removeprefix("\ufeff").lstrip().startswith("{"):
        raise InputError(
            f"{path}: not a design.json; if it is a job, design it first: camwright design {path} --out DIR, then "
            "camwright export DIR/design.json"
        )
    return parse_design(text, str(path))


def _view(written: TableFiles, directory: Path) -> View:
    """Show each table as its drive runs it, what was refused, and what was set aside."""
    heads = ("target", "points", "position\num", "ratio\n1e-6", "acceleration\n%", "judgement", "files")
    table = new_table("Tables as the drives run them", heads, left=("target", "judgement", "files"))
    for result in written.results:
        off = result.deviation
        failed = [check.name for check in result.judgement.checks if not check.passed]
        table.add_row(
            result.target.name,
            str(result.table.points),
            number(result.position_error * 1e6, 3) + ("" if result.accurate else " *"),
            number(off.ratio * 1e6, 3),
            number(None if off.acceleration is None else off.acceleration * 100, 3, without="unbounded"),
            "passed" if result.passed else "failed: " + ", ".join(failed),
            "\n".join(result.files) or "not released",
        )
    note = "No table was tested on a controller. Check the integrity of the data after every import."
    notes = [new_text(f"{name} cannot take this cam: {'; '.join(faults)}") for name, faults in written.refused.items()]
    notes += [
        new_text(f"{name}: the new table is withheld; the older {old} is now {new}", "yellow")
        for name, names in written.older.items()
        for old, new in names.items()
    ]
    for result in written.results:
        rough = result.dense.deviation.acceleration if result.dense else None
        if rough is not None and rough > (result.deviation.acceleration or 0.0):
            points = result.dense.table.points if result.dense else 0
            notes.append(
                new_text(
                    f"{result.target.name} rounds to float32: {points} points would be off by {rough * 100:.3g} % of the acceleration"
                )
            )
    notes += [
        new_text(f"{result.target.name}: one table for {result.cuts} cuts, after which its counts close")
        for result in written.results
        if result.cuts > 1
    ]
    notes += [
        new_text(
            f"{result.target.name}: {result.drift * 1e6:+.3g} u{result.units.slave.si} beyond the pitch in each cut",
            "yellow",
        )
        for result in written.results
        if abs(result.drift) > 1e-12
    ]
    if any(not result.accurate for result in written.results):
        notes.insert(0, new_text("* the nearest that this target can come; the error asked for is exceeded somewhere"))
    return stacked(table, *notes, new_text(f"in {directory}"), new_text(note))
