"""What a sheet says, against what its own cam and job give when they are worked out again."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict
from typing import Any

from camwright.recipes.expected import Expected
from camwright.recipes.model import Recipe

SAME = 1e-6
"""What a value computed anew may be off the recorded one, relative to it: another processor or another version of numpy."""

ROUNDING = 1e-9
"""The same relative to the limit that a value is judged by, or to the tool's travel: values near zero are rounding."""

_SOUGHT = 1e-3
"""The same of what is found by search, to a tolerance of its own: line speeds and the working range."""

_LEFT_OUT = ("at", "source")
"""Of a check: of two equal peaks rounding says which is the greatest."""


def differs(name: str, found: float | None, recorded: float | None, scale: float, share: float = SAME) -> Iterator[str]:
    """Tell a value that is not the recorded one, but for rounding."""
    same = (
        found is recorded
        if found is None or recorded is None
        else abs(found - recorded) <= share * abs(recorded) + ROUNDING * scale
    )
    if not same:
        yield f"{name}: {found!r}, recorded {recorded!r}"


def sheet_faults(recipe: Recipe, again: Expected) -> Iterator[str]:
    """Compare every value of a sheet with the one computed anew; each that differs, by its place in recipe.json."""
    for name, value in asdict(again).items():
        share = _SOUGHT if name in ("speed_band", "working_range", "marks") else SAME
        yield from _leaf(name, value, asdict(recipe)[name], share, 1.0)


def _compared(place: str, found: Any, recorded: Any, share: float) -> Iterator[str]:
    """Compare values of any depth; checks by their names."""
    if isinstance(found, dict):
        left_out, scale = (_LEFT_OUT, abs(found.get("limit") or 1.0)) if "passed" in found else ((), 1.0)
        for key in found:
            if key not in left_out:
                yield from _leaf(f"{place}.{key}", found[key], recorded[key], share, scale)
    elif isinstance(found, tuple) and found and isinstance(found[0], dict) and "passed" in found[0]:
        new, old = ({check["name"]: check for check in checks} for checks in (found, recorded))
        if list(new) != list(old):
            yield f"{place} are {', '.join(new)}, recorded {', '.join(old)}"
        for name in new.keys() & old.keys():
            yield from _compared(f"{place}.{name}", new[name], old[name], share)
    elif isinstance(found, tuple):
        if len(found) != len(recorded):
            yield f"{place} has {len(found)} entries, recorded {len(recorded)}"
            return
        for i, (one, other) in enumerate(zip(found, recorded, strict=True)):
            yield from _compared(f"{place}[{i}]", one, other, share)
    else:
        yield from _leaf(place, found, recorded, share, 1.0)


def _leaf(place: str, found: Any, recorded: Any, share: float, scale: float) -> Iterator[str]:
    numbers = [isinstance(value, int | float) and not isinstance(value, bool) for value in (found, recorded)]
    if isinstance(found, dict | tuple) and isinstance(recorded, dict | list | tuple):
        yield from _compared(place, found, recorded, share)
    elif all(numbers):
        yield from differs(place, float(found), float(recorded), scale, share)
    elif found != recorded:
        yield f"{place}: {found!r}, recorded {recorded!r}"
