"""The columns of the tables that production reads: lists, line speeds, offsets, in any language and with any of the usual separators."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

from camwright.house.files import read_bytes
from camwright.house.units import exact_quantity
from camwright.profiles.errors import InputError
from camwright.profiles.polynomial.profile import FloatArray
from camwright.profiles.tables.column_words import words_of
from camwright.profiles.tables.delimited import Column, Sheet
from camwright.profiles.tables.text import decode

_UNIT = re.compile(r".*[\[(]\s*([^\[\]()]{1,20}?)\s*[\])]\s*")
_PER = re.compile(r".+_(m|mm|in|ft)_per_(s|min|h)")

_WIDE = str.maketrans("（）［］", "()[]")
"""Brackets as Chinese text has them."""

_WORDS: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "length": (("len",), ("length", "länge", "laenge", "longueur", "长度", "长")),
    "quantity": (
        ("qty", "pcs", "pieces", "count", "anz", "number", "stk"),
        ("quantity", "anzahl", "stück", "stueck", "menge", "数量", "件数", "个数"),
    ),
    "kind": (("art", "typ"), ("kind", "type", "operation", "种类", "类型")),
    "time": (("t",), ("time", "zeit", "时间")),
    "acceleration": (("a",), ("acceleration", "beschl", "加速度")),
    "speed": (("v",), ("speed", "velocity", "geschw", "速度", "车速")),
    "offset": (("c",), ("offset", "versatz", "abweichung", "偏移", "偏差")),
}
"""What columns are called, in small letters: words of a heading, and what a word may hold."""

_NAMES = frozenset({"part", "article", "artikel", "order", "auftrag", "item", "job", "id", "no", "nr"})
"""Words of a heading whose numbers are names: that of a part is not how many there are."""


def read_table_text(path: Path, what: str, limit: int) -> str:
    """Read a table as spreadsheets write it: in UTF-8, UTF-16, GBK or the code page of Windows."""
    return decode(read_bytes(path, what, limit), str(path), limit)


def role(name: str) -> str | None:
    """Say what a column is by its heading; ``None`` if that does not tell."""
    words = words_of(name.translate(_WIDE))
    if _NAMES.intersection(words):
        return None
    return next(
        (
            what
            for what, (whole, parts) in _WORDS.items()
            if any(word in whole or any(part in word for part in parts) for word in words)
        ),
        None,
    )


def columns(sheet: Sheet, names: Sequence[str], needed: int, header: str) -> dict[str, int]:
    """Say which column is what, by the headings or without any by their order.

    Parameters
    ----------
    sheet
        The table.
    names
        What is looked for; the first ``needed`` of them must be there.
    needed
        How many.
    header
        Headings as they should be, for messages.

    Raises
    ------
    InputError
        A column is missing, or two are called alike.
    """
    if not sheet.heading:
        if len(sheet.columns) < needed:
            raise InputError(
                f"{sheet.place}: {len(sheet.columns)} column where {needed} are needed; write a header like {header} and rows below"
            )
        return {name: number for number, name in enumerate(names[: len(sheet.columns)])}
    at: dict[str, int] = {}
    for number, column in enumerate(sheet.columns):
        found = role(column.name)
        if found is not None and found in names:
            if found in at:
                raise InputError(
                    f"{sheet.place}, line {sheet.heading}: column {found} stands there twice; leave one out"
                )
            at[found] = number
    missing = [name for name in names[:needed] if name not in at]
    if missing:
        raise InputError(
            f"{sheet.place}, line {sheet.heading}: there is no column {' and no column '.join(missing)}; write a header like {header}"
        )
    return at


def unit_of(column: Column) -> str | None:
    """Give the unit of a column, known to the reader of tables or not; ``line_speed_m_per_min`` is in m/min."""
    per = _PER.fullmatch(column.heading.strip().lower())
    if per:
        return f"{per[1]}/{per[2]}"
    if column.unit is not None:
        return column.unit
    found = _UNIT.fullmatch(column.heading.translate(_WIDE))
    return found[1] if found else None


def column_in_si(sheet: Sheet, at: int, name: str, kind: str, header: str) -> FloatArray:
    """Read a column of numbers into SI units.

    Parameters
    ----------
    sheet, at
        The table, and which column.
    name
        What it is, for messages.
    kind
        Kind of its quantity, a key of `camwright.house.units.KINDS`.
    header
        Headings as they should be, for messages.

    Raises
    ------
    InputError
        The column has no unit or a wrong one, or a cell is no number, with its line.
    """
    unit = unit_of(sheet.columns[at])
    where = f"{sheet.place}, line {sheet.heading}" if sheet.heading else sheet.place
    if unit is None:
        raise InputError(f"{where}: column {name} has no unit; write a header like {header}")
    try:
        factor = float(exact_quantity(f"1 {unit}", kind))
    except InputError as error:
        raise InputError(*(f"{where}: column {name}: {fault}" for fault in error.faults)) from error
    return sheet.numbers(at, name) * factor
