"""Reading a table of a TOML file key by key, all faults gathered with their place."""

from __future__ import annotations

import difflib
import tomllib
from collections.abc import Sequence
from pathlib import Path
from typing import Any, TypeVar

from camwright.house.files import read_text
from camwright.house.toml_faults import toml_fault
from camwright.house.units import quantity, shown
from camwright.profiles.errors import InputError

Option = TypeVar("Option", bound=str)

_MOST_BYTES = 1 << 20


def read_toml(path: Path, what: str) -> tuple[dict[str, Any], str]:
    """Read a TOML file; its data and its text."""
    text = read_text(path, what, _MOST_BYTES)
    try:
        return tomllib.loads(text), text
    except RecursionError as error:
        raise InputError(f"{path}: not TOML: nested too deeply") from error
    except ValueError as error:  # TOMLDecodeError, and integers beyond Python's limit of digits
        raise InputError(f"{path}: not TOML: {toml_fault(text, error)}") from error


class TomlTable:
    """One table of a file, read key by key.

    A key that is wrong adds a fault and gives a stand-in value, so that the rest of the file is read too; `close`
    adds a fault for each key that nobody asked for.

    Parameters
    ----------
    data
        What the file holds at this place.
    place
        Where that is, for messages, e.g. ``"bender.toml [feed]"``.
    faults
        Where faults are gathered; shared by all tables of a file.
    """

    def __init__(self, data: object, place: str, faults: list[str]) -> None:
        self.place = place
        self.faults = faults
        self._known: list[str] = []
        if not isinstance(data, dict):
            self.faults.append(f"{place}: not a table; write the table's name in brackets and its keys below")
            data = {}
        self._data: dict[str, Any] = data

    def table(self, key: str, *, needed: bool = True) -> TomlTable:
        """Read a table inside this one; an empty one if it may be left out."""
        self._known.append(key)
        place = f"{self.place} [{key}]"
        if key not in self._data:
            if needed:
                self.faults.append(f"{place}: missing; add the table [{key}]")
            return TomlTable({}, place, [] if needed else self.faults)
        return TomlTable(self._data[key], place, self.faults)

    def tables(self, key: str) -> list[TomlTable]:
        """Read an array of tables, ``[[key]]``, of at least one."""
        self._known.append(key)
        found = self._data.get(key)
        if not isinstance(found, list) or not found:
            self.faults.append(f"{self.place} [[{key}]]: missing; add one table [[{key}]] or more")
            return []
        return [TomlTable(entry, f"{self.place} [[{key}]] {i + 1}", self.faults) for i, entry in enumerate(found)]

    def quantity(self, key: str, kind: str, *, zero: bool = False, default: float | None = None) -> float:
        """Read a number with a unit, in SI units."""
        value = self._value(key, default)
        if value is None or (value is default and key not in self._data):
            return 1.0 if default is None else default
        return self._quantity(value, kind, zero, f"{self.place} {key}")

    def rows(self, key: str, kinds: tuple[str, str], *, needed: bool = True) -> list[tuple[float, float]]:
        """Read rows of two quantities each, zero allowed."""
        value = self._value(key, None if needed else [])
        if value is None:
            return []
        if not isinstance(value, list):
            self.faults.append(f"{self.place} {key} = {shown(value)}: not a list of rows")
            return []
        found = []
        for i, row in enumerate(value):
            place = f"{self.place} {key}, row {i + 1}"
            if not isinstance(row, list) or len(row) != 2:
                self.faults.append(f"{place}: {shown(row)}: not a row of two quantities")
                continue
            first, second = (self._quantity(v, kind, True, place) for v, kind in zip(row, kinds, strict=True))
            found.append((first, second))
        return found

    def number(self, key: str, least: float, greatest: float, *, above: bool = False) -> float:
        """Read a bare number from ``least`` (or above it) to ``greatest``."""
        value = self._value(key, None)
        if value is None:
            return greatest
        plain = isinstance(value, int | float) and not isinstance(value, bool)
        if not plain or not (least < value <= greatest if above else least <= value <= greatest):
            self.faults.append(
                f"{self.place} {key} = {shown(value)}: not a number {'above' if above else 'from'} {least:g} "
                f"up to {greatest:g}"
            )
            return greatest
        return float(value)

    def integer(self, key: str, least: int, greatest: int, default: int | None = None) -> int:
        """Read a whole number in a range."""
        value = self._value(key, default)
        if value is None:
            return least
        if isinstance(value, bool) or not isinstance(value, int) or not least <= value <= greatest:
            self.faults.append(f"{self.place} {key} = {shown(value)}: not a whole number from {least} to {greatest}")
            return least
        return value

    def option(self, key: str, options: Sequence[Option], default: Option | None = None) -> Option:
        """Read one of a few words."""
        value = self._value(key, default)
        for word in options:
            if value == word:
                return word
        if value is not None:
            self.faults.append(f"{self.place} {key} = {shown(value)}: not known; write one of {', '.join(options)}")
        return options[0]

    def text(self, key: str, default: str | None = None) -> str:
        """Read a text of one line, at most 100 characters."""
        value = self._value(key, default)
        if value is None:
            return ""
        if not isinstance(value, str) or not value.strip() or len(value) > 100 or not value.isprintable():
            self.faults.append(f"{self.place} {key} = {shown(value)}: not a text of 1 to 100 characters on one line")
            return ""
        return value

    def close(self) -> None:
        """Add a fault for every key that is not known here."""
        for key in self._data:
            if key not in self._known:
                near = difflib.get_close_matches(key[:100], self._known, n=1, cutoff=0.5)
                advice = f"did you mean {near[0]}?" if near else f"the keys here are {', '.join(self._known)}"
                self.faults.append(f"{self.place} {shown(key)[1:-1]}: there is no such key; {advice}")

    def _value(self, key: str, default: object) -> Any:
        self._known.append(key)
        if key not in self._data and default is None:
            self.faults.append(f"{self.place} {key}: missing")
        return self._data.get(key, default)

    def _quantity(self, value: object, kind: str, zero: bool, place: str) -> float:
        try:
            return quantity(value, kind, zero=zero)
        except InputError as error:
            self.faults.append(f"{place} = {error}")
            return 1.0
