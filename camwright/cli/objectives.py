"""What ``camwright compare --objectives`` does: the trade-off of all objectives and laws."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from camwright.house.output import Voice

if TYPE_CHECKING:
    from rich.console import RenderableType

    from camwright.jobs.job import Job


def compare_objectives(asked: Job, directory: Path, *, figures: bool, voice: Voice) -> int:
    """Solve a job for every objective, print the trade-off, and draw it.

    Parameters
    ----------
    asked
        The job.
    directory
        Where the figure goes: ``tradeoff.svg`` and ``tradeoff.png``.
    figures
        Whether to draw it.
    voice
        How to answer.

    Returns
    -------
    int
        Exit code: 0.
    """
    from camwright.house.files import staged
    from camwright.studies.tradeoff import (
        step_count,
        trade_off,
        tradeoff_answer,
        tradeoff_view,
    )

    files: list[Path] = []
    with voice.progress(step_count(asked) + 1) as step:
        result = trade_off(asked, step)
        if figures:
            from camwright.figures import tradeoff_figures

            step("writing files")
            with staged(directory) as aside:
                files = [directory / file.name for file in sorted(tradeoff_figures(result, aside))]

    def view() -> RenderableType:
        from rich.console import Group

        from camwright.cli.views import files_view

        return Group(tradeoff_view(result), files_view(files))

    voice.answer(lambda: tradeoff_answer(result, files), view)
    return 0
