"""Fields of settings files: numbers with units, bare numbers, texts and rows, each read once into SI and kept by its place."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, ClassVar, Literal, Self, cast, get_args, get_origin

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    ModelWrapValidatorHandler,
    ValidationInfo,
    WithJsonSchema,
    model_validator,
)
from pydantic_core import PydanticCustomError

from camwright.house.units import KINDS, quantity, shown
from camwright.profiles.errors import InputError

Path = list[str | int]
"""Keys from the top of a file to a place in it, and numbers where tables or rows are several."""


@dataclass
class Settings:
    """What is right in itself in a settings file, whatever else is wrong.

    Parameters
    ----------
    numbers
        Numbers by their place in the file, ``"cut.length"``, in SI units; defaults of what a table leaves out included.
    place
        The table that is being read.
    """

    numbers: dict[str, float] = field(default_factory=dict)
    place: str = ""

    def path(self, key: str) -> str:
        """Place of a key in the table that is being read."""
        return f"{self.place}.{key}" if self.place else key

    def example(self, path: str, examples: list[Any]) -> Any:
        """Choose what a message tells to write at a place."""
        del path
        return examples[0]


class Table(BaseModel):
    """A table of a settings file: no unknown keys, no conversions. A class says where in the file its table stands."""

    model_config = ConfigDict(strict=True, extra="forbid", frozen=True, allow_inf_nan=False)
    _place: ClassVar[str] = ""

    @model_validator(mode="wrap")
    @classmethod
    def _read_at_place(cls, data: Any, handler: ModelWrapValidatorHandler[Self], info: ValidationInfo) -> Self:
        """Tell the fields where they stand, and keep the default numbers of what is left out."""
        settings = info.context
        if not isinstance(settings, Settings):  # made in Python, as the default of another table
            return handler(data)
        outer, settings.place = settings.place, cls._place
        for key, each in cls.model_fields.items() if isinstance(data, dict) else ():
            if key not in data and isinstance(each.default, int | float) and not isinstance(each.default, bool):
                settings.numbers[settings.path(key)] = each.default
        try:
            return handler(data)
        finally:
            settings.place = outer


def tables_in(annotation: Any) -> list[type[Table]]:
    """List the models of tables that a type is made of."""
    if isinstance(annotation, type) and get_origin(annotation) is None:
        return [annotation] if issubclass(annotation, Table) else []
    return (
        []
        if get_origin(annotation) is Literal
        else [table for part in get_args(annotation) for table in tables_in(part)]
    )


def table_place(path: Path) -> str:
    """Write the name of a table, or of one of several that share a name: ``[servo.tolerance]``, ``[[rule]] 2``."""
    for at, part in enumerate(path):
        if isinstance(part, int):
            rest = f" {table_place(path[at + 1 :])}" if path[at + 1 :] else ""
            return f"[[{'.'.join(map(str, path[:at]))}]] {part + 1}{rest}"
    return f"[{'.'.join(map(str, path))}]"


def refusal(message: str) -> PydanticCustomError:
    """Make the error of a value whose message is complete but for its place."""
    return PydanticCustomError("value", "{message}", {"message": message})


def keep(value: float, info: ValidationInfo, key: str | None = None) -> float:
    """Keep a number under its place, or that of another key, so that it can be checked although the file has faults."""
    settings = cast(Settings, info.context)
    settings.numbers[settings.path(key or cast(str, info.field_name))] = value
    return value


def read_quantity(
    value: object, kind: str, *, zero: bool = False, signed: bool = False, example: str | None = None
) -> float:
    """Read a quantity as `camwright.house.units.quantity` does; its faults as those of a field."""
    try:
        return quantity(value, kind, zero=zero, signed=signed, example=example)
    except InputError as error:
        raise refusal(str(error)) from error


def quantity_field(
    kind: str,
    *,
    zero: bool = False,
    signed: bool = False,
    example: str | None = None,
    kept_as: str | None = None,
    times: float = 1.0,
) -> tuple[BeforeValidator, WithJsonSchema]:
    """Make the parts of a field that is written as a number with a unit; arguments as `camwright.house.units.quantity`.

    ``kept_as`` is the key of its table under which it is kept, the field's own if not given; ``times`` what it is kept multiplied by.
    """

    def read(value: object, info: ValidationInfo) -> float:
        return keep(times * read_quantity(value, kind, zero=zero, signed=signed, example=example), info, kept_as)

    least = "of either sign" if signed else "zero or more" if zero else "greater than zero"
    schema = quantity_schema(f"{KINDS[kind].name}, {least}", [example or KINDS[kind].example], signed=signed)
    return BeforeValidator(read), schema


def number_field(least: float, greatest: float, words: str, example: str, *, above: bool = False) -> BeforeValidator:
    """Make the validator of a field that is written as a bare number in a range.

    Parameters
    ----------
    least, greatest
        The range.
    words
        What a number outside is told.
    example
        A number to write.
    above
        Whether the least value itself is outside.
    """

    def read(value: object, info: ValidationInfo) -> float:
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise refusal(f"{shown(value)}: not a number; write e.g. {info.field_name} = {example}")
        if not math.isfinite(value) or not (least < value <= greatest if above else least <= value <= greatest):
            raise refusal(f"{shown(value)}: {words}")
        return keep(float(value), info)

    return BeforeValidator(read)


def whole_field(least: int, greatest: int, example: int) -> BeforeValidator:
    """Make the validator of a field that is written as a whole number in a range."""

    def read(value: object, info: ValidationInfo) -> int:
        if isinstance(value, bool) or not isinstance(value, int) or not least <= value <= greatest:
            raise refusal(
                f"{shown(value)}: not a whole number from {least} to {greatest}; write e.g. {info.field_name} = {example}"
            )
        keep(value, info)
        return value

    return BeforeValidator(read)


def checked(check: Callable[[object], str | None]) -> BeforeValidator:
    """Make the validator of a text from a check that tells what is wrong with it."""

    def read(value: object) -> object:
        message = check(value)
        if message is not None:
            raise refusal(message)
        return value

    return BeforeValidator(read)


def line_field(example: str) -> tuple[BeforeValidator, Any]:
    """Make the parts of a field that is a text on one line."""
    return checked(_line), Field(examples=[example], json_schema_extra={"minLength": 1, "maxLength": 100})


def row_field(first: str, second: str) -> BeforeValidator:
    """Make the validator of a row of two quantities, zero allowed; the arguments are their kinds."""

    def read(value: object) -> tuple[float, float]:
        if not isinstance(value, list) or len(value) != 2:
            raise refusal(f"{shown(value)}: not a row of two quantities")
        return read_quantity(value[0], first, zero=True), read_quantity(value[1], second, zero=True)

    return BeforeValidator(read)


def quantity_schema(words: str, examples: list[str], *, signed: bool = False) -> WithJsonSchema:
    """Make the JSON Schema of a number with a unit."""
    sign = "[+-]?" if signed else "[+]?"
    return WithJsonSchema(
        {
            "type": "string",
            "description": f"{words}, as a number and a unit",
            "examples": examples,
            "minLength": 3,
            "maxLength": 100,
            "pattern": rf"^\s*{sign}([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]{{1,3}})?\s*([A-Za-z°µμ/]|1\s*/).*$",
        }
    )


def _line(value: object) -> str | None:
    """Say what is wrong with a text on one line."""
    right = isinstance(value, str) and value.strip() and len(value) <= 100 and value.isprintable()
    return None if right else f"{shown(value)}: not a text of 1 to 100 characters on one line"
