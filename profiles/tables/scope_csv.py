"""TwinCAT Scope's export: rows of keys above the numbers, a column of times for each channel or for each rate."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace

from camwright.profiles.tables.column_words import bare_unit
from camwright.profiles.tables.delimited import LONGEST_LINE, WIDEST, Column, Sheet, trimmed
from camwright.profiles.tables.numbers import number_in
from camwright.profiles.tables.text import refuse

_FIRST = re.compile(r"\s{0,99}Name([\t;,:])")
"""How the file begins: with its project's name, or with those of the channels."""
_KEY, _FILE = "Name", "File"
_COPY = re.compile(r"(.{1,200}) \([0-9]{1,3}\)")
"""What Scope calls a channel that is drawn a second time."""
_TICKS = re.compile(r"[0-9]{16,20}")
"""A time of day as Windows counts it, in steps of 100 ns."""
_TICK = 1e-4
"""The same in ms."""


def is_scope(text: str) -> bool:
    """Whether a text is such an export."""
    return _FIRST.match(text) is not None


def read_scope(text: str, place: str) -> Sheet:
    """Read an export, whatever its settings: separator, one column of times for each channel or rate, times of day, end mark.

    Columns of times are called ``time``, in ms, with the heading ``Name``, the key that stands above them. A channel that was
    exported once more, as Scope does with one that is drawn twice, is left out.

    Raises
    ------
    InputError
        There are no rows or no times, or a row has more cells than there are columns.
    """
    found = _FIRST.match(text)
    separator = found[1] if found else "\t"
    lines = [(number, line.rstrip(" \r")) for number, line in enumerate(text.split("\n"), start=1)]
    for number, line in lines:
        if len(line) > LONGEST_LINE:
            raise refuse(place, number, f"the line is {len(line)} characters long; at most {LONGEST_LINE} are read")
    split = [
        (number, [cell.strip().strip('"') for cell in line.split(separator)]) for number, line in lines if line.strip()
    ]
    comma = separator != ","
    first = next((k for k, (_, cells) in enumerate(split) if number_in(cells[0], comma) is not None), len(split))
    heads = [(number, cells) for number, cells in split[:first] if cells[0] == _KEY]
    if not heads or first == len(split):
        raise refuse(
            place, None, "this begins as an export of TwinCAT Scope, but there are no channels or no rows in it"
        )
    heading, names = heads[-1]
    if len(heads) == 1 and any(cells[0] == _FILE for _, cells in split[:first]):
        raise refuse(place, None, f"no row of names has times beside the channels: {_NO_TIMES}")
    width = len(trimmed(names))
    keys = {cells[0]: [*cells, *[""] * width] for _, cells in split[:first]}
    units = keys.get("Unit", [""] * width)
    columns = tuple(
        Column("time", "ms", heading=_KEY) if name == _KEY else Column(name, bare_unit(unit), heading=name)
        for name, unit in zip(names[:width], units, strict=False)
    )
    if width > WIDEST or width < 2:
        raise refuse(place, heading, f"there are {width} columns; export the channels of command and actual position")
    rows, numbers = _rows(split[first:], width, place)
    if (
        rows
        and len(trimmed(split[first][1])) < len(columns)
        and not any(column.heading == _KEY for column in columns[1:])
    ):
        raise refuse(
            place, split[first][0], f"{len(trimmed(split[first][1]))} cells where the names are {width}: {_NO_TIMES}"
        )
    sheet = Sheet(place, columns, _in_ms(columns, rows), numbers, heading, comma)
    return _without_copies(sheet)


_NO_TIMES = "export the recording with its times (Timelines: all, or for each sample time)"


def used_rows(sheet: Sheet, used: Sequence[int]) -> Sheet:
    """Keep the rows in which columns say something new: slower channels end early, or are repeated, where nothing is interpolated."""
    kept: list[int] = []
    for k, row in enumerate(sheet.rows):
        cells = [row[at] for at in used]
        if any(cells) and (not kept or cells != [sheet.rows[kept[-1]][at] for at in used]):
            kept.append(k)
    return replace(sheet, rows=tuple(sheet.rows[k] for k in kept), lines=tuple(sheet.lines[k] for k in kept))


def _rows(split: Sequence[tuple[int, list[str]]], width: int, place: str) -> tuple[list[list[str]], tuple[int, ...]]:
    """Bring the rows to one width; the mark of the end is none."""
    rows, numbers = [], []
    for number, cells in split:
        if cells[0] == "EOF" and not any(cells[1:]):
            break
        filled = trimmed(cells)
        if len(filled) > width:
            raise refuse(
                place,
                number,
                f"{len(filled)} cells where the channels and their times are {width}; a comma cannot both separate cells and be the "
                "decimal sign: export with another separator",
            )
        rows.append([*filled, *[""] * (width - len(filled))])
        numbers.append(number)
    return rows, tuple(numbers)


def _in_ms(columns: Sequence[Column], rows: list[list[str]]) -> tuple[tuple[str, ...], ...]:
    """Turn times of day into ms from the first row on."""
    for at, column in enumerate(columns):
        if column.heading == _KEY and rows and _TICKS.fullmatch(rows[0][at]):
            begin = int(rows[0][at])
            for row in rows:
                row[at] = repr((int(row[at]) - begin) * _TICK) if _TICKS.fullmatch(row[at]) else row[at]
    return tuple(tuple(row) for row in rows)


def _without_copies(sheet: Sheet) -> Sheet:
    """Leave out channels that stand there again."""
    names = [column.name for column in sheet.columns]
    left: list[int] = []
    for k, name in enumerate(names):
        found = _COPY.fullmatch(name)
        first = names.index(found[1]) if found and found[1] in names else None
        if first is None or any(row[k] != row[first] for row in sheet.rows):
            left.append(k)
    return replace(
        sheet,
        columns=tuple(sheet.columns[k] for k in left),
        rows=tuple(tuple(row[k] for k in left) for row in sheet.rows),
    )
