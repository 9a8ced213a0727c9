"""What the figures of a design are made of: their page, the lines of profiles, limits, zones and titles."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from camwright.figures.style import LINES, zone_parts
from camwright.house.numbers import Units, converted
from camwright.house.pictures import Band, Frame, Item, Line, Look, Picture
from camwright.house.svg import legend_rows
from camwright.profiles.cut import Cut
from camwright.profiles.polynomial.profile import FloatArray

WIDTH, LEFT, RIGHT = 624.0, 72.0, 24.0
"""The page, and what is free beside its frames (pt)."""

TITLE = 15.0
"""Height of a line of the title (pt)."""

_LEGEND_ROW, _LEGEND_MARGIN = 15.0, 8.0
_LONGEST_TITLE = 84

_LOOKS: dict[str, tuple[float, tuple[float, ...]]] = {
    "optimised": (2.2, ()),
    "linear_return": (1.5, (8.0, 2.6)),
    "poly_3_4_5": (1.5, (9.0, 2.3, 2.0, 2.3)),
}
"""Width and dash of each profile drawn (pt)."""

BLACK, GREY = "#000", "#6b6b6b"
DOTTED = (1.3, 2.0)


def profile_line(name: str, points: FloatArray, label: str = "") -> Line:
    """Draw a curve of a profile in its own colour and dash; points of shape ``(n, 2)``."""
    width, dash = _LOOKS[name]
    return Line(points, LINES[name]["color"], width, label, dash)


def thin_line(name: str, points: FloatArray, label: str = "") -> Line:
    """Draw what goes with a curve, thin and in its colour."""
    return Line(points, LINES[name]["color"], 0.5, label)


def across(value: float, start: float, end: float, label: str = "") -> Line:
    """Mark a limit: a dotted line at a height."""
    return Line(np.array([[start, value], [end, value]]), BLACK, 1.3, label, DOTTED)


def upright(place: float, low: float, high: float, label: str = "") -> Line:
    """Mark a limit: a dotted line at a place."""
    return Line(np.array([[place, low], [place, high]]), BLACK, 1.3, label, DOTTED)


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
    lowest = max(frame.top + frame.height + (30.0 if frame.xlabel else 16.0) for frame in frames)
    height = lowest + _LEGEND_ROW * len(legend_rows(told, WIDTH)) + _LEGEND_MARGIN
    return Picture(WIDTH, 12.0 * math.ceil(height / 12.0), title, LEFT, frames, told)


def first_frame(title: str) -> float:
    """Top of the first frame below a title (pt)."""
    return 12.0 * math.ceil((12.0 + TITLE * len(title.split("\n"))) / 12.0)
