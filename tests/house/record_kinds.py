"""The kinds of places in a record of keys and lists."""

from __future__ import annotations


def kinds(value: object, path: tuple[str | int, ...] = ()) -> dict[tuple[str, ...], tuple[str | int, ...]]:
    """One place of each kind of key or item: of lists the first item stands for all."""
    found: dict[tuple[str, ...], tuple[str | int, ...]] = {}
    for key, each in value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ():
        place = (*path, key)
        found.setdefault(tuple("#" if isinstance(part, int) else part for part in place), place)
        found = {**kinds(each, place), **found}
    return found
