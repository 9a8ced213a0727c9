"""The text of a TOML file, written from its data."""

from __future__ import annotations

import json
from functools import lru_cache
from typing import Any


def toml_text(data: dict[str, Any]) -> str:
    """Write data as TOML: the same data, the same text.

    Parameters
    ----------
    data
        What `tomllib` reads from a job file: values, and tables of values and tables.

    Examples
    --------
    >>> print(toml_text({"name": "a", "cut": {"length": "250 mm"}}), end="")
    name = "a"
    <BLANKLINE>
    [cut]
    length = "250 mm"
    """
    return "\n".join(_table(data, ())) + "\n"


def _table(data: dict[str, Any], path: tuple[str, ...]) -> list[str]:
    """Write a table: its values first, then the tables in it under their full names."""
    lines = [f"{_key(key)} = {_value(value)}" for key, value in data.items() if not isinstance(value, dict)]
    if path and (lines or not data):
        lines = [f"[{'.'.join(map(_key, path))}]", *lines]
    for key, value in data.items():
        if isinstance(value, dict):
            lines += ["", *_table(value, (*path, key))]
    return lines


@lru_cache(maxsize=256)
def _key(key: str) -> str:
    """Write a key, quoted: every key may be."""
    plain = key.replace("_", "a").replace("-", "a")
    return key if plain.isascii() and plain.isalnum() else _text(key)


def _value(value: object) -> str:
    """Write a value; those of job files are texts, numbers, truths, and arrays and inline tables of them."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return _text(value)
    if isinstance(value, list):
        return f"[{', '.join(map(_value, value))}]"
    if isinstance(value, dict):
        return "{" + ", ".join(f"{_key(key)} = {_value(entry)}" for key, entry in value.items()) + "}"
    return repr(value)


def _text(text: str) -> str:
    """Write a basic string; the escapes of JSON are TOML's but for the delete character."""
    return _QUOTED(text).replace("\x7f", "\\u007f")


_QUOTED = json.JSONEncoder(ensure_ascii=False).encode
