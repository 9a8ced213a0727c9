"""Fields of job files that hold the range of a servo's parameter, and keys that only a servo-aware design has."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from typing import cast

from pydantic import BeforeValidator, ValidationInfo, WithJsonSchema

from camwright.house.setting_fields import refusal
from camwright.house.units import KINDS, quantity, shown
from camwright.jobs.fields import Known, Spread
from camwright.profiles.errors import InputError

PERCENT = re.compile(r"\s*([0-9]+\.?[0-9]*|\.[0-9]+)\s*%\s*")
"""A percentage; its number is the first group."""

_PERCENT_SCHEMA = {"type": "string", "pattern": r"^\s*([0-9]+\.?[0-9]*|\.[0-9]+)\s*%\s*$", "maxLength": 100}


def quantity_spread(kind: str, low: str, high: str, *, zero: bool = False) -> tuple[BeforeValidator, WithJsonSchema]:
    """Make the parts of a range of a quantity: a percentage of the servo's own value, or two ends with units.

    Parameters
    ----------
    kind
        Name of the kind, a key of `camwright.house.units.KINDS`.
    low, high
        Ends that messages tell to write.
    zero
        Whether an end may be zero.
    """

    def end(value: object) -> float:
        return quantity(value, kind, zero=zero)

    item = {"type": "string", "minLength": 3, "maxLength": 100}
    return _spread(end, KINDS[kind].name, f'["{low}", "{high}"]', item, [[low, high]])


def number_spread(greatest: float, words: str, low: float, high: float) -> tuple[BeforeValidator, WithJsonSchema]:
    """Make the parts of a range of a bare number, above zero: a percentage of the servo's own value, or two ends.

    Parameters
    ----------
    greatest
        Greatest number allowed.
    words
        What the number is, as messages call it.
    low, high
        Ends that messages tell to write.
    """

    def end(value: object) -> float:
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise InputError(f"{shown(value)}: not a number; write e.g. {low:g}")
        if not 0.0 < value <= greatest:  # not a number is neither
            raise InputError(f"{shown(value)}: {words} is above 0 and at most {greatest:g}; write e.g. {low:g}")
        return float(value)

    item = {"type": "number", "exclusiveMinimum": 0, "maximum": greatest}
    return _spread(end, words, f"[{low:g}, {high:g}]", item, [[low, high]])


def ends(spread: Spread | None, nominal: float) -> tuple[float, float]:
    """Least and greatest value of a parameter, about the servo's own.

    Parameters
    ----------
    spread
        What the job file says; nothing where it says nothing.
    nominal
        The servo's own value, in SI units.
    """
    if spread is None:
        return nominal, nominal
    return spread if isinstance(spread, tuple) else (nominal * (1.0 - spread), nominal * (1.0 + spread))


def aware_only(advice: str, only: str | None = None) -> BeforeValidator:
    """Make the validator of a key, or of one of its values, that only a servo-aware design has.

    Parameters
    ----------
    advice
        What to do instead of adding ``servo_aware = true``.
    only
        The value; all values if not given.
    """

    def read(value: object, info: ValidationInfo) -> object:
        if not cast(Known, info.context).servo_aware and only in (None, value):
            raise refusal(f"{shown(value)}: for servo-aware designs only; add servo_aware = true or {advice}")
        return value

    return BeforeValidator(read)


def _spread(
    end: Callable[[object], float], words: str, example: str, item: dict[str, object], examples: list[object]
) -> tuple[BeforeValidator, WithJsonSchema]:
    """Make the parts of a range from what reads one end of it."""

    def read(value: object, info: ValidationInfo) -> Spread:
        found = _share(value) if isinstance(value, str) else _pair(value)
        cast(Known, info.context).spreads[cast(str, info.field_name)] = found
        return found

    def _share(value: str) -> float:
        text = PERCENT.fullmatch(value)
        share = float(text.group(1)) / 100 if text else math.nan
        if not 0.0 < share < 1.0:
            raise refusal(
                f'{shown(value)}: not a percentage above 0 % and below 100 %; write e.g. "10 %", to both sides, or the ends '
                f"of the range, {example}"
            )
        return share

    def _pair(value: object) -> tuple[float, float]:
        if not isinstance(value, list) or len(value) != 2:
            raise refusal(f'{shown(value)}: not a range; write e.g. "10 %", to both sides, or its two ends, {example}')
        try:
            low, high = (end(entry) for entry in value)
        except InputError as error:
            raise refusal(f"{shown(value)}: {error}") from error
        if low > high:
            raise refusal(f"{shown(value)}: the range is upside down; give its lower end first")
        return low, high

    pair = {"type": "array", "prefixItems": [item, item], "minItems": 2, "maxItems": 2}
    schema = {
        "anyOf": [_PERCENT_SCHEMA, pair],
        "description": f"range of {words}: a percentage of the servo's own to both sides, or the two ends",
        "examples": ["10 %", *examples],
    }
    return BeforeValidator(read), WithJsonSchema(schema)
