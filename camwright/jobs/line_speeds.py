"""The line speeds at which a servo-aware cam must be in sync: the field of a job file, its checks, and how it is written."""

from __future__ import annotations

from collections.abc import Iterator
from decimal import Decimal
from typing import cast

from pydantic import BeforeValidator, ValidationInfo, WithJsonSchema

from camwright.house.numbers import typed
from camwright.house.setting_fields import refusal
from camwright.house.units import quantity, shown
from camwright.jobs.fields import Known
from camwright.jobs.spread_fields import PERCENT
from camwright.profiles.errors import InputError

DEFAULT_SLOWEST = 0.1
"""Least line speed of a servo-aware job that names none, as a share of the job's: creeping, as lines start and stop."""

LEAST_SLOWEST = 0.01
"""Least share that can be asked for."""

_SAME = 1e-9
"""By this share the upper end may be off the job's line speed: what a text of some digits is off."""

_ENDS = ("slowest", "fastest")
"""The ends of a range; a line speed alone is its upper end."""

_EXAMPLE = '["10 %", "100 %"]'


def line_speeds_field() -> tuple[BeforeValidator, WithJsonSchema]:
    """Make the parts of a field of line speeds: one, or the ends of a range, each a speed or a percentage of the job's line speed."""

    def read(value: object, info: ValidationInfo) -> tuple[str, ...]:
        given: list[object] = value if isinstance(value, list) else [value]
        ends = tuple(end for end in given if isinstance(end, str))
        if len(given) not in (1, 2) or len(ends) < len(given):
            raise refusal(
                f"{shown(value)}: neither a line speed nor the two ends of a range; write e.g. {_EXAMPLE}, or "
                '"100 %" for the one line speed of the job'
            )
        numbers = cast(Known, info.context).numbers
        for name, end in zip(_ENDS[-len(ends) :], ends, strict=True):
            share, value = _read(end)
            numbers[_place(name, share=share)] = value
        return ends

    end = {"type": "string", "minLength": 3, "maxLength": 100}
    schema = {
        "anyOf": [end, {"type": "array", "prefixItems": [end, end], "minItems": 2, "maxItems": 2}],
        "description": "line speeds at which a servo-aware cam must be in sync: a range up to the job's line speed, or that alone",
        "examples": [["10 %", "100 %"], ["8 m/min", "80 m/min"], "100 %"],
        "default": ["10 %", "100 %"],
    }
    return BeforeValidator(read), WithJsonSchema(schema)


def slowest_share(known: Known, line_speed: float) -> float:
    """Least line speed over the job's (m/s), from what its job file says or leaves out; 1 for a servo-blind job."""
    if not known.servo_aware:
        return 1.0
    low, high = (_share(known, name, line_speed) for name in _ENDS)
    if high is None:
        return DEFAULT_SLOWEST
    return 1.0 if low is None else min(1.0, low)


def line_speeds_text(slowest: float) -> list[str] | str:
    """Write line speeds so that the same share is read again."""
    if slowest == 1.0:
        return "100 %"
    return [f"{(Decimal(repr(slowest)) * 100).normalize():f} %", "100 %"]


def line_speed_conflicts(known: Known) -> Iterator[str]:
    """Check line speeds against the job's: a range ends there, and begins neither above it nor at a standstill."""
    line_speed = known.numbers.get("cut.line_speed")
    if line_speed is None:
        return
    low, high = (_share(known, name, line_speed) for name in _ENDS)
    if high is None:
        return
    own = typed(line_speed, "m/s")
    if abs(high - 1.0) > _SAME:
        yield (
            f"[objective] line_speeds: {_written(known, _ENDS[1])} is not [cut] line_speed = {own}, for which the cam is designed and "
            f'where its line speeds end; write "100 %", or correct [cut] line_speed'
        )
    elif low is not None and low < LEAST_SLOWEST:
        yield (
            f"[objective] line_speeds: {_written(known, _ENDS[0])} is {100 * low:.3g} % of [cut] line_speed = {own}, below "
            f"{100 * LEAST_SLOWEST:g} %; begin at {100 * LEAST_SLOWEST:g} %: a servo follows a line that slow almost exactly"
        )
    elif low is not None and low > 1.0 + _SAME:
        yield f"[objective] line_speeds: the range is upside down; give its lower end first, e.g. {_EXAMPLE}"


def _place(name: str, *, share: bool) -> str:
    """Place under which an end is kept: it is a share of the job's line speed, or a line speed (m/s)."""
    return f"objective.{name}_{'share' if share else 'speed'}"


def _read(text: str) -> tuple[bool, float]:
    """Read an end: whether it is a share, and the share or the line speed (m/s)."""
    percent = PERCENT.fullmatch(text)
    if percent:
        return True, float(Decimal(percent.group(1)) / 100)
    try:
        return False, quantity(text, "speed")
    except InputError as error:
        raise refusal(f'{error}, or a percentage of [cut] line_speed, e.g. "10 %"') from error


def _share(known: Known, name: str, line_speed: float) -> float | None:
    """Give an end as a share of the job's line speed (m/s); nothing if the file does not say it."""
    if _place(name, share=True) in known.numbers:
        return known.numbers[_place(name, share=True)]
    speed = known.numbers.get(_place(name, share=False))
    return None if speed is None else speed / line_speed


def _written(known: Known, name: str) -> str:
    """Write an end as a job file would."""
    share = known.numbers.get(_place(name, share=True))
    return (
        f'"{100 * share:.10g} %"'
        if share is not None
        else f'"{typed(known.numbers[_place(name, share=False)], "m/s")}"'
    )
