"""The command ``camwright verify``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from camwright.cli.options import Json, Quiet
from camwright.house.output import Voice
from camwright.recipe.verify import Fault, verify, verify_answer


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
        return Text(f"{directory}: as it was written; its tables are the motion that it promises")
    table = Table(title=Text(f"{directory}: NOT as it was written"), title_justify="left")
    table.add_column("file")
    table.add_column("what is wrong")
    for fault in faults:
        table.add_row(Text(fault.file), Text(fault.what))
    return table
