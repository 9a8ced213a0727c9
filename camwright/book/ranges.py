"""Ranges of a quantity as users write them: ``start:stop:step``, or one value."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction

from camwright.house.units import KINDS, exact_quantity, shown
from camwright.profiles.errors import InputError

MOST_VALUES = 1000
"""Most values of one range: also the most entries of a folder of the book."""

_BARE = re.compile(r"\s*[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]{1,3})?\s*")


@dataclass(frozen=True)
class Range:
    """Equidistant values, exact.

    Parameters
    ----------
    step
        What each is above the one before.
    count
        Number of values.
    """

    first: Fraction
    step: Fraction
    count: int

    def __len__(self) -> int:
        """Count the values."""
        return self.count

    def __getitem__(self, index: int) -> Fraction:
        """Give the value of an index, 0 and up."""
        if not 0 <= index < self.count:
            raise IndexError(index)
        first, step = self.first, self.step
        return Fraction(
            first.numerator * step.denominator + index * step.numerator * first.denominator,
            first.denominator * step.denominator,
        )

    def __iter__(self) -> Iterator[Fraction]:
        """Give the values, ascending."""
        return map(self.__getitem__, range(self.count))

    @property
    def last(self) -> Fraction:
        """The last value."""
        return self[self.count - 1]


def parse_range(text: str, option: str, kind: str, unit: str) -> Range:
    """Read a range: every value from the start by the step, the stop included if a step falls on it.

    Parameters
    ----------
    text
        ``start:stop:step`` or one value; each a bare number in the unit given or a number with a unit of the same kind.
    option
        What messages begin with, e.g. ``"--length"``.
    kind
        Name of the kind of quantity, a key of `camwright.house.units.KINDS`.
    unit
        Unit of bare numbers.

    Returns
    -------
    Range
        The values in the SI unit, ascending.

    Raises
    ------
    InputError
        Every fault of the range.

    Examples
    --------
    >>> [float(value) for value in parse_range("250:270:10", "--length", "length", "mm")]
    [0.25, 0.26, 0.27]
    >>> list(parse_range("1 m/s", "--line-speed", "speed", "m/min"))
    [Fraction(1, 1)]
    """
    parts = text[:200].split(":")
    example = KINDS[kind].example.split(" ")[0]
    if len(parts) not in (1, 3):
        raise InputError(
            f"{option} {shown(text)}: not start:stop:step and not one value; write e.g. "
            f"{example}:{2 * int(example)}:10 ({unit}) or {example}"
        )
    values, faults = [], []
    for name, part in zip(("start", "stop", "step"), parts, strict=False):
        try:
            values.append(exact_quantity(f"{part.strip()} {unit}" if _BARE.fullmatch(part) else part.strip(), kind))
        except InputError as error:
            faults.append(f"{option}{f', {name}' if len(parts) == 3 else ''}: {error}")
    if faults:
        raise InputError(*faults)
    if len(values) == 1:
        return Range(values[0], Fraction(0), 1)
    start, stop, step = values
    if start > stop:
        raise InputError(
            f"{option} {shown(text)}: the start lies beyond the stop; write the smaller value first, "
            f"{parts[1].strip()}:{parts[0].strip()}:{parts[2].strip()}"
        )
    count = int((stop - start) / step) + 1
    if count > MOST_VALUES:
        raise InputError(
            f"{option} {shown(text)}: {count} values, the limit is {MOST_VALUES}; take a step of at least "
            f"{float((stop - start) / (MOST_VALUES - 1)):.6g} {KINDS[kind].unit}, or make several books"
        )
    return Range(start, step if count > 1 else Fraction(0), count)


def decimal(value: Fraction) -> str:
    """Write an exact number with as many digits as it needs, at most 15.

    Examples
    --------
    >>> decimal(Fraction(250)), decimal(Fraction(501, 2)), decimal(Fraction(50, 3))
    ('250', '250.5', '16.6666666666667')
    """
    return f"{float(value):.15g}"


def distinct(values: Range, scale: Fraction) -> bool:
    """Whether no two values are written alike in a unit of which the SI unit holds ``scale``."""
    return len({decimal(value * scale) for value in values}) == len(values)
