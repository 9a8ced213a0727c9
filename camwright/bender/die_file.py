"""CFF2 files (``.cf2``): the lines, arcs and bridges of a cutting die, as die-making programs exchange them.

Lines are ``L,pointage,type,layer,x0,y0,x1,y1,bridges,width``, arcs ``A,...,x0,y0,x1,y1,xc,yc,way,bridges,width``, calls
``C,name,x,y,angle,sx,sy`` of blocks ``SUB,name``; ``UM`` stands for mm, ``UI`` for inches. Sources: Esko, KB196417801 (a line with
the number and the width of its bridges), and a whole sample at labelworld.ru. That way 1 is anticlockwise, and that bridges
stand evenly along their line, is inferred.
"""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from camwright.bender.dxf_guard import MOST_BYTES, MOST_ENTITIES
from camwright.bender.dxf_styles import Style
from camwright.bender.piece import Piece
from camwright.profiles.errors import InputError
from camwright.profiles.notice import Notice
from camwright.profiles.polynomial.profile import FloatArray

_UNITS = {"UM": "mm", "UI": "in"}
_PASSED = frozenset({"LL", "UR"})
"""The extents of a block."""
_DEEPEST = 8
_ROUND = 0.01
"""Part of the radius by which the ends of an arc may lie off its circle."""


@dataclass(frozen=True, eq=False)
class DieLine:
    """A line or an arc of a die.

    Parameters
    ----------
    piece
        Where it runs, in the file's unit.
    style
        Its type as the layer, its pointage as the colour.
    bridges, width
        Number of its bridges, and the width of each in the file's unit.
    """

    piece: Piece
    style: Style
    bridges: int
    width: float

    def scaled(self, unit: float) -> DieLine:
        """Give the same in metres, one unit of the file being so long (m)."""
        return replace(self, piece=self.piece.scaled(unit), width=unit * self.width)


@dataclass(frozen=True, eq=False)
class Die:
    """What a file holds: its lines, its unit (``""`` where it names none), and what was left out."""

    lines: tuple[DieLine, ...]
    unit: str
    left_out: Counter[str]


@dataclass(frozen=True)
class _Row:
    number: int
    cells: tuple[str, ...]


@dataclass(frozen=True)
class _Place:
    """Where a block is put: scaled, turned and then moved."""

    move: complex = 0j
    turn: complex = 1 + 0j
    mirror: bool = False

    def at(self, point: complex) -> complex:
        """Give the place of a point."""
        return self.move + self.turn * (point.conjugate() if self.mirror else point)


def is_cf2(path: Path) -> bool:
    """Whether a file is named as one, or begins as one."""
    if path.suffix.lower() in (".cf2", ".cff2"):
        return True
    try:
        with path.open("rb") as file:
            return file.read(16).lstrip().startswith(b"$BOF")
    except OSError:
        return False


def read_cf2(path: Path) -> Die:
    """Read a file.

    Raises
    ------
    InputError
        It is none, or a line of it cannot be read; the message names the line.
    """
    blocks, unit = _blocks(path)
    if "MAIN" not in blocks:
        raise InputError(f"{path}: not a CFF2 file: there is no block MAIN in it")
    left_out: Counter[str] = Counter()
    lines: list[DieLine] = []
    try:
        _draw(blocks, "MAIN", _Place(), 0, lines, left_out)
    except InputError as error:
        raise InputError(*(f"{path}: {fault}" for fault in error.faults)) from error
    return Die(tuple(lines), unit, left_out)


def _blocks(path: Path) -> tuple[dict[str, list[_Row]], str]:
    """Cut the file into its blocks: ``MAIN`` and each ``SUB`` by its name."""
    blocks: dict[str, list[_Row]] = {}
    unit, name, ended = "", "", False
    for number, line in enumerate(_text(path).splitlines(), start=1):
        cells = tuple(cell.strip() for cell in line.split(","))
        word = cells[0].upper()
        if word in ("MAIN", "SUB", "ORDER"):
            name = {"MAIN": "MAIN", "ORDER": ""}.get(word, f"SUB {''.join(cells[1:2])}".upper())
            if name:
                blocks[name] = []
        elif word == "END":
            name = ""
        elif word == "$EOF":
            ended = True
        elif word in _UNITS:
            unit = _UNITS[word]
        elif name and word:
            blocks[name].append(_Row(number, cells))
    if not ended:
        raise InputError(
            f"{path}: not a CFF2 file to its end: it breaks off without $EOF; export or copy the drawing again"
        )
    return blocks, unit


def _text(path: Path) -> str:
    """Read the file."""
    try:
        if path.stat().st_size > MOST_BYTES:
            raise InputError(f"{path}: more than the {MOST_BYTES} bytes of the largest drawing that is read")
        return path.read_bytes().decode("utf-8", "replace")
    except OSError as error:
        raise InputError(f"{path}: the drawing cannot be read: {error}") from error


def _draw(
    blocks: dict[str, list[_Row]], name: str, place: _Place, depth: int, lines: list[DieLine], left_out: Counter[str]
) -> None:
    """Draw a block and those that it calls."""
    for row in blocks[name]:
        word = row.cells[0].upper()
        if word == "L":
            lines.append(_line(row, place))
        elif word == "A":
            lines.append(_arc(row, place))
        elif word == "C":
            called = f"SUB {row.cells[1]}".upper() if len(row.cells) > 1 else ""
            if called not in blocks or depth == _DEEPEST:
                raise InputError(
                    f"line {row.number}: the block {row.cells[1:2]} is not in the file, or is nested more than {_DEEPEST} deep"
                )
            _draw(blocks, called, _called(row, place), depth + 1, lines, left_out)
        elif word == "SCALE":
            if any(value != 1.0 for value in _numbers(row, 1, 2)):
                raise InputError(
                    f"line {row.number}: a SCALE other than 1,1 is not read; export the die in its true size"
                )
        elif word not in _PASSED:
            left_out[Notice("{kind} (no line work)", kind=word)] += 1
        if len(lines) > MOST_ENTITIES:
            raise InputError(f"more than {MOST_ENTITIES} lines; split the die")


def _numbers(row: _Row, first: int, count: int) -> list[float]:
    """Read cells as finite numbers."""
    cells = row.cells[first : first + count]
    try:
        values = [float(cell) for cell in cells]
    except ValueError:
        values = []
    if len(values) < count or not all(math.isfinite(value) for value in values):
        raise InputError(
            f"line {row.number}: {','.join(row.cells)[:80]!r} does not hold {count} numbers from cell {first + 1} on"
        )
    return values


def _called(row: _Row, around: _Place) -> _Place:
    x, y, angle, sx, sy = _numbers(row, 2, 5)
    if abs(sx) != abs(sy) or sx == 0.0:
        raise InputError(
            f"line {row.number}: the block is stretched by {sx:g} and {sy:g}, which turns arcs into ellipses"
        )
    # mirrored in x is mirrored in y and turned by half a turn
    turn = sx * complex(math.cos(math.radians(angle)), math.sin(math.radians(angle)))
    mirror = sy != sx
    move = around.at(complex(x, y))
    return _Place(move, around.turn * (turn.conjugate() if around.mirror else turn), around.mirror != mirror)


def _made(row: _Row, place: _Place, points: list[complex], bulges: list[float], bridges: list[float]) -> DieLine:
    at = [place.at(point) for point in points]
    sign = -1.0 if place.mirror else 1.0
    style = Style(f"type-{row.cells[2]}", row.cells[1], "Continuous")
    name = Notice("{what} on layer {layer}", what=f"{row.cells[0].upper()} line {row.number}", layer=style.layer)
    places: FloatArray = np.array([[point.real, point.imag] for point in at])
    count = int(bridges[0]) if bridges else 0
    if count < 0 or (count and not bridges[1] > 0.0):
        raise InputError(f"line {row.number}: {count} bridges of {bridges[1]:g}, which are none")
    width = bridges[1] * abs(place.turn) if count else 0.0
    return DieLine(Piece(places, sign * np.array(bulges), name), style, count, width)


def _bridges(row: _Row, at: int) -> list[float]:
    """Give number and width of the bridges; both may be left out."""
    return _numbers(row, at, 2) if len(row.cells) > at + 1 and row.cells[at] else []


def _line(row: _Row, place: _Place) -> DieLine:
    x0, y0, x1, y1 = _numbers(row, 4, 4)
    return _made(row, place, [complex(x0, y0), complex(x1, y1)], [0.0], _bridges(row, 8))


def _arc(row: _Row, place: _Place) -> DieLine:
    """Read an arc: a bulge for each half where it is more than half a circle."""
    x0, y0, x1, y1, xc, yc, way = _numbers(row, 4, 7)
    centre, start, end = complex(xc, yc), complex(x0, y0) - complex(xc, yc), complex(x1, y1) - complex(xc, yc)
    radius = abs(start)
    if way not in (1.0, -1.0) or abs(abs(end) - radius) > _ROUND * radius:
        raise InputError(
            f"line {row.number}: no arc: its ends are {radius:g} and {abs(end):g} from its centre, its way is {way:g}"
        )
    if radius == 0.0:
        return _made(row, place, [centre, centre], [0.0], [])
    sweep = (math.atan2(end.imag, end.real) - math.atan2(start.imag, start.real)) * way % (2 * math.pi) or 2 * math.pi
    halves = 1 if sweep <= math.pi else 2
    middle = [start * complex(math.cos(way * sweep / 2), math.sin(way * sweep / 2))] * (halves - 1)
    points = [centre + point for point in (start, *middle, end)]
    return _made(row, place, points, [way * math.tan(sweep / halves / 4)] * halves, _bridges(row, 11))


def bridge_places(line: DieLine) -> list[tuple[float, float]]:
    """Middles of a line's bridges, evenly along it: the parts of rule between them are equal (file's unit)."""
    points, bulges = line.piece.points, line.piece.bulges
    parts = len(bulges)
    found = []
    for k in range(line.bridges):
        at = (k + 1) / (line.bridges + 1) * parts
        segment = min(int(at), parts - 1)
        found.append(_along(points[segment], points[segment + 1], float(bulges[segment]), at - segment))
    return found


def _along(start: FloatArray, end: FloatArray, bulge: float, part: float) -> tuple[float, float]:
    """Give the place a part of the way along a line or an arc."""
    first, chord = complex(*start), complex(*end) - complex(*start)
    if bulge == 0.0:
        place = first + part * chord
    else:
        half = 2 * math.atan(bulge)
        # the chord to a point of the circle turns by half the angle that is passed
        place = first + chord * (math.sin(part * half) / math.sin(half)) * complex(
            math.cos((part - 1) * half), math.sin((part - 1) * half)
        )
    return place.real, place.imag
