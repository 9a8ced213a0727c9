"""The recipe sheet of a bent drawing: PDF and HTML from the same data."""

from __future__ import annotations

import json
import shutil
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from camwright.bender.answer import BentDrawing, size_words
from camwright.bender.bend_list import BendRow, bend_rows
from camwright.bender.program_file import ROUNDING, BentOutline
from camwright.house.fonts import font_folders
from camwright.house.provenance import camwright_version

_TEMPLATES = Path(__file__).parent / "templates"
_MOST_ROWS = 150
_MOST_OUTLINES = 20


def sheet_data(result: BentDrawing) -> dict[str, Any]:
    """Gather everything the sheet shows, as texts ready to print."""
    job, table = result.job, result.job.springback
    return {
        "drawing": result.drawing.name,
        "drawing_sha256": result.sha256,
        "job_sha256": job.sha256,
        "version": camwright_version(),
        "bender": job.name,
        "facts": [
            ["Size", f"{size_words(result.found)}, the drawing's unit is {result.found.unit}"],
            ["Rule", f"{1e3 * job.height:g} mm × {1e3 * job.thickness:g} mm"],
            ["Arcs", _division_words(job)],
            ["Ellipses and splines", f"lines within {1e3 * job.flattening:g} mm, counted in the deviation"],
            ["Springback table", f"{table.name}, {table.interpolation}"],
            ["Programs", f"{len(result.outlines)}, {job.flavour} style"],
        ],
        "angles": [[f"{a:.3f}", f"{b:.3f}"] for a, b in np.degrees(np.stack([table.workpiece, table.mould], axis=1))],
        "radii": [
            [f"{1e3 * r:g}", f"{np.degrees(b):.3f}"] for r, b in zip(table.radius, table.radius_mould, strict=True)
        ],
        "step": f"{np.degrees(table.step):g}",
        "warnings": list(result.warnings),
        "passed": result.passed,
        "outlines": [
            _outline_data(outline, str(style), result)
            for outline, style in zip(result.outlines[:_MOST_OUTLINES], result.found.styles, strict=False)
        ],
        "left_out": max(0, len(result.outlines) - _MOST_OUTLINES),
    }


def _division_words(job: Any) -> str:
    rule = type(job.divide).__name__
    if rule == "EqualSides":
        return f"a circle as {job.divide.sides} sides"
    if rule == "EqualSteps":
        return f"steps of {1e3 * job.divide.step:g} mm"
    return f"fewest bends within {1e3 * job.divide.chord_error:g} mm"


def _outline_data(outline: BentOutline, style: str, result: BentDrawing) -> dict[str, Any]:
    proof, gain = outline.proof, 1 - outline.times.total / outline.paper_times.total
    closing = "open outline" if proof.closing_error is None else f"{1e3 * proof.closing_error:.4f} mm"
    paper = f"paper's rule: {outline.paper_bends}, chord error {1e3 * outline.paper_error:.3f} mm"
    sequential = f"sequential trapezoids {outline.paper_times.total:.2f} s"
    allowed = 1e3 * (outline.plan.chord_error + ROUNDING)
    over = np.degrees(outline.mould_overshoot[0])
    rows = bend_rows(outline, result.job, _MOST_ROWS)
    return {
        "name": outline.program.name,
        "source": outline.plan.outline.name,
        "sha256": outline.sha256,
        "facts": [
            ["Style", style],
            ["Bends", f"{outline.plan.bends} ({paper})"],
            ["Rule length", f"{1e3 * proof.rule_length:.3f} mm"],
            ["Largest deviation", f"{1e3 * proof.deviation:.4f} mm (allowed {allowed:.4f} mm)"],
            ["Closing error", closing],
            ["Cycle time", f"{outline.times.total:.2f} s; {sequential} ({-100 * gain:+.1f} %)"],
            ["Overshoot", f"feed {1e3 * outline.feed_overshoot[0]:.4f} mm, mould {over:.4f}°"],
            ["Collisions", str(len(outline.collisions)) if outline.collisions else "none"],
        ],
        "bends": [_row(row) for row in rows],
        "left_out": outline.plan.bends - len(rows),
        "last_feed": f"{outline.program.feeds[-1] / 1e3:.3f}",
    }


def _row(row: BendRow) -> list[str]:
    return [
        str(row.bend),
        f"N{row.line:03d}",
        f"{row.feed:.3f}",
        f"{abs(row.turn):.3f} {'left' if row.turn > 0 else 'right'}",
        "corner" if row.radius is None else f"{row.radius:.3f}",
        f"{abs(row.mould):.3f}",
        f"{row.compensation:+.3f}",
    ]


def write_sheet(result: BentDrawing, directory: Path, figures: list[Path]) -> None:
    """Write ``sheet.pdf`` and ``sheet.html``.

    Parameters
    ----------
    result
        The programs of a drawing.
    directory
        Where the sheets go.
    figures
        Proof figures as SVG, one an outline; none leaves the figures out.
    """
    data = sheet_data(result)
    _write_pdf(data, directory / "sheet.pdf", figures)
    _write_html(data, directory / "sheet.html", figures)


def _write_pdf(data: dict[str, Any], target: Path, figures: list[Path]) -> None:
    import typst

    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder)
        shutil.copy(_TEMPLATES / "sheet.typ", place / "sheet.typ")
        for i, figure in enumerate(figures[:_MOST_OUTLINES]):
            shutil.copy(figure, place / f"figure-{i}.svg")
        data = {**data, "figures": min(len(figures), _MOST_OUTLINES)}
        (place / "data.json").write_text(json.dumps(data), encoding="utf-8")
        source = str(place / "sheet.typ")
        typst.compile(
            source, output=str(target), root=folder, font_paths=font_folders(), ignore_system_fonts=True, timestamp=0
        )


def _write_html(data: dict[str, Any], target: Path, figures: list[Path]) -> None:
    import jinja2

    loader = jinja2.FileSystemLoader(_TEMPLATES)
    environment = jinja2.Environment(loader=loader, autoescape=True, undefined=jinja2.StrictUndefined)
    drawings = [figure.read_text(encoding="utf-8") for figure in figures[:_MOST_OUTLINES]]
    page = environment.get_template("sheet.html").render(**data, drawings=drawings)
    target.write_text(page, encoding="utf-8")
