"""Plain plots as data: lines, marks, bars and zones in frames, quick to draw, which read well in black and white.

`camwright.house.svg` draws them in a tenth of the time that a plotting library takes to be imported.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal

from camwright.house.numbers import number
from camwright.profiles.polynomial.profile import FloatArray

APART = 38.0
"""Least distance of ticks along x (pt)."""

_MOST_DECIMALS, _LARGE = 4, 1e6
"""Ticks with more decimals, or beyond this, are written in powers of ten where that is shorter: there is no room."""


Look = Literal["grey", "hatched", "green"]
"""How a zone is told apart."""

Shape = Literal["disc", "ring", "open", "square", "frame", "diamond", "cross"]
"""What a mark looks like: an open disc is white inside, a ring and a frame let the lines be seen."""

Hatch = Literal["", "lines", "back", "crosses", "plus", "level", "dots"]
"""What lies over the colour of a bar or an area."""

DASHED = (5.0, 2.5)
"""Stroke and gap (pt) of a line that is simply dashed."""


@dataclass(frozen=True, eq=False)
class DrawnLine:
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
    dash
        Lengths of strokes and gaps in turn (pt); drawn through if empty.
    """

    points: FloatArray
    colour: str
    width: float
    label: str = ""
    dash: tuple[float, ...] = ()


@dataclass(frozen=True, eq=False)
class DrawnMarks:
    """Places of a plot: arguments as of `DrawnLine`, with the size of each mark (pt)."""

    points: FloatArray
    colour: str
    size: float
    shape: Shape
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


@dataclass(frozen=True, eq=False)
class Bar:
    """A filled rectangle.

    Parameters
    ----------
    low, high
        Two corners ``(x, y)``, in the units of the frame.
    colour
        As ``"#rrggbb"``.
    hatch
        What lies over the colour.
    label
        In the legend; none if empty.
    """

    low: tuple[float, float]
    high: tuple[float, float]
    colour: str
    hatch: Hatch = ""
    label: str = ""


@dataclass(frozen=True, eq=False)
class Area:
    """A filled outline.

    Parameters
    ----------
    points
        Its corners, shape ``(n, 2)``, in the units of the frame.
    colour, hatch, label
        As of a `Bar`.
    """

    points: FloatArray
    colour: str
    hatch: Hatch = ""
    label: str = ""


@dataclass(frozen=True, eq=False)
class Note:
    """A few words at a place of a frame, not cut off at its edges.

    Parameters
    ----------
    place
        ``(x, y)`` in the units of the frame.
    text
        The words, in one or several lines.
    anchor
        Which part of them lies at the place.
    shift
        From the place to the middle of their height (pt), y downwards.
    size
        Of the letters (pt).
    boxed
        Whether they stand on white.
    """

    place: tuple[float, float]
    text: str
    anchor: Literal["start", "middle", "end"] = "start"
    shift: tuple[float, float] = (0.0, 0.0)
    size: float = 9.0
    boxed: bool = False
    label: str = field(default="", init=False)


@dataclass(frozen=True, eq=False)
class Arrow:
    """A line upwards or downwards with a head at its end, not cut off at the edges of the frame.

    Parameters
    ----------
    place, start, tip
        Its place along x, and the heights of both ends, in the units of the frame.
    colour, width, label, dash
        As of a `DrawnLine`.
    """

    place: float
    start: float
    tip: float
    colour: str
    width: float
    label: str = ""
    dash: tuple[float, ...] = ()


Item = DrawnLine | DrawnMarks | Band | Bar | Area | Note | Arrow


@dataclass(frozen=True)
class Tick:
    """A tick that is chosen, not computed: its value in the units of the frame, and its text."""

    value: float
    text: str
    bold: bool = False


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
        What is drawn in it: bands, areas, bars, lines, marks, arrows and notes on top of each other, each the undermost first.
    xlabel, ylabel, title
        Texts; none where empty. Without an x label its ticks have no numbers either. Each may have several lines.
    grid
        Whether lines at the ticks and at zero are drawn.
    apart
        Least distance of ticks along y (pt).
    xticks, yticks
        Those along an axis, if not multiples of a round number.
    numbers
        Whether ticks along x have numbers without an x label too.
    edges
        Whether the frame is closed at its top and right.
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
    xticks: Sequence[Tick] | None = None
    yticks: Sequence[Tick] | None = None
    numbers: bool = False
    edges: bool = True


@dataclass(frozen=True, eq=False)
class Picture:
    """A page of frames.

    Parameters
    ----------
    width, height
        Its size (pt).
    title, title_left
        Above the frames, in one or several lines, none where empty, and where it begins (pt).
    frames
        What is on it.
    legend
        Items with labels, told in this order.
    legend_below
        Whether the legend stands in rows below the frames, or in the upper left corner of the first.
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
