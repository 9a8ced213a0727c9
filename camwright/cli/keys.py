"""The command ``camwright keys``."""

from __future__ import annotations

from dataclasses import asdict
from typing import Annotated

import typer

from camwright.cli.options import Json, Quiet
from camwright.cli.views.parts import View, new_table, new_text
from camwright.house.output import Voice
from camwright.jobs.keys import JobKey, find_keys, job_keys
from camwright.profiles.errors import InputError


def run(
    key: Annotated[
        str | None, typer.Argument(metavar="[KEY]", help='A key, a table, or a place: "length", "servo", "cut.length".')
    ] = None,
    as_json: Json = False,
    quiet: Quiet = False,
) -> int:
    """List the keys of a job file: what each takes, its default, what it means and what uses it."""
    found = job_keys() if key is None else find_keys(key)
    if not found:
        raise InputError(f"a job file has no key or table {key!r}; camwright keys lists them all")
    Voice(as_json, quiet).answer(
        lambda: {"keys": [{"path": each.path, **asdict(each)} for each in found]}, lambda: _view(found)
    )
    return 0


def _view(keys: tuple[JobKey, ...]) -> View:
    """Show keys as a table."""
    heads = ("key", "takes", "default", "meaning", "used in")
    table = new_table(headings=heads, left=heads, show_lines=True)
    for key in keys:
        place = f"[{key.table}] {key.name}" if key.table else key.name
        default = "required" if key.required else key.default or "none"
        of = f"\n{key.machine}" if key.machine else ""
        table.add_row(
            new_text(place + of),
            new_text(f"{key.takes}, e.g. {key.example}"),
            new_text(default),
            key.meaning,
            key.used_in,
        )
    return table
