"""Cut lists and line speeds as spreadsheets write them, read by the house's one reader of tables; every bad row is refused by its line."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from camwright.house.files import read_text
from camwright.house.units import KINDS, exact_quantity
from camwright.profiles.cut_list import PIECE_KINDS, CutList, ListRow, PieceKind
from camwright.profiles.errors import InputError
from camwright.profiles.line_run import LineRun
from camwright.profiles.polynomial.profile import FloatArray
from camwright.profiles.tables.column_words import bare_unit, words_of
from camwright.profiles.tables.delimited import Column, Layout, Sheet, number_in, read_sheet

MOST_BYTES = 32 * 2**20
MOST_PIECES = 200_000
"""Most pieces of a list."""

LIST_HEADER = "length [mm],quantity,kind"
LINE_HEADER = "time [s],speed [m/min]"

_MOST_FAULTS = 20
_CELL = re.compile(r"([-+]?[0-9.,]+(?:[eE][-+]?[0-9]{1,3})?)\s*(\S.{0,20})?")
_UNIT = re.compile(r".*[\[(]\s*([^\[\]()]{1,20}?)\s*[\])]\s*")

_WORDS: dict[str, tuple[str, ...]] = {
    "length": ("length", "len", "länge", "laenge", "longueur", "长度", "长"),
    "quantity": (
        "quantity",
        "qty",
        "count",
        "pieces",
        "pcs",
        "number",
        "anzahl",
        "stück",
        "stueck",
        "menge",
        "数量",
        "件数",
    ),
    "kind": ("kind", "type", "art", "typ", "operation", "种类", "类型"),
    "time": ("time", "zeit", "t", "时间"),
    "speed": ("speed", "velocity", "v", "geschwindigkeit", "geschw", "速度"),
}
"""What columns are called: a word of the heading, in lower case."""


def read_cut_list(path: Path) -> CutList:
    """Read a cut list: length, quantity and kind of each row.

    A length has its unit in the cell or in the heading (``length [mm]``); columns without headings are taken in this order. The kind is
    cut where none is given.

    Raises
    ------
    InputError
        The file cannot be read, or rows are not as described: each of them is named by its line.
    """
    return parse_cut_list(read_text(path, "cut list", MOST_BYTES), str(path))


def parse_cut_list(text: str, place: str) -> CutList:
    """Read a cut list from its text; as `read_cut_list`."""
    layout = Layout(_is_list_cell, lambda lines: _above(lines, "length"))
    sheet = read_sheet(text, place, _role, LIST_HEADER, "cut list", layout)
    at = _columns(sheet, ("length", "quantity", "kind"), needed=2, header=LIST_HEADER)
    unit = _unit_of(sheet.columns[at["length"]])
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

    Raises
    ------
    InputError
        The file cannot be read, or a row is not as described, with its line.
    """
    return parse_line_run(read_text(path, "table of line speeds", MOST_BYTES), str(path))


def parse_line_run(text: str, place: str) -> LineRun:
    """Read the speed of the line from its text; as `read_line_run`."""
    sheet = read_sheet(text, place, _role, LINE_HEADER, "table of line speeds")
    at = _columns(sheet, ("time", "speed"), needed=2, header=LINE_HEADER)
    columns: dict[str, FloatArray] = {}
    for name in ("time", "speed"):
        unit = _unit_of(sheet.columns[at[name]])
        where = f"{place}, line {sheet.heading}" if sheet.heading else place
        if unit is None:
            raise InputError(f"{where}: column {name} has no unit; write a header like {LINE_HEADER}")
        try:
            factor = float(exact_quantity(f"1 {unit}", name))
        except InputError as error:
            raise InputError(*(f"{where}: column {name}: {fault}" for fault in error.faults)) from error
        columns[name] = sheet.numbers(at[name], name) * factor
    time, speed = columns["time"] - columns["time"][0], columns["speed"]
    if len(time) < 2:
        raise InputError(f"{place}: one row; the speed of the line needs two at least, the first at its start")
    for row, line in enumerate(sheet.lines):
        if speed[row] < 0:
            raise InputError(
                f"{place}, line {line}: a speed of {speed[row]:.6g} m/s; a line runs forwards: write 0 or more"
            )
        if row and time[row] <= time[row - 1]:
            raise InputError(
                f"{place}, line {line}: the time does not increase from the row before; sort the rows by time"
            )
    return LineRun(time, speed)


def _role(name: str) -> str | None:
    """Say what a column is by its heading."""
    words = words_of(name)
    return next((role for role, known in _WORDS.items() if any(word in known for word in words)), None)


def _is_list_cell(cell: str, comma: bool) -> bool:
    """Whether a cell is a number, a length with its unit, or a kind."""
    found = _CELL.fullmatch(cell.strip())
    known = found is not None and number_in(found[1], comma) is not None
    return known or cell.strip().lower() in PIECE_KINDS


def _above(lines: Sequence[Sequence[str]], name: str) -> int:
    """Count the lines above the rows: up to the heading that names a column, and a row of units below it."""
    for number, cells in enumerate(lines[:20]):
        if any(_role(cell) == name for cell in cells):
            below = [cell for cell in lines[number + 1] if cell.strip()] if number + 1 < len(lines) else []
            return number + 1 + (1 if below and all(bare_unit(cell) is not None for cell in below) else 0)
    return 0


def _columns(sheet: Sheet, names: Sequence[str], needed: int, header: str) -> dict[str, int]:
    """Say which column is what, by the headings or without any by their order."""
    if not sheet.heading:
        if len(sheet.columns) < needed:
            raise InputError(
                f"{sheet.place}: {len(sheet.columns)} column where {needed} are needed; write a header like {header} and rows below"
            )
        return {name: number for number, name in enumerate(names[: len(sheet.columns)])}
    at: dict[str, int] = {}
    for number, column in enumerate(sheet.columns):
        role = _role(column.name)
        if role is not None and role in names:
            if role in at:
                raise InputError(
                    f"{sheet.place}, line {sheet.heading}: column {role} stands there twice; leave one out"
                )
            at[role] = number
    missing = [name for name in names[:needed] if name not in at]
    if missing:
        raise InputError(
            f"{sheet.place}, line {sheet.heading}: there is no column {' and no column '.join(missing)}; write a header like {header}"
        )
    return at


def _unit_of(column: Column) -> str | None:
    """Give the unit of a column, known to the reader of tables or not."""
    if column.unit is not None:
        return column.unit
    found = _UNIT.fullmatch(column.heading)
    return found[1] if found else None


def _length(cell: str, unit: str | None, comma: bool) -> float:
    """Read a length: a number in the column's unit, or with a unit of its own."""
    text = cell.strip()
    found = _CELL.fullmatch(text)
    number = None if found is None else number_in(found[1], comma)
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
    lines.append(LINE_HEADER)
    lines += [
        f"{time!r},{speed!r}"
        for time, speed in zip(run.times.tolist(), (np.asarray(run.speeds) * 60).tolist(), strict=True)
    ]
    return "\n".join(lines) + "\n"
