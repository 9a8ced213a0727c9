"""Numbers in SI units under keys that name the unit, as Python programs give them, turned into what job files hold."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from camwright.house.units import dimension_of, shown

_UNITS = {
    "_m_per_s2": "m/s^2",
    "_m_per_s3": "m/s^3",
    "_m_per_s": "m/s",
    "_rad_per_s2": "rad/s^2",
    "_rad_per_s3": "rad/s^3",
    "_rad_per_s": "rad/s",
    "_per_s": "1/s",
    "_kg_m2": "kg m^2",
    "_N_m": "N m",
    "_kg": "kg",
    "_rad": "rad",
    "_m": "m",
    "_s": "s",
}
"""Ends of keys and the units that they name, longer ends before those that they end in."""


def with_units(data: Mapping[str, Any], place: str, faults: list[str]) -> dict[str, Any]:
    """Turn ``{"length_m": 0.6}`` into ``{"length": "0.6 m"}``, in tables of tables too; other entries stay as they are.

    Parameters
    ----------
    data
        What a job file would hold at a place.
    place
        That place, for messages: empty, or the name of a table.
    faults
        Told of each quantity that is given twice, and of each whose key and value both have a unit.

    Examples
    --------
    >>> with_units({"length_m": 0.6, "line_speed": "80 m/min", "sync_ratio": 1.0}, "cut", [])
    {'length': '0.6 m', 'line_speed': '80 m/min', 'sync_ratio': 1.0}
    """
    found: dict[str, Any] = {}
    for key, value in data.items():
        if isinstance(value, Mapping):
            found[key] = with_units(value, f"{place}.{key}" if place else key, faults)
            continue
        name, text = _with_unit(key, value)
        where = f"[{place}] {key}" if place else key
        if name in found or (name != key and name in data):
            faults.append(f"{where}: given twice, as {name} and as {key}; leave one out")
        faults += _unit_twice(where, key, value)
        found[name] = text
    return found


def _with_unit(key: str, value: Any) -> tuple[str, Any]:
    """Give an entry its unit, if its key names one and its value is a number."""
    end = _unit_of(key)
    if end and isinstance(value, int | float) and not isinstance(value, bool):
        return key.removesuffix(end), f"{float(value)!r} {_UNITS[end]}"
    return key, [list(pair) if isinstance(pair, tuple) else pair for pair in value] if isinstance(
        value, tuple
    ) else value


def _unit_twice(where: str, key: str, value: Any) -> Iterator[str]:
    """Say that a key names a unit and its value has one."""
    end = _unit_of(key)
    if end and isinstance(value, str) and dimension_of(value) is not None:
        name, unit = key.removesuffix(end), _UNITS[end]
        yield f'{where} = {shown(value)}: the key names its unit; give it a number of {unit}, or write {name} = "{value}"'


def _unit_of(key: str) -> str:
    """Find the end of a key that names a unit; empty where none does."""
    return next((end for end in _UNITS if key.endswith(end)), "")
