"""The command ``camwright targets``."""

from __future__ import annotations

import json
from typing import Any

import typer

from camwright.cli.options import Json, Quiet
from camwright.cli.views.parts import View, new_table
from camwright.drives.export import targets_answer
from camwright.house.output import Voice


def run(as_json: Json = False, quiet: Quiet = False) -> int:
    """List the targets: limits, interpolation, evidence, and what was never tested on a controller."""
    answer = targets_answer()
    if as_json:
        typer.echo(json.dumps(answer, allow_nan=False))
    else:
        Voice(as_json=False, quiet=quiet).answer(dict, lambda: _view(answer))
    return 0


def _view(answer: list[dict[str, Any]]) -> View:
    """Show the targets."""
    heads = ("name", "what", "interpolation", "points", "numbers", "evidence")
    left = [head for head in heads if head != "points"]
    table = new_table("Targets; none was tested on a controller", heads, left, show_lines=True)
    for entry in answer:
        table.add_row(
            entry["name"],
            entry["title"],
            entry["interpolation"],
            "–" if entry["max_points"] is None else str(entry["max_points"]),
            entry["number_format"],
            entry["evidence"],
        )
    return table
