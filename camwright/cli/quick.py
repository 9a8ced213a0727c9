"""The command ``camwright quick``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from camwright.house.output import Voice

if TYPE_CHECKING:
    from rich.console import RenderableType


def quick(
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
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object instead of a table.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Print nothing.")] = False,
) -> int:
    """Make the patent's quintic cam of a rotary cross-cutter from three lengths."""
    from camwright.house.files import staged
    from camwright.studies.quick import quick_answer, quick_cam_text, read_cross_cut

    cut = read_cross_cut(circumference, sync, length)
    answer = quick_answer(cut)
    file: Path | None = None
    if out is not None:
        file = out / "cam.csv"
        with staged(out) as aside:
            (aside / file.name).write_bytes(quick_cam_text(cut).encode())

    def data() -> dict[str, Any]:
        return answer.to_dict() if file is None else {**answer.to_dict(), "files": [str(file)]}

    def view() -> RenderableType:
        from rich.console import Group

        from camwright.cli.views import files_view

        return answer.view() if file is None else Group(answer.view(), files_view([file]))

    Voice(as_json, quiet).answer(data, view)
    return 0
