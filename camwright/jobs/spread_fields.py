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

_MOST_DAMPING = 100.0
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


def damping_spread() -> tuple[BeforeValidator, WithJsonSchema]:
    """Make the parts of a range of the damping ratio: a percentage of the servo's own value, or two ends."""

    def end(value: object) -> float:
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise InputError(f"{shown(value)}: not a number; write e.g. 0.63")
        if not 0.0 < value <= _MOST_DAMPING:  # not a number is neither
            raise InputError(
                f"{shown(value)}: the damping ratio is above 0 and at most {_MOST_DAMPING:g}; write e.g. 0.63"
            )
        return float(value)

    item = {"type": "number", "exclusiveMinimum": 0, "maximum": _MOST_DAMPING}
    return _spread(end, "the damping ratio", "[0.63, 0.77]", item, [[0.63, 0.77]])


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
