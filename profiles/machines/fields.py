"""What a machine says of each of its numbers, for whoever reads or shows them: job files, schemas, recipes.

A machine's dataclass annotates its fields with these: ``stroke: Annotated[float, Quantity("length", example="800 mm")]``.
"""

from __future__ import annotations

import math
from dataclasses import MISSING, dataclass, fields
from functools import cache
from typing import Annotated, Any, get_args, get_origin, get_type_hints

_LOADS = frozenset({"mass", "inertia", "torque"})
"""Kinds of quantities that give a motor something to do."""


@dataclass(frozen=True, kw_only=True)
class About:
    """What holds of every kind of field.

    Parameters
    ----------
    key
        Key in the machine's table of a job file; the field's own name if empty.
    shown
        Whether a line that says what the machine is like names it.
    """

    key: str = ""
    shown: bool = False


@dataclass(frozen=True)
class Instead:
    """Another number of the same kind that may be given in the place of one.

    Parameters
    ----------
    key
        Its key in the machine's table of a job file.
    times
        What it is multiplied by to give the number.
    example
        What to write.
    description
        What it is.
    """

    key: str
    times: float
    example: str
    description: str


@dataclass(frozen=True)
class Quantity(About):
    """A number with a unit.

    Parameters
    ----------
    kind
        Kind of quantity: ``"length"``, ``"mass"``, ``"angle"`` and so on.
    zero, signed
        Whether zero, or zero and negative values, are allowed.
    example
        What to write; empty for the usual example of the kind.
    usual
        What to add where the machine gives the motor nothing to do; empty for the example.
    description
        What it is.
    instead
        What may be given in its place.
    """

    kind: str
    zero: bool = False
    signed: bool = False
    example: str = ""
    usual: str = ""
    description: str = ""
    instead: Instead | None = None


@dataclass(frozen=True)
class BareNumber(About):
    """A bare number in a range, its least value outside.

    Parameters
    ----------
    above, greatest
        The range.
    example
        What to write.
    description
        What it is.
    advice
        What a number outside is told.
    """

    above: float
    greatest: float
    example: float
    description: str
    advice: str


@dataclass(frozen=True)
class Whole(About):
    """A whole number in a range; arguments as of `BareNumber`, its least value inside."""

    least: int
    greatest: int
    example: int
    description: str


@dataclass(frozen=True)
class Choice(About):
    """One of some words.

    Parameters
    ----------
    words
        What can be chosen.
    description
        What it is.
    """

    words: tuple[str, ...]
    description: str


GEAR_RATIO = BareNumber(
    0,
    1e6,
    10,
    "motor turns per turn",
    "it is motor turns per turn of the machine, above 0 and at most 1e6; write 1 for a direct drive",
)
"""A gear between motor and slave."""


@dataclass(frozen=True)
class MachineField:
    """A field of a machine.

    Parameters
    ----------
    name
        Attribute of the machine.
    key
        Key in job files.
    about
        What it is.
    default
        Its default; `dataclasses.MISSING` where there is none.
    """

    name: str
    key: str
    about: Quantity | BareNumber | Whole | Choice
    default: Any

    @property
    def required(self) -> bool:
        """Whether it must be given."""
        return self.default is MISSING

    @property
    def free(self) -> bool:
        """Whether it is the design's to choose where it is left out: its default is not a number."""
        return isinstance(self.default, float) and math.isnan(self.default)

    @property
    def load(self) -> bool:
        """Whether it gives the motor something to do."""
        return isinstance(self.about, Quantity) and self.about.kind in _LOADS


@cache
def fields_of(machine: type[Any]) -> tuple[MachineField, ...]:
    """List the fields of a kind of machine in their order.

    Raises
    ------
    TypeError
        A field does not say what it is.
    """
    hints = get_type_hints(machine, include_extras=True)
    found = []
    for each in fields(machine):
        hint = hints[each.name]
        marks = get_args(hint)[1:] if get_origin(hint) is Annotated else ()
        about = next((mark for mark in marks if isinstance(mark, About)), None)
        if not isinstance(about, Quantity | BareNumber | Whole | Choice):
            raise TypeError(f"{machine.__name__}.{each.name} does not say what it is; annotate it with a Quantity")
        found.append(MachineField(each.name, about.key or each.name, about, each.default))
    return tuple(found)
