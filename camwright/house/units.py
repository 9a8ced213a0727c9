"""Quantities with units as users write them, read into SI numbers at the border of the house."""

from __future__ import annotations

import json
import re
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache, lru_cache
from importlib.resources import files

from camwright.profiles.errors import InputError


@dataclass(frozen=True)
class Kind:
    """A kind of quantity: what it is called, its dimension, how to write it, and the range that camwright computes in.

    Parameters
    ----------
    name
        What messages call it.
    dimension
        Powers of the base dimensions.
    example
        A quantity of this kind as text.
    unit
        The SI unit.
    least, greatest
        Range of the value in the SI unit.
    """

    name: str
    dimension: dict[str, int]
    example: str
    unit: str
    least: float
    greatest: float


KINDS: dict[str, Kind] = {
    "length": Kind("a length", {"[length]": 1}, "600 mm", "m", 1e-9, 1e6),
    "speed": Kind("a speed", {"[length]": 1, "[time]": -1}, "80 m/min", "m/s", 1e-9, 1e6),
    "acceleration": Kind("an acceleration", {"[length]": 1, "[time]": -2}, "30 m/s^2", "m/s^2", 1e-9, 1e9),
    "jerk": Kind("a jerk", {"[length]": 1, "[time]": -3}, "3000 m/s^3", "m/s^3", 1e-9, 1e15),
    "time": Kind("a time", {"[time]": 1}, "4 ms", "s", 1e-9, 1e6),
    "time squared": Kind("a squared time", {"[time]": 2}, "300 ms^2", "s^2", 1e-18, 1e6),
    "time cubed": Kind("a cubed time", {"[time]": 3}, "2000 ms^3", "s^3", 1e-27, 1e6),
    "angular rate": Kind("an angular rate", {"[angle]": 1, "[time]": -1}, "120 rad/s", "rad/s", 1e-6, 1e9),
    "gain": Kind("a gain", {"[time]": -1}, "35 1/s", "1/s", 1e-6, 1e9),
    "angle": Kind("an angle", {"[angle]": 1}, "90 deg", "rad", 1e-9, 1e6),
    "angular acceleration": Kind(
        "an angular acceleration", {"[angle]": 1, "[time]": -2}, "2000 rad/s^2", "rad/s^2", 1e-9, 1e12
    ),
    "angular jerk": Kind("an angular jerk", {"[angle]": 1, "[time]": -3}, "50000 rad/s^3", "rad/s^3", 1e-9, 1e15),
    "mass": Kind("a mass", {"[mass]": 1}, "20 kg", "kg", 1e-9, 1e9),
    "inertia": Kind("an inertia", {"[mass]": 1, "[length]": 2}, "0.05 kg m^2", "kg m^2", 1e-12, 1e12),
    "torque": Kind("a torque", {"[mass]": 1, "[length]": 2, "[time]": -2}, "12 N m", "N m", 1e-9, 1e12),
}
"""The kinds of quantities by name."""

_LONGEST = 100
_FEW = 12
_TEXT = re.compile(r"([+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]{1,3})?)\s*(.*)", re.DOTALL)
_NAME_AND_POWER = r"([^\W\d_]{1,24}|°)(?:\s*(?:\*\*|\^)\s*([+-]?[1-9]))?"
_FACTOR = re.compile(r"([*/·]?)\s*" + _NAME_AND_POWER)
_UNIT = re.compile(
    rf"(?:1?\s*/\s*{_NAME_AND_POWER}|{_NAME_AND_POWER}(?:\s+{_NAME_AND_POWER})*)(?:\s*[*/·]\s*{_NAME_AND_POWER})*"
)
# A space multiplies, as in "12 N m", but only ahead of any "*" or "/": "m/s s" could be read in two ways.
_COMMA = re.compile(r"([+-]?[0-9]*),([0-9]+)\s*([^0-9,.].*)", re.DOTALL)
_HERTZ = ("Hz", "hertz", "kHz")
_SUPERSCRIPT = re.compile("⁻?[¹²³]")
_PLAIN = str.maketrans("⁻¹²³", "-123")


def quantity(text: object, kind: str, *, zero: bool = False, signed: bool = False, example: str | None = None) -> float:
    """Read a quantity: a number and a unit of the right dimension.

    Parameters
    ----------
    text
        What the user wrote: a number, a space, a unit. A unit is made of names, ``*`` or a space, ``/`` and powers.
    kind
        Name of the kind expected, a key of `KINDS`.
    zero
        Whether zero is allowed.
    signed
        Whether zero and negative values are allowed.
    example
        What messages tell to write; the example of the kind if not given.

    Returns
    -------
    float
        The value in the SI unit of the kind, positive unless allowed otherwise.

    Raises
    ------
    InputError
        No unit, another dimension, no number, or a number outside the range of the kind.

    Examples
    --------
    >>> quantity("600 mm", "length"), quantity("24 in", "length"), quantity("80 m/min", "speed")
    (0.6, 0.6096, 1.3333333333333333)
    >>> quantity(200, "speed")
    Traceback (most recent call last):
        ...
    camwright.profiles.errors.InputError: 200: a number without a unit; write e.g. "200 m/min"
    """
    return float(exact_quantity(text, kind, zero=zero, signed=signed, example=example))


def exact_quantity(
    text: object, kind: str, *, zero: bool = False, signed: bool = False, example: str | None = None
) -> Fraction:
    """Read a quantity as `quantity` does, without rounding it to a float.

    Examples
    --------
    >>> exact_quantity("0.1 mm", "length")
    Fraction(1, 10000)
    """
    if isinstance(text, str):
        return _exact(text, kind, zero, signed, example or KINDS[kind].example)
    wanted = KINDS[kind] if example is None else replace(KINDS[kind], example=example)
    if isinstance(text, int | float) and not isinstance(text, bool):
        raise InputError(f'{shown(text)}: a number without a unit; write e.g. "{_repeated(text, wanted)}"')
    raise InputError(f'{shown(text)}: not {wanted.name} with a unit; write e.g. "{wanted.example}"')


def quantity_text(value: float, kind: str, example: str | None = None) -> str:
    """Write an SI value so that `quantity` reads it back bit by bit.

    It has the unit of the example where few digits do in that unit, else the SI unit of its kind.

    Parameters
    ----------
    value
        The value, finite.
    kind
        Name of its kind, a key of `KINDS`.
    example
        A quantity of the unit to write; the example of the kind if not given.

    Examples
    --------
    >>> quantity_text(0.6, "length"), quantity_text(80 / 60, "speed"), quantity_text(0.1 + 0.2, "length")
    ('600 mm', '80 m/min', '0.30000000000000004 m')
    """
    unit = (example or KINDS[kind].example).split(" ", 1)[1]
    text = f"{float(Fraction(value) / exact_quantity(f'1 {unit}', kind)):.{_FEW}g} {unit}"
    same = _TEXT.fullmatch(text) is not None and float(_sized(text, unit, kind)) == value
    return text if same else f"{value!r} {KINDS[kind].unit}"


def _sized(text: str, unit: str, kind: str) -> Fraction:
    """Value of a number and a unit, whatever its size and sign."""
    return Fraction(text.removesuffix(unit).strip()) * exact_quantity(f"1 {unit}", kind)


@lru_cache(maxsize=1024)
def _exact(text: str, kind: str, zero: bool, signed: bool, example: str) -> Fraction:
    """Read the text of a quantity; kept, because job files of one machine differ in few of them."""
    wanted = replace(KINDS[kind], example=example)
    hint = f'write e.g. "{example}"'
    number, unit = _number_and_unit(text, wanted, hint)
    factor, dimension = _unit(unit, shown(text), wanted)
    if kind == "gain" and unit in _HERTZ:
        turns = f"{float(Fraction(number) * factor):.4g} 1/s"
        raise InputError(
            f'{shown(text)}: hertz counts turns, and a gain has none; write "{number} 1/s" or, if turns are meant, "{turns}"'
        )
    if dimension != wanted.dimension:
        raise InputError(f"{shown(text)}: {_described(dimension)}, but {wanted.name} is expected; {hint}")
    exact = Fraction(number) * factor
    if (zero or signed) and exact == 0:
        return exact
    if exact <= 0 and not signed:
        least = "not below zero" if zero else "greater than zero"
        raise InputError(
            f"{shown(text)}: {'negative' if exact < 0 else 'zero'}; {wanted.name} {least} is expected; {hint}"
        )
    # as decimals: the float 1e-9 is greater than the 1e-9 that a user writes
    if not Fraction(repr(wanted.least)) <= abs(exact) <= Fraction(repr(wanted.greatest)):
        raise InputError(
            f"{shown(text)}: outside the range of {wanted.name}, "
            f"{wanted.least:g} to {wanted.greatest:g} {wanted.unit}; {hint}"
        )
    return exact


def _number_and_unit(text: str, wanted: Kind, hint: str) -> tuple[str, str]:
    """Cut the text of a quantity into a finite number and a unit."""
    if len(text) > _LONGEST:
        raise InputError(f"{shown(text)}: longer than {_LONGEST} characters; {hint}")
    comma = _COMMA.fullmatch(text.strip())
    if comma is not None:
        raise InputError(f"{shown(text)}: a comma in the number; {_without_comma(*comma.groups())}")
    found = _TEXT.fullmatch(text.strip())
    if found is None:
        raise InputError(f"{shown(text)}: not {wanted.name}, a finite number and a unit; {hint}")
    number, unit = found.group(1), found.group(2)
    if not unit:
        raise InputError(f'{shown(text)}: a number without a unit; write e.g. "{_repeated(number, wanted)}"')
    return number, unit


def dimension_of(text: str) -> dict[str, int] | None:
    """Powers of the base dimensions of a text that is a number and a unit; None where it is not.

    Examples
    --------
    >>> dimension_of("80 m/min"), dimension_of("10 %")
    ({'[length]': 1, '[time]': -1}, None)
    """
    found = _TEXT.fullmatch(text.strip()) if len(text) <= _LONGEST else None
    if found is None or not found[2]:
        return None
    try:
        return _unit(found[2], text, KINDS["length"])[1]
    except InputError:
        return None


def shown(value: object) -> str:
    """Render what the user wrote for a message: one line, at most 60 characters."""
    if isinstance(value, int) and not isinstance(value, bool) and value.bit_length() > 200:
        return "an integer of more than 60 digits"
    text = ascii(value) if isinstance(value, str) and not value.isprintable() else repr(value)
    return text if len(text) <= 60 else text[:57] + "..."


def _without_comma(whole: str, decimals: str, unit: str) -> str:
    """Say how to write a number that has a comma: with a point, or without it where it may part thousands."""
    point = f'"{whole or "0"}.{decimals} {unit}"'
    if len(decimals) == 3 and whole.strip("+-0"):
        return f'write {point} for a fraction, "{whole}{decimals} {unit}" for thousands'
    return f"write {point}"


def _repeated(number: object, kind: Kind) -> str:
    """Join the user's number and the unit of the kind's example; the example when the number cannot stand."""
    text = str(number) if not isinstance(number, int) or number.bit_length() < 50 else ""
    unit = kind.example.split(" ", 1)[1]
    return f"{text} {unit}" if re.fullmatch(r"[0-9.]{1,12}", text) and float(text) > 0 else kind.example


def _unit(text: str, place: str, wanted: Kind) -> tuple[Fraction, dict[str, int]]:
    """Read a unit expression, left to right; the factor to SI base units and the powers of the base dimensions."""
    hint = f'write e.g. "{wanted.example}"'
    plain = _SUPERSCRIPT.sub(lambda found: "^" + found.group().translate(_PLAIN), text)
    if _UNIT.fullmatch(plain) is None:
        raise InputError(f"{place}: {shown(text)} is not a unit; {hint}")
    factor, dimension = Fraction(1), dict[str, int]()
    for sign, name, power in _FACTOR.findall(plain.removeprefix("1")):
        known = _known_units().get(name)
        if known is None:
            raise InputError(
                f"{place}: there is no unit {shown(name)}; {hint}; units are m, mm, cm, um, in, ft, s, ms, min, h, "
                "fpm, rad, deg, rev, rpm, Hz, kg, g, lb, N, Nm"
            )
        exponent = (-1 if sign == "/" else 1) * int(power or 1)
        factor *= Fraction(known[0]) ** exponent
        for base, times in known[1].items():
            dimension[base] = dimension.get(base, 0) + exponent * times
    return factor, {base: times for base, times in dimension.items() if times}


def _described(dimension: dict[str, int]) -> str:
    """Name a dimension: by its kind, or by its base dimensions."""
    for kind in KINDS.values():
        if kind.dimension == dimension:
            return kind.name
    if not dimension:
        return "a number without dimension"
    return "a quantity in " + " ".join(
        f"{name.strip('[]')}^{power}" if power != 1 else name.strip("[]") for name, power in sorted(dimension.items())
    )


@cache
def _known_units() -> dict[str, tuple[str, dict[str, int]]]:
    """Read every name of a unit, its factor to SI base units as text, and the powers of the base dimensions.

    ``units.json`` is what pint makes of our definitions (``tests/house/unit_table.py``), so that no command loads pint.
    """
    known: dict[str, tuple[str, dict[str, int]]] = json.loads(
        (files("camwright.house") / "units.json").read_text(encoding="utf-8")
    )
    return known
