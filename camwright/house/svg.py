"""Drawing a picture as SVG: lines stay lines and text stays text; only what no printer shows is left out of a line."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from html import escape

import numpy as np

from camwright.house.pictures import (
    APART,
    Area,
    Arrow,
    Band,
    Bar,
    DrawnLine,
    DrawnMarks,
    Frame,
    Item,
    Note,
    Picture,
    Tick,
    ticks,
)
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
_OTHERS: dict[str, str] = {
    "back": "M-1 5L1 7M0 0L6 6M5 -1L7 1",
    "crosses": "M0 0L6 6M6 0L0 6",
    "plus": "M3 0V6M0 3H6",
    "level": "M0 3H6",
    "dots": "M2.5 3H3.5",
}
"""Patterns beside the slanted lines, each on a square of 6 pt."""

_FILLS = {"grey": "#e4e4e4", "hatched": "url(#cam-hatch)", "green": "#d9ead3"}
_BLACK, _GRID, _ZERO = "#000", "#ccc", "#999"
_SAMPLE, _GAP, _BETWEEN, _BELOW, _ROW = 24.0, 7.0, 22.0, 12.0, 15.0
"""Length of a sample in the legend, from it to its text, from entry to entry, from its last row to the lower edge, from row to row (pt)."""

_BESIDE = 46.0
"""From a frame to the middle of its y label (pt), where its numbers are not long."""

_HEAD = 8.0
"""Length of an arrow's head (pt)."""

_Tick = tuple[float, str, bool]


def picture_svg(picture: Picture) -> str:
    """Draw a picture; the same picture gives the same text."""
    width, height = picture.width, picture.height
    size = f'width="{width:g}pt" height="{height:g}pt" viewBox="0 0 {width:g} {height:g}"'
    look = f'font-family="{_FONTS}" font-size="{_TEXT:g}" fill="none"'
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" {size} role="img" {look}>']
    drawn = [*picture.legend, *(item for frame in picture.frames for item in frame.items)]
    parts += _patterns({_hatch(item) for item in drawn})
    for number, line in enumerate(picture.title.split("\n") if picture.title else []):
        parts.append(_text(line, picture.title_left, 17.0 + 15.0 * number, "start", _TITLE))
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


def _hatch(item: Item) -> str:
    if isinstance(item, Band):
        return "lines" if item.look == "hatched" else ""
    return item.hatch if isinstance(item, Bar | Area) else ""


def _patterns(used: set[str]) -> Iterator[str]:
    """Define the hatches that a picture uses."""
    if "lines" in used:
        yield _HATCH
    for name, path in _OTHERS.items():
        if name in used:
            yield (
                f'<defs><pattern id="cam-{name}" width="6" height="6" patternUnits="userSpaceOnUse">'
                f'<path d="{path}" stroke="#777" stroke-width="{1.0 if name == "dots" else 0.6:g}"/></pattern></defs>'
            )


def _frame(frame: Frame) -> Iterator[str]:
    """Draw one frame: what is in it, cut off at its edges, then its axes and notes."""
    width, height = frame.width, frame.height
    xticks, yticks = _ticks(frame)
    yield f'<g transform="translate({frame.left:g} {frame.top:g})">'
    yield f'<svg width="{width:g}" height="{height:g}" viewBox="0 0 {width:g} {height:g}" stroke-linejoin="round">'
    yield from (_band(frame, item) for item in frame.items if isinstance(item, Band))
    if frame.grid:
        yield from _grid(frame, xticks, yticks)
    for item in sorted(frame.items, key=_layer):
        yield from _drawn(frame, item)
    yield "</svg>"
    yield from _axes(frame, xticks, yticks)
    for item in frame.items:
        if isinstance(item, Note):
            yield from _note(frame, item)
        elif isinstance(item, Arrow):
            ends = _on_page(frame, np.array([[item.place, item.start], [item.place, item.tip]])).tolist()
            yield from _arrow(item, ends[0][0], ends[0][1], ends[1][1])
    yield "</g>"


def _grid(frame: Frame, xticks: list[_Tick], yticks: list[_Tick]) -> Iterator[str]:
    """Draw lines at the ticks, and at zero."""
    width, height = frame.width, frame.height
    yield _stroke("".join(f"M{at:g} 0V{height:g}" for at, *_ in xticks), _GRID, 0.5)
    yield _stroke("".join(f"M0 {at:g}H{width:g}" for at, *_ in yticks), _GRID, 0.5)
    if frame.yticks is None and frame.low[1] <= 0.0 <= frame.high[1]:
        yield _stroke(f"M0 {_on_page(frame, np.zeros((1, 2)))[0, 1]:g}H{width:g}", _ZERO, 0.6)


def _layer(item: Item) -> int:
    """Give what lies below what: areas, bars, lines, marks."""
    return (Area, Bar, DrawnLine, DrawnMarks, Band, Note, Arrow).index(type(item))


def _drawn(frame: Frame, item: Item) -> Iterator[str]:
    """Draw what is neither below the grid nor beyond the edges."""
    if isinstance(item, Bar):
        yield from _bar(frame, item)
    elif isinstance(item, Area):
        path = " ".join(map(str, _on_page(frame, item.points).ravel().tolist()))
        yield from _filled("path", f'd="M{path}Z"', item)
    elif isinstance(item, DrawnLine):
        yield from _line(frame, item)
    elif isinstance(item, DrawnMarks):
        yield from (_mark(item, across, down) for across, down in _on_page(frame, item.points).tolist())


def _ticks(frame: Frame) -> tuple[list[_Tick], list[_Tick]]:
    """Place the ticks along x and y: where (pt), text, bold or not."""
    placed: list[list[_Tick]] = []
    for axis, room in enumerate((frame.width / APART, frame.height / frame.apart)):
        chosen = frame.yticks if axis else frame.xticks
        if chosen is None:
            values, texts = ticks(float(frame.low[axis]), float(frame.high[axis]), max(3, round(room)))
            chosen = [Tick(value, text) for value, text in zip(values, texts, strict=True)]
        at = _on_page(frame, np.array([[tick.value, tick.value] for tick in chosen]).reshape(-1, 2))[:, axis]
        placed.append([(place, tick.text, tick.bold) for place, tick in zip(at.tolist(), chosen, strict=True)])
    return placed[0], placed[1]


def _axes(frame: Frame, xticks: list[_Tick], yticks: list[_Tick]) -> Iterator[str]:
    """Draw the edge of a frame, its ticks and their numbers, its labels and title."""
    width, height = frame.width, frame.height
    steps = [f"M{at:g} {height:g}v3.5" for at, *_ in xticks] + [f"M-3.5 {at:g}h3.5" for at, *_ in yticks]
    edge = f"M0 0H{width:g}V{height:g}H0Z" if frame.edges else f"M0 0V{height:g}H{width:g}"
    yield _stroke(f"{edge}{''.join(steps)}", _BLACK, 0.8)
    for number, text in enumerate(reversed(frame.title.split("\n") if frame.title else [])):
        yield _text(text, 0.5 * width, -12.0 - 14.0 * number, "middle", _TEXT + 1)
    yield from (_text(text, -6.5, at, "end", bold=bold) for at, text, bold in yticks)
    if frame.xlabel or frame.numbers:
        yield from (_text(text, at, height + 10.5, "middle") for at, text, _ in xticks)
    for number, text in enumerate(frame.xlabel.split("\n") if frame.xlabel else []):
        yield _text(text, 0.5 * width, height + 23.0 + 14.0 * number, "middle")
    beside = max([_BESIDE, *(16.5 + 0.93 * text_width(text) for _, text, _ in yticks)])  # clear of the longest number
    for number, text in enumerate(reversed(frame.ylabel.split("\n") if frame.ylabel else [])):
        turned = _text(text, 0.0, 0.0, "middle")
        yield f'<g transform="translate({-beside - 14.0 * number:g} {0.5 * height:g}) rotate(-90)">{turned}</g>'


def _on_page(frame: Frame, points: FloatArray) -> FloatArray:
    """Turn places of a frame's units into places in it (pt), y downwards."""
    size = np.array([frame.width, frame.height])
    part = (points - frame.low) / (frame.high - frame.low)
    return np.asarray(np.round(np.where([False, True], 1.0 - part, part) * size, 2), dtype=np.float64)


def _line(frame: Frame, item: DrawnLine) -> Iterator[str]:
    """Draw the stretches of a line."""
    places = _on_page(frame, item.points)
    ends = np.flatnonzero(np.isnan(places).any(axis=1))
    parts = [part[~np.isnan(part).any(axis=1)] for part in np.split(places, ends)]
    paths = [" ".join(map(str, simplified(part).ravel().tolist())) for part in parts if len(part) > 1]
    if paths:
        yield _stroke(f"M{'M'.join(paths)}", item.colour, item.width, dash=item.dash)


def _band(frame: Frame, item: Band) -> str:
    """Draw a zone."""
    left, right = (float(_on_page(frame, np.array([[x, 0.0]]))[0, 0]) for x in (item.start, item.end))
    if item.start == item.end:
        return (
            f'<path d="M{left:g} 0V{frame.height:g}" stroke="{_BLACK}" stroke-width="1.5" stroke-dasharray="1.5 2.5"/>'
        )
    return f'<rect x="{left:g}" width="{right - left:g}" height="{frame.height:g}" fill="{_FILLS[item.look]}"/>'


def _bar(frame: Frame, item: Bar) -> Iterator[str]:
    """Draw a filled rectangle, and what lies over it."""
    corners = _on_page(frame, np.array([item.low, item.high]))
    (left, top), (right, bottom) = corners.min(axis=0).tolist(), corners.max(axis=0).tolist()
    yield from _filled("rect", f'x="{left:g}" y="{top:g}" width="{right - left:g}" height="{bottom - top:g}"', item)


def _filled(form: str, place: str, item: Bar | Area) -> Iterator[str]:
    """Fill a form with its colour, and what lies over it."""
    edge = (
        f' stroke="{item.colour}" stroke-width="0.5"' if isinstance(item, Area) else ""
    )  # closes the seam to the next
    yield f'<{form} {place} fill="{item.colour}"{edge}/>'
    if item.hatch:
        yield f'<{form} {place} fill="url(#cam-{"hatch" if item.hatch == "lines" else item.hatch})"/>'


def _note(frame: Frame, item: Note) -> Iterator[str]:
    """Set the lines of a note about its place."""
    across, down = (_on_page(frame, np.array([item.place]))[0] + item.shift).tolist()
    lines = item.text.split("\n")
    if item.boxed:
        width = max(text_width(line, item.size) for line in lines)
        left = across - {"start": 0.0, "middle": 0.5, "end": 1.0}[item.anchor] * width
        half = 0.6 * item.size * len(lines)
        yield f'<rect x="{left:.2f}" y="{down - half:.2f}" width="{width:.2f}" height="{2 * half:.2f}" fill="#fff"/>'
    for number, line in enumerate(lines):
        yield _text(line, across, down + 1.2 * item.size * (number - 0.5 * (len(lines) - 1)), item.anchor, item.size)


def _mark(item: DrawnMarks, across: float, down: float) -> str:
    """Draw one mark about a place."""
    half = 0.5 * item.size
    if item.shape == "square":
        at = f'x="{across - half:g}" y="{down - half:g}" width="{item.size:g}" height="{item.size:g}"'
        return f'<rect {at} fill="{item.colour}"/>'
    if item.shape == "frame":
        at = f'x="{across - half:g}" y="{down - half:g}" width="{item.size:g}" height="{item.size:g}"'
        return f'<rect {at} stroke="{item.colour}" stroke-width="1.3"/>'
    if item.shape == "cross":
        strokes = f"M{across - half:g} {down - half:g}l{item.size:g} {item.size:g}m0 {-item.size:g}l{-item.size:g} {item.size:g}"
        return _stroke(strokes, item.colour, 1.3)
    if item.shape == "diamond":
        return f'<path d="M{across:g} {down - half:g}l{half:g} {half:g}l{-half:g} {half:g}l{-half:g} {-half:g}Z" fill="{item.colour}"/>'
    edge = f'stroke="{item.colour}" stroke-width="1.5"'
    look = {"disc": f'fill="{item.colour}"', "open": f'fill="#fff" {edge}', "ring": edge}[item.shape]
    return f'<circle cx="{across:g}" cy="{down:g}" r="{half:g}" {look}/>'


def _arrow(item: Arrow, across: float, start: float, tip: float) -> Iterator[str]:
    """Draw an arrow upwards or downwards on the page."""
    head = min(_HEAD, abs(tip - start)) * (1.0 if tip < start else -1.0)
    yield _stroke(f"M{across:g} {start:g}V{tip + head:g}", item.colour, item.width, dash=item.dash)
    yield f'<path d="M{across:g} {tip:g}l3 {head:g}h-6Z" fill="{item.colour}"/>'


def _stroke(path: str, colour: str, width: float, *, dash: tuple[float, ...] = ()) -> str:
    dashes = f' stroke-dasharray="{" ".join(f"{part:g}" for part in dash)}"' if dash else ""
    return f'<path d="{path}" stroke="{colour}" stroke-width="{width:g}"{dashes}/>'


def _text(text: str, across: float, middle: float, anchor: str, size: float = _TEXT, *, bold: bool = False) -> str:
    """Set a line of text about a height."""
    look = "" if size == _TEXT else f' font-size="{size:g}"'
    look += ' font-weight="bold"' if bold else ""
    place = f'x="{across:g}" y="{middle + _BASE * size:.2f}"'
    return f'<text {place} fill="{_BLACK}" text-anchor="{anchor}"{look}>{escape(text)}</text>'


def _legend(picture: Picture) -> Iterator[str]:
    """Tell what the items are: in rows below the frames, or one below the other in the first."""
    if not picture.legend_below:
        first = picture.frames[0]
        for number, item in enumerate(picture.legend):
            yield from _entry(item, first.left + 9.0, first.top + 14.0 + _ROW * number)
        return
    rows = legend_rows(picture.legend, picture.width)
    for number, row in enumerate(reversed(rows)):
        across = 0.5 * (picture.width - _row_width(row))
        for item in row:
            yield from _entry(item, across, picture.height - _BELOW - _ROW * number)
            across += _entry_width(item) + _BETWEEN


def legend_rows(legend: Iterable[Item], width: float) -> list[list[Item]]:
    """Put the entries of a legend into rows that a page of a width (pt) holds."""
    rows: list[list[Item]] = [[]]
    for item in legend:
        if rows[-1] and _row_width([*rows[-1], item]) > width - _BETWEEN:
            rows.append([])
        rows[-1].append(item)
    return rows


def _row_width(row: list[Item]) -> float:
    return sum(map(_entry_width, row)) + _BETWEEN * (len(row) - 1)


def _entry_width(item: Item) -> float:
    return _sample_width(item) + _GAP + text_width(item.label)


def _entry(item: Item, left: float, middle: float) -> Iterable[str]:
    """Draw a sample of an item, and its label beside it."""
    label = _text(item.label, left + _sample_width(item) + _GAP, middle, "start")
    if isinstance(item, DrawnLine):
        return _stroke(f"M{left:.2f} {middle:g}h{_SAMPLE:g}", item.colour, item.width, dash=item.dash), label
    if isinstance(item, DrawnMarks):
        return _mark(item, left + 0.5 * item.size, middle), label
    if isinstance(item, Arrow):
        return *_arrow(item, left + 0.5 * _SAMPLE, middle + 6.0, middle - 6.0), label
    box = f'x="{left:.2f}" y="{middle - 5.5:g}" width="{_SAMPLE:g}" height="11"'
    if isinstance(item, Bar | Area):
        return *_filled("rect", box, item), label
    fill = _FILLS[item.look] if isinstance(item, Band) else "none"
    return f'<rect {box} fill="{fill}" stroke="{_BLACK}" stroke-width="0.5"/>', label


def _sample_width(item: Item) -> float:
    return item.size if isinstance(item, DrawnMarks) else _SAMPLE


def text_width(text: str, size: float = _TEXT) -> float:
    """Bound the width of a text of a size (pt)."""
    return size * sum(_WIDE if ord(letter) >= 0x2E80 else _NARROW for letter in text)
