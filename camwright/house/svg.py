"""Drawing a picture as SVG: lines stay lines and text stays text; only what no printer shows is left out of a line."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from html import escape

import numpy as np

from camwright.house.pictures import APART, Band, Frame, Item, Line, Marks, Picture, ticks
from camwright.profiles.polynomial.profile import FloatArray

FINEST = 0.06
"""Distance (pt) below which points of a line are one, and a point on the way is none: finer than 1200 dpi."""

_PASSES = 6
"""Times that every second point may go; the line moves by no more than this many times `FINEST` in all."""

_FONTS = "DejaVu Sans, Noto Sans SC, Arial, sans-serif"
_TEXT, _TITLE = 10.0, 12.0
_BASE = 0.36
"""From the middle of a line of text down to its base, by its size."""

_WIDE, _NARROW = 1.0, 0.62
"""Width of a letter by its size, of Chinese and of the rest, at most but for rare ones: what the legend leaves room for."""

_HATCH = (
    '<defs><pattern id="cam-hatch" width="6" height="6" patternUnits="userSpaceOnUse">'
    '<path d="M-1 1L1 -1M0 6L6 0M5 7L7 5" stroke="#555" stroke-width="0.8"/></pattern></defs>'
)
_FILLS = {"grey": "#e4e4e4", "hatched": "url(#cam-hatch)"}
_BLACK, _GRID, _ZERO = "#000", "#ccc", "#999"
_SAMPLE, _GAP, _BETWEEN, _BELOW = 24.0, 7.0, 22.0, 12.0
"""Length of a sample in the legend, from it to its text, from entry to entry, and from the legend's middle to the lower edge (pt)."""


def picture_svg(picture: Picture) -> str:
    """Draw a picture; the same picture gives the same text."""
    width, height = picture.width, picture.height
    size = f'width="{width:g}pt" height="{height:g}pt" viewBox="0 0 {width:g} {height:g}"'
    look = f'font-family="{_FONTS}" font-size="{_TEXT:g}" fill="none"'
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" {size} role="img" {look}>']
    if any(isinstance(item, Band) and item.look == "hatched" for frame in picture.frames for item in frame.items):
        parts.append(_HATCH)
    if picture.title:
        parts.append(_text(picture.title, picture.title_left, 17.0, "start", _TITLE))
    for frame in picture.frames:
        parts += _frame(frame)
    return "\n".join([*parts, *_legend(picture), "</svg>\n"])


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


def _frame(frame: Frame) -> Iterator[str]:
    """Draw one frame: what is in it, cut off at its edges, then its axes."""
    width, height = frame.width, frame.height
    across, up = (
        ticks(float(frame.low[axis]), float(frame.high[axis]), max(3, round(room)))
        for axis, room in enumerate((width / APART, height / frame.apart))
    )
    x, y = (_on_page(frame, np.repeat(np.array(values)[:, None], 2, axis=1)) for values in (across[0], up[0]))
    xticks, yticks = (
        list(zip(x[:, 0].tolist(), across[1], strict=True)),
        list(zip(y[:, 1].tolist(), up[1], strict=True)),
    )
    yield f'<g transform="translate({frame.left:g} {frame.top:g})">'
    yield f'<svg width="{width:g}" height="{height:g}" viewBox="0 0 {width:g} {height:g}" stroke-linejoin="round">'
    for item in frame.items:
        if isinstance(item, Band):
            yield _band(frame, item)
    if frame.grid:
        yield _stroke("".join(f"M{at:g} 0V{height:g}" for at, _ in xticks), _GRID, 0.5)
        yield _stroke("".join(f"M0 {at:g}H{width:g}" for at, _ in yticks), _GRID, 0.5)
        if frame.low[1] <= 0.0 <= frame.high[1]:
            yield _stroke(f"M0 {_on_page(frame, np.zeros((1, 2)))[0, 1]:g}H{width:g}", _ZERO, 0.6)
    for item in frame.items:
        if isinstance(item, Line):
            yield from _line(frame, item)
    for item in frame.items:
        if isinstance(item, Marks):
            yield from (_mark(item, across, down) for across, down in _on_page(frame, item.points).tolist())
    yield "</svg>"
    yield from _axes(frame, xticks, yticks)
    yield "</g>"


def _axes(frame: Frame, xticks: list[tuple[float, str]], yticks: list[tuple[float, str]]) -> Iterator[str]:
    """Draw the edge of a frame, its ticks and their numbers, its labels and title."""
    width, height = frame.width, frame.height
    steps = [f"M{at:g} {height:g}v3.5" for at, _ in xticks] + [f"M-3.5 {at:g}h3.5" for at, _ in yticks]
    yield _stroke(f"M0 0H{width:g}V{height:g}H0Z{''.join(steps)}", _BLACK, 0.8)
    if frame.title:
        yield _text(frame.title, 0.5 * width, -12.0, "middle", _TEXT + 1)
    yield from (_text(text, -6.5, at, "end") for at, text in yticks)
    if frame.xlabel:
        yield from (_text(text, at, height + 10.5, "middle") for at, text in xticks)
        yield _text(frame.xlabel, 0.5 * width, height + 23.0, "middle")
    for number, text in enumerate(reversed(frame.ylabel.split("\n") if frame.ylabel else [])):
        turned = _text(text, 0.0, 0.0, "middle")
        yield f'<g transform="translate({-46.0 - 14.0 * number:g} {0.5 * height:g}) rotate(-90)">{turned}</g>'


def _on_page(frame: Frame, points: FloatArray) -> FloatArray:
    """Turn places of a frame's units into places in it (pt), y downwards."""
    size = np.array([frame.width, frame.height])
    part = (points - frame.low) / (frame.high - frame.low)
    return np.asarray(np.round(np.where([False, True], 1.0 - part, part) * size, 2), dtype=np.float64)


def _line(frame: Frame, item: Line) -> Iterator[str]:
    """Draw the stretches of a line."""
    places = _on_page(frame, item.points)
    ends = np.flatnonzero(np.isnan(places).any(axis=1))
    parts = [part[~np.isnan(part).any(axis=1)] for part in np.split(places, ends)]
    paths = [" ".join(map(str, simplified(part).ravel().tolist())) for part in parts if len(part) > 1]
    if paths:
        yield _stroke(f"M{'M'.join(paths)}", item.colour, item.width, dashed=item.dashed)


def _band(frame: Frame, item: Band) -> str:
    """Draw a zone."""
    left, right = (float(_on_page(frame, np.array([[x, 0.0]]))[0, 0]) for x in (item.start, item.end))
    if item.start == item.end:
        return (
            f'<path d="M{left:g} 0V{frame.height:g}" stroke="{_BLACK}" stroke-width="1.5" stroke-dasharray="1.5 2.5"/>'
        )
    return f'<rect x="{left:g}" width="{right - left:g}" height="{frame.height:g}" fill="{_FILLS[item.look]}"/>'


def _mark(item: Marks, across: float, down: float) -> str:
    """Draw one mark about a place."""
    half = 0.5 * item.size
    if item.shape == "square":
        at = f'x="{across - half:g}" y="{down - half:g}" width="{item.size:g}" height="{item.size:g}"'
        return f'<rect {at} fill="{item.colour}"/>'
    look = f'fill="{item.colour}"' if item.shape == "disc" else f'stroke="{item.colour}" stroke-width="1.5"'
    return f'<circle cx="{across:g}" cy="{down:g}" r="{half:g}" {look}/>'


def _stroke(path: str, colour: str, width: float, *, dashed: bool = False) -> str:
    dash = ' stroke-dasharray="5 2.5"' if dashed else ""
    return f'<path d="{path}" stroke="{colour}" stroke-width="{width:g}"{dash}/>'


def _text(text: str, across: float, middle: float, anchor: str, size: float = _TEXT) -> str:
    """Set a line of text about a height."""
    larger = "" if size == _TEXT else f' font-size="{size:g}"'
    place = f'x="{across:g}" y="{middle + _BASE * size:.2f}"'
    return f'<text {place} fill="{_BLACK}" text-anchor="{anchor}"{larger}>{escape(text)}</text>'


def _legend(picture: Picture) -> Iterator[str]:
    """Tell what the items are: in a row below the frames, or one below the other in the first."""
    if picture.legend_below:
        sizes = [_sample_width(item) + _GAP + _text_width(item.label) for item in picture.legend]
        across = 0.5 * (picture.width - sum(sizes) - _BETWEEN * (len(sizes) - 1))
        for item, size in zip(picture.legend, sizes, strict=True):
            yield from _entry(item, across, picture.height - _BELOW)
            across += size + _BETWEEN
    else:
        first = picture.frames[0]
        for number, item in enumerate(picture.legend):
            yield from _entry(item, first.left + 9.0, first.top + 14.0 + 15.0 * number)


def _entry(item: Item, left: float, middle: float) -> Iterable[str]:
    """Draw a sample of an item, and its label beside it."""
    label = _text(item.label, left + _sample_width(item) + _GAP, middle, "start")
    if isinstance(item, Line):
        return _stroke(f"M{left:.2f} {middle:g}h{_SAMPLE:g}", item.colour, item.width, dashed=item.dashed), label
    if isinstance(item, Marks):
        return _mark(item, left + 0.5 * item.size, middle), label
    box = f'x="{left:.2f}" y="{middle - 5.5:g}" width="{_SAMPLE:g}" height="11" fill="{_FILLS[item.look]}"'
    return f'<rect {box} stroke="{_BLACK}" stroke-width="0.5"/>', label


def _sample_width(item: Item) -> float:
    return item.size if isinstance(item, Marks) else _SAMPLE


def _text_width(text: str) -> float:
    return _TEXT * sum(_WIDE if ord(letter) >= 0x2E80 else _NARROW for letter in text)
