"""The lines of a CFF2 file style by style, in metres, and the bridges that they bring along."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from camwright.bender.die_file import bridge_places, read_cf2
from camwright.bender.dxf_entities import cleaned
from camwright.bender.dxf_styles import StylePieces
from camwright.bender.job import UNITS
from camwright.profiles.bender.bridges import BridgeMark
from camwright.profiles.errors import InputError
from camwright.profiles.notice import Notice, Number


def die_styles(
    path: Path, units: str | None, believed: tuple[float, float], left_out: Counter[str]
) -> tuple[str, tuple[str, ...], list[StylePieces]]:
    """Read a CFF2 file.

    Parameters
    ----------
    units
        Its unit, whatever it says; ``None`` for its own.
    believed
        Length below which a line has none, and greatest coordinate (m).
    left_out
        Counts what is left out, by what it is and why.

    Returns
    -------
    (unit, doubts, styles)
        Its unit, what is doubtful about that, and what each style holds.

    Raises
    ------
    InputError
        The file is none, has no unit, or a line of it cannot be read.
    """
    die = read_cf2(path)
    unit = units or die.unit
    if not unit:
        raise InputError(
            f'{path}: the drawing does not say its unit (UM or UI); write units = "mm" under [drawing] of the bender job'
        )
    doubts: tuple[str, ...] = ()
    if die.unit and unit != die.unit:
        text = "{file}: it says {said}, the bender job says {units}: read in {units}"
        doubts = (Notice(text, file=path.name, said=die.unit, units=unit),)
    left_out.update(die.left_out)
    least, greatest = believed
    found: dict[tuple[str, str, str], StylePieces] = {}
    for line in (each.scaled(UNITS[unit]) for each in die.lines):
        own = found.setdefault(line.style.key, StylePieces(line.style))
        drawn = cleaned(line.piece, least)
        left_out.update(drawn.notes)
        if drawn.piece is None:
            continue
        if float(np.abs(drawn.piece.points).max()) > greatest:
            raise InputError(
                f"{path}: {line.piece.name}: a coordinate beyond {greatest / 1e3:g} km; is its unit {unit}?"
            )
        own.pieces.append(drawn.piece)
        own.bridges += [(BridgeMark(line.piece.name, place), line.width) for place in bridge_places(line)]
    return unit, doubts, [own for own in found.values() if own.pieces]


def bridges_of(
    path: Path, chosen: Sequence[StylePieces], gap: float, marks: list[BridgeMark]
) -> tuple[float, tuple[str, ...]]:
    """Take the bridges that lines bring along as marks, those of lines that lie on each other once.

    Returns
    -------
    (width, doubts)
        Their width (m), 0 without any, and what had to be assumed.

    Raises
    ------
    InputError
        They are of several widths.
    """
    found = [entry for own in chosen for entry in own.bridges]
    if not found:
        return 0.0, ()
    widths = sorted({round(width, 7) for _, width in found})
    if len(widths) > 1:
        told = ", ".join(f"{1e3 * width:g}" for width in widths)
        raise InputError(
            f"{path}: its bridges are {told} mm wide, and a rule has one width; give them with --bridges, or choose a style"
        )
    places: set[tuple[int, int]] = set()
    for mark, _ in found:
        x, y = (round(part / (2 * gap)) for part in mark.place)
        if (x, y) not in places:
            places.add((x, y))
            marks.append(mark)
    text = (
        "{file}: it says how many bridges its lines have, not where: {count} of {width} mm are placed evenly along them"
    )
    return widths[0], (Notice(text, file=path.name, count=str(len(marks)), width=Number(1e3 * widths[0], "g")),)
