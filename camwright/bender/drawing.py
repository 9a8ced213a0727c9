"""From a DXF file to outlines: layers, blocks, units, and loose entities joined into paths."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from camwright.bender.dxf_curves import MOST_SEGMENTS
from camwright.bender.dxf_entities import (
    Piece,
    piece_of,
    require_bounded,
    walk,
)
from camwright.bender.dxf_guard import MOST_ENTITIES, look_at
from camwright.bender.job import UNITS
from camwright.profiles.bender.outline import Outline
from camwright.profiles.errors import InputError

_DEEPEST = 8
_MOST_UNFOLDED = MOST_ENTITIES
_MOST_FAULTS = 20
_INSUNITS = {1: UNITS["in"], 2: UNITS["ft"], 4: UNITS["mm"], 5: UNITS["cm"], 6: UNITS["m"]}
_AROUND = [(i, j) for i in (-1, 0, 1) for j in (-1, 0, 1)]


@dataclass(frozen=True)
class Drawing:
    """The outlines of a drawing (m), and what was left out of it.

    Parameters
    ----------
    outlines
        In the order of the drawing.
    warnings
        What was ignored.
    """

    outlines: tuple[Outline, ...]
    warnings: tuple[str, ...]


def read_drawing(
    path: Path, gap: float, flattening: float, units: str | None = None, layer: str | None = None
) -> Drawing:
    """Read the die lines of a DXF file.

    Parameters
    ----------
    path
        The file.
    gap
        Ends nearer to each other are joined (m).
    flattening
        Largest distance of splines and ellipses from their polylines (m).
    units
        Unit of a drawing that does not say its own; ``None`` refuses such a drawing.
    layer
        Read this layer only.

    Raises
    ------
    InputError
        The file is no DXF, or what it holds cannot be bent; every message with the file, the entity and the reason.
    """
    look_at(path)
    document = _open(path)
    unit = _unit(path, document, units)
    layers = {entry.dxf.name.casefold(): entry for entry in document.layers}
    if layer is not None and layer.casefold() not in layers:
        known = ", ".join(sorted(entry.dxf.name for entry in layers.values()))
        raise InputError(f"{path}: there is no layer {layer!r}; the layers are {known}")
    ignored: Counter[str] = Counter()
    shown = _shown(document, layers, layer, ignored)
    pieces, faults = _pieces(document, shown, flattening / unit, ignored)
    if faults:
        raise InputError(*(f"{path}: {fault}" for fault in faults[:_MOST_FAULTS]))
    warnings = tuple(f"{path.name}: left out {count} × {what}" for what, count in sorted(ignored.items()))
    if not pieces:
        where = f" on layer {layer}" if layer else ""
        more = "; " + "; ".join(warnings) if warnings else ""
        raise InputError(
            f"{path}: no line, arc, circle, ellipse, spline or polyline{where}: the drawing is empty{more}"
        )
    if sum(len(piece.bulges) for piece in pieces) > MOST_SEGMENTS:
        raise InputError(f"{path}: more than {MOST_SEGMENTS} segments; split the drawing or allow more flattening")
    outlines = []
    for piece in join(pieces, gap / unit):
        name = f"{path.name}: {piece.name}"
        outlines.append(Outline(unit * piece.points, piece.bulges, name, unit * piece.flattening))
    return Drawing(tuple(outlines), warnings)


def _shown(document: Any, layers: dict[str, Any], layer: str | None, ignored: Counter[str]) -> Iterator[Any]:
    """Give the entities that a reader of the drawing sees, of one layer only if it is named; those on layers that are off are counted."""
    for entity, own in walk(document.modelspace()):
        if layer is not None and own.casefold() != layer.casefold():
            continue
        entry = layers.get(own.casefold())
        if entry is not None and (entry.is_frozen() or entry.is_off()):
            ignored[f"entity on layer {own} (off or frozen)"] += 1
        else:
            yield entity


def _pieces(
    document: Any, shown: Iterator[Any], flattening: float, ignored: Counter[str]
) -> tuple[list[Piece], list[str]]:
    """Turn entities into pieces, as far as they can be; what is no line work is counted, what cannot be bent is a fault."""
    pieces: list[Piece] = []
    faults: list[str] = []
    try:
        require_bounded(document, _MOST_UNFOLDED, _DEEPEST)
        for entity in shown:
            try:
                piece = piece_of(entity, flattening)
            except InputError as error:
                faults += error.faults
                if len(faults) >= _MOST_FAULTS:
                    break
                continue
            if piece is None:
                ignored[f"{entity.dxftype()} (no line work)"] += 1
            else:
                pieces.append(piece)
    except InputError as error:
        faults += error.faults
    return pieces, faults


def _open(path: Path) -> Any:
    import ezdxf

    try:
        return ezdxf.readfile(path)  # type: ignore[attr-defined]
    except (ezdxf.DXFError, OSError, UnicodeError, ValueError, LookupError, TypeError, AttributeError) as error:  # type: ignore[attr-defined]
        raise InputError(f"{path}: not a DXF file that can be read: {str(error) or type(error).__name__}") from error


def _unit(path: Path, document: Any, units: str | None) -> float:
    code = document.header.get("$INSUNITS", 0)
    if code in _INSUNITS:
        return _INSUNITS[code]
    if code == 0 and units is not None:
        return UNITS[units]
    if code == 0:
        raise InputError(
            f"{path}: the drawing does not say its unit ($INSUNITS is 0 or missing); set it in the drawing, "
            'or write units = "mm" under [drawing] of the bender job'
        )
    raise InputError(f"{path}: unit code {code} of $INSUNITS is not known; set the drawing to mm, cm, m, in or ft")


def join(pieces: list[Piece], gap: float) -> list[Piece]:
    """Join open pieces whose ends are within a gap of each other, and close those whose own ends are.

    Paths begin with the first piece of the drawing that is not used yet, and run in its direction; at each end the
    nearest free end is taken. The end of a joined piece is moved onto the one before it.
    """
    free = _FreeEnds(pieces, gap)
    found = []
    for i, piece in enumerate(pieces):
        if not free.take(i):
            continue
        if piece.closed:
            found.append(piece)
            continue
        chain, names = [piece], [piece.name]
        for backwards in (False, True):
            while math.dist(chain[0].points[0], chain[-1].points[-1]) > gap:
                step = free.nearest(chain[0].points[0] if backwards else chain[-1].points[-1])
                if step is None:
                    break
                other, end = step
                names.append(other.name)
                if backwards:
                    chain.insert(0, other if end == -1 else other.reverse())
                else:
                    chain.append(other if end == 0 else other.reverse())
        found.append(_chained(chain, names, gap))
    return found


class _FreeEnds:
    """Ends of open pieces that are not joined yet, in cells of twice the gap: all within the gap lie in a cell or its neighbours."""

    def __init__(self, pieces: list[Piece], gap: float) -> None:
        self._pieces, self._gap = pieces, gap
        self._used = [False] * len(pieces)
        self._ends: dict[tuple[int, int], list[tuple[int, int]]] = {}
        for i, piece in enumerate(pieces):
            if not piece.closed:
                for end in (0, -1):
                    self._ends.setdefault(_cell(piece.points[end], 2 * gap), []).append((i, end))

    def take(self, i: int) -> bool:
        """Take a piece; whether it was free."""
        free, self._used[i] = not self._used[i], True
        return free

    def nearest(self, place: np.ndarray[Any, Any]) -> tuple[Piece, int] | None:
        """Take the piece whose free end is nearest to a place, within the gap: the piece and which end, or ``None``."""
        x, y = _cell(place, 2 * self._gap)
        best, nearest = None, self._gap
        for i, j in _AROUND:
            for candidate, end in self._ends.get((x + i, y + j), ()):
                away = math.dist(self._pieces[candidate].points[end], place)
                if not self._used[candidate] and (away < nearest or (away == nearest and best is None)):
                    best, nearest = (candidate, end), away
        if best is None:
            return None
        self.take(best[0])
        return self._pieces[best[0]], best[1]


def _chained(chain: list[Piece], names: list[str], gap: float) -> Piece:
    points = np.vstack([chain[0].points[:1], *(piece.points[1:] for piece in chain)])
    if math.dist(points[0], points[-1]) <= gap and len(points) > 2:
        points[-1] = points[0]
    name = names[0] if len(names) == 1 else f"{names[0]} and {len(names) - 1} joined to it"
    empty = np.flatnonzero((np.diff(points, axis=0) == 0).all(axis=1))
    if len(empty):
        x, y = points[empty[0]]
        raise InputError(f"{name}: an entity at ({x:g}, {y:g}) is not longer than the gap that is closed; remove it")
    flattening = max(piece.flattening for piece in chain)
    return Piece(points, np.concatenate([piece.bulges for piece in chain]), name, flattening)


def _cell(place: np.ndarray[Any, Any], size: float) -> tuple[int, int]:
    return math.floor(place[0] / size), math.floor(place[1] / size)
