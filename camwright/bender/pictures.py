"""Plain plots as data, drawn by typst: lines and marks in panels, for outlines of many thousand sides.

The sheet is set by typst anyway, and it draws 10 000 segments in a tenth of the time that a plotting library takes to be
imported. Lines stay lines; only what no printer shows is left out of them.
"""

from __future__ import annotations

import base64
import json
import math
import re
import shutil
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np

from camwright.profiles.polynomial.profile import FloatArray

_TEMPLATE = Path(__file__).parent / "templates" / "figure.typ"
_PIXELS_PER_INCH = 150.0
_KINDS: tuple[Literal["svg", "png"], ...] = ("svg", "png")

FINEST = 0.06
"""Distance (pt) below which points of a line are one, and a point on the way is none: finer than 1200 dpi."""

_PASSES = 6
"""Times that every second point may go; the line moves by no more than this many times `FINEST` in all."""

_STROKES = 'fill="none" stroke-linejoin="round"'
_EMBEDDED = re.compile(r'<image [^>]*href="data:image/svg\+xml;base64,([A-Za-z0-9+/=]*)"[^>]*/>')

_APART = 38.0
"""Least distance of ticks along x (pt)."""


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
class Frame:
    """One system of axes.

    Parameters
    ----------
    left, top, width, height
        Its frame on the page (pt).
    low, high
        Ranges of x and y, shape ``(2,)`` each.
    items
        What is drawn in it: lines, the undermost first, and marks on top of them.
    xlabel, ylabel, title
        Texts; none where empty. Without an x label its ticks have no numbers either.
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
    items: Sequence[Line | Marks]
    xlabel: str = ""
    ylabel: str = ""
    title: str = ""
    grid: bool = False
    apart: float = _APART


@dataclass(frozen=True, eq=False)
class Picture:
    """A page of panels.

    Parameters
    ----------
    width, height
        Its size (pt).
    title, title_left
        Above the panels, and where it begins (pt).
    panels
        What is on it.
    legend
        Lines and marks with labels, told in this order.
    legend_below
        Whether the legend stands in a row below the panels, or in the upper left corner of the first.
    """

    width: float
    height: float
    title: str
    title_left: float
    panels: Sequence[Frame]
    legend: Sequence[Line | Marks]
    legend_below: bool = True


def ticks(low: float, high: float, most: int) -> tuple[list[float], list[str]]:
    """Choose the multiples of 1, 2 or 5 times a power of ten in a range, ``most`` of them at most, and write them."""
    power = math.floor(math.log10((high - low) / most))
    for part in (1.0, 2.0, 5.0, 10.0, 20.0):
        step = part * 10.0**power
        first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
        if last - first < most:
            break
    decimals = max(0, -math.floor(math.log10(step) + 1e-9))
    values = [number * step for number in range(first, last + 1)]
    return values, [f"{abs(value):.{decimals}f}" if value >= 0 else f"\u2212{-value:.{decimals}f}" for value in values]


def simplified(points: FloatArray) -> FloatArray:
    """Leave out of a line (pt) what cannot be seen: points that lie together, and points on the way between others."""
    kept = points[np.concatenate([[True], (np.abs(np.diff(points, axis=0)) > 0).any(axis=1)])]
    for _ in range(_PASSES):
        if len(kept) < 3:
            break
        before, here, after = kept[:-2], kept[1:-1], kept[2:]
        along, out = after - before, here - before
        size = np.maximum(np.hypot(*along.T), 1e-9)
        part = np.clip((out * along).sum(axis=1) / size**2, 0.0, 1.0)
        away = np.hypot(*(out - part[:, None] * along).T)
        gone = np.concatenate([[False], away <= FINEST, [False]])
        gone[2::2] = False  # of neighbours one stays
        if not gone.any():
            gone = np.concatenate([[False], away <= FINEST, [False]])
            gone[1::2] = False
            if not gone.any():
                break
        kept = kept[~gone]
    return np.asarray(kept, dtype=np.float64)


def _on_page(panel: Frame, points: FloatArray) -> FloatArray:
    """Turn places of a panel into places in its frame (pt), y downwards."""
    size = np.array([panel.width, panel.height])
    part = (points - panel.low) / (panel.high - panel.low)
    return np.asarray(np.round(np.where([False, True], 1.0 - part, part) * size, 2), dtype=np.float64)


def _lines(panel: Frame) -> str:
    """Write the lines of a panel as SVG: typst takes it in a fifth of the time of as many segments of its own."""
    box = f"0 0 {panel.width:g} {panel.height:g}"
    head = f'<svg xmlns="http://www.w3.org/2000/svg" width="{panel.width:g}" height="{panel.height:g}" viewBox="{box}"'
    found = [f"{head} {_STROKES}>"]
    for item in panel.items:
        if isinstance(item, Line):
            places = _on_page(panel, item.points)
            ends = np.flatnonzero(np.isnan(places).any(axis=1))
            parts = [part[~np.isnan(part).any(axis=1)] for part in np.split(places, ends)]
            paths = [" ".join(map(str, simplified(part).ravel().tolist())) for part in parts if len(part) > 1]
            if paths:
                dash = ' stroke-dasharray="5 2.5"' if item.dashed else ""
                look = f'stroke="{item.colour}" stroke-width="{item.width:g}"{dash}'
                found.append(f'<path d="M{"M".join(paths)}" {look}/>')
    return "".join([*found, "</svg>"])


def _look(item: Line | Marks) -> dict[str, Any]:
    if isinstance(item, Marks):
        return {"shape": item.shape, "colour": item.colour, "size": item.size, "label": item.label}
    return {"shape": "line", "colour": item.colour, "width": item.width, "dashed": item.dashed, "label": item.label}


def _panel(panel: Frame) -> dict[str, Any]:
    axes = []
    for axis, most in enumerate((panel.width / _APART, panel.height / panel.apart)):
        values, labels = ticks(float(panel.low[axis]), float(panel.high[axis]), max(3, round(most)))
        marks = np.repeat(np.array(values)[:, None], 2, axis=1)
        axes.append(
            [[place, label] for place, label in zip(_on_page(panel, marks)[:, axis].tolist(), labels, strict=True)]
        )
    zero = float(_on_page(panel, np.zeros((1, 2)))[0, 1])
    return {
        "frame": [panel.left, panel.top, panel.width, panel.height],
        "lines": _lines(panel),
        "marks": [
            {**_look(item), "points": _on_page(panel, item.points).tolist()}
            for item in panel.items
            if isinstance(item, Marks)
        ],
        "xticks": axes[0],
        "yticks": axes[1],
        "xlabel": panel.xlabel,
        "ylabel": panel.ylabel,
        "title": panel.title,
        "grid": panel.grid,
        "zero": zero if 0 <= zero <= panel.height else None,
    }


def _unfolded(svg: str) -> str:
    """Put the lines of the panels themselves in the place of the pictures in the picture that typst makes of them."""

    def inner(found: re.Match[str]) -> str:
        lines = base64.b64decode(found[1]).decode("utf-8")
        return f"<g {_STROKES}{lines[lines.index('>') :].removesuffix('</svg>')}</g>"

    return _EMBEDDED.sub(inner, svg)


def write_pictures(pictures: Mapping[str, Picture], directory: Path) -> None:
    """Write pictures by name, each as SVG (text as outlines) and PNG."""
    import typst

    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder) / "figure.typ"
        shutil.copy(_TEMPLATE, source)
        for name, picture in pictures.items():
            data = {
                "width": picture.width,
                "height": picture.height,
                "title": picture.title,
                "title_left": picture.title_left,
                "panels": [_panel(panel) for panel in picture.panels],
                "legend": [_look(item) for item in picture.legend],
                "legend_below": picture.legend_below,
            }
            source.with_suffix(".json").write_text(json.dumps(data), encoding="utf-8")
            for kind in _KINDS:
                file = directory / f"{name}.{kind}"
                typst.compile(
                    str(source),
                    output=str(file),
                    root=folder,
                    ignore_system_fonts=True,
                    format=kind,
                    ppi=_PIXELS_PER_INCH,
                )
                if kind == "svg":
                    file.write_text(_unfolded(file.read_text(encoding="utf-8")), encoding="utf-8")
