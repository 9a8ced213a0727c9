"""The command ``camwright identify``."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer

from camwright.cli.options import Json, Quiet, TraceColumns, option_quantity
from camwright.cli.views.parts import View, files_view, new_table, new_text, stacked
from camwright.house.files import read_bytes, require_plain, write_files
from camwright.house.numbers import number
from camwright.house.output import Voice
from camwright.profiles.errors import InputError
from camwright.profiles.trace import Trace
from camwright.studies.identification import (
    FIT,
    identify_answer,
    identify_file,
    is_servo_text,
    one_line,
    origin_of,
    parameters_of,
    range_text,
    residual_unit,
    rounded,
    servo_text,
)
from camwright.validation.identify.identification import Identified

_MOST_BYTES = 2**20


def run(
    trace: Annotated[
        Path,
        typer.Argument(metavar="TRACE", help="Recorded trace: CSV with time, command and actual, each with its unit."),
    ],
    out: Annotated[
        Path | None,
        typer.Option(
            "--out", metavar="FILE", help=r"Write the \[servo] table of a job file here; no file if left out."
        ),
    ] = None,
    velocity_feedforward: Annotated[
        float | None,
        typer.Option(
            "--velocity-feedforward",
            metavar="SHARE",
            help="Velocity feed-forward set in the drive; fitted if left out.",
        ),
    ] = None,
    acceleration_feedforward: Annotated[
        str | None,
        typer.Option(
            "--acceleration-feedforward",
            metavar="VALUE",
            help="Acceleration feed-forward set in the drive, e.g. 330 ms^2, or fit; 0 if left out.",
        ),
    ] = None,
    jerk_feedforward: Annotated[
        str | None,
        typer.Option(
            "--jerk-feedforward",
            metavar="VALUE",
            help="Jerk feed-forward set in the drive, e.g. 2000 ms^3, or fit; 0 if left out.",
        ),
    ] = None,
    columns: TraceColumns = None,
    as_json: Json = False,
    quiet: Quiet = False,
) -> int:
    """Find the servo's parameters from a recorded trace."""
    if out is not None and (out.is_dir() or not out.name):
        raise InputError(f"{out}: a directory; --out names the file to write, e.g. servo.toml")
    if out is not None:
        _require_ours(out)
    beyond = {
        **_fed("acceleration_feedforward", acceleration_feedforward, "time squared", "330 ms^2"),
        **_fed("jerk_feedforward", jerk_feedforward, "time cubed", "2000 ms^3"),
    }
    voice = Voice(as_json, quiet)
    with voice.progress(1) as step:
        step("fitting the servo")
        recorded, found = identify_file(trace, velocity_feedforward, beyond, columns)
    files: list[Path] = []
    if out is not None:
        files = write_files(out.parent, {out.name: servo_text(trace, recorded, found)})

    voice.answer(lambda: identify_answer(trace, recorded, found, files), lambda: _view(trace, recorded, found, files))
    return 0


def _fed(name: str, text: str | None, kind: str, example: str) -> dict[str, float | None]:
    """Read an option of feed-forward: what is set, nothing known where it is to be fitted, or no entry where it is left out."""
    if text is None:
        return {}
    if text.strip() == FIT:
        return {name: None}
    return {name: option_quantity(f"--{name.replace('_', '-')}", text, kind, zero=True, example=example)}


def _require_ours(out: Path) -> None:
    """Refuse to write over a file that identify did not write, or that was changed since.

    Raises
    ------
    InputError
        Such a file, a link or a device is there.
    """
    require_plain(out.parent, [out.name])
    if os.path.lexists(out) and not is_servo_text(read_bytes(out, "servo file", _MOST_BYTES)):
        raise InputError(
            f"{out}: there already, and not as camwright identify wrote it; it is not overwritten: name another file with --out"
        )


def _view(path: Path, trace: Trace, found: Identified, files: Sequence[Path]) -> View:
    """Show the servo, how well it is known, and how well it fits."""
    scale, unit = residual_unit(trace)
    heads = ("parameter", "value", "unit", "95 % confidence")
    table = new_table(f"Servo of {one_line(path.name)}", heads, {*heads} - {"value"})
    for name, (_, symbol, factor, written) in parameters_of(found).items():
        value, bounds = getattr(found.servo, name) * factor, found.confidence.get(name)
        spread = 0.0 if bounds is None else 0.5 * factor * (bounds[1] - bounds[0])
        note = origin_of(found, name) if bounds is None else range_text(bounds, factor, "")
        words = name.replace("_", " ")
        table.add_row(words if symbol == words else f"{words} {symbol}", rounded(value, spread), written, note)
    ending = f"fit {found.fit:.6f}, residual {number(found.residual * scale, 3)} {unit} rms over {found.rows} rows"
    notes = [new_text(f"Note: {note}") for note in found.notes]
    return stacked(table, new_text(ending), *notes, *([files_view(files)] if files else []))
