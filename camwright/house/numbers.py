"""How numbers are written for people: the unit, its names in job files and in print, the digits."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True)
class Shown:
    """The unit in which people read a quantity.

    Parameters
    ----------
    printed
        Its name on sheets and in figures.
    factor
        By what an SI value is multiplied.
    typed
        Its name as it is typed in a job file, where that is another.
    bound
        Decimals of a bound in a message; six digits are kept where there are none.
    """

    printed: str
    factor: float = 1.0
    typed: str = ""
    bound: int | None = None


SHOWN: dict[str, Shown] = {
    "1": Shown("1"),
    "m": Shown("mm", 1e3),
    "m/s": Shown("m/min", 60.0),
    "m/s^2": Shown("m/s²", typed="m/s^2"),
    "m/s^3": Shown("m/s³", typed="m/s^3"),
    "1/m": Shown("1/m"),
    "rad": Shown("°", math.degrees(1.0), "deg", 3),
    "rad/s": Shown("1/min", 30.0 / math.pi, "rpm"),
    "rad/s^2": Shown("rad/s²", typed="rad/s^2"),
    "rad/s^3": Shown("rad/s³", typed="rad/s^3"),
    "rad/m": Shown("rad/m"),
    "rad/m^2": Shown("rad/m²", typed="rad/m^2"),
    "bandwidth": Shown("rad/s"),
    "1/s": Shown("1/s"),
    "s": Shown("ms", 1e3),
    "s^2": Shown("ms²", 1e6, "ms^2"),
    "s^3": Shown("ms³", 1e9, "ms^3"),
    "N m": Shown("N⋅m", typed="N m"),
    "J": Shown("J"),
    "kg": Shown("kg"),
    "kg m^2": Shown("kg⋅m²", typed="kg m^2"),
}
"""Units by the SI unit; ``bandwidth`` is an angular rate that is no speed of rotation."""


@dataclass(frozen=True)
class Units:
    """Units in which a job is answered, those of who wrote it.

    Parameters
    ----------
    name
        What they are together.
    shown
        Units by the SI unit.
    si_measures
        Whether measures of motion are shown in SI units on the screen.
    fine
        Decimals of a length where servo errors are told.
    decimal
        What stands before decimals in print: a point, as controllers take it, or what a reader's language has.
    """

    name: str
    shown: Mapping[str, Shown] = field(hash=False, compare=False, repr=False)
    si_measures: bool
    fine: int
    decimal: str = "."

    def measure(self, unit: str) -> Shown:
        """Give the unit in which a measure of motion is shown on the screen."""
        return Shown(si_unit(unit)) if self.si_measures else self.shown.get(unit, Shown(si_unit(unit)))


METRIC = Units("metric", SHOWN, si_measures=True, fine=4)
"""Millimetres and metres a minute."""

INCH = Units(
    "inch",
    SHOWN
    | {
        "m": Shown("in", 1 / 0.0254),
        "m/s": Shown("ft/min", 60 / 0.3048),
        "m/s^2": Shown("ft/s²", 1 / 0.3048, "ft/s^2"),
        "m/s^3": Shown("ft/s³", 1 / 0.3048, "ft/s^3"),
    },
    si_measures=False,
    fine=5,
)
"""Inches and feet a minute."""

_LENGTH = re.compile(r"\s*[-+0-9.eE]+\s*([a-zµ]+)\s*")
_IMPERIAL = frozenset({"in", "inch", "inches", "ft", "foot", "feet"})


def units_of(data: Mapping[str, object]) -> Units:
    """Tell the units of a job file's data from its cut length: inches and feet, or metric.

    Examples
    --------
    >>> units_of({"cut": {"length": "24 in"}}).name, units_of({"cut": {"length": "600 mm"}}).name, units_of({}).name
    ('inch', 'metric', 'metric')
    """
    cut = data.get("cut")
    length = cut.get("length") if isinstance(cut, Mapping) else None
    found = _LENGTH.fullmatch(length) if isinstance(length, str) else None
    return INCH if found is not None and found[1] in _IMPERIAL else METRIC


def unit_shown(unit: str, units: Units = METRIC) -> str:
    """Name the unit in which a quantity is read, as it is printed."""
    return units.shown[unit].printed


def si_unit(unit: str) -> str:
    """Write an SI unit as it is printed."""
    return unit.replace("^2", "²").replace("^3", "³").replace(" ", "⋅")


def converted(value: float, unit: str, units: Units = METRIC) -> float:
    """Turn an SI value into the unit in which it is read."""
    return value * units.shown[unit].factor


def number(value: float | None, digits: int = 5, *, without: str = "–") -> str:
    """Write a number with a decimal point, as controllers take it, with so many significant digits and a true minus.

    Examples
    --------
    >>> number(-0.30000000000000004), number(138.244694), number(2.5e-13), number(250000.0), number(None)
    ('−0.3', '138.24', '2.5e−13', '250000', '–')
    """
    if value is None:
        return without
    if value == 0.0:
        return "0"
    size = math.floor(math.log10(abs(value)))
    text = f"{value:.{max(0, digits - 1 - size)}f}" if -4 <= size < 9 else f"{value:.{digits - 1}e}"
    if "e" in text:
        mantissa, _, power = text.partition("e")
        text = f"{_trimmed(mantissa)}e{int(power)}"
    else:
        text = _trimmed(text)
    return text.replace("-", "−")


def _trimmed(text: str) -> str:
    return text.rstrip("0").rstrip(".") if "." in text else text


def shown(value: float | None, unit: str, digits: int = 5, units: Units = METRIC) -> str:
    """Write an SI value in the unit in which it is read, without the unit."""
    return in_print(number(None if value is None else converted(value, unit, units), digits), units)


def in_print(text: str, units: Units) -> str:
    """Write a number that has a decimal point with the decimal sign of its reader.

    Examples
    --------
    >>> from dataclasses import replace
    >>> in_print("13.333", replace(METRIC, decimal=","))
    '13,333'
    """
    return text.replace(".", units.decimal)


def fine_length(value: float, units: Units = METRIC) -> float:
    """Round a length to a tenth of a micrometre, in inches to a hundred thousandth, in the unit in which it is read."""
    return round(converted(value, "m", units), units.fine)


def with_unit(value: float, unit: str, digits: int = 5, units: Units = METRIC) -> str:
    """Write an SI value with its unit as it is printed; with the SI unit itself where no other is shown."""
    if unit not in units.shown:
        return f"{number(value, digits)} {unit}"
    symbol = unit_shown(unit, units)
    gap = "" if symbol == "°" else " "
    return shown(value, unit, digits, units) + ("" if symbol == "1" else gap + symbol)


def typed(value: float, unit: str, digits: int = 10, units: Units = METRIC) -> str:
    """Write an SI value as it is typed in a job file.

    Examples
    --------
    >>> typed(0.6, "m"), typed(-0.5235987755982988, "rad"), typed(0.7, "1")
    ('600 mm', '-30 deg', '0.7')
    >>> typed(0.6096, "m", units=INCH), typed(1.3208, "m/s", units=INCH)
    ('24 in', '260 ft/min')
    """
    name = units.shown[unit].typed or units.shown[unit].printed
    return f"{converted(value, unit, units):.{digits}g}{'' if name == '1' else ' ' + name}"


def inside(value: float, digits: int = 5, *, up: bool) -> float:
    """Round the end of a range to so many digits, up or down: what is told lies inside what was found.

    Examples
    --------
    >>> inside(81.67498, up=False), inside(81.67402, up=True), inside(80.0, up=False)
    (81.674, 81.675, 80.0)
    """
    if value <= 0.0:
        return 0.0
    scale = 10.0 ** (digits - 1 - math.floor(math.log10(value)))
    return (math.ceil(value * scale - 1e-4) if up else math.floor(value * scale + 1e-4)) / scale
