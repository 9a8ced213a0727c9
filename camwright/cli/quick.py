"""The command ``camwright quick``."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import Annotated

import typer

from camwright.answers.measures import with_files
from camwright.cli.options import Json, Quiet
from camwright.cli.views.parts import View, files_view, new_table, stacked
from camwright.house.output import Voice, complain
from camwright.house.owned import Work, write_owned
from camwright.profiles.cross_cutter import CrossCut
from camwright.studies.quick import quick_answer, quick_cam_text, quick_rows, read_cross_cut


def run(
    circumference: Annotated[
        str, typer.Option("--circumference", metavar="LENGTH", help='Circumference of the knife, e.g. "400 mm".')
    ],
    sync: Annotated[
        str,
        typer.Option("--sync", metavar="LENGTH", help="Length of the sync zone, half of it on each side of the cut."),
    ],
    length: Annotated[str, typer.Option("--length", metavar="LENGTH", help="Cut length.")],
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="Write cam.csv here; no file if left out.")
    ] = None,
    as_json: Json = False,
    quiet: Quiet = False,
) -> int:
    """Make the patent's quintic cam of a rotary cross-cutter from three lengths."""
    cut = read_cross_cut(circumference, sync, length)
    files: list[Path] = []
    if out is not None:
        text = quick_cam_text(cut)
        work = Work("quick", "cross-cutter", hashlib.sha256(text.encode()).hexdigest())
        files = write_owned(out, work, {"cam.csv": text}, complain)
    answer = quick_answer(cut)
    Voice(as_json, quiet).answer(
        lambda: with_files(answer, files) if files else answer,
        lambda: stacked(_view(cut), files_view(files)) if files else _view(cut),
    )
    return 0


def _view(cut: CrossCut) -> View:
    """Show what the cam is like."""
    table = new_table("Cross-cutter, quintic cam", show_header=False)
    for row in quick_rows(cut):
        table.add_row(*row)
    return table
