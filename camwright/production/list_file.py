"""Cut lists and line speeds as spreadsheets write them, read by the house's one reader of tables; every bad row is refused by its line."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from camwright.house.units import KINDS, exact_quantity
from camwright.production.columns import column_in_si, columns, read_table_text, role, unit_of
from camwright.profiles.cut_list import PIECE_KINDS, CutList, ListRow, PieceKind
from camwright.profiles.errors import InputError
from camwright.profiles.line_run import LineRun
from camwright.profiles.tables.delimited import RowLayout, is_unit_row, read_sheet
from camwright.profiles.tables.numbers import GROUPS, grouped, number_in

MOST_BYTES = 32 * 2**20
MOST_PIECES = 200_000
"""Most pieces of a list."""

LIST_HEADER = "length [mm],quantity,kind"
LINE_HEADER = "time [s],speed [m/min]"

_MOST_FAULTS = 20
_UNLIKE = 1e-6
"""Share of the highest speed by which accelerations may miss the speeds that they add up to: decimals of a table."""
_CELL = re.compile(r'([-+]?[0-9.,]+(?:[eE][-+]?[0-9]{1,3})?)\s*([^\W\d_°"][^;,|\t]{0,20}|[°"])?')


def read_cut_list(path: Path) -> CutList:
    """Read a cut list: length, quantity and kind of each row.

    A length has its unit in the cell or in the heading (``length [mm]``); columns without headings are taken in this order. The kind is
    cut where none is given.

    Raises
    ------
    InputError
        The file cannot be read, or rows are not as described: each of them is named by its line.
    """
    return parse_cut_list(read_table_text(path, "cut list", MOST_BYTES), str(path))


def parse_cut_list(text: str, place: str) -> CutList:
    """Read a cut list from its text; as `read_cut_list`."""
    layout = RowLayout(_is_list_cell, _above)
    sheet = read_sheet(text, place, role, LIST_HEADER, "cut list", layout)
    at = columns(sheet, ("length", "quantity", "kind"), needed=2, header=LIST_HEADER)
    unit = unit_of(sheet.columns[at["length"]])
    rows: list[ListRow] = []
    faults: list[str] = []
    for cells, line in zip(sheet.rows, sheet.lines, strict=True):
        try:
            length = _length(cells[at["length"]], unit, sheet.comma)
            quantity = _quantity(cells[at["quantity"]], sheet.comma)
            kind = _kind(cells[at["kind"]] if "kind" in at else "")
            rows.append(ListRow(length, quantity, kind, line))
        except InputError as error:
            faults += [f"{place}, line {line}: {fault}" for fault in error.faults]
    pieces = sum(row.quantity for row in rows)
    if not faults and not rows:
        faults.append(f"{place}: there is no row in it; write rows below a header like {LIST_HEADER}")
    if not faults and rows[-1].kind == "skip":
        faults.append(
            f"{place}, line {rows[-1].line}: the list ends with a skip, behind which nothing is cut; end it with a cut or a crop"
        )
    if not faults and pieces > MOST_PIECES:
        faults.append(f"{place}: {pieces} pieces, the limit is {MOST_PIECES}; split the list")
    if faults:
        more = len(faults) - _MOST_FAULTS
        raise InputError(*faults[:_MOST_FAULTS], *([f"{place}: {more} more rows with faults"] if more > 0 else []))
    return CutList(tuple(rows), place)


def read_line_run(path: Path) -> LineRun:
    """Read the speed of the line over time: straight between the rows, kept beyond both ends.

    With a column of accelerations these are straight between the rows.

    Raises
    ------
    InputError
        The file cannot be read, or a row is not as described, with its line.
    """
    return parse_line_run(read_table_text(path, "table of line speeds", MOST_BYTES), str(path))


def parse_line_run(text: str, place: str) -> LineRun:
    """Read the speed of the line from its text; as `read_line_run`."""
    sheet = read_sheet(text, place, role, LINE_HEADER, "table of line speeds")
    at = columns(sheet, ("time", "speed", "acceleration"), needed=2, header=LINE_HEADER)
    time = column_in_si(sheet, at["time"], "time", "time", LINE_HEADER)
    time, speed = time - time[0], column_in_si(sheet, at["speed"], "speed", "speed", LINE_HEADER)
    if len(time) < 2:
        raise InputError(f"{place}: one row; the speed of the line needs two at least, the first at its start")
    for row, line in enumerate(sheet.lines):
        if speed[row] > KINDS["speed"].greatest or time[row] > KINDS["time"].greatest:
            raise InputError(
                f"{place}, line {line}: {speed[row]:.6g} m/s after {time[row]:.6g} s; at most {KINDS['speed'].greatest:g} m/s and "
                f"{KINDS['time'].greatest:g} s are read"
            )
        if speed[row] < 0:
            raise InputError(
                f"{place}, line {line}: a speed of {speed[row]:.6g} m/s; a line runs forwards: write 0 or more"
            )
        if row and time[row] <= time[row - 1]:
            raise InputError(
                f"{place}, line {line}: the time does not increase from the row before; sort the rows by time"
            )
    if "acceleration" not in at:
        return LineRun(time, speed)
    acceleration = column_in_si(sheet, at["acceleration"], "acceleration", "acceleration", LINE_HEADER)
    off = np.abs(np.diff(speed) - 0.5 * np.diff(time) * (acceleration[:-1] + acceleration[1:]))
    wrong = np.flatnonzero(off > _UNLIKE * max(float(speed.max()), 1e-9))
    if len(wrong):
        raise InputError(
            f"{place}, line {sheet.lines[int(wrong[0]) + 1]}: accelerations do not add up to the speeds; leave the column out, and the "
            "speed is straight between the rows"
        )
    return LineRun(time, speed, acceleration)


def _is_list_cell(cell: str, comma: bool) -> bool:
    """Whether a cell is a number, a length with its unit, or a kind."""
    found = _CELL.fullmatch(cell.strip())
    known = found is not None and number_in(found[1], comma) is not None
    return known or cell.strip().lower() in PIECE_KINDS


def _above(lines: Sequence[Sequence[str]]) -> int:
    """Count the lines above the rows: up to the heading that names the lengths, and a row of units below it."""
    for number, cells in enumerate(lines[:20]):
        if any(role(cell) == "length" for cell in cells):
            return number + 1 + (1 if number + 1 < len(lines) and is_unit_row(lines[number + 1]) else 0)
    return 0


def _length(cell: str, unit: str | None, comma: bool) -> float:
    """Read a length: a number in the column's unit, or with a unit of its own."""
    text = cell.strip()
    found = _CELL.fullmatch(text)
    number = None if found is None else number_in(found[1], comma)
    if grouped(text):
        raise InputError(f"length {text[:50]!r} {GROUPS}")
    if found is None or number is None:
        example = KINDS["length"].example if unit is None else f"600 in the column's {unit}"
        raise InputError(f"length {text[:50]!r} is no length; write e.g. {example}")
    own = found[2] or unit
    if own is None:
        raise InputError(f"length {text[:50]!r} has no unit; write {found[1]} mm, or name the column length [mm]")
    plain = found[1].replace(",", ".") if comma else found[1]
    return float(exact_quantity(f"{plain} {own}", "length"))


def _quantity(cell: str, comma: bool) -> int:
    """Read how many: a whole number, one at least."""
    text = cell.strip()
    number = number_in(text, comma)
    if number is None or not 1 <= number <= MOST_PIECES or number != round(number):
        raise InputError(f"quantity {text[:50]!r} is no whole number from 1 to {MOST_PIECES}; write how many, e.g. 3")
    return int(number)


def _kind(cell: str) -> PieceKind:
    """Read what is done with a length; a cut where nothing stands."""
    text = cell.strip().lower()
    for kind in PIECE_KINDS:
        if text in ("", kind):
            return kind
    raise InputError(f"kind {cell.strip()[:50]!r} is none of {', '.join(PIECE_KINDS)}; leave it out for a cut")


def line_run_text(run: LineRun, comments: Sequence[str] = ()) -> str:
    """Write the speed of the line over time so that `parse_line_run` reads it back."""
    lines = ["# " + " ".join(comment.splitlines()) for comment in comments]
    values = [run.times, np.asarray(run.speeds) * 60]
    if run.accelerations is not None:
        values.append(run.accelerations)
    lines.append(LINE_HEADER + (",acceleration [m/s^2]" if run.accelerations is not None else ""))
    lines += [",".join(map(repr, row)) for row in zip(*(column.tolist() for column in values), strict=True)]
    return "\n".join(lines) + "\n"
