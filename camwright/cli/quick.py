"""The command ``camwright quick``."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import Annotated, Any

import typer

from camwright.cli.options import Json, Quiet
from camwright.cli.views.files import files_view
from camwright.cli.views.parts import View, new_table, stacked
from camwright.house.output import Voice, complain
from camwright.house.owned import Work, write_owned
from camwright.studies.quick import QuickAnswer, quick_answer, quick_cam_text, read_cross_cut


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
    answer = quick_answer(cut)
    file: Path | None = None
    if out is not None:
        file = out / "cam.csv"
        text = quick_cam_text(cut)
        work = Work("quick", "cross-cutter", hashlib.sha256(text.encode()).hexdigest())
        write_owned(out, work, {file.name: text}, complain)

    def data() -> dict[str, Any]:
        return answer.to_dict() if file is None else {**answer.to_dict(), "files": [str(file)]}

    Voice(as_json, quiet).answer(
        data, lambda: _view(answer) if file is None else stacked(_view(answer), files_view([file]))
    )
    return 0


def _view(answer: QuickAnswer) -> View:
    """Show what the cam is like."""
    table = new_table("Cross-cutter, quintic cam", show_header=False)
    for row in answer.rows():
        table.add_row(*row)
    return table
