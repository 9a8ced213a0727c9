"""The command ``camwright identify``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from camwright.house.output import Voice
from camwright.profiles.errors import InputError

if TYPE_CHECKING:
    from rich.console import RenderableType


def identify(
    trace: Annotated[
        Path,
        typer.Argument(metavar="TRACE", help="Recorded trace: CSV with time, command and actual, each with its unit."),
    ],
    out: Annotated[
        Path | None,
        typer.Option("--out", metavar="FILE", help="Write the [servo] table of a job file here; no file if left out."),
    ] = None,
    velocity_feedforward: Annotated[
        float | None,
        typer.Option(
            "--velocity-feedforward",
            metavar="SHARE",
            help="Velocity feed-forward set in the drive; fitted if left out.",
        ),
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object instead of a table.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Print neither table nor progress.")] = False,
) -> int:
    """Find the servo's parameters from a recorded trace."""
    from camwright.house.files import staged
    from camwright.studies.identification import (
        identify_answer,
        identify_file,
        identify_view,
        servo_text,
    )

    if out is not None and (out.is_dir() or not out.name):
        raise InputError(f"{out}: a directory; --out names the file to write, e.g. servo.toml")
    voice = Voice(as_json, quiet)
    with voice.progress(1) as step:
        step("fitting the servo")
        recorded, found = identify_file(trace, velocity_feedforward)
    files: list[Path] = []
    if out is not None:
        with staged(out.parent) as aside:
            (aside / out.name).write_bytes(servo_text(trace, recorded, found).encode())
        files.append(out)

    def view() -> RenderableType:
        from rich.console import Group

        from camwright.cli.views import files_view

        shown = identify_view(trace, recorded, found)
        return Group(shown, files_view(files)) if files else shown

    voice.answer(lambda: identify_answer(trace, recorded, found, files), view)
    return 0
