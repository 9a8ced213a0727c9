"""Comparing two records of the golden run."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from typing import Any

RELATIVE = 1e-9
"""Numbers of an answer may differ by this share of the greater one."""

ABSOLUTE = 1e-15
"""Numbers may differ by this anyway."""


def same_number(before: float, after: float) -> bool:
    """Say whether two numbers are the same but for rounding."""
    return abs(before - after) <= max(ABSOLUTE, RELATIVE * max(abs(before), abs(after)))


def differences(path: str, before: Any, after: Any) -> Iterator[tuple[str, Any, Any]]:
    """Find where two answers differ.

    Parameters
    ----------
    path
        Where they stand.
    before, after
        Parsed JSON.

    Yields
    ------
    tuple
        Path, before, after; ``"(none)"`` for what is not there.
    """
    none = "(none)"
    if isinstance(before, dict) and isinstance(after, dict):
        for key in [*before, *(key for key in after if key not in before)]:
            yield from differences(f"{path} > {key}", before.get(key, none), after.get(key, none))
        shared = [key for key in before if key in after]
        if shared != [key for key in after if key in before]:
            yield f"{path} (order of keys)", list(before), list(after)
    elif isinstance(before, list) and isinstance(after, list):
        for i in range(max(len(before), len(after))):
            values = (entries[i] if i < len(entries) else none for entries in (before, after))
            yield from differences(f"{path} > {i}", *values)
    elif type(before) is not type(after):
        yield path, before, after
    elif isinstance(before, float):
        if not same_number(before, after):
            yield path, before, after
    elif before != after:
        yield path, before, after


def compare(before: dict[str, Any], after: dict[str, Any], names: Iterable[str]) -> list[str]:
    """List each difference between two records, one text each: where, before, after.

    Parameters
    ----------
    before, after
        Records.
    names
        Cases that are compared.
    """
    return [
        f"{path}\n    before {shown(old)}\n    after  {shown(new)}"
        for name in names
        for path, old, new in differences(name, before.get(name, "(none)"), after.get(name, "(none)"))
    ]


def shown(value: Any) -> str:
    """Write a value on one line."""
    text = json.dumps(value, ensure_ascii=False)
    return text if len(text) <= 2000 else text[:2000] + " …"
