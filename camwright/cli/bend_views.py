"""What ``camwright bend`` prints for people: rich tables."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from camwright.bender.answer import BentDrawing
from camwright.bender.calibration import Calibration

_MOST_ROWS = 40


def drawing_view(result: BentDrawing, files: Sequence[Path]) -> RenderableType:
    """Show the programs of a drawing, their checks, warnings and files."""
    table = Table(title=f"Programs of {result.drawing.name}", title_justify="left")
    table.add_column("program")
    for name in (
        "bends\n",
        "by the paper's\narc rule",
        "rule\nmm",
        "deviation\nmm",
        "closing\nmm",
        "cycle\ns",
        "sequential\ns",
        "gain\n%",
    ):
        table.add_column(name, justify="right")
    table.add_column("checks")
    for outline in result.outlines[:_MOST_ROWS]:
        proof, cycle, paper = outline.proof, outline.times.total, outline.paper_times.total
        passed = all(check.passed for check in outline.checks)
        table.add_row(
            outline.program.name,
            str(outline.plan.bends),
            str(outline.paper_bends),
            f"{1e3 * proof.rule_length:.3f}",
            f"{1e3 * proof.deviation:.4f}",
            "open" if proof.closing_error is None else f"{1e3 * proof.closing_error:.4f}",
            f"{cycle:.2f}",
            f"{paper:.2f}",
            f"{100 * (1 - cycle / paper):.1f}",
            Text("passed", "green") if passed else Text("FAILED", "bold red"),
        )
    more = len(result.outlines) - _MOST_ROWS
    notes = [Text(f"{more} more programs are not shown")] if more > 0 else []
    notes += [
        Text(
            f"{outline.program.name}: {check.name} {check.value:.3g} {check.unit}, allowed {check.limit:.3g}",
            "bold red",
        )
        for outline in result.outlines
        for check in outline.checks
        if not check.passed
    ]
    notes += [Text(f"warning: {text}", "yellow") for text in result.warnings]
    notes += [Text(f"wrote {file}") for file in files]
    return Group(table, *notes)


def calibration_view(result: Calibration, files: Sequence[Path]) -> RenderableType:
    """Show the test bends with their residuals, and the files."""
    table = Table(title=f"Test bends of {result.springback.name}", title_justify="left")
    for name in ("row", "radius\nmm", "mould angle\n°", "measured\n°", "by the table\n°", "residual\n°"):
        table.add_column(name, justify="right")
    for bend, residual in zip(result.bends[:_MOST_ROWS], result.residuals, strict=False):
        table.add_row(
            str(bend.row),
            "corner" if bend.radius is None else f"{bend.radius:g}",
            f"{bend.mould:.3f}",
            f"{bend.workpiece:.3f}",
            f"{bend.workpiece + residual:.3f}",
            f"{residual:+.3f}",
        )
    more = len(result.bends) - _MOST_ROWS
    notes = [Text(f"{more} more test bends are in the residuals' file")] if more > 0 else []
    notes += [Text(f"warning: {text}", "yellow") for text in result.springback.warnings()]
    return Group(table, *notes, *(Text(f"wrote {file}") for file in files))
