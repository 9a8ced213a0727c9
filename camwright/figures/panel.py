"""What the figures of a design are made of: their page, the lines of profiles, limits, zones and titles."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from camwright.figures.strokes import LIMIT, LINES, Stroke
from camwright.figures.style import zone_parts
from camwright.house.numbers import Units, converted
from camwright.house.pictures import Band, DrawnLine, Frame, Item, Look, Picture, Tick
from camwright.house.svg import legend_rows
from camwright.profiles.cut import Cut
from camwright.profiles.polynomial.profile import FloatArray

WIDTH, LEFT, RIGHT = 648.0, 72.0, 24.0
"""The page, and what is free beside its frames (pt)."""

TITLE = 15.0
"""Height of a line of the title (pt)."""

_LEGEND_ROW, _LEGEND_MARGIN = 15.0, 8.0
_LONGEST_TITLE = 84
_MOST_POINTS = 4000
"""Points drawn of a sampling phase; far more than a printed line shows."""

NOTHING: FloatArray = np.empty((0, 2))
"""No points: what a sample of a legend has."""


def stroked(stroke: Stroke, points: FloatArray, label: str = "") -> DrawnLine:
    """Draw a curve, points of shape ``(n, 2)``."""
    return DrawnLine(points, stroke.colour, stroke.width, label, stroke.dash)


def profile_line(name: str, points: FloatArray, label: str = "") -> DrawnLine:
    """Draw a curve of a profile in its own colour and dash; points of shape ``(n, 2)``."""
    return stroked(LINES[name], points, label)


def phase_lines(name: str, curves: Sequence[FloatArray]) -> list[DrawnLine]:
    """Draw the curve of each sampling phase: the first in the profile's own line, the others thin below it, one line with gaps."""
    gap = np.full((1, 2), np.nan)
    others = [part for each in curves[1:] for part in (_stride(each), gap)]
    thin = [thin_line(name, np.concatenate(others))] if others else []
    return [*thin, profile_line(name, _stride(curves[0]))]


def _stride(values: FloatArray) -> FloatArray:
    """Take as many points as a line needs."""
    return values[:: max(1, len(values) // _MOST_POINTS)]


def thin_line(name: str, points: FloatArray, label: str = "") -> DrawnLine:
    """Draw what goes with a curve, thin and in its colour."""
    return DrawnLine(points, LINES[name].colour, 0.5, label)


def across(value: float, start: float, end: float, label: str = "") -> DrawnLine:
    """Mark a limit: a dotted line at a height."""
    return stroked(LIMIT, np.array([[start, value], [end, value]]), label)


def zone_bands(cut: Cut, units: Units) -> list[Band]:
    """Shade sync zone and shear zone of a cycle."""
    return [
        *(band(start, end, "sync zone", units) for start, end in cut.sync_parts),
        *(band(start, end, "shear zone", units) for start, end in zone_parts(cut, cut.shear_start, cut.shear_zone)),
    ]


def band(start: float, end: float, label: str, units: Units) -> Band:
    """Shade a zone given in m."""
    look: Look = "hatched" if label == "shear zone" else "grey"
    return Band(converted(start, "m", units), converted(end, "m", units), look, label)


def head(name: str, words: str) -> str:
    """Write a title: a job's name, and what is drawn of it, on a second line where one is too short."""
    return f"{name}: {words}" if len(name) + len(words) < _LONGEST_TITLE else f"{name}:\n{words}"


def page(title: str, frames: Sequence[Frame], legend: Sequence[Item]) -> Picture:
    """Put frames on a page that ends below its legend; that of each label comes once."""
    told = list({item.label: item for item in legend}.values())
    lowest = max(
        frame.top + frame.height + (16.0 + 14.0 * len(frame.xlabel.split("\n")) if frame.xlabel else 16.0)
        for frame in frames
    )
    height = lowest + _LEGEND_ROW * len(legend_rows(told, WIDTH)) + _LEGEND_MARGIN
    return Picture(WIDTH, 12.0 * math.ceil(height / 12.0), title, LEFT, frames, told)


def wide_frame(
    top: float,
    height: float,
    low: FloatArray,
    high: FloatArray,
    items: Sequence[Item],
    xlabel: str = "",
    ylabel: str = "",
    title: str = "",
    *,
    apart: float = 24.0,
    yticks: Sequence[Tick] | None = None,
) -> Frame:
    """Make a panel over the whole width of the page, with lines at its ticks; arguments as of a `Frame`."""
    words = (xlabel, ylabel, title)
    return Frame(LEFT, top, WIDTH - LEFT - RIGHT, height, low, high, items, *words, True, apart, yticks=yticks)


def first_frame(title: str) -> float:
    """Top of the first frame below a title (pt)."""
    return 12.0 * math.ceil((12.0 + TITLE * len(title.split("\n"))) / 12.0)
