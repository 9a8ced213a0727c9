"""The command ``camwright bend``."""

from __future__ import annotations

import hashlib
import math
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Literal

import typer

from camwright.bender.answer import BentDrawing, answer, calibration_answer, check_words, size_words
from camwright.bender.bend_list import csv_text
from camwright.bender.calibration import Calibration, calibrate, residuals_text
from camwright.bender.catalogue import sheet_words
from camwright.bender.drawing import Reading, read_drawing
from camwright.bender.dxf_styles import style_choice
from camwright.bender.figures import draw
from camwright.bender.job import BenderJob, load_bender
from camwright.bender.program_file import bend_outlines
from camwright.bender.sending import End, Parity, SerialLine, send, transfer
from camwright.bender.sheet import write_sheet
from camwright.cli.options import Json, Quiet
from camwright.cli.views.parts import View, new_table, new_text, stacked
from camwright.house.files import is_device_name
from camwright.house.language import Language
from camwright.house.output import Voice, complain
from camwright.house.owned import Work, owned, write_owned
from camwright.house.progress import Step
from camwright.profiles.bender.bridges import BridgeRule
from camwright.profiles.errors import InputError
from camwright.profiles.notice import Notice

_MOST_FIGURES = 20
_MOST_ROWS = 40


def run(
    drawing: Annotated[Path | None, typer.Argument(metavar="[DRAWING]", help="Die lines (DXF or CFF2).")] = None,
    job: Annotated[
        Path | None, typer.Option("--job", metavar="BENDER", help="Bender job (TOML); the bundled bender if left out.")
    ] = None,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="Output directory; out/<drawing> if left out.")
    ] = None,
    layer: Annotated[str | None, typer.Option("--layer", metavar="NAME", help="Bend this layer only.")] = None,
    style: Annotated[
        str | None,
        typer.Option("--style", metavar="STYLE", help="Bend lines of this style only, e.g. layer=CUT,colour=1."),
    ] = None,
    styles: Annotated[
        Literal["one", "all"],
        typer.Option("--styles", help="Bend one style; or all of them, each for itself."),
    ] = "one",
    overlaps: Annotated[
        Literal["merge", "refuse"],
        typer.Option("--overlaps", help="Lines that lie on each other: use them once, or refuse the drawing."),
    ] = "merge",
    arcs: Annotated[
        Literal["find", "keep"],
        typer.Option("--arcs", help="Chords that lie on an arc: bend that arc, or keep them as drawn."),
    ] = "find",
    start: Annotated[
        str | None, typer.Option("--start", metavar="X,Y", help="Begin at the vertex nearest to this place (mm).")
    ] = None,
    reverse: Annotated[bool, typer.Option("--reverse", help="Bend each outline from its other end.")] = False,
    language: Annotated[Language, typer.Option("--language", help="Language of the bending sheet.")] = "en",
    bridges: Annotated[
        str | None,
        typer.Option(
            "--bridges", metavar="WIDTH@SPACING", help="Bridges of this width, this far apart (mm), e.g. 6@100."
        ),
    ] = None,
    accept_collisions: Annotated[
        bool,
        typer.Option("--accept-collisions", help="Pass although the bent part meets the mould or the rule to come."),
    ] = False,
    measurements: Annotated[
        Path | None, typer.Option("--calibrate", metavar="CSV", help="Make a springback table from test bends instead.")
    ] = None,
    port: Annotated[
        str | None, typer.Option("--port", metavar="DEVICE", help="Send the programs over this serial line.")
    ] = None,
    baud: Annotated[int, typer.Option("--baud", min=50, max=4_000_000, help="Bits per second of the line.")] = 9600,
    handshake: Annotated[
        Literal["xonxoff", "rtscts"], typer.Option("--handshake", help="How the machine holds the line up.")
    ] = "xonxoff",
    data_bits: Annotated[int, typer.Option("--data-bits", min=7, max=8, help="Data bits of a character.")] = 8,
    parity: Annotated[Parity, typer.Option("--parity", help="Parity of a character.")] = "none",
    stop_bits: Annotated[int, typer.Option("--stop-bits", min=1, max=2, help="Stop bits of a character.")] = 1,
    attributes: Annotated[
        str | None,
        typer.Option("--attributes", metavar="LETTERS", help="In the header of a Fagor program; MX if left out."),
    ] = None,
    end: Annotated[
        End | None,
        typer.Option(
            "--end", help="Character that ends a program on the line; esc for Fagor and none for ISO if left out."
        ),
    ] = None,
    wait: Annotated[
        float | None,
        typer.Option("--wait", metavar="SECONDS", min=0, max=3600, help="Wait between programs, instead of asking."),
    ] = None,
    as_json: Json = False,
    no_figures: Annotated[bool, typer.Option("--no-figures", help="Write neither figures nor sheets.")] = False,
    quiet: Quiet = False,
) -> int:
    """Turn a drawing of die lines into proved NC programs of a rule bender."""
    voice = Voice(as_json, quiet)
    bender = load_bender(job)
    if measurements is not None:
        if drawing is not None:
            raise InputError("--calibrate makes a table and bends no drawing; leave the drawing out")
        return _calibrate(measurements, bender, out, voice)
    if drawing is None:
        raise InputError("no drawing is named; give a DXF or CFF2 file, or test bends with --calibrate")
    _require_name(drawing)
    if bridges is not None:
        bender = replace(bender, bridges=_bridges(bridges, bender.bridges))
    place = None if start is None else _place(start)
    choice = style_choice(style, layer, each=styles == "all")
    arc_error = bender.divide.allowed if arcs == "find" else None
    reading = Reading(
        bender.drawing.gap, bender.drawing.flattening, bender.units, choice, overlaps, arc_error, bender.bridges.layer
    )
    directory = Path("out") / drawing.stem if out is None else out
    with voice.progress(5) as step:
        result = replace(_bent(drawing, bender, reading, place, reverse, step), collisions_accepted=accept_collisions)
        names = _names(drawing.stem, len(result.outlines))
        programs = [directory / f"{name}.nc" for name in names]
        work = Work("bend", drawing.stem, result.sha256)
        files = _write(result, names, directory, work, language=None if no_figures else language, step=step)
    if port is not None and not result.passed:
        result = replace(result, notes=(*result.notes, Notice("nothing is sent to {port}: a check failed", port=port)))
    elif port is not None:
        line = SerialLine(port, baud, handshake, data_bits, parity, stop_bits)
        _send(result, line, lambda text: transfer(text, bender.flavour, attributes, end), wait, voice)
    voice.answer(lambda: answer(result, programs, files), lambda: _drawing_view(result, files))
    return 0 if result.passed else 1


def _require_name(file: Path) -> None:
    """Refuse a file whose name would name files that Windows takes for devices."""
    if is_device_name(file.name):
        raise InputError(
            f"{file}: Windows takes {file.stem} for a device, and the files are called after it; rename the file"
        )


def _send(
    result: BentDrawing, line: SerialLine, framed: Callable[[str], list[bytes]], wait: float | None, voice: Voice
) -> None:
    """Send the programs one at a time: the machine must be told to receive each.

    Raises
    ------
    InputError
        There are several, and neither a time to wait nor anybody to ask.
    """
    count = len(result.outlines)
    if count > 1 and wait is None and not sys.stdin.isatty():
        raise InputError(
            f"{count} programs are to be sent, and the machine takes one at a time: give the seconds between them with "
            "--wait, or run the command in a terminal, where it asks"
        )
    for number, outline in enumerate(result.outlines):
        name = outline.program.name
        if number and wait is not None:
            time.sleep(wait)
        elif number:
            typer.prompt(
                f"start the reception of {name} on the machine, then press Enter", "", show_default=False, err=True
            )
        rows = framed(outline.text)
        with voice.progress(len(rows) + 1) as step:
            send(rows, line, _counter(step, name, len(rows)))


def _counter(step: Step, name: str, lines: int) -> Callable[[int], None]:
    return lambda count: step(f"{name}: line {count} of {lines} sent")


def _place(text: str) -> tuple[float, float]:
    """Read ``--start``, in mm, into metres."""
    try:
        x, y = (1e-3 * float(part) for part in text.split(","))
    except ValueError:
        x = y = math.nan
    if not (math.isfinite(x) and math.isfinite(y)):
        raise InputError(f"--start {text!r}: not a place; write two numbers in mm, e.g. --start 12.5,0")
    return x, y


def _bridges(text: str, rule: BridgeRule) -> BridgeRule:
    """Read ``--bridges``, in mm; the tool is that of the job."""
    try:
        width, spacing = (1e-3 * float(part) for part in text.split("@"))
    except ValueError:
        width = spacing = math.nan
    if not (0 < width < spacing < math.inf):
        raise InputError(
            f"--bridges {text!r}: not a width and a greater spacing; write two numbers in mm, e.g. --bridges 6@100"
        )
    return replace(rule, width=width, spacing=spacing, at=(), layer=None)


def _names(stem: str, count: int) -> list[str]:
    return [stem] if count == 1 else [f"{stem}-{i + 1}" for i in range(count)]


def _bent(
    drawing: Path, bender: BenderJob, reading: Reading, place: tuple[float, float] | None, reverse: bool, step: Step
) -> BentDrawing:
    """Read a drawing and bend its outlines."""
    step("reading the drawing")
    found = read_drawing(drawing, reading)
    outlines = [outline.reverse() if reverse else outline for outline in found.outlines]
    if place is not None:
        outlines = [outline.begin_at(*place) for outline in outlines]
    step("writing and proving programs")
    marks = found.marks
    notes: tuple[str, ...] = ()
    if found.bridge_width and (bender.bridges.asked or bender.bridges.layer is not None):
        text = "the bridges that are asked for are taken, not the {count} of the file"
        marks, notes = (), (Notice(text, count=str(len(marks))),)
    elif found.bridge_width:
        bender = replace(bender, bridges=replace(bender.bridges, width=found.bridge_width))
    bent = bend_outlines(outlines, bender, drawing.stem, marks)
    return BentDrawing(drawing, hashlib.sha256(drawing.read_bytes()).hexdigest(), bender, found, bent, notes)


def _write(
    result: BentDrawing, names: list[str], directory: Path, work: Work, *, language: Language | None, step: Step
) -> list[Path]:
    """Write programs and bend lists, and in a language figures and sheets: all or none."""
    step("writing files")
    with owned(directory, work, complain) as aside:
        for name, outline in zip(names, result.outlines, strict=True):
            (aside / f"{name}.nc").write_bytes(outline.text.encode("ascii"))
            (aside / f"{name}-bends.csv").write_bytes(csv_text(outline, result.job).encode("ascii"))
        if language is not None:
            step("drawing figures")
            shown = names[:_MOST_FIGURES]
            for name, outline in zip(shown, result.outlines, strict=False):
                draw(outline, aside, name, sheet_words(language))
            step("typesetting the sheet")
            write_sheet(result, aside, [aside / f"{name}-proof.svg" for name in shown], language)
        return [directory / name for name in sorted(file.name for file in aside.iterdir())]


def _calibrate(measurements: Path, bender: BenderJob, out: Path | None, voice: Voice) -> int:
    """Make a springback table from test bends."""
    _require_name(measurements)
    result = calibrate(measurements, bender)
    directory = Path("out") / measurements.stem if out is None else out
    texts = {f"{measurements.stem}.toml": result.text, f"{measurements.stem}-residuals.csv": residuals_text(result)}
    work = Work("bend --calibrate", measurements.stem, hashlib.sha256(measurements.read_bytes()).hexdigest())
    files = write_owned(directory, work, texts, complain)
    voice.answer(lambda: calibration_answer(result, files), lambda: _calibration_view(result, files))
    return 0


def _drawing_view(result: BentDrawing, files: Sequence[Path]) -> View:
    """Show the programs of a drawing, their checks, warnings and files."""
    heads = (
        "program",
        "bends\n",
        "by the paper's\narc rule",
        "rule\nmm",
        "deviation\nmm",
        "closing\nmm",
        "cycle\ns",
        "sequential\ns",
        "gain\n%",
        "checks",
    )
    table = new_table(f"Programs of {result.drawing.name}", heads, left=("program", "checks"))
    for outline in result.outlines[:_MOST_ROWS]:
        proof, cycle, paper = outline.proof, outline.run.times.total, outline.run.paper_times.total
        failed = result.failed(outline)
        judged = new_text("FAILED", "bold red") if failed else new_text("passed", "green")
        if not failed and any(result.accepted(check) for check in outline.checks):
            judged = new_text("accepted", "yellow")
        table.add_row(
            outline.program.name,
            str(outline.plan.bends),
            str(outline.paper.bends),
            f"{1e3 * proof.rule_length:.3f}",
            f"{1e3 * proof.deviation:.4f}",
            "open" if proof.closing_error is None else f"{1e3 * proof.closing_error:.4f}",
            f"{cycle:.2f}",
            f"{paper:.2f}",
            f"{100 * (1 - cycle / paper):.1f}",
            judged,
        )
    more = len(result.outlines) - _MOST_ROWS
    notes = [new_text(f"{more} more programs are not shown")] if more > 0 else []
    notes += [new_text(f"the drawing is {size_words(result.found)} large, its unit is {result.found.unit}")]
    notes += [
        new_text(
            f"{outline.program.name}: {check.name} {check_words(check)}",
            "bold red",
        )
        for outline in result.outlines
        for check in result.failed(outline)
    ]
    notes += [new_text(f"warning: {text}", "yellow") for text in result.warnings]
    notes += [new_text(f"wrote {file}") for file in files]
    return stacked(table, *notes)


def _calibration_view(result: Calibration, files: Sequence[Path]) -> View:
    """Show the test bends with their residuals, and the files."""
    heads = ("row", "radius\nmm", "mould angle\n°", "measured\n°", "by the table\n°", "residual\n°")
    table = new_table(f"Test bends of {result.springback.name}", heads)
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
    notes = [new_text(f"{more} more test bends are in the residuals' file")] if more > 0 else []
    notes += [new_text(f"warning: {text}", "yellow") for text in result.springback.warnings()]
    return stacked(table, *notes, *(new_text(f"wrote {file}") for file in files))
