"""TwinCAT CNC and ISG kernel: the ASCII cam file (``Tablename … Begintable … EndTable``)."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np

from camwright.profiles.errors import InputError
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.tables.cam_table import CamTable, PieceLaw, make_table
from camwright.profiles.tables.interpolation import in_format, quintics
from camwright.profiles.tables.target import (
    Header,
    Target,
    advance_in,
    units_in,
)
from camwright.profiles.tables.text import (
    check_ascending,
    check_count,
    integer,
    lines_of,
    real,
    refuse,
    shown,
)

MOST_PAIRS = 360
TURN = 3_600_000
"""Master period: one turn of 360° in units of 0.0001°."""
LEAST_STEP = 1000

_LINEAR, _LINE_POLY5, _POLY5_LINE = 1, 4, 5
_COLUMN, _PAIRS = 3, 7
_KEY = re.compile(r"\s*(Tablename|Table-ID|Tabletype|Function ?type|Lines)(?:\s*=\s*|\s+)(.*)", re.IGNORECASE)


def write(table: CamTable, header: Header) -> dict[str, str]:
    """Write pairs of integers; the last point is not repeated, the kernel leads from the last pair to the first.

    Alternating lines and quintics with no ratio slope at their ends are written as LINE_POLY5 or POLY5_LINE, all else
    as LINEAR.

    Raises
    ------
    InputError
        The master period is not one turn of `TURN` units, or points are less than `LEAST_STEP` apart.
    """
    stored = in_format(table, "int32")
    if stored.x[0] < 0 or stored.period != TURN:
        raise InputError(
            f"the master of this kernel turns once a cycle: the period must be {TURN} units of 0.0001°, from 0 on; it "
            f"runs from {stored.x[0]:g} to {stored.x[-1]:g}"
        )
    if (np.diff(stored.x) < LEAST_STEP).any():
        i = int(np.argmin(np.diff(stored.x)))
        raise InputError(
            f"points {i + 1} and {i + 2} lie less than 0.1° of the master apart, which this kernel does not take"
        )
    zebra = set(table.laws) == {"line", "quintic"}
    # the segment that leads from the last pair to the first is the first segment
    function = _LINEAR if not zebra else (_LINE_POLY5 if table.laws[-1] == "line" else _POLY5_LINE)
    head = "".join(f"# {line}\n" for line in header.lines(TARGET.title, table))
    rows = "".join(f"{int(x)} {int(y)}\n" for x, y in zip(stored.x[:-1], stored.y[:-1], strict=True))
    text = (
        f"{head}Tablename = {header.identifier}\nTable-ID = 1\nTabletype = {_PAIRS}\nFunctiontype = {function}\n"
        f"Lines = {table.points - 1}\nBegintable\n{rows}EndTable\n"
    )
    return {f"{header.identifier}_isg.txt": text}


def read(text: str, place: str) -> CamTable:
    """Read a table of one column (type 3) or of pairs (type 7), LINEAR, LINE_POLY5 or POLY5_LINE."""
    lines = [(raw.partition("#")[0].strip(), number) for number, raw in enumerate(lines_of(text, place), start=1)]
    lines = [(line, number) for line, number in lines if line]
    head, table = _split(lines, "begintable")
    keys = _head(head, place)
    if table is None:
        raise refuse(place, None, "the line Begintable is missing")
    rows, rest = _split(table, "endtable")
    if rest is None:
        raise refuse(place, None, "the line EndTable is missing")
    if rest:
        raise refuse(place, rest[0][1], "something follows EndTable; one table stands in one file")
    for key in ("tabletype", "functiontype", "lines"):
        if key not in keys:
            raise refuse(place, None, f"the table's head has no {key.capitalize()}")
    kind, function, count = (integer(keys[k][0], place, keys[k][1]) for k in ("tabletype", "functiontype", "lines"))
    if count != len(rows):
        raise refuse(place, keys["lines"][1], f"Lines says {count}, but the table has {len(rows)}")
    if kind not in (_COLUMN, _PAIRS) or function not in (_LINEAR, _LINE_POLY5, _POLY5_LINE):
        raise refuse(
            place,
            keys["tabletype"][1],
            f"Tabletype {kind} with Functiontype {function} is not read; types 3 and 7 with 1, 4 or 5 are",
        )
    return _table(_cells(rows, 1 if kind == _COLUMN else 2, place), kind, function, text, place)


def _split(lines: list[tuple[str, int]], word: str) -> tuple[list[tuple[str, int]], list[tuple[str, int]] | None]:
    """Split lines at a word that stands alone; ``None`` for what follows if it does not."""
    place = next((k for k, (line, _) in enumerate(lines) if line.lower() == word), None)
    return (lines, None) if place is None else (lines[:place], lines[place + 1 :])


def _head(lines: list[tuple[str, int]], place: str) -> dict[str, tuple[str, int]]:
    """Read what stands before the table: each key once, with its value and line."""
    keys: dict[str, tuple[str, int]] = {}
    for line, number in lines:
        found = _KEY.fullmatch(line)
        if not found:
            raise refuse(place, number, f"{shown(line)} is no line of the table's head")
        key = found[1].lower().replace(" ", "")
        if key in keys:
            raise refuse(place, number, f"{found[1]} is given twice")
        keys[key] = (found[2], number)
    return keys


def _cells(rows: list[tuple[str, int]], width: int, place: str) -> list[tuple[list[float], int]]:
    cells = []
    for line, number in rows:
        parts = line.split()
        if len(parts) != width:
            raise refuse(place, number, f"the line has {len(parts)} values; this type of table has {width}")
        cells.append(([real(part, place, number, comma=True) for part in parts], number))
    return cells


def _table(cells: list[tuple[list[float], int]], kind: int, function: int, text: str, place: str) -> CamTable:
    check_count(len(cells), 2, MOST_PAIRS if kind == _PAIRS else None, place)
    values = [row for row, _ in cells]
    if kind == _COLUMN:
        x = [TURN * k / len(values) for k in range(len(values))]
        y = [row[0] for row in values]
    else:
        x, y = [row[0] for row in values], [row[1] for row in values]
        check_ascending(x, [number for _, number in cells], place)
    stated = advance_in(text)
    x.append(x[0] + TURN)
    y.append(y[0] + (stated or 0.0))
    if x[-1] <= x[-2]:
        raise refuse(place, cells[-1][1], "the master positions span more than one turn of 360°")
    units, known = units_in(text), stated is not None
    if function == _LINEAR:
        return make_table(x, y, law="line", units=units, travel_known=known)
    if len(values) % 2:
        raise refuse(
            place, None, f"a table of lines and quintics in turn has an even number of pairs; there are {len(values)}"
        )
    last: PieceLaw = "line" if function == _LINE_POLY5 else "quintic"
    other: PieceLaw = "quintic" if last == "line" else "line"
    laws = tuple(last if k % 2 else other for k in range(len(values)))
    return _smooth(make_table(x, y, law=laws, units=units, travel_known=known))


def _smooth(table: CamTable) -> CamTable:
    """Give the knots the slopes of the lines that end or begin there, and no ratio slope."""
    chord = np.diff(table.y) / np.diff(table.x)
    ratio = np.array(
        [chord[k] if k < len(chord) and table.laws[k] == "line" else chord[k - 1] for k in range(table.points)]
    )
    if table.laws[-1] == "line":
        ratio[0] = chord[-1]
    else:
        ratio[-1] = chord[0]
    return replace(table, ratio=ratio, ratio_slope=np.zeros(table.points))


def rebuild(table: CamTable) -> CamProfile:
    """Lines, and quintics that take over the lines' slopes with no ratio slope."""
    return quintics(_smooth(table) if "quintic" in table.laws else table)


TARGET = Target(
    name="twincat-cnc",
    title="Beckhoff TwinCAT CNC and ISG kernel, ASCII cam file",
    interpolation="straight lines, or in turn lines and quintics that take over the lines' slopes",
    law="line",
    spacing="free",
    max_points=MOST_PAIRS + 1,
    number_format="int32",
    evidence=(
        "File format, table types, function types, properties of the tables: infosys TwinCAT CNC (15306147467 and "
        "following), ISG kernel documentation (179240075, 179241611, 179258123). That a quintic has no ratio slope at "
        "its ends is inferred, and so is that pairs may be run with LINEAR."
    ),
    steps=(
        "Copy the file to where the kernel's configuration names its cam tables; give the table its own Table-ID.",
        "Set up both axes as modulo axes: the master turns 360° a cycle, the slave's modulo is its travel per cycle.",
        "Command MC_CamIn with FunctionType TableDefined, start mode EndlessPositive if the slave keeps turning.",
    ),
    endings=("_isg.txt",),
    write=write,
    read=read,
    rebuild=rebuild,
    least_step=(LEAST_STEP + 1) / TURN,  # both points are rounded
)
