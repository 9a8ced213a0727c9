"""Keys of settings files that name a unit, as ``length_mm``: the unit belongs to the value, so they are told and read as ``length``."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from functools import cache
from typing import Any, Literal, get_args, get_origin

from camwright.house.setting_fields import Path, Table, table_place, tables_in
from camwright.house.units import dimension_of, shown

_POWER = re.compile(r"(?<=[A-Za-z])([23])(?=[_/]|$)")


def plain_keys(model: type[Table], data: dict[str, Any]) -> tuple[dict[str, Any], list[str]]:
    """Rename the keys of a settings file that name a unit to those that the file has, with what is meant as their values.

    Parameters
    ----------
    model
        What the file holds.
    data
        What the TOML file holds.

    Returns
    -------
    (data, faults)
        The data with the file's own keys, so that nothing is told as missing that is there; one message for each renamed key.
    """
    faults: list[str] = []
    return _plain([model], data, [], faults), faults


def _plain(models: list[type[Table]], data: dict[str, Any], path: Path, faults: list[str]) -> dict[str, Any]:
    """Rename the keys of a table, and of the tables in it."""
    fields = [_tables_of(model) for model in _fitting(models, data)]
    found: dict[str, Any] = {}
    for key, value in data.items():
        tables = next((each[key] for each in reversed(fields) if key in each), None)
        if tables is not None:
            found[key] = _inside(tables, value, [*path, key], faults)
            continue
        name, meant, fault = _renamed(_fitting(models, data), key, value, data)
        found[name] = meant
        if fault:
            faults.append(f"{table_place(path)} {fault}" if path else fault)
    return found


def _inside(models: list[type[Table]], value: Any, path: Path, faults: list[str]) -> Any:
    """Rename the keys of a table or of a list of tables; anything else stays as it is."""
    if models and isinstance(value, dict):
        return _plain(models, value, path, faults)
    if models and isinstance(value, list):
        return [_inside(models, each, [*path, at], faults) for at, each in enumerate(value)]
    return value


def _fitting(models: list[type[Table]], data: dict[str, Any]) -> list[type[Table]]:
    """Choose among tables that are told apart by a word those whose word it is; all where none is."""

    def fits(model: type[Table]) -> bool:
        return all(key not in data or data[key] in words for key, words in _words_of(model).items())

    return [model for model in models if fits(model)] or models


@cache  # a book reads a job for every combination
def _tables_of(model: type[Table]) -> dict[str, list[type[Table]]]:
    """List the tables that each key of a table may hold."""
    return {key: tables_in(each.annotation) for key, each in model.model_fields.items()}


@cache
def _words_of(model: type[Table]) -> dict[str, tuple[Any, ...]]:
    """List the words that a table may hold under those of its keys that take nothing else."""
    fields = model.model_fields.items()
    return {key: get_args(each.annotation) for key, each in fields if get_origin(each.annotation) is Literal}


def _renamed(models: list[type[Table]], key: str, value: Any, data: dict[str, Any]) -> tuple[str, Any, str]:
    """Find the key that is meant, its value and what to say; the same and nothing where none is."""
    for name, examples in _quantities(models):
        if not key.startswith(f"{name}_") or name in data:
            continue
        named = {unit: dimension_of(f"1 {unit}") for unit in _units(key.removeprefix(f"{name}_"))}
        if not any(named.values()):
            continue
        wanted = [dimension_of(text) for example in examples for text in _texts(example)]
        meant = _meant(value, next((unit for unit, dimension in named.items() if dimension in wanted), None))
        advice = f"write {name} = {_shown(meant)}" if meant else f"write e.g. {name} = {_shown(examples[0])}"
        told = f"{key} = {shown(value)}: the key names a unit, which belongs to the value; {advice}"
        return name, meant or examples[0], told
    return key, value, ""


def _shown(value: str | list[str]) -> str:
    return json.dumps(value, ensure_ascii=False)


def _meant(value: Any, unit: str | None) -> str | list[str] | None:
    """Write what a key that names a unit was meant to be given; nothing where that is not clear."""
    if isinstance(value, list):
        each = [_meant(one, unit) for one in value]
        return [one for one in each if isinstance(one, str)] if all(isinstance(one, str) for one in each) else None
    if isinstance(value, str):
        return None if dimension_of(value) is None else value
    if isinstance(value, int | float) and not isinstance(value, bool) and unit is not None:
        return f"{value} {unit}"
    return None


def _quantities(models: list[type[Table]]) -> list[tuple[str, list[str | list[str]]]]:
    """List the keys of tables that take a number with a unit, or several, longer names first; and examples of their values."""
    found = [each for model in models for each in _quantities_of(model)]
    return sorted(found, key=lambda each: -len(each[0]))


@cache
def _quantities_of(model: type[Table]) -> list[tuple[str, list[str | list[str]]]]:
    entries = model.model_json_schema()["properties"]
    examples = {
        key: [each for each in entry.get("examples", []) if _is_quantity(each)] for key, entry in entries.items()
    }
    return [(key, each) for key, each in examples.items() if each]


def _is_quantity(example: Any) -> bool:
    return any(dimension_of(text) is not None for text in _texts(example))


def _texts(example: Any) -> list[str]:
    """List the texts of an example, one or several."""
    return [each for each in (example if isinstance(example, list) else [example]) if isinstance(each, str)]


def _units(end: str) -> Iterator[str]:
    """Read the end of a key as a unit: ``m_per_s2`` is m/s^2, ``kg_m2`` is kg m^2, ``m_min`` is m min or m/min."""
    text = _POWER.sub(r"^\1", f"_{end}".replace("_per_", "/").removeprefix("_"))
    text = f"1{text}" if text.startswith("/") else text
    yield text.replace("_", " ")
    if "_" in text:
        yield text.replace("_", "/", 1).replace("_", " ")
