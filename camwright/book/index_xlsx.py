"""A book's index as a workbook: the designs, the limits, and what the book was made of."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from datetime import datetime
from pathlib import Path
from typing import Any

from camwright.book.plan import Book
from camwright.book.rows import COLUMNS, LIMIT_COLUMNS, Cell

_NO_TIME = datetime(2000, 1, 1)
# a workbook must state when it was made; this one says nothing, so that its bytes stay the same
_WIDE = {"reason": 60, "failed_checks": 30, "folder": 44, "objective": 20, "name": 24, "value of": 80}


def write_workbook(path: Path, book: Book, designs: Iterable[Sequence[Cell]], limits: Iterable[Sequence[Cell]]) -> None:
    """Write the workbook row by row, so that its memory does not grow; texts are written as texts, whatever they hold."""
    options = {
        "constant_memory": True,
        "strings_to_formulas": False,
        "strings_to_numbers": False,
        "strings_to_urls": False,
        "tmpdir": str(path.parent),
    }
    from xlsxwriter import Workbook

    workbook = Workbook(str(path), options)
    workbook.set_properties({"created": _NO_TIME, "comments": f"camwright {dict(book.versions)['camwright']}"})
    bold = workbook.add_format({"bold": True, "text_wrap": True, "valign": "top"})
    about: list[tuple[str, Cell]] = [("job", book.name), ("job_sha256", book.job_sha256)]
    about += [(key, _plain(value)) for key, value in book.parameters().items() if key != "job_sha256"]
    _sheet(workbook, "designs", book.units.named(COLUMNS), designs, bold)
    _sheet(workbook, "limits", book.units.named(LIMIT_COLUMNS), limits, bold)
    _sheet(workbook, "about", ("name", "value of"), about, bold)
    workbook.close()


def _sheet(workbook: Any, name: str, columns: Sequence[str], rows: Iterable[Sequence[Cell]], bold: Any) -> None:
    """Write a sheet: the columns' names, then the rows; the names stay in sight."""
    sheet = workbook.add_worksheet(name)
    for column, title in enumerate(columns):
        sheet.set_column(column, column, _WIDE.get(title, 13))
    sheet.freeze_panes(1, 0)
    for column, title in enumerate(columns):
        sheet.write_string(0, column, title, bold)
    for number, row in enumerate(rows, start=1):
        for column, cell in enumerate(row):
            if isinstance(cell, str):
                sheet.write_string(number, column, cell)
            elif cell is not None:
                sheet.write_number(number, column, cell)


def _plain(value: object) -> str:
    """Write a parameter as a text."""
    if isinstance(value, dict):
        return ", ".join(f"{name} {entry}" for name, entry in value.items())
    return ", ".join(map(str, value)) if isinstance(value, list) else str(value)
