"""The command ``camwright examples``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from camwright.cli.options import Json, Quiet
from camwright.cli.views.parts import View, files_view, new_table
from camwright.house.files import write_files
from camwright.house.output import Voice
from camwright.jobs.examples import Example, example, examples
from camwright.profiles.errors import InputError


def run(
    name: Annotated[str | None, typer.Argument(metavar="[NAME]", help="Write this example.")] = None,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="Where to write it; here if left out.")
    ] = None,
    as_json: Json = False,
    quiet: Quiet = False,
) -> int:
    """List the example jobs, or write one as a file."""
    voice = Voice(as_json, quiet)
    if name is None:
        found = examples()
        listed = [{"name": each.name, "machine": each.machine, "about": each.about} for each in found.values()]
        voice.answer(lambda: {"examples": listed}, lambda: _view(list(found.values())))
        return 0
    one, directory = example(name), Path() if out is None else out
    file = directory / one.path.name
    if file.exists() or file.is_symlink():
        raise InputError(f"{file}: there already; name another directory with --out")
    write_files(directory, {file.name: one.path.read_bytes()})
    voice.answer(lambda: {"files": [str(file)]}, lambda: files_view([file]))
    return 0


def _view(found: list[Example]) -> View:
    """Show the examples."""
    heads = ("name", "machine", "about")
    table = new_table("Example jobs: camwright examples NAME writes one here", heads, heads, show_lines=True)
    for each in found:
        table.add_row(each.name, each.machine, each.about)
    return table
