"""What a machine is like, in a line."""

from __future__ import annotations

from camwright.house.numbers import METRIC, Units, typed
from camwright.house.units import KINDS
from camwright.profiles.machines import Machine
from camwright.profiles.machines.fields import MachineField, Quantity, fields_of


def machine_words(machine: Machine, digits: int = 4, units: Units = METRIC) -> str:
    """Say in a line what a machine is like: its lengths, and what is not as usual."""
    found = (_field_words(each, getattr(machine, each.name), digits, units) for each in fields_of(type(machine)))
    return ", ".join(each for each in found if each)


def _field_words(each: MachineField, value: float | str, digits: int, units: Units) -> str:
    """Word one number of a machine; nothing for what is not shown or as usual."""
    name = each.key.replace("_", " ")
    if not each.about.shown:
        return ""
    if isinstance(each.about, Quantity):
        return f"{name} {typed(float(value), KINDS[each.about.kind].unit, digits, units)}"
    if value == each.default:
        return ""
    return f"{value} {name}"
