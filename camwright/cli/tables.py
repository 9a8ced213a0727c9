"""The commands about cam tables: ``camwright export | audit | targets``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from camwright.house.output import Voice

if TYPE_CHECKING:
    from rich.console import RenderableType

    from camwright.drives.audit import Audit
    from camwright.drives.export import Exported
    from camwright.stored.design_file import StoredDesign

_Json = Annotated[bool, typer.Option("--json", help="Print JSON instead of tables.")]
_Quiet = Annotated[bool, typer.Option("--quiet", help="Print neither tables nor progress.")]


def register(app: typer.Typer) -> None:
    """Add the commands to the command line."""
    app.command("export")(export_command)
    app.command("audit")(audit_command)
    app.command("targets")(targets_command)


def export_command(
    design: Annotated[Path, typer.Argument(metavar="DESIGN", help="A design.json that camwright design wrote.")],
    to: Annotated[str, typer.Option("--to", metavar="NAMES", help="Targets, separated by commas, or all.")],
    points: Annotated[
        int | None, typer.Option("--points", metavar="N", help="Number of points; chosen if left out.")
    ] = None,
    units: Annotated[
        str | None,
        typer.Option("--units", metavar="M,S", help="Units of master and slave, for example mm,deg; mm if left out."),
    ] = None,
    max_error: Annotated[str, typer.Option("--max-error", metavar="LENGTH", help="Greatest position error.")] = "1 um",
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="Output directory; tables beside DESIGN.")
    ] = None,
    force: Annotated[
        bool, typer.Option("--force", help="Write tables that break a limit, too; their head says so.")
    ] = False,
    as_json: _Json = False,
    quiet: _Quiet = False,
) -> int:
    """Write a design for drives; every file is read back and judged as the drive will run it."""
    from camwright.drives.export import export_answer, export_possible, export_report
    from camwright.drives.options import parse_targets, parse_units
    from camwright.drives.withheld import copy_aside, older_tables, remove
    from camwright.house.files import staged
    from camwright.house.json_text import to_json
    from camwright.house.provenance import camwright_version
    from camwright.house.units import quantity
    from camwright.profiles.errors import InputError
    from camwright.profiles.tables.knots import Accuracy
    from camwright.profiles.tables.target import Header
    from camwright.profiles.tables.targets import target_of

    names = parse_targets(to)
    accuracy = Accuracy(position=quantity(max_error, "length"))
    stored = _design(design)
    job = stored.job
    wanted = None if units is None else parse_units(units, job.machine, job.cut)
    directory = design.parent / "tables" if out is None else out
    voice = Voice(as_json, quiet)
    with voice.progress(len(names) + 1) as step:
        results, refused = export_possible(
            stored.profile, job, names, units=wanted, accuracy=accuracy, points=points, force=force, step=step
        )
        if refused and (to.strip() != "all" or not results):
            raise InputError(*(f"{name}: {fault}" for name, faults in refused.items() for fault in faults))
        step("writing files")
        withheld = [result.target for result in results if not result.files]
        withheld += [target_of(name) for name in refused]
        older = older_tables(directory, withheld, Header(job.name, camwright_version()))
        with staged(directory) as aside:
            for result in results:
                for name, text in result.files.items():
                    (aside / name).write_bytes(text.encode())
            copy_aside(directory, aside, older)
            report = {**export_report(results, job, refused), "set_aside": older}
            (aside / "report.json").write_bytes(to_json(report).encode())
        remove(directory, older)
    voice.answer(
        lambda: {**export_answer(results), "set_aside": older},
        lambda: _export_view(results, refused, older, directory),
    )
    return 0 if all(result.passed for result in results) else 1


def _design(path: Path) -> StoredDesign:
    """Read a design; of a job say how to make one."""
    from camwright.house.files import read_text
    from camwright.profiles.errors import InputError
    from camwright.stored.design_file import MOST_BYTES, parse_design

    text = read_text(path, "design file", MOST_BYTES)
    if not text.removeprefix("\ufeff").lstrip().startswith("{"):
        raise InputError(
            f"{path}: not a design.json; if it is a job, design it first: camwright design {path} --out DIR, then "
            "camwright export DIR/design.json"
        )
    return parse_design(text, str(path))


def audit_command(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="A cam table in the layout of any target.")],
    job: Annotated[Path, typer.Option("--job", metavar="JOB", help="Job file (TOML) that the cam is run for.")],
    target: Annotated[
        str | None, typer.Option("--target", metavar="NAME", help="Layout; recognised if left out.")
    ] = None,
    units: Annotated[
        str | None,
        typer.Option("--units", metavar="M,S", help="Units of master and slave, for files that state none: mm,deg."),
    ] = None,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="Output directory; out/<name> if left out.")
    ] = None,
    no_figures: Annotated[bool, typer.Option("--no-figures", help="Write no figures.")] = False,
    as_json: _Json = False,
    quiet: _Quiet = False,
) -> int:
    """Judge a cam that runs today as its drive runs it, and set it beside the optimum of the same job."""
    from camwright.drives.audit import audit, audit_answer
    from camwright.house.files import staged
    from camwright.jobs.job import load_job

    asked = load_job(job)
    voice = Voice(as_json, quiet)
    files: list[Path] = []
    with voice.progress(4) as step:
        result = audit(file, asked, target, units, step)
        if not no_figures:
            from camwright.figures import audit_figures

            step("writing files")
            directory = Path("out") / asked.name if out is None else out
            with staged(directory) as aside:
                files = [directory / figure.name for figure in audit_figures(result, aside)]
    voice.answer(lambda: audit_answer(result, file, files), lambda: _audit_view(result, file, files))
    return 0 if result.judgement.passed else 1


def targets_command(as_json: _Json = False, quiet: _Quiet = False) -> int:
    """List the targets: limits, interpolation, evidence, and what was never tested on a controller."""
    from camwright.drives.export import targets_answer

    answer = targets_answer()
    if as_json:
        import json

        typer.echo(json.dumps(answer, allow_nan=False))
    else:
        Voice(as_json=False, quiet=quiet).answer(dict, lambda: _targets_view(answer))
    return 0


def _export_view(
    results: list[Exported],
    refused: dict[str, tuple[str, ...]],
    older: dict[str, dict[str, str]],
    directory: Path,
) -> RenderableType:
    from rich.console import Group
    from rich.table import Table
    from rich.text import Text

    table = Table(title="Tables as the drives run them", title_justify="left")
    for name in ("target", "points", "position\num", "ratio\n1e-6", "acceleration\n%", "judgement", "files"):
        table.add_column(name, justify="left" if name in ("target", "judgement", "files") else "right")
    for result in results:
        off = result.deviation
        failed = [check.name for check in result.judgement.checks if not check.passed]
        table.add_row(
            result.target.name,
            str(result.table.points),
            f"{result.position_error * 1e6:.3g}" + ("" if result.accurate else " *"),
            f"{off.ratio * 1e6:.3g}",
            "unbounded" if off.acceleration is None else f"{off.acceleration * 100:.3g}",
            "passed" if result.passed else "failed: " + ", ".join(failed),
            "\n".join(result.files) or "not released",
        )
    note = "No table was tested on a controller. Check the integrity of the data after every import."
    notes = [Text(f"{name} cannot take this cam: {'; '.join(faults)}") for name, faults in refused.items()]
    notes += [
        Text(f"{name}: the new table is withheld; the older {old} is now {new}", "yellow")
        for name, names in older.items()
        for old, new in names.items()
    ]
    for result in results:
        rough = result.dense.deviation.acceleration if result.dense else None
        if rough is not None and rough > (result.deviation.acceleration or 0.0):
            points = result.dense.table.points if result.dense else 0
            notes.append(
                Text(
                    f"{result.target.name} rounds to float32: {points} points would be off by {rough * 100:.3g} % of the acceleration"
                )
            )
    if any(not result.accurate for result in results):
        notes.insert(0, Text("* the nearest that this target can come; the error asked for is exceeded somewhere"))
    return Group(table, *notes, Text(f"in {directory}"), Text(note))


def _audit_view(result: Audit, file: Path, files: list[Path]) -> RenderableType:
    from rich.console import Group
    from rich.table import Table
    from rich.text import Text

    from camwright.cli.views import checks_view, files_view
    from camwright.drives.audit import MEASURES

    table = Table(title=f"{file}: {result.target.title}, {result.table.points} points", title_justify="left")
    for name in ("", "this cam", "optimum", "saving"):
        table.add_column(name, justify="left" if not name else "right")
    unit = result.job.machine.slave_unit
    for (measure, title), power in zip(MEASURES.items(), ("/s", "/s²", "/s²", "/s³", "/s³"), strict=True):
        (own, best), saving = result.pair(measure), result.saving(measure)
        mark = " *" if result.is_sampled(measure) else ""
        table.add_row(
            f"{title} ({unit}{power}){mark}",
            f"{own:.5g}",
            f"{best:.5g}",
            "–" if saving is None else f"{saving * 100:.1f} %",
        )
    reports = (result.report, result.optimum_report)
    slips = [f"{1e6 * report.motion.sync_ratio_error:.4g}" for report in reports]
    table.add_row("sync error of the tool's speed (1e-6)", *slips, "")
    servos = [report.servo for report in reports]
    for title, name in (("following error", "peak_following_error"), ("shear-zone error", "shear_zone_error")):
        values = ["unstable" if servo is None else f"{1e3 * getattr(servo, name):.4g}" for servo in servos]
        table.add_row(f"{title} of the servo (mm)", *values, "")
    notes = [Text(f"Note: {note}") for note in result.notes]
    if any(result.is_sampled(measure) for measure in MEASURES):
        time = result.job.servo.sample_time * 1e3
        notes.insert(
            0, Text(f"* unbounded; by differences of the positions at the sample time of {time:g} ms, for both")
        )
    return Group(table, checks_view(result.judgement.checks), *notes, files_view(files))


def _targets_view(answer: list[dict[str, Any]]) -> RenderableType:
    from rich.table import Table

    table = Table(title="Targets; none was tested on a controller", title_justify="left", show_lines=True)
    for name in ("name", "what", "interpolation", "points", "numbers", "evidence"):
        table.add_column(name, justify="right" if name == "points" else "left")
    for entry in answer:
        table.add_row(
            entry["name"],
            entry["title"],
            entry["interpolation"],
            "–" if entry["max_points"] is None else str(entry["max_points"]),
            entry["number_format"],
            entry["evidence"],
        )
    return table
