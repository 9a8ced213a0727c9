"""The bending sheet of a bent drawing: PDF and HTML from the same data, in the language that its reader reads."""

from __future__ import annotations

import json
import math
import shutil
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from camwright.bender.answer import BentDrawing
from camwright.bender.bend_list import BridgeRow, bend_rows, bridge_rows
from camwright.bender.catalogue import SheetWords, sheet_words
from camwright.bender.job import BenderJob
from camwright.bender.program_file import ROUNDING, BentOutline
from camwright.house.fonts import font_folders
from camwright.house.language import Language
from camwright.house.provenance import camwright_version
from camwright.profiles.bender.division import EqualSides, EqualSteps

_TEMPLATES = Path(__file__).parent / "templates"
_MOST_ROWS = 150
_MOST_OUTLINES = 20
_MOST_LINES = 12
"""Lines with a collision that a program's table names."""


def sheet_data(result: BentDrawing, language: Language) -> dict[str, Any]:
    """Gather everything the sheet shows, as texts ready to print."""
    job, table, words = result.job, result.job.springback, sheet_words(language)
    number = words.number
    width, height = result.found.size
    size = {"width": number(1e3 * width, ".3f"), "height": number(1e3 * height, ".3f"), "unit": result.found.unit}
    rule = {"height": number(1e3 * job.rule.height, "g"), "thickness": number(1e3 * job.rule.thickness, "g")}
    return {
        "language": language,
        "words": words.messages,
        "drawing": result.drawing.name,
        "drawing_sha256": result.sha256,
        "job_sha256": job.sha256,
        "version": camwright_version(),
        "bender": job.name,
        "facts": [
            [words("size"), words("size.value", **size)],
            [words("rule"), words("rule.value", **rule)],
            [words("arcs"), _division_words(job, words)],
            [words("curves"), words("curves.value", value=number(1e3 * job.drawing.flattening, "g"))],
            [words("table"), f"{table.name}, {words(f'interpolation.{table.interpolation}')}"],
            [words("programs"), words("programs.value", count=str(len(result.outlines)), flavour=job.flavour)],
            [words("bridges"), _bridge_words(sum(len(outline.bridges) for outline in result.outlines), job, words)],
        ],
        "angles": [
            [number(a, ".3f"), number(b, ".3f")]
            for a, b in np.degrees(np.stack([table.workpiece, table.mould], axis=1)).tolist()
        ],
        "radii": [
            [number(1e3 * r, "g"), number(b, ".3f")]
            for r, b in zip(table.radius.tolist(), np.degrees(table.radius_mould).tolist(), strict=True)
        ],
        "step": number(float(np.degrees(table.step)), "g"),
        "warnings": [words.said(text) for text in result.warnings],
        "passed": result.passed,
        "judgement": _judgement(result, words),
        "outlines": [
            _outline_data(outline, str(style), result, words)
            for outline, style in zip(result.outlines[:_MOST_OUTLINES], result.found.styles, strict=False)
        ],
        "left_out": max(0, len(result.outlines) - _MOST_OUTLINES),
    }


def _judgement(result: BentDrawing, words: SheetWords) -> str:
    if not result.passed:
        return words("checks.failed")
    accepted = any(result.accepted(check) for outline in result.outlines for check in outline.checks)
    return words("checks.accepted" if accepted else "checks.passed")


def _division_words(job: BenderJob, words: SheetWords) -> str:
    divide = job.divide
    if isinstance(divide, EqualSides):
        return words("arcs.EqualSides", value=str(divide.sides))
    if isinstance(divide, EqualSteps):
        return words("arcs.EqualSteps", value=words.number(1e3 * divide.step, "g"))
    return words("arcs.FewestBends", value=words.number(1e3 * divide.allowed(1.0), "g"))


def _bridge_words(count: int, job: BenderJob, words: SheetWords) -> str:
    """Say how many bridges there are and who cuts them."""
    if not count:
        return words("bridges.none")
    values = {"count": str(count), "width": words.number(1e3 * job.bridges.width, "g")}
    if job.bridges.command is None:
        return words("bridges.hand", **values)
    return f"{words('bridges.machine', command=job.bridges.command, **values)}. {words('bridges.time')}"


def _collision_words(outline: BentOutline, job: BenderJob, words: SheetWords) -> str:
    """Say how often the part meets something, and in which lines."""
    hits = outline.run.collisions
    if not hits:
        return words("collisions.none")
    numbers = job.numbering.numbers(outline.program.blocks)[outline.program.bend_blocks()]
    lines = [f"N{numbers[hit.bend]:03d}" for hit in hits[:_MOST_LINES]] + ["…"] * (len(hits) > _MOST_LINES)
    return words("collisions.value", count=str(len(hits)), lines=", ".join(lines))


def _outline_data(outline: BentOutline, style: str, result: BentDrawing, words: SheetWords) -> dict[str, Any]:
    proof, gain, number = outline.proof, 1 - outline.run.times.total / outline.run.paper_times.total, words.number
    closing = proof.closing_error
    paper = {"paper": str(outline.paper.bends), "error": number(1e3 * outline.paper.chord_error, ".3f")}
    deviation = {
        "value": number(1e3 * proof.deviation, ".4f"),
        "allowed": number(1e3 * (outline.plan.chord_error + ROUNDING), ".4f"),
    }
    cycle = {
        "time": number(outline.run.times.total, ".2f"),
        "paper": number(outline.run.paper_times.total, ".2f"),
        "change": number(-100 * gain, "+.1f"),
    }
    over = {
        "feed": number(1e3 * outline.run.feed_overshoot[0], ".4f"),
        "mould": number(float(np.degrees(outline.run.mould_overshoot[0])), ".4f"),
    }
    bridges = bridge_rows(outline, result.job)
    return {
        "name": outline.program.name,
        "source": words.said(outline.plan.outline.name),
        "sha256": outline.sha256,
        "facts": [
            [words("style"), style],
            [words("bends"), words("bends.value", count=str(outline.plan.bends), **paper)],
            [words("length"), f"{number(1e3 * proof.rule_length, '.3f')} mm"],
            [words("deviation"), words("deviation.value", **deviation)],
            [words("closing"), words("closing.open") if closing is None else f"{number(1e3 * closing, '.4f')} mm"],
            [words("cycle"), words("cycle.value", **cycle)],
            [words("overshoot"), words("overshoot.value", **over)],
            [words("collisions"), _collision_words(outline, result.job, words)],
            [words("bridges"), _bridge_words(len(outline.bridges), result.job, words)],
        ],
        "bends": [_row(row, words) for row in bend_rows(outline, result.job, _MOST_ROWS)],
        "left_out": max(0, outline.plan.bends - _MOST_ROWS),
        "last_feed": number(outline.program.feeds[-1] / 1e3, ".3f"),
        "bridges": [_bridge_row(row, words) for row in bridges[:_MOST_ROWS]],
        "bridges_left_out": max(0, len(bridges) - _MOST_ROWS),
    }


def _row(row: tuple[Any, ...], words: SheetWords) -> list[str]:
    number = words.number
    bend, line, feed, turn, radius, mould, springback, *_ = row
    return [
        str(bend),
        f"N{line:03d}",
        number(feed, ".3f"),
        f"{number(abs(turn), '.3f')} {words('left' if turn > 0 else 'right')}",
        words("corner") if math.isinf(radius) else number(radius, ".3f"),
        number(abs(mould), ".3f"),
        number(springback, "+.3f"),
    ]


def _bridge_row(row: BridgeRow, words: SheetWords) -> list[str]:
    return [
        str(row.number),
        str(row.after) if row.after else words("start"),
        words.number(row.begin, ".3f"),
        words.number(row.end, ".3f"),
        words.number(row.middle, ".3f"),
        words("by_hand") if row.line is None else f"N{row.line:03d}",
    ]


def write_sheet(result: BentDrawing, directory: Path, figures: list[Path], language: Language) -> None:
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
    data = sheet_data(result, language)
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
