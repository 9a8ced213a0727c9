"""The command ``camwright verify``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from camwright.cli.options import Json, Quiet
from camwright.cli.views.parts import View, new_table, new_text, stacked
from camwright.house.output import Voice
from camwright.recipes.family_verify import is_family
from camwright.recipes.verify import Verified, examine, verify_answer


def run(
    directory: Annotated[Path, typer.Argument(metavar="DIR", help="The folder of a recipe, or of a family of cams.")],
    key: Annotated[
        Path | None,
        typer.Option("--key", metavar="PUB", help="Public key (PEM) of who must have signed it with recipe --sign."),
    ] = None,
    as_json: Json = False,
    quiet: Quiet = False,
) -> int:
    """Prove that the folder of a recipe or a family is what was written, and its sheet the cams'; of a recipe the tables, too."""
    voice = Voice(as_json, quiet)
    with voice.progress(1) as step:
        step("checking")
        found = examine(directory, key)
    voice.answer(lambda: verify_answer(found), lambda: _view(directory, found))
    return 1 if found.faults else 0


def _view(directory: Path, found: Verified) -> View:
    notes = [new_text(f"Note: {note.file}: {note.what}") for note in found.notes]
    if not found.faults:
        promised = "sheet says what its cams do" if is_family(directory) else "tables are the motion that it promises"
        head = f"{directory}: as it was written; its {promised}"
        return stacked(new_text("\n- ".join((head, *found.proved))), *notes)
    heads = ("file", "what is wrong")
    table = new_table(new_text(f"{directory}: NOT as it was written"), heads, heads)
    for fault in found.faults:
        table.add_row(new_text(fault.file), new_text(fault.what))
    return stacked(table, *notes)
