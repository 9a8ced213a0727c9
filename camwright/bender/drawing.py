"""From a DXF or CFF2 file to outlines: units, styles, overlaps, and loose entities joined into paths."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

import numpy as np

from camwright.bender.chords import FoundArc, with_arcs
from camwright.bender.die_file import is_cf2
from camwright.bender.die_styles import bridges_of, die_styles
from camwright.bender.dxf_blocks import Seen, require_bounded, walk
from camwright.bender.dxf_curves import MOST_SEGMENTS
from camwright.bender.dxf_entities import Resolution, is_line_work, piece_of
from camwright.bender.dxf_opening import open_dxf, readable
from camwright.bender.dxf_styles import Layers, Style, StyleChoice, StylePieces
from camwright.bender.job import UNITS
from camwright.bender.joining import join
from camwright.bender.near_ends import NearEnds, near_ends
from camwright.bender.overlaps import EntityOverlap, between_styles, without_overlaps
from camwright.bender.piece import Piece
from camwright.profiles.bender.bridges import BridgeMark
from camwright.profiles.bender.outline import Outline
from camwright.profiles.errors import InputError
from camwright.profiles.notice import Notice

_MOST_FAULTS = 20
_LEAST = 1e-7
"""Length (m) below which a segment has none: a tenth of what a program can write."""

_GREATEST = 1e7
"""Greatest coordinate (m) that is believed; the numbers have nanometres left there."""

_INSUNITS = {1: "in", 2: "ft", 4: "mm", 5: "cm", 6: "m"}


@dataclass(frozen=True)
class Reading:
    """How a drawing is read.

    Parameters
    ----------
    gap
        Ends nearer to each other are joined, lines nearer to each other are one (m).
    flattening
        Largest distance of splines and ellipses from their polylines (m).
    units
        Unit of the drawing, whatever its header says; ``None`` for the header's.
    style
        Which styles are bent.
    overlaps
        Whether lines that lie on each other are used once, or the drawing refused.
    arc_error
        Largest distance (m) at a radius (m) between an arc and the chords that are bent as that arc; ``None`` bends
        chords as they are drawn.
    bridge_layer
        The layer whose points and lines mark bridges, and are not bent.
    """

    gap: float
    flattening: float
    units: str | None = None
    style: StyleChoice = field(default_factory=StyleChoice)
    overlaps: Literal["merge", "refuse"] = "merge"
    arc_error: Callable[[float], float] | None = None
    bridge_layer: str | None = None


@dataclass(frozen=True)
class Drawing:
    """The outlines of a drawing (m), and what is doubtful about it.

    Parameters
    ----------
    outlines
        Style by style, in the order of the drawing.
    size
        Width and height of what is bent (m).
    overlaps
        What is drawn twice.
    near_ends
        Free ends that nearly meet.
    warnings
        What was left out, repaired, merged or not joined.
    bridge_width
        Width of the bridges that the file itself has (m); 0 where it has none.
    """

    outlines: tuple[Outline, ...]
    styles: tuple[Style, ...]
    unit: str
    size: tuple[float, float]
    overlaps: tuple[EntityOverlap, ...]
    near_ends: tuple[NearEnds, ...]
    warnings: tuple[str, ...]
    marks: tuple[BridgeMark, ...] = ()
    bridge_width: float = 0.0


@dataclass(frozen=True, eq=False)
class _Lines:
    """The lines of one style (m): paths, and what was found on the way to them."""

    paths: list[Piece]
    overlaps: tuple[EntityOverlap, ...]
    near: tuple[NearEnds, ...]
    arcs: tuple[FoundArc, ...]


def read_drawing(path: Path, reading: Reading) -> Drawing:
    """Read the die lines of a DXF or a CFF2 file.

    Parameters
    ----------
    reading
        How it is read.

    Raises
    ------
    InputError
        The file is no DXF, holds several styles of which none is chosen, or lines that cannot be bent; every message
        with the file, the entity and the reason.
    """
    left_out: Counter[str] = Counter()
    marks: list[BridgeMark] = []
    warnings: tuple[str, ...] = ()
    others: list[StylePieces] = []
    if is_cf2(path):
        unit, doubts, everything = die_styles(path, reading.units, (_LEAST, _GREATEST), left_out)
        layers = {found.style.layer for found in everything}
    else:
        document, warnings = open_dxf(path)
        with readable(path):
            unit, doubts = _unit(path, document, reading.units)
            layers, everything, others = _gathered(path, document, reading, UNITS[unit], left_out, marks)
    chosen = _chosen(path, everything, layers, reading.style, left_out)
    width, more = bridges_of(path, chosen, reading.gap, marks)
    doubts += more
    lines = [_lines(path, found, reading, left_out) for found in chosen]
    outlines = [
        Outline(p.points, p.bulges, Notice("{file}: {what}", file=path.name, what=p.name), p.flattening)
        for one in lines
        for p in one.paths
    ]
    styles = [found.style for found, one in zip(chosen, lines, strict=True) for _ in one.paths]
    overlaps = tuple(overlap for one in lines for overlap in one.overlaps)
    near = tuple(ends for one in lines for ends in one.near)
    doubts += _unmarked(reading.bridge_layer, marks)
    told = [
        *(Notice("left out {count} × {what}", count=str(n), what=what) for what, n in sorted((+left_out).items())),
        *_few(
            [Notice("{overlap}; it is bent once", overlap=overlap.told) for overlap in overlaps],
            "{count} more entities lie on others",
        ),
        *_few(
            _mixed(chosen, [*everything, *others], reading.gap), "{count} more entities lie on others of another style"
        ),
        *_few([ends.told for ends in near], "{count} more pairs of ends nearly meet"),
        *_few([arc.told for one in lines for arc in one.arcs], "{count} more runs of chords lie on arcs"),
    ]
    warnings += (*doubts, *(Notice("{file}: {what}", file=path.name, what=text) for text in told))
    return Drawing(tuple(outlines), tuple(styles), unit, _size(outlines), overlaps, near, warnings, tuple(marks), width)


def _unit(path: Path, document: Any, units: str | None) -> tuple[str, tuple[str, ...]]:
    """Tell the drawing's unit, and what is doubtful about it: the job's word counts more than the header's."""
    code = document.header.get("$INSUNITS", 0)
    header = _INSUNITS.get(code)
    if units is not None:
        if header == units or code == 0:
            return units, ()
        said = header or Notice("unit code {code}", code=str(code))
        text = "{file}: its header says {said} ($INSUNITS), the bender job says {units}: read in {units}"
        return units, (Notice(text, file=path.name, said=said, units=units),)
    if header is not None:
        return header, ()
    if code == 0:
        raise InputError(
            f"{path}: the drawing does not say its unit ($INSUNITS is 0 or missing); set it in the drawing, "
            'or write units = "mm" under [drawing] of the bender job'
        )
    raise InputError(
        f"{path}: unit code {code} of $INSUNITS is not known; set the drawing to mm, cm, m, in or ft, "
        'or write units = "mm" under [drawing] of the bender job'
    )


def _gathered(
    path: Path, document: Any, reading: Reading, unit: float, left_out: Counter[str], marks: list[BridgeMark]
) -> tuple[set[str], list[StylePieces], list[StylePieces]]:
    """Read what is shown of the layer that is asked for, style by style; the names of all layers; and what the other layers hold."""
    resolution = Resolution(reading.flattening / unit, _LEAST / unit, _GREATEST / unit)
    layers = Layers(document.layers)
    names = {name.casefold(): name for name in sorted(layers.names)}
    found: dict[tuple[str, str, str], StylePieces] = {}
    others: dict[tuple[str, str, str], StylePieces] = {}
    wanted = None if reading.style.layer is None else reading.style.layer.casefold()
    hidden: Counter[str] = Counter()
    segments = aside = 0
    try:
        require_bounded(document)
        for seen in walk(document, layers, hidden):
            names.setdefault(seen.style.layer.casefold(), seen.style.layer)
            if reading.bridge_layer is not None and seen.style.layer.casefold() == reading.bridge_layer.casefold():
                _mark(seen, unit, marks, left_out)
                continue
            if wanted not in (None, seen.style.layer.casefold()):
                if aside < MOST_SEGMENTS:
                    aside += _aside(seen, others, resolution, unit)
                continue
            if not is_line_work(seen.entity):
                left_out[Notice("{kind} (no line work)", kind=seen.entity.dxftype())] += 1
                continue
            own = found.setdefault(seen.style.key, StylePieces(seen.style))
            try:
                drawn = piece_of(seen.entity, seen.name, resolution)
            except InputError as error:
                own.faults += error.faults
                continue
            left_out.update(drawn.notes)
            if drawn.piece is not None:
                own.pieces.append(drawn.piece.scaled(unit))
                segments += len(drawn.piece.bulges)
            if segments > MOST_SEGMENTS:
                raise InputError(f"more than {MOST_SEGMENTS} segments; split the drawing or allow more flattening")
    except InputError as error:
        raise InputError(*(f"{path}: {fault}" for fault in error.faults)) from error
    left_out.update(hidden)
    return set(names.values()), [own for own in found.values() if own.pieces or own.faults], list(others.values())


def _unmarked(layer: str | None, marks: Sequence[BridgeMark]) -> tuple[str, ...]:
    """Say that the layer of the bridges marks none."""
    if layer is None or marks:
        return ()
    return (Notice("no bridge is marked: layer {layer} holds no point and no line", layer=layer),)


def _mark(seen: Seen, unit: float, marks: list[BridgeMark], left_out: Counter[str]) -> None:
    """Take a point, or the middle of a line, as the mark of a bridge."""
    kind, dxf = seen.entity.dxftype(), seen.entity.dxf
    if kind not in ("POINT", "LINE"):
        left_out[Notice("{kind} (no mark of a bridge: draw a point or a line)", kind=kind)] += 1
        return
    ends = (dxf.location,) if kind == "POINT" else (dxf.start, dxf.end)
    x, y = (unit * sum(end[k] for end in ends) / len(ends) for k in (0, 1))
    if not (abs(x) <= _GREATEST and abs(y) <= _GREATEST):
        raise InputError(f"{seen.name}: its coordinates are not finite, or beyond {_GREATEST / 1e3:g} km")
    marks.append(BridgeMark(seen.name, (x, y)))


def _aside(seen: Seen, others: dict[tuple[str, str, str], StylePieces], resolution: Resolution, unit: float) -> int:
    """Read an entity of a layer that is not bent, to tell what lies on it; what cannot be read does no harm there."""
    if not is_line_work(seen.entity):
        return 0
    try:
        piece = piece_of(seen.entity, seen.name, resolution).piece
    except InputError:
        return 0
    if piece is None:
        return 0
    others.setdefault(seen.style.key, StylePieces(seen.style)).pieces.append(piece.scaled(unit))
    return len(piece.bulges)


def _mixed(chosen: Sequence[StylePieces], everything: Sequence[StylePieces], tolerance: float) -> list[Notice]:
    """Name what is bent and lies on something of another style, bent or not."""
    try:
        overlaps = between_styles([found.pieces for found in everything], tolerance)
    except InputError as error:
        text = "lines of different styles that lie on each other are not looked for: {reason}"
        return [Notice(text, reason=str(error))]
    bent = {piece.name for found in chosen for piece in found.pieces}
    return [
        Notice(
            "{overlap}; their styles differ, so each stays as it is: remove one of them if it is drawn by mistake",
            overlap=overlap.told,
        )
        for overlap in overlaps
        if overlap.first in bent or overlap.second in bent
    ]


def _chosen(
    path: Path, everything: Sequence[StylePieces], layers: set[str], choice: StyleChoice, left_out: Counter[str]
) -> list[StylePieces]:
    """Pick the styles that are asked for.

    Raises
    ------
    InputError
        None fits, several do, or one holds what cannot be bent.
    """
    if choice.layer is not None and choice.layer.casefold() not in {name.casefold() for name in layers}:
        raise InputError(f"{path}: there is no layer {choice.layer!r}; the layers are {', '.join(sorted(layers))}")
    fitting = [found for found in everything if choice.fits(found.style)]
    if everything and not fitting:
        raise InputError(f"{path}: no line has the style {choice}; the styles are", *map(_style_words, everything))
    if len(fitting) > 1 and not choice.each:
        raise InputError(
            f"{path}: the drawing holds {len(fitting)} styles, which are never joined into one rule; choose one with "
            "--style, or bend each for itself with --styles all",
            *map(_style_words, fitting),
        )
    faults = [f"{path}: {fault}" for found in fitting for fault in found.faults]
    if faults:
        raise InputError(*faults[:_MOST_FAULTS])
    if not fitting:
        where = f" on layer {choice.layer}" if choice.layer else ""
        more = "".join(f"; left out {count} × {what}" for what, count in sorted(left_out.items()))
        raise InputError(
            f"{path}: no line, arc, circle, ellipse, spline or polyline{where}: the drawing is empty{more}"
        )
    return fitting


def _style_words(found: StylePieces) -> str:
    count = len(found.pieces) + len(found.faults)
    length = 1e3 * sum(piece.length for piece in found.pieces)
    return f"--style {found.style}: {count} {'entity' if count == 1 else 'entities'}, {length:.3f} mm"


def _lines(path: Path, found: StylePieces, reading: Reading, left_out: Counter[str]) -> _Lines:
    """Join the pieces of one style: what is drawn twice is used once, chords that lie on an arc become that arc.

    Raises
    ------
    InputError
        Something is drawn twice and that is to be refused, or nothing is left.
    """
    try:
        pieces, doubled = without_overlaps(found.pieces, reading.gap)
        if doubled and reading.overlaps == "refuse":
            raise InputError(
                *(f"{overlap.told}; remove it, or leave --overlaps refuse out" for overlap in doubled[:_MOST_FAULTS])
            )
        lasting = [piece for piece in pieces if piece.length > reading.gap]
        if not lasting:
            raise InputError(f"nothing is longer than the gap of {1e3 * reading.gap:g} mm that is closed")
        left_out[Notice("line not longer than the gap")] += len(pieces) - len(lasting)
        joined = join(lasting, reading.gap)
    except InputError as error:
        raise InputError(*(f"{path}: {fault}" for fault in error.faults)) from error
    near = near_ends(joined, reading.gap)
    if reading.arc_error is None:
        return _Lines(joined, doubled, near, ())
    fitted = [with_arcs(piece, reading.arc_error, reading.gap) for piece in joined]
    return _Lines([piece for piece, _ in fitted], doubled, near, tuple(arc for _, arcs in fitted for arc in arcs))


def _size(outlines: Sequence[Outline]) -> tuple[float, float]:
    """Width and height of some outlines (m), their arcs' bellies included."""
    places = [outline.points for outline in outlines]
    for outline in outlines:
        arcs = np.flatnonzero(outline.arcs)
        if not len(arcs):
            continue
        start, end = (heading[arcs] for heading in outline.headings)
        for k in range(4):  # where the arc runs along an axis
            way = k * math.pi / 2
            low, high = np.minimum(start, end), np.maximum(start, end)
            passed = arcs[low + (way - low) % (2 * math.pi) <= high]
            side = way - math.pi / 2 * np.sign(outline.bulges[passed])
            out = outline.radii[passed, None] * np.stack([np.cos(side), np.sin(side)], axis=1)
            places.append(outline.centres[passed] + out)
    width, height = np.ptp(np.vstack(places), axis=0)
    return float(width), float(height)


def _few(texts: Sequence[Notice], rest: str) -> list[Notice]:
    more = len(texts) - _MOST_FAULTS
    return [*texts] if more <= 0 else [*texts[:_MOST_FAULTS], Notice(rest, count=str(more))]
