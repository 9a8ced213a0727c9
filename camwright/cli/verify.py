"""The command ``camwright verify``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from camwright.cli.options import Json, Quiet
from camwright.cli.views.parts import new_table, new_text
from camwright.house.output import Voice
from camwright.recipes.verify import Fault, verify, verify_answer

if TYPE_CHECKING:
    from rich.console import RenderableType


def run(
    directory: Annotated[Path, typer.Argument(metavar="DIR", help="A recipe folder.")],
    as_json: Json = False,
    quiet: Quiet = False,
) -> int:
    """Prove that a recipe folder is what was written, and that its tables are the motion that it promises."""
    voice = Voice(as_json, quiet)
    with voice.progress(1) as step:
        step("checking")
        faults = verify(directory)
    voice.answer(lambda: verify_answer(faults), lambda: _view(directory, faults))
    return 1 if faults else 0


def _view(directory: Path, faults: list[Fault]) -> RenderableType:
    if not faults:
        return new_text(f"{directory}: as it was written; its tables are the motion that it promises")
    table = new_table(title=new_text(f"{directory}: NOT as it was written"), title_justify="left")
    table.add_column("file")
    table.add_column("what is wrong")
    for fault in faults:
        table.add_row(new_text(fault.file), new_text(fault.what))
    return table
