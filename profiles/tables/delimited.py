"""Rows of numbers as spreadsheets, scopes and engineering tools write them: separators, headings, where the numbers begin."""

from __future__ import annotations

import collections
import csv
import re
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np

from camwright.profiles.errors import InputError
from camwright.profiles.polynomial.profile import FloatArray
from camwright.profiles.tables.column_words import bare_unit, split_unit
from camwright.profiles.tables.numbers import GROUPS, grouped, is_number, is_stamp, measured_in, number_in
from camwright.profiles.tables.text import refuse, shown

SEPARATORS = ("\t", ";", "|", ",", " ")
"""Signs that may separate cells; of equals the first."""
GREATEST = 1e12
LONGEST_LINE = 20_000

_ENDS = "0123456789.,"
"""What a number without a unit ends with."""
_COMMENT = re.compile(
    r"\s*(?:#|//|%+\s*[^\W\d_]{2}|%+\s*[^\W\d_]\b|(?:number of points|(?:master|slave) units)\b)", re.IGNORECASE
)
"""How a comment begins, or a line above the rows of Aerotech's cams; a row of units may begin with a percent sign, too."""
_FAULT_CELL = re.compile(r"#(?:[A-Z/0]{3,12}[!?]|N/A|NV)[\s,;|]")
"""What a spreadsheet writes for a cell that it cannot compute: the row that begins with one is no comment."""
_COUNTED = re.compile(r"\s*[\[(]?(?:pcs|stk|stück|pieces|件|个|张|片)\.?[\])]?\s*", re.IGNORECASE)
_SAID = re.compile(r"sep=(.)", re.IGNORECASE)
_REMARK = re.compile(r"(?<!\s)\s+(?://|#|!).*")
"""A comment behind a row; it is looked for once in each run of blanks, however long that is."""
_MISFIT = (
    "{count} cells where {where} {width}; separate cells by one sign, and where it is the comma write numbers with a decimal "
    "point"
)
_SAMPLE = 200
"""Lines that the separator is judged by."""
WIDEST = 400
_ONE_OR_TWO = re.compile(r"[+-]?[0-9]{1,15}(?:,[0-9]{0,15})?;?")
"""A number with a decimal comma, or two numbers; it is one where one name stands above."""
FEWEST_LISTED = 12
"""Lines of one number each that make a list."""


@dataclass(frozen=True)
class Column:
    """What the headings say of a column.

    Parameters
    ----------
    name
        Its name, ``""`` without one.
    unit
        Its unit as `camwright.profiles.tables.column_words.unit_word` names it, what stands in its brackets if that is none, or ``None``.
    known
        Whether the unit is one.
    heading
        The heading as written.
    """

    name: str
    unit: str | None = None
    known: bool = True
    heading: str = ""


class RowError(InputError):
    """A row of what is a table otherwise is at fault."""


def _spoilt(place: str, line: int, reason: str) -> RowError:
    return RowError(*refuse(place, line, reason).messages)


@dataclass(frozen=True)
class RowLayout:
    """What the rows of a file look like where they are not all numbers.

    Parameters
    ----------
    holds
        Whether a cell, with or without a comma as decimal sign, is such as rows hold.
    above
        How many of the lines, cut into cells, stand above the rows.
    """

    holds: Callable[[str, bool], bool]
    above: Callable[[Sequence[Sequence[str]]], int]


@dataclass(frozen=True, eq=False)
class Sheet:
    """Rows and what they are called.

    Parameters
    ----------
    place
        What messages begin with.
    columns
        One for each column.
    rows
        Cells as written, all rows of one width.
    lines
        Number of each row's line.
    heading
        Number of the line that names the columns; 0 without one.
    comma
        Whether a comma may be the decimal sign.
    """

    place: str
    columns: tuple[Column, ...]
    rows: tuple[tuple[str, ...], ...]
    lines: tuple[int, ...]
    heading: int
    comma: bool

    @property
    def where(self) -> str:
        """Where the headings stand, for messages."""
        return f"{self.place}, line {self.heading}" if self.heading else self.place

    def not_in(self, name: str, unit: str, units: Collection[str]) -> InputError:
        """Say that a column cannot be in a unit."""
        return InputError(
            f"{self.where}: column {name} cannot be in {unit[:50]!r}; its unit is one of {', '.join(units)}"
        )

    def numbers(self, at: int, what: str = "") -> FloatArray:
        """Read a column.

        Raises
        ------
        InputError
            A cell is no number, with its line.
        """
        values = np.empty(len(self.rows))
        for row, cells in enumerate(self.rows):
            value = number_in(cells[at], self.comma)
            if value is None:
                _require_no_groups(self.place, [(self.lines[row], [cells[at]])])
            if value is None or abs(value) > GREATEST:
                raise refuse(
                    self.place,
                    self.lines[row],
                    f"{what + ' ' if what else ''}{cells[at].strip()[:50]!r} is not a finite number of at most {GREATEST:g}; "
                    "write it like 12.5 or 1.25e1",
                )
            values[row] = value
        return values

    def is_numeric(self, at: int) -> bool:
        """Whether every cell of a column is a number."""
        return all(number_in(cells[at], self.comma) is not None for cells in self.rows)


def read_sheet(
    text: str, place: str, names: Callable[[str], str | None], example: str, kind: str, layout: RowLayout | None = None
) -> Sheet:
    """Find the rows of numbers in a text, and their headings.

    Comment lines begin with ``#`` or ``//``. The separator is the one by which most cells are numbers, unless a line
    ``sep=;`` says it. Numbers begin at the first line that begins with a number (or a time of day) and holds two; what
    stands above are headings. Every line from there on must have as many cells.

    Parameters
    ----------
    text
        What stands in the file.
    place
        What messages begin with.
    names
        Tells what a column is from its name, ``None`` if it cannot: so the line that names the columns is found.
    example
        A heading as it should be, for messages.
    kind
        What the file should hold, for messages.
    layout
        What rows look like; rows of numbers where not given.

    Raises
    ------
    InputError
        There are no rows, or one has another number of cells; the message names the line.
    """
    lines, remarks, said = _lines(text, place)
    if not lines:
        raise InputError(f"{place}: there is no {kind} in it; write a header like {example} and rows below")
    separator = said or _separator([line for _, line in lines], is_number if layout is None else layout.holds)
    comma = separator != "," or any('"' in line for _, line in lines)
    split = [(number, _cells(line, separator)) for number, line in lines]
    first = _first_row(split, comma, None if said else separator, layout, place)
    headings = split[:first]
    again = [trimmed(cells) for _, cells in headings]
    rows = [
        (number, cells) for number, cells in split[first:] if trimmed(cells) not in again
    ]  # headings of a further page
    if not rows:
        _require_no_groups(place, [(number, _cells(line, sign)) for number, line in lines for sign in SEPARATORS])
    if layout is None:
        _require_no_spoilt_row(headings, comma, names, place)
        width = _width(headings, rows)
    else:  # rows may end early, so their usual width says little, and cells at the end may be left out
        width = max((len(trimmed(cells)) for _, cells in headings or rows), default=0)
        rows = [(number, _padded(cells, max(width, len(cells)))) for number, cells in rows]
    headings = headings or _remarked(remarks[-1:], separator, width, names)
    columns, heading = _columns(headings, width, names)
    if rows and heading:
        _require_wide_header(columns, width, names, place, rows[0][0])
    kept = tuple(_row(cells, width, number, place, bool(headings)) for number, cells in rows)
    sheet = Sheet(place, columns, kept, tuple(number for number, _ in rows), heading, comma)
    return sheet if layout is not None else _without_units(sheet)


def _first_row(
    split: list[tuple[int, list[str]]], comma: bool, found: str | None, layout: RowLayout | None, place: str
) -> int:
    """Find the first row of numbers; words at the end, as of scopes, are taken off. A separator is given if it was found, not said."""
    if layout is not None:
        return layout.above([cells for _, cells in split])
    while len(split) > 1 and not any(sign.isdigit() for cell in split[-1][1] for sign in cell):
        split.pop()
    first = next((k for k, (_, cells) in enumerate(split) if _is_row(cells, comma)), None)
    if first is None:  # no row of two numbers: a list
        return _list_start(split, comma)
    if found == ",":
        _require_no_comma(split[first:], first, place)
    return first


def _require_wide_header(
    columns: Sequence[Column], width: int, names: Callable[[str], str | None], place: str, line: int
) -> None:
    """Refuse a header that names columns, but fewer than the rows have."""
    named = len(trimmed([column.heading for column in columns]))
    if named < width and sum(names(column.name) is not None for column in columns) >= 2:
        raise _spoilt(place, line, _MISFIT.format(count=width, where="the header has", width=named))


def _remarked(
    remarks: Sequence[tuple[int, str]], separator: str, width: int, names: Callable[[str], str | None]
) -> list[tuple[int, list[str]]]:
    """Take the comment above the rows for their heading, where it names the columns."""
    for number, line in remarks:
        for sign in (separator, *SEPARATORS):
            cells = _cells(line, sign)
            if len(trimmed(cells)) == width > 1 and sum(names(split_unit(cell)[0]) is not None for cell in cells) >= 2:
                return [(number, cells)]
    return []


def _without_units(sheet: Sheet) -> Sheet:
    """Put the units that stand in the cells of a column into its heading.

    Raises
    ------
    InputError
        They differ, from each other or from the heading's; a nought needs none.
    """
    rows, columns = [list(row) for row in sheet.rows], list(sheet.columns)
    for at, column in enumerate(sheet.columns):
        if all(row[at].rstrip()[-1:] in _ENDS for row in rows):
            continue
        found = [measured_in(row[at], sheet.comma) for row in rows]
        unit = next((cell[1] for cell in found if cell), None)
        if unit is None:
            continue
        stated = column.unit or unit
        for number, row, cell in zip(sheet.lines, rows, found, strict=True):
            if (cell is not None and cell[1] != stated) or (cell is None and number_in(row[at], sheet.comma)):
                raise _spoilt(
                    sheet.place,
                    number,
                    f"{row[at].strip()[:50]!r} where the column is in {stated}; write the whole column in one unit",
                )
            row[at] = row[at] if cell is None else cell[0]
        columns[at] = replace(column, unit=stated)
    return replace(sheet, columns=tuple(columns), rows=tuple(map(tuple, rows)))


def _require_no_groups(place: str, lines: Sequence[tuple[int, Sequence[str]]]) -> None:
    """Refuse cells whose thousands are set apart, by line: which sign is the decimal one would be a guess."""
    for number, cells in lines:
        for cell in cells:
            if grouped(cell):
                raise refuse(place, number, f"{cell.strip()[:50]!r} {GROUPS}")


def _lines(text: str, place: str) -> tuple[list[tuple[int, str]], list[tuple[int, str]], str | None]:
    """Give the lines that say something, the comments above them, and the separator that the first line may state."""
    kept: list[tuple[int, str]] = []
    remarks: list[tuple[int, str]] = []
    said: str | None = None
    for number, raw in enumerate(text.removeprefix("\ufeff").replace("\r\n", "\n").split("\n"), start=1):
        if len(raw) > LONGEST_LINE:
            raise refuse(place, number, f"the line is {len(raw)} characters long; at most {LONGEST_LINE} are read")
        line = raw.strip(" \r")
        if not line.strip("\t;,| "):
            continue
        if _COMMENT.match(line) and not _FAULT_CELL.match(line.lstrip()):
            if not kept:
                remarks.append((number, line.lstrip().lstrip("#/%").strip()))
            continue
        found = _SAID.fullmatch(line.strip())
        if found and not kept:
            said = found[1]
            continue
        if line[:1].isdigit() or line[:1] in "+-.":
            line = _without_note(_REMARK.sub("", line))
        kept.append((number, line))
    return kept, remarks, said


def _without_note(line: str) -> str:
    """Take words off that stand behind the one semicolon of a row."""
    row, _, words = line.partition(";")
    first = words.lstrip()[:1]
    noted = row[-1:].isspace() and ";" not in words and (first.isalpha() or first == "_")
    return row if noted else line


def _separator(lines: Sequence[str], holds: Callable[[str, bool], bool]) -> str:
    """Find the sign that makes most cells numbers, with thousands set apart or not, or what rows hold, and fewest words."""
    sample = lines[len(lines) // 2 :][:_SAMPLE] if len(lines) > 2 * _SAMPLE else lines[-_SAMPLE:]

    def score(sign: str) -> int:
        total = 0
        for line in sample:
            cells = [cell for cell in _cells(line, sign) if cell.strip()]
            found = sum(holds(cell, sign != "," or '"' in line) or grouped(cell) for cell in cells)
            total += found - 2 * (len(cells) - found) if found > 1 else 0
        return total

    best = max(SEPARATORS, key=score)
    if score(best) <= 0:
        return max(SEPARATORS[:4], key=lambda sign: sum(line.count(sign) for line in (lines[0], *sample)))
    above = next((line for line in reversed(lines) if not _ONE_OR_TWO.fullmatch(line.strip())), ",")
    return ";" if best == "," and "," not in above and above != lines[-1] else best


def _cells(line: str, separator: str) -> list[str]:
    """Cut a line; quotes hold a cell together."""
    if separator == " ":
        return line.split()
    if '"' not in line:
        return line.split(separator)
    try:
        return next(csv.reader([line], delimiter=separator, skipinitialspace=True), [])
    except csv.Error:
        return line.split(separator)


def trimmed(cells: Sequence[str]) -> list[str]:
    """Take empty cells off the end of a row."""
    count = len(cells)
    while count and not cells[count - 1].strip():
        count -= 1
    return list(cells[:count])


def _is_row(cells: Sequence[str], comma: bool) -> bool:
    """Whether a line holds numbers: it begins with one, or a time of day, and has two."""
    filled = [cell.strip() for cell in cells if cell.strip()]
    found = sum(is_number(cell, comma) for cell in filled)
    return found >= 2 and (is_number(filled[0], comma) or is_stamp(filled[0]))


def _require_no_spoilt_row(
    headings: Sequence[tuple[int, list[str]]], comma: bool, names: Callable[[str], str | None], place: str
) -> None:
    """Refuse a row below the names of which one cell is no number: passed over as a heading it would be another table."""
    below = False
    for number, cells in headings:
        filled = [cell.strip() for cell in cells]
        wrong = [cell for cell in filled if not is_number(cell, comma) and not is_stamp(cell)]
        if below and len(wrong) == 1 and len(filled) > 1:
            raise _spoilt(
                place, number, f"{shown(wrong[0])} is no number, and the row stands below the names of the columns"
            )
        below = below or sum(names(split_unit(cell)[0]) is not None for cell in cells) >= 2


def _list_start(split: Sequence[tuple[int, list[str]]], comma: bool) -> int:
    """Find where a list of one number a line begins, if the text ends with one."""
    start = len(split)
    while start and len(filled := trimmed(split[start - 1][1])) == 1 and is_number(filled[0], comma):
        start -= 1
    return start if len(split) - start >= FEWEST_LISTED else len(split)


def _require_no_comma(rows: Sequence[tuple[int, list[str]]], above: int, place: str) -> None:
    """Refuse two columns that may as well be one with a decimal comma: nothing stands above, and the second has always as many digits."""
    if above or len(rows) < FEWEST_LISTED or any(len(cells) != 2 or not cells[1].isdecimal() for _, cells in rows):
        return
    if len(rows[0][1][1]) > 1 and len({len(cells[1]) for _, cells in rows}) == 1:
        raise _spoilt(
            place,
            rows[0][0],
            f"{','.join(rows[0][1])[:50]!r} may be two numbers, or one with a decimal comma; name the columns above, as in x [mm],y [mm], "
            "or write decimal points",
        )


def _width(headings: Sequence[tuple[int, list[str]]], rows: Sequence[tuple[int, list[str]]]) -> int:
    """Count the columns: those of most rows, or of a heading that names more but the rows' empty cells."""
    usual = collections.Counter(len(trimmed(cells)) for _, cells in rows).most_common(1)
    width = usual[0][0] if usual else 0
    named = len(trimmed(headings[-1][1])) if headings else 0
    written = max((len(cells) for _, cells in rows), default=0)
    return min(named if width < named <= max(written, width + 1) or not width else width, WIDEST)


def _row(cells: list[str], width: int, number: int, place: str, named: bool) -> tuple[str, ...]:
    """Bring a row to the number of columns: empty cells at its end are no cells."""
    filled = trimmed(cells)
    if len(filled) > width or len(cells) < width:
        count = len(filled) if len(filled) > width else len(cells)
        where = "the header has" if named else "most rows have"
        raise _spoilt(
            place,
            number,
            _MISFIT.format(count=count, where=where, width=width),
        )
    return (*filled, *[""] * (width - len(filled)))


def _columns(
    headings: Sequence[tuple[int, list[str]]], width: int, names: Callable[[str], str | None]
) -> tuple[tuple[Column, ...], int]:
    """Name the columns: the lowest line that names two, with a row of units below it."""
    lines: list[tuple[int, list[str]]] = []
    for number, cells in headings:  # a unit may stand alone below the names
        if len(trimmed(cells)) > 1 or width == 1 or (lines and is_unit_row(cells)):
            lines.append((number, _padded(cells, width)))
    if not lines:
        return (Column(""),) * width, 0
    known = [
        k
        for k, (_, cells) in enumerate(lines)
        if sum(names(split_unit(cell)[0]) is not None for cell in cells) >= min(2, width)
    ]
    at = known[-1] if known else _lowest_names(lines)
    number, cells = lines[at]
    below = [units for _, units in lines[at + 1 :] if is_unit_row(units)]
    columns = []
    for k, cell in enumerate(cells):
        name, unit, right = split_unit(cell)
        if unit is None and below and below[0][k].strip():
            unit = bare_unit(below[0][k])
        columns.append(Column(name, unit, right, cell.strip()))
    return tuple(columns), number


def _lowest_names(lines: Sequence[tuple[int, list[str]]]) -> int:
    """Find the lowest heading that is no row of units."""
    return next((k for k in reversed(range(len(lines))) if not is_unit_row(lines[k][1])), len(lines) - 1)


def is_unit_row(cells: Sequence[str]) -> bool:
    """Whether a line holds units: one at least, beside them nothing but words for pieces."""
    filled = [cell for cell in cells if cell.strip()]
    units = [cell for cell in filled if bare_unit(cell) is not None]
    return bool(units) and all(cell in units or _COUNTED.fullmatch(cell) for cell in filled)


def _padded(cells: Sequence[str], width: int) -> list[str]:
    return [*cells[:width], *[""] * (width - len(cells))]
