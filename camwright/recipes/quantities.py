"""How SI numbers are shown to a fitter: unit, factor and digits."""

from __future__ import annotations

import math

SHOWN: dict[str, tuple[str, float]] = {
    "1": ("1", 1.0),
    "m": ("mm", 1e3),
    "m/s": ("m/min", 60.0),
    "m/s^2": ("m/s²", 1.0),
    "m/s^3": ("m/s³", 1.0),
    "1/m": ("1/m", 1.0),
    "rad": ("°", math.degrees(1.0)),
    "rad/s": ("1/min", 30.0 / math.pi),
    "rad/s^2": ("rad/s²", 1.0),
    "rad/s^3": ("rad/s³", 1.0),
    "rad/m": ("rad/m", 1.0),
    "rad/m^2": ("rad/m²", 1.0),
    "bandwidth": ("rad/s", 1.0),
    "1/s": ("1/s", 1.0),
    "s": ("ms", 1e3),
    "N m": ("N⋅m", 1.0),
    "J": ("J", 1.0),
    "kg": ("kg", 1.0),
    "kg m^2": ("kg⋅m²", 1.0),
}
"""Unit shown and factor to it, by SI unit; ``bandwidth`` is an angular rate that is no speed of rotation."""


def unit_shown(unit: str) -> str:
    """Name the unit in which a fitter reads a quantity."""
    return SHOWN[unit][0]


def si_unit(unit: str) -> str:
    """Write an SI unit as it is printed."""
    return unit.replace("^2", "²").replace("^3", "³").replace(" ", "⋅")


def converted(value: float, unit: str) -> float:
    """Turn an SI value into the unit in which a fitter reads it."""
    return value * SHOWN[unit][1]


def number(value: float, digits: int = 5) -> str:
    """Write a number with a decimal point, as controllers take it, with so many significant digits and a true minus.

    Examples
    --------
    >>> number(-0.30000000000000004), number(138.244694), number(2.5e-13), number(250000.0)
    ('−0.3', '138.24', '2.5e−13', '250000')
    """
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


def shown(value: float, unit: str, digits: int = 5) -> str:
    """Write an SI value in the unit in which a fitter reads it, without the unit."""
    return number(converted(value, unit), digits)


def with_unit(value: float, unit: str, digits: int = 5) -> str:
    """Write an SI value with its unit as a fitter reads it."""
    symbol = unit_shown(unit)
    gap = "" if symbol == "°" else " "
    return shown(value, unit, digits) + ("" if symbol == "1" else gap + symbol)
