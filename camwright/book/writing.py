"""Writing what a book says of itself at the end: index, limit table, list of files."""

from __future__ import annotations

import contextlib
import csv
import io
import json
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict
from datetime import datetime
from pathlib import Path
from typing import Any, TextIO

from camwright.book.folder import MANIFEST, BookFolder
from camwright.book.index_html import design_row, html_pieces
from camwright.book.journal import Journal
from camwright.book.plan import Book
from camwright.book.rows import (
    COLUMNS,
    LIMIT_COLUMNS,
    Cell,
    Counts,
    count,
    index_rows,
    limit_rows,
)

_PAGE = "designs.html"
"""Where the rows of the page lie aside."""

INDEX = ("index.html", "index.xlsx", "index.csv", "limits.csv")
"""The files of a book's own, beside the list of all files."""


def write_index(book: Book, journal: Journal, folder: BookFolder) -> Counts:
    """Write a book's own files out of its journal, the list of all files last.

    The rows of the designs are made once for all three that hold them, and are in memory one at a time: of a page they come last, so its
    part of each is kept in a file aside until then.
    """
    counts = count(journal.entries())
    limits = list(limit_rows(book, journal.entries()))
    with folder.aside(_PAGE).open("w+", encoding="utf-8", newline="") as page:
        with _workbook(folder.aside("index.xlsx"), book) as sheets:
            designs = _on_page(
                page, sheets.rows("designs", book.units.named(COLUMNS), index_rows(book, journal.entries()))
            )
            digests = {"index.csv": folder.write("index.csv", csv_lines(book, book.units.named(COLUMNS), designs))}
            names = book.units.named(LIMIT_COLUMNS)
            written = sheets.rows("limits", names, limits)
            digests["limits.csv"] = folder.write("limits.csv", csv_lines(book, names, written))
            sheets.write_about(book)
        page.seek(0)
        digests["index.html"] = folder.write("index.html", html_pieces(book, counts, limits, page))
    digests["index.xlsx"] = folder.take("index.xlsx")
    folder.write(MANIFEST, _manifest(book, journal, counts, digests))
    return counts


def _on_page(page: TextIO, rows: Iterable[Sequence[Cell]]) -> Iterator[Sequence[Cell]]:
    """Write the part of the page that each row is, and hand it on."""
    for row in rows:
        page.write(design_row(row))
        yield row


def _manifest(book: Book, journal: Journal, counts: Counts, digests: dict[str, str]) -> Iterator[str]:
    """Write the list of all files: parameters, counts, then path and SHA-256 of every file, one a line."""
    head = {
        "kind": "camwright book",
        "schema_version": 1,
        "job": book.name,
        "fingerprint": book.fingerprint,
        "parameters": book.parameters(),
        "counts": asdict(counts),
    }
    yield json.dumps(head, indent=1)[:-2] + ',\n "files": [\n'
    first = True
    for path, digest in _files(book, journal, digests):
        yield ("" if first else ",\n") + f"  {json.dumps({'path': path, 'sha256': digest})}"
        first = False
    yield "\n ]\n}\n"


def _files(book: Book, journal: Journal, digests: dict[str, str]) -> Iterator[tuple[str, str]]:
    yield from sorted(digests.items())
    for entry in journal.entries():
        place = book.combination(entry.number).folder
        for name, digest in entry.files:
            yield f"{place}/{name}", digest


def csv_lines(book: Book, columns: Sequence[str], rows: Iterable[Sequence[Cell]]) -> Iterator[str]:
    """Write rows line by line: comments with the origin, the columns' names with units, the rows; what is not there is empty.

    No cell begins with a name of the user's, so none can pass for a formula.
    """
    yield f"# job: {book.name}\n"
    yield f"# job_sha256: {book.job_sha256}\n"
    for name, version in book.versions:
        yield f"# {name}: {version}\n"
    yield _line(columns)
    for row in rows:
        yield _line(row)


def _line(row: Sequence[Cell]) -> str:
    """Write one row."""
    line = io.StringIO()
    csv.writer(line, lineterminator="\n").writerow(["" if cell is None else cell for cell in row])
    return line.getvalue()


_NO_TIME = datetime(2000, 1, 1)
# a workbook must state when it was made; this one says nothing, so that its bytes stay the same
_WIDE = {"reason": 60, "failed_checks": 30, "folder": 44, "objective": 20, "name": 24, "value of": 80}


class _Sheets:
    """Sheets of a workbook, written row by row, so that its memory does not grow; texts are written as texts, whatever they hold."""

    def __init__(self, workbook: Any) -> None:
        self._workbook = workbook
        self._bold = workbook.add_format({"bold": True, "text_wrap": True, "valign": "top"})

    def rows(self, name: str, columns: Sequence[str], rows: Iterable[Sequence[Cell]]) -> Iterator[Sequence[Cell]]:
        """Write a sheet, and hand its rows on: the columns' names, then the rows; the names stay in sight."""
        sheet = self._workbook.add_worksheet(name)
        for column, title in enumerate(columns):
            sheet.set_column(column, column, _WIDE.get(title, 13))
        sheet.freeze_panes(1, 0)
        for column, title in enumerate(columns):
            sheet.write_string(0, column, title, self._bold)
        for number, row in enumerate(rows, start=1):
            for column, cell in enumerate(row):
                if isinstance(cell, str):
                    sheet.write_string(number, column, cell)
                elif cell is not None:
                    sheet.write_number(number, column, cell)
            yield row

    def write_about(self, book: Book) -> None:
        """Write the sheet of what the book is made of."""
        about: list[tuple[str, Cell]] = [("job", book.name), ("job_sha256", book.job_sha256)]
        about += [(key, _plain(value)) for key, value in book.parameters().items() if key != "job_sha256"]
        for _ in self.rows("about", ("name", "value of"), about):
            pass


@contextlib.contextmanager
def _workbook(path: Path, book: Book) -> Iterator[_Sheets]:
    """Open the workbook of a book, to be finished at the end."""
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
    yield _Sheets(workbook)
    workbook.close()


def _plain(value: object) -> str:
    """Write a parameter as a text."""
    if isinstance(value, dict):
        return ", ".join(f"{name} {entry}" for name, entry in value.items())
    return ", ".join(map(str, value)) if isinstance(value, list) else str(value)
