"""A book's index and limit table as CSV, for spreadsheets and controllers."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Iterator, Sequence

from camwright.book.plan import Book
from camwright.book.rows import Cell


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
