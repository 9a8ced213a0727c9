"""The machine tables of job files, one for each kind of machine, and the machines that they stand for.

A machine's fields say what they are (`camwright.profiles.machines.fields`); its table is made from that.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache, reduce
from operator import or_
from typing import Annotated, Any, Literal

from pydantic import Field, create_model

from camwright.house.setting_fields import Table, number_field, quantity_field, whole_field
from camwright.house.units import KINDS
from camwright.jobs.fields import Known
from camwright.profiles.machines import MACHINES, Machine
from camwright.profiles.machines.fields import BareNumber, Choice, Instead, MachineField, Quantity, Whole, fields_of


class MachineTable(Table):
    """The table of any machine."""

    _place = "machine"


@cache
def table_of(machine: type[Machine]) -> type[MachineTable]:
    """Make the table of a kind of machine: its keys with what they take, and their defaults."""
    kind = Annotated[Literal[machine.kind], Field(description="which machine", examples=[machine.kind])]  # type: ignore[name-defined]
    keys: dict[str, Any] = {}
    for each in fields_of(machine):
        keys[each.key] = _key(each)
        if isinstance(each.about, Quantity) and each.about.instead is not None:
            keys[each.about.instead.key] = _instead(each.about, each.about.instead, each.key)
    return create_model(
        f"{machine.__name__}Table", __base__=MachineTable, __doc__=machine.summary, kind=(kind, ...), **keys
    )


def machine_tables() -> Any:
    """Any machine table, told apart by its kind."""
    tables: Any = reduce(or_, (table_of(machine) for machine in MACHINES.values()))
    return Annotated[tables, Field(discriminator="kind")]


def _key(each: MachineField) -> tuple[Any, Any]:
    """Make a key of a machine table: its type with validators and schema, and its default."""
    about = each.about
    default: Any = ... if each.required else None if each.free else each.default
    if isinstance(about, Quantity):
        default = None if about.instead is not None and each.required else default  # `either_faults` asks for either
        parts = quantity_field(about.kind, zero=about.zero, signed=about.signed, example=about.example or None)
        known = [] if default in (..., None) else [Field(json_schema_extra={"default": _written(about, default)})]
        return Annotated[(float | None if default is None else float, *parts, *known)], default
    if isinstance(about, Whole):
        whole = whole_field(about.least, about.greatest, about.example)
        extra: dict[str, Any] = {"minimum": about.least, "maximum": about.greatest}
        return Annotated[int, whole, Field(description=about.description, json_schema_extra=extra)], default
    if isinstance(about, BareNumber):
        number = number_field(about.above, about.greatest, about.advice, f"{about.example:g}", above=True)
        extra = {"exclusiveMinimum": about.above, "maximum": about.greatest}
        shown = Field(description=about.description, examples=[about.example], json_schema_extra=extra)
        return Annotated[float, number, shown], default
    return Annotated[Literal[about.words], Field(description=about.description)], default


def _instead(about: Quantity, instead: Instead, kept_as: str) -> tuple[Any, Any]:
    """Make the key of a number that may be given in the place of another, under whose key it is kept."""
    parts = quantity_field(about.kind, example=instead.example, kept_as=kept_as, times=instead.times)
    return Annotated[(float | None, *parts)], None


def either_of(machine: type[Machine]) -> Iterator[tuple[str, Instead, str]]:
    """List the required numbers of a machine that another may stand for: key, the other, what to write."""
    for each in fields_of(machine):
        if isinstance(each.about, Quantity) and each.about.instead is not None and each.required:
            yield each.key, each.about.instead, each.about.example or KINDS[each.about.kind].example


def either_faults(machine: type[Machine], table: dict[str, Any]) -> Iterator[str]:
    """Say of what is missing that either number will do, and of two that stand for the same that one is enough."""
    for key, instead, example in either_of(machine):
        if key not in table and instead.key not in table:
            yield f'[machine] {key}: missing; add e.g. {key} = "{example}", or {instead.key} = "{instead.example}"'
        elif key in table and instead.key in table:
            yield f"[machine] {instead.key}: there is {key} too, which says the same; leave one of them out"


def _written(about: Quantity, default: float) -> str:
    """Write a default with its unit: nothing in the unit that users write, else the SI unit."""
    kind = KINDS[about.kind]
    return f"{default:g} {kind.unit}" if default else f"0 {(about.example or kind.example).split(' ', 1)[1]}"


def machine_of(known: Known) -> Machine | None:
    """Make the machine of a job file from what is known of it; nothing where a number is missing that it needs."""
    machine = known.machine
    if machine is None:
        return None
    values: dict[str, Any] = {}
    for each in fields_of(machine):
        found = (
            known.choices.get(each.key)
            if isinstance(each.about, Choice)
            else known.numbers.get(f"machine.{each.key}", each.default if each.free else None)
        )
        if found is None:
            return None
        values[each.name] = int(found) if isinstance(each.about, Whole) else found
    return machine(**values)
