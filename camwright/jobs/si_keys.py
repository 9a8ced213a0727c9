"""Numbers in SI units under keys that name the unit, as Python programs give them, turned into what job files hold."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

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
        Told of each quantity that is given twice.

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
        if name in found or (name != key and name in data):
            faults.append(f"[{place}] {key}: given twice, as {name} and as {key}; leave one out")
        found[name] = text
    return found


def _with_unit(key: str, value: Any) -> tuple[str, Any]:
    """Give an entry its unit, if its key names one and its value is a number."""
    if isinstance(value, int | float) and not isinstance(value, bool):
        for end, unit in _UNITS.items():
            if key.endswith(end):
                return key.removesuffix(end), f"{float(value)!r} {unit}"
    return key, [list(pair) if isinstance(pair, tuple) else pair for pair in value] if isinstance(
        value, tuple
    ) else value
