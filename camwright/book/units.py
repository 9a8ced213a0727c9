"""The units of a book: those of its job, exact where lengths and speeds are written into job files."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from camwright.house.numbers import INCH, Units

_FOOT = Fraction("0.3048")


@dataclass(frozen=True)
class BookUnits:
    """Units in which a book is read.

    Parameters
    ----------
    length, speed
        Units of cut lengths and line speeds, as they are typed.
    per_metre, per_metre_per_second
        How many of them the SI unit holds.
    velocity, acceleration, jerk
        The same of the motion's measures.
    endings
        Endings of the columns' names, by those of a metric book.
    """

    length: str
    speed: str
    per_metre: Fraction
    per_metre_per_second: Fraction
    velocity: float
    acceleration: float
    jerk: float
    endings: Mapping[str, str]

    def named(self, columns: Sequence[str]) -> tuple[str, ...]:
        """Name columns by these units.

        Examples
        --------
        >>> INCHES.named(["number", "length_mm", "released_m_per_min", "peak_jerk_m_per_s3"])
        ('number', 'length_in', 'released_ft_per_min', 'peak_jerk_ft_per_s3')
        """
        return tuple(self._named(column) for column in columns)

    def valued(self, value: float | None, unit: str) -> tuple[float | None, str]:
        """Put the value of an objective into these units; arguments and answer with the unit as it is typed.

        Examples
        --------
        >>> value, unit = INCHES.valued(30.48, "m/s^2")
        >>> round(value, 9), unit, METRES.valued(2.0, "m/s^2")
        (100.0, 'ft/s^2', (2.0, 'm/s^2'))
        """
        if value is None or not self.endings or unit not in INCH.shown:
            return value, unit
        measure = INCH.shown[unit]
        return value * measure.factor, measure.typed or measure.printed

    def _named(self, column: str) -> str:
        for metric, own in self.endings.items():
            if column.endswith(metric):
                return column.removesuffix(metric) + own
        return column


METRES = BookUnits("mm", "m/min", Fraction(1000), Fraction(60), 1.0, 1.0, 1.0, {})
"""Millimetres and metres a minute; measures of motion in SI units."""

INCHES = BookUnits(
    "in",
    "ft/min",
    1 / Fraction("0.0254"),
    60 / _FOOT,
    float(60 / _FOOT),
    float(1 / _FOOT),
    float(1 / _FOOT),
    {
        "_mm": "_in",
        "_m_per_min": "_ft_per_min",
        "_m_per_s": "_ft_per_min",
        "_m_per_s2": "_ft_per_s2",
        "_m_per_s3": "_ft_per_s3",
    },
)
"""Inches and feet a minute."""


def book_units(units: Units) -> BookUnits:
    """Give the units of a book by those of its job."""
    return INCHES if units == INCH else METRES
