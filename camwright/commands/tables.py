"""The commands about cam tables: ``camwright export | audit | targets``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from camwright.output import Voice

if TYPE_CHECKING:
    from rich.console import RenderableType

    from camwright.audit import Audit
    from camwright.export import Exported

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
    units: Annotated[str, typer.Option("--units", metavar="M,S", help="Units of master and slave.")] = "mm,mm",
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
    from camwright.answers import to_json
    from camwright.design_file import read_design
    from camwright.export import export, export_answer, export_report, parse_targets, parse_units
    from camwright.files import staged
    from camwright.units import quantity
    from profiles.tables.knots import Accuracy

    names = parse_targets(to)
    accuracy = Accuracy(position=quantity(max_error, "length"))
    stored = read_design(design)
    wanted = parse_units(units, stored.job.machine.pitch, stored.job.cut.length)
    directory = design.parent / "tables" if out is None else out
    voice = Voice(as_json, quiet)
    with voice.progress(len(names) + 1) as step:
        results = export(
            stored.profile, stored.job, names, units=wanted, accuracy=accuracy, points=points, force=force, step=step
        )
        step("writing files")
        with staged(directory) as aside:
            for result in results:
                for name, text in result.files.items():
                    (aside / name).write_bytes(text.encode())
            (aside / "report.json").write_bytes(to_json(export_report(results, stored.job)).encode())
    voice.answer(lambda: export_answer(results), lambda: _export_view(results, directory))
    return 0 if all(result.passed for result in results) else 1


def audit_command(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="A cam table in the layout of any target.")],
    job: Annotated[Path, typer.Option("--job", metavar="JOB", help="Job file (TOML) that the cam is run for.")],
    target: Annotated[
        str | None, typer.Option("--target", metavar="NAME", help="Layout; recognised if left out.")
    ] = None,
    units: Annotated[str | None, typer.Option("--units", metavar="M,S", help="Units of master and slave.")] = None,
    as_json: _Json = False,
    quiet: _Quiet = False,
) -> int:
    """Judge a cam that runs today as its drive runs it, and set it beside the optimum of the same job."""
    from camwright.audit import audit, audit_answer
    from camwright.export import parse_units
    from camwright.job import load_job

    asked = load_job(job)
    given = None if units is None else parse_units(units, asked.machine.pitch, asked.cut.length)
    voice = Voice(as_json, quiet)
    with voice.progress(3) as step:
        result = audit(file, asked, target, given, step)
    voice.answer(lambda: audit_answer(result, asked, file), lambda: _audit_view(result, file))
    return 0 if result.judgement.passed else 1


def targets_command(as_json: _Json = False, quiet: _Quiet = False) -> int:
    """List the targets: limits, interpolation, evidence, and what was never tested on a controller."""
    from camwright.export import targets_answer

    answer = targets_answer()
    if as_json:
        import json

        typer.echo(json.dumps(answer, allow_nan=False))
    else:
        Voice(as_json=False, quiet=quiet).answer(dict, lambda: _targets_view(answer))
    return 0


def _export_view(results: list[Exported], directory: Path) -> RenderableType:
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
            f"{off.position * 1e6:.3g}",
            f"{off.ratio * 1e6:.3g}",
            "unbounded" if off.acceleration is None else f"{off.acceleration * 100:.3g}",
            "passed" if result.passed else "failed: " + ", ".join(failed),
            "\n".join(result.files) or "not released",
        )
    note = "No table was tested on a controller. Check the integrity of the data after every import."
    return Group(table, Text(f"in {directory}"), Text(note))


def _audit_view(result: Audit, file: Path) -> RenderableType:
    from rich.console import Group
    from rich.table import Table
    from rich.text import Text

    from camwright.tables import checks_view

    table = Table(title=f"{file}: {result.target.title}, {result.table.points} points", title_justify="left")
    for name in ("", "this cam", "optimum", "saving"):
        table.add_column(name, justify="left" if not name else "right")
    for measure, title in (
        ("peak_speed", "peak speed (m/s)"),
        ("peak_acceleration", "peak acceleration (m/s²)"),
        ("rms_acceleration", "RMS acceleration (m/s²)"),
        ("peak_jerk", "peak jerk (m/s³)"),
    ):
        own, best = getattr(result.report.motion, measure), getattr(result.optimum_report.motion, measure)
        saving = result.saving(measure)
        table.add_row(
            title,
            "unbounded" if own is None else f"{own:.5g}",
            "unbounded" if best is None else f"{best:.5g}",
            "–" if saving is None else f"{saving * 100:.1f} %",
        )
    notes = [Text(f"Note: {note}") for note in result.table.notes]
    return Group(table, checks_view(result.judgement.checks), *notes)


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
