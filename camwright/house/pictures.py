"""Plain plots as data: lines, marks and zones in frames, for sheets that must be quick to draw and read well in black and white.

`camwright.house.svg` draws them in a tenth of the time that a plotting library takes to be imported.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from camwright.house.numbers import number
from camwright.profiles.polynomial.profile import FloatArray

APART = 38.0
"""Least distance of ticks along x (pt)."""

_MOST_DECIMALS, _LARGE = 4, 1e6
"""Ticks with more decimals, or beyond this, are written in powers of ten where that is shorter: there is no room."""


Look = Literal["grey", "hatched"]
"""How a zone is told apart."""


@dataclass(frozen=True, eq=False)
class Line:
    """A line of a plot.

    Parameters
    ----------
    points
        Shape ``(n, 2)``, in the units of the panel; NaN between stretches.
    colour
        As ``"#rrggbb"``.
    width
        Of the stroke (pt).
    label
        In the legend; none if empty.
    dashed
        Whether it is.
    """

    points: FloatArray
    colour: str
    width: float
    label: str = ""
    dashed: bool = False


@dataclass(frozen=True, eq=False)
class Marks:
    """Places of a plot: arguments as of `Line`, with the size of each mark (pt)."""

    points: FloatArray
    colour: str
    size: float
    shape: Literal["disc", "ring", "square"]
    label: str = ""


@dataclass(frozen=True, eq=False)
class Band:
    """A part of x over the whole height, under everything else.

    Parameters
    ----------
    start, end
        Where it is, in the units of the frame; of no length it is a dotted line.
    look
        How it is told apart.
    label
        In the legend; none if empty.
    """

    start: float
    end: float
    look: Look
    label: str = ""


Item = Line | Marks | Band


@dataclass(frozen=True, eq=False)
class Frame:
    """One system of axes.

    Parameters
    ----------
    left, top, width, height
        Its frame on the page (pt).
    low, high
        Ranges of x and y, shape ``(2,)`` each.
    items
        What is drawn in it: bands, lines and marks on top of them, each the undermost first.
    xlabel, ylabel, title
        Texts; none where empty. Without an x label its ticks have no numbers either. A y label may have several lines.
    grid
        Whether lines at the ticks and at zero are drawn.
    apart
        Least distance of ticks along y (pt).
    """

    left: float
    top: float
    width: float
    height: float
    low: FloatArray
    high: FloatArray
    items: Sequence[Item]
    xlabel: str = ""
    ylabel: str = ""
    title: str = ""
    grid: bool = False
    apart: float = APART


@dataclass(frozen=True, eq=False)
class Picture:
    """A page of frames.

    Parameters
    ----------
    width, height
        Its size (pt).
    title, title_left
        Above the frames, none where empty, and where it begins (pt).
    frames
        What is on it.
    legend
        Items with labels, told in this order.
    legend_below
        Whether the legend stands in a row below the frames, or in the upper left corner of the first.
    """

    width: float
    height: float
    title: str
    title_left: float
    frames: Sequence[Frame]
    legend: Sequence[Item]
    legend_below: bool = True


def ticks(low: float, high: float, most: int) -> tuple[list[float], list[str]]:
    """Choose the multiples of 1, 2 or 5 times a power of ten in a range, ``most`` of them at most, and write them."""
    power = math.floor(math.log10((high - low) / most))
    for part in (1.0, 2.0, 5.0, 10.0, 20.0):
        step = part * 10.0**power
        first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
        if last - first < most:
            break
    power = math.floor(math.log10(step) + 1e-9)
    values = [count * step for count in range(first, last + 1)]
    greatest = max(abs(first), abs(last)) * step
    if power < -_MOST_DECIMALS or greatest >= _LARGE:
        return values, [number(value, math.floor(math.log10(greatest)) - power + 1) for value in values]
    texts = [f"{value:.{max(0, -power)}f}" for value in values]
    return values, [text.replace("-", "\u2212") for text in texts]
