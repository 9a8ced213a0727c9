"""Reading a settings file: a job's, a bender's, a table of springback; all its faults at once, in plain words."""

from __future__ import annotations

import difflib
import json
from collections.abc import Sequence
from typing import Any, TypeVar, get_args, get_origin

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from camwright.house.setting_fields import Path, Settings, Table, table_place, tables_in
from camwright.house.unit_keys import plain_keys
from camwright.house.units import shown

File = TypeVar("File", bound=Table)


def read_settings(model: type[File], data: dict[str, Any], settings: Settings) -> tuple[File | None, list[str]]:
    """Check the structure and every single value of a settings file.

    Parameters
    ----------
    model
        What the file holds.
    data
        What the TOML file holds.
    settings
        Is told what is right in itself.

    Returns
    -------
    (file, faults)
        The file, or nothing if it has faults; one message for each fault, each with its place.
    """
    data, faults = plain_keys(model, data)
    try:
        file = model.model_validate(data, context=settings)
    except ValidationError as error:
        return None, faults + [_fault(entry, model, settings) for entry in error.errors(include_url=False)]
    return None if faults else file, faults


def _fault(error: ErrorDetails, model: type[Table], settings: Settings) -> str:
    """Say what is wrong, where, and the way out."""
    path, table, inner = _resolved(model, error["loc"])
    kind, value = error["type"], error["input"]
    several = bool(inner) and isinstance(path[-1], str) and get_origin(table.model_fields[path[-1]].annotation) is list
    where = f"[[{path[-1]}]]" if several else _where(path, is_table=bool(inner))
    if kind in ("union_tag_not_found", "union_tag_invalid"):
        return _tag_fault(error, where, inner)
    if several:
        more = f"add one table [[{path[-1]}]] or more"
        return f"{where}: missing; {more}" if kind == "missing" else f"{where} = {shown(value)}: not tables; {more}"
    if kind == "missing":
        return f"{where}: missing; {_advice(path, table, inner, settings)}"
    if kind == "extra_forbidden":
        return _key_fault(path, list(table.model_fields))
    if kind == "value":
        return f"{where}{': ' if isinstance(path[-1], int) else ' = '}{error['msg']}"
    if kind == "literal_error":
        allowed = str(error["ctx"]["expected"]).replace("'", '"')
        return f"{where} = {shown(value)}: not known; write {allowed}"
    if kind == "bool_type":
        return f"{where} = {shown(value)}: neither true nor false; write true or false without quotes"
    if kind == "list_type":
        return f"{where} = {shown(value)}: not a list of rows"
    names = ".".join(str(part) for part in path)
    return f"{where} = {shown(value)}: not a table; write [{names}] on a line of its own and its keys below"


def _tag_fault(error: ErrorDetails, where: str, inner: list[type[Table]]) -> str:
    """Say that the key which tells what a table is, as a machine's kind, is missing or not known."""
    tag, words = _plain(error["ctx"]["discriminator"]), _plain(error["ctx"].get("expected_tags", ""))
    if error["type"] == "union_tag_not_found":
        return f'{where} {tag}: missing; add e.g. {tag} = "{_tags(inner[0], tag)[0]}"'
    return f"{where} {tag} = {shown(error['input'][tag])}: not known; write {_choice(words.split(', '))}"


def _key_fault(path: Path, known: list[str]) -> str:
    """Say that there is no such key, and which are known."""
    key, before = str(path[-1]), f"{table_place(path[:-1])} " if path[:-1] else ""
    near = difflib.get_close_matches(key[:100], known, n=1, cutoff=0.5)
    advice = f"did you mean {near[0]}?" if near else f"the keys here are {', '.join(known)}"
    return f"{before}{shown(key)[1:-1]}: there is no such key; {advice}"


def _resolved(model: type[Table], location: Sequence[str | int]) -> tuple[Path, type[Table], list[type[Table]]]:
    """Follow the location of a fault through the models.

    Returns
    -------
    (path, table, inner)
        The path in the file, without the words by which tables of several kinds are told apart; the model of the table
        that the fault stands in; the models of tables that the place itself may hold.
    """
    path: Path = []
    table, inner = model, [model]
    for part in location:
        if isinstance(part, int):
            path.append(part)
        elif len(inner) > 1:  # pydantic puts the kind of a table between the table and the key
            inner = [each for each in inner if any(part in get_args(f.annotation) for f in each.model_fields.values())]
        else:
            path.append(part)
            table = inner[0]
            inner = tables_in(table.model_fields[part].annotation) if part in table.model_fields else []
    return path, table, inner


def _tags(table: type[Table], key: str) -> tuple[str, ...]:
    """Words of a key by which tables are told apart."""
    return get_args(table.model_fields[key].annotation)


def _where(path: Path, *, is_table: bool) -> str:
    """Write the place of a key or table."""
    if isinstance(path[-1], int):
        return table_place(path) if is_table else f"{_where(path[:-1], is_table=False)}, row {path[-1] + 1}"
    if not path[:-1]:
        return table_place(path) if is_table else str(path[-1])
    return f"{table_place(path[:-1])} {path[-1]}"


def _advice(path: Path, table: type[Table], inner: list[type[Table]], settings: Settings) -> str:
    """Say what to write for a key or table that is missing."""
    key = str(path[-1])
    if inner:
        return f"add the table {table_place(path)}"
    entry = table.model_json_schema()["properties"][key]
    examples = entry.get("examples", entry.get("enum"))
    return (
        f"add e.g. {key} = {json.dumps(settings.example('.'.join(map(str, path)), examples))}" if examples else "add it"
    )


def _plain(text: str) -> str:
    """Take the quotes off words that pydantic names."""
    return str(text).replace("'", "")


def _choice(words: list[str]) -> str:
    """Write words to choose from."""
    quoted = [f'"{word}"' for word in words]
    return f"{', '.join(quoted[:-1])} or {quoted[-1]}"
