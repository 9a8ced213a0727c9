"""How numbers are written for people: the unit, its names in job files and in print, the digits."""

from __future__ import annotations

import math
from dataclasses import dataclass


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
    "N m": Shown("N⋅m", typed="N m"),
    "J": Shown("J"),
    "kg": Shown("kg"),
    "kg m^2": Shown("kg⋅m²", typed="kg m^2"),
}
"""Units by the SI unit; ``bandwidth`` is an angular rate that is no speed of rotation."""


def unit_shown(unit: str) -> str:
    """Name the unit in which a quantity is read, as it is printed."""
    return SHOWN[unit].printed


def si_unit(unit: str) -> str:
    """Write an SI unit as it is printed."""
    return unit.replace("^2", "²").replace("^3", "³").replace(" ", "⋅")


def converted(value: float, unit: str) -> float:
    """Turn an SI value into the unit in which it is read."""
    return value * SHOWN[unit].factor


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


def shown(value: float | None, unit: str, digits: int = 5) -> str:
    """Write an SI value in the unit in which it is read, without the unit."""
    return number(None if value is None else converted(value, unit), digits)


def with_unit(value: float, unit: str, digits: int = 5) -> str:
    """Write an SI value with its unit as it is printed."""
    symbol = unit_shown(unit)
    gap = "" if symbol == "°" else " "
    return shown(value, unit, digits) + ("" if symbol == "1" else gap + symbol)


def typed(value: float, unit: str, digits: int = 10) -> str:
    """Write an SI value as it is typed in a job file.

    Examples
    --------
    >>> typed(0.6, "m"), typed(-0.5235987755982988, "rad"), typed(0.7, "1")
    ('600 mm', '-30 deg', '0.7')
    """
    name = SHOWN[unit].typed or SHOWN[unit].printed
    return f"{converted(value, unit):.{digits}g}{'' if name == '1' else ' ' + name}"
