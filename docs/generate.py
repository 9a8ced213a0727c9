"""Writes the pages and the schemas that are made from the code: ``python docs/generate.py``.

A test says when they are no longer what the code says.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from importlib import import_module
from itertools import groupby
from pathlib import Path
from typing import Any

import typer
from typer.main import get_command

from camwright.cli.commands import COMMANDS
from camwright.jobs.keys import JobKey, job_keys
from camwright.jobs.structure import job_schema
from camwright.stored.design_file import design_schema

HERE = Path(__file__).parent
SCHEMAS = HERE.parent / "camwright" / "schemas"


def pages() -> dict[Path, str]:
    """Make every generated page, and the schemas of job files and of design.json."""
    return {
        SCHEMAS / "job.schema.json": json.dumps(job_schema(), indent=2) + "\n",
        SCHEMAS / "design.schema.json": json.dumps(design_schema(), indent=2) + "\n",
        HERE / "reference" / "keys.md": "\n".join(_keys()) + "\n",
        HERE / "reference" / "commands.md": "\n".join(_commands()) + "\n",
    }


def _keys() -> Iterator[str]:
    """Write the keys of a job file, a section each table."""
    yield "# Keys of a job file"
    yield ""
    yield "Made from the schema of job files. `camwright keys KEY` prints the same; `camwright new` writes a file with all of them."
    for (table, machine), group in groupby(job_keys(), lambda key: (key.table, key.machine)):
        keys = list(group)
        yield ""
        yield f"## {_place(table, machine)}"
        yield ""
        yield "| key | takes | default | meaning | used in |"
        yield "|---|---|---|---|---|"
        for key in keys:
            yield _row(key)


def _place(table: str, machine: str) -> str:
    """Name a table."""
    if not table:
        return "At the top of the file"
    return f"`[{table}]` of a `{machine}`" if machine else f"`[{table}]`"


def _row(key: JobKey) -> str:
    """Write a key as a row."""
    default = "required" if key.required else f"`{key.default}`" if key.default else "none"
    return f"| `{key.name}` | {key.takes}, e.g. `{key.example}` | {default} | {key.meaning} | {key.used_in} |"


def _commands() -> Iterator[str]:
    """Write the commands with their arguments and options."""
    yield "# Commands"
    yield ""
    yield "Made from the command line. `camwright COMMAND --help` prints the same."
    for name, command in COMMANDS.items():
        application = typer.Typer()
        application.command(name)(import_module(f"camwright.cli.{name}").run)
        yield ""
        yield f"## `camwright {name}`"
        yield ""
        yield command.does
        yield ""
        yield f"    {command.example}"
        yield ""
        yield "| argument or option | meaning |"
        yield "|---|---|"
        for parameter in get_command(application).params:
            if parameter.name in ("install_completion", "show_completion"):
                continue
            yield f"| {_named(parameter)} | {_text(parameter)} |"


def _named(parameter: Any) -> str:
    """Write how a parameter is given."""
    if parameter.param_type_name == "argument":
        return f"`{parameter.metavar or parameter.name.upper()}`"
    takes = "" if parameter.is_flag else f" `{parameter.metavar or parameter.name.upper()}`"
    return ", ".join(f"`{each}`" for each in parameter.opts) + takes


def _text(parameter: Any) -> str:
    """Write what an option means, in one line."""
    return " ".join((parameter.help or "").split()).replace("\\[", "[").replace("|", "\\|")


if __name__ == "__main__":
    for path, text in pages().items():
        path.write_text(text, encoding="utf-8")
