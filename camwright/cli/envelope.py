"""The command ``camwright envelope``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from camwright.house.output import Voice

if TYPE_CHECKING:
    from rich.console import RenderableType


def envelope(
    job: Annotated[Path, typer.Argument(metavar="JOB", help="Job file (TOML).")],
    points: Annotated[
        int, typer.Option("--points", metavar="N", min=2, max=200, help="Number of cut lengths, and of line speeds.")
    ] = 15,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="Output directory; out/<name> if left out.")
    ] = None,
    no_figures: Annotated[bool, typer.Option("--no-figures", help="Write no figure.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object instead of a table.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Print neither table nor progress.")] = False,
) -> int:
    """Map which cut lengths and line speeds are possible, with which return, and what binds."""
    from camwright.house.files import staged
    from camwright.jobs.job import load_job
    from camwright.studies.envelope import envelope_answer

    asked = load_job(job)
    directory = Path("out") / asked.name if out is None else out
    voice = Voice(as_json, quiet)
    with voice.progress(points * (points + 1)) as step:
        answer = envelope_answer(asked, points, step)
    texts = answer.files()
    with staged(directory) as aside:
        for name, text in texts.items():
            (aside / name).write_bytes(text.encode())
        if not no_figures:
            from camwright.figures.envelope import envelope_figure

            envelope_figure(answer, aside)
        files = [directory / name for name in sorted(file.name for file in aside.iterdir())]

    def data() -> dict[str, Any]:
        return {**answer.to_dict(), "files": [str(file) for file in files]}

    def view() -> RenderableType:
        from rich.console import Group

        from camwright.cli.views import files_view

        return Group(answer.view(), files_view(files))

    voice.answer(data, view)
    return 0
