"""`Message`: what an error says, its numbers and names apart from its words, so that who knows the user's own can put them in."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import Literal

Toward = Literal["nearest", "below", "above"]

HOLE = re.compile(r"\{(@?)([\w.]+)\}")
"""A hole in a sentence: the sign of a quantity's name, and the name."""


def rounded_to(value: float, digits: int, up: bool) -> float:
    """Round to a number of digits, up or down."""
    scale = 10.0 ** (digits - 1 - math.floor(math.log10(abs(value))))
    return (math.ceil(value * scale - 1e-6) if up else math.floor(value * scale + 1e-6)) / scale


@dataclass(frozen=True)
class Value:
    """A number in a message.

    Parameters
    ----------
    number
        The number (SI).
    unit
        Its SI unit; empty for none.
    digits
        Significant digits.
    toward
        ``"below"`` or ``"above"`` for a bound that itself does not work, so that what is printed does: six digits are kept then.
    chosen
        Number and unit as they were rounded and found to work, if they were: printed as they are, but in another unit beyond them.
    """

    number: float
    unit: str
    digits: int = 10
    toward: Toward = "nearest"
    chosen: str = ""

    def written(self, factor: float, unit: str, decimals: int | None = None) -> str:
        """Write it in a unit that it is a number of times of; a bound with so many decimals, if given."""
        number, gap = self.number * factor, f" {unit}" if unit else ""
        if self.chosen and self.chosen.endswith(gap):
            return self.chosen
        if self.toward == "nearest":
            return f"{number:.{self.digits}g}{gap}"
        up = self.toward == "above"
        if decimals is not None:
            aside = 0.5 * 10.0**-decimals
            return f"{number + (aside if up else -aside):.{decimals}f}{gap}"
        step = 10.0 ** (math.floor(math.log10(number)) - 5)
        number = (math.floor(number / step + 1e-6) + 1 if up else math.ceil(number / step - 1e-6) - 1) * step
        return f"{number:.{self.digits}g}{gap}"


@dataclass(frozen=True)
class Message:
    """What is wrong: quantity, value, limit, way out.

    Parameters
    ----------
    text
        The sentence, with ``{name}`` where a value belongs and ``{@quantity}`` where a quantity is named, which a job file has a
        place for; a number of the machine is ``{@machine.stroke}``.
    values
        The values by name.

    Examples
    --------
    >>> str(Message("{@sync_zone} = {zone}: above the stroke of {stroke}", (("zone", Value(0.5, "m")), ("stroke", Value(0.4, "m")))))
    'sync zone = 0.5 m: above the stroke of 0.4 m'
    """

    text: str
    values: tuple[tuple[str, Value], ...] = ()

    def __str__(self) -> str:
        """Write it in SI units, with plain names."""
        known = dict(self.values)

        def filled(found: re.Match[str]) -> str:
            name = found[2]
            if found[1]:
                return name.rpartition(".")[2].replace("_", " ")
            return known[name].chosen or known[name].written(1.0, known[name].unit)

        return HOLE.sub(filled, self.text)


MOST_PERCENT = 1000.0
"""Greatest share that is told in per cent."""


def part_of(share: float) -> str:
    """Tell a share of what is named next: in per cent, as a multiple where that would be more than anyone reads.

    Examples
    --------
    >>> part_of(0.125), part_of(241.0), part_of(12345.6)
    ('12.5 % of', '241 times', '12346 times')
    """
    if 100.0 * share <= MOST_PERCENT:
        return f"{100.0 * share:.3g} % of"
    return f"{share:.3g} times" if share < MOST_PERCENT else f"{share:.0f} times"
