"""What the lower floors say in names and SI units, worded for people: places in the job file, units that they write."""

from __future__ import annotations

import math
import re

from camwright.house.units import KINDS
from camwright.profiles.machines import Machine
from camwright.profiles.machines.fields import MachineField, Quantity, fields_of
from camwright.profiles.message import Message, Value

_PLACE = re.compile(r"\{(@?)(\w+)\}")

TABLES: dict[str, tuple[str, ...]] = {
    "cut": ("length", "line_speed", "sync_zone", "shear_zone", "shear_zone_at", "sync_tolerance", "sync_ratio"),
    "limits": ("speed", "acceleration", "jerk", "reversal", "motor"),
    "servo": ("position_gain", "sample_time", "bandwidth", "damping"),
    "objective": ("minimise",),
}
"""Tables of a job file that hold the quantities which messages name; all others stand in that of the machine."""

_SHOWN: dict[str, tuple[float, str, int | None]] = {
    "m": (1e3, "mm", None),
    "m/s": (60.0, "m/min", None),
    "rad": (math.degrees(1.0), "deg", 3),
    "rad/s": (30.0 / math.pi, "rpm", None),
}
"""Unit in which people write a quantity, by SI unit: factor, name, decimals of a bound."""


def place_of(quantity: str) -> str:
    """Say where in a job file a quantity stands: ``[table] key``."""
    table = next((table for table, keys in TABLES.items() if quantity in keys), "machine")
    return f"[{table}] {quantity}"


def value_words(value: Value) -> str:
    """Write a value in the unit that people use for it."""
    factor, unit, decimals = _SHOWN.get(value.unit, (1.0, value.unit, None))
    return value.written(factor, unit, decimals)


def words(message: Message | str) -> str:
    """Word a message as one that speaks of a job file."""
    if isinstance(message, str):
        return message
    known = dict(message.values)
    return _PLACE.sub(
        lambda found: place_of(found[2]) if found[1] else value_words(known[found[2]]),
        message.text,
    )


def machine_words(machine: Machine, digits: int = 4) -> str:
    """Say in a line what a machine is like: its lengths, and what is not as usual."""
    found = (_field_words(each, getattr(machine, each.name), digits) for each in fields_of(type(machine)))
    return ", ".join(each for each in found if each)


def _field_words(each: MachineField, value: float | str, digits: int) -> str:
    """Word one number of a machine; nothing for what is not shown or as usual."""
    name = each.key.replace("_", " ")
    if not each.about.shown:
        return ""
    if isinstance(each.about, Quantity):
        factor, unit, _ = _SHOWN.get(KINDS[each.about.kind].unit, (1.0, KINDS[each.about.kind].unit, None))
        return f"{name} {float(value) * factor:.{digits}g} {unit}"
    if value == each.default:
        return ""
    return f"{value} {name}"
