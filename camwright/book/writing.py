"""Writing what a book says of itself at the end: index, limit table, list of files."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import asdict

from camwright.book.folder import MANIFEST, BookFolder
from camwright.book.index_csv import csv_lines
from camwright.book.index_html import html_pieces
from camwright.book.index_xlsx import write_workbook
from camwright.book.journal import Journal
from camwright.book.plan import Book
from camwright.book.rows import (
    COLUMNS,
    LIMIT_COLUMNS,
    Counts,
    count,
    index_rows,
    limit_rows,
)

INDEX = ("index.html", "index.xlsx", "index.csv", "limits.csv")
"""The files of a book's own, beside the list of all files."""


def write_index(book: Book, journal: Journal, folder: BookFolder) -> Counts:
    """Write a book's own files out of its journal, the list of all files last."""
    counts = count(journal.entries())
    digests = {
        "index.csv": folder.write(
            "index.csv", csv_lines(book, book.units.named(COLUMNS), index_rows(book, journal.entries()))
        ),
        "limits.csv": folder.write(
            "limits.csv", csv_lines(book, book.units.named(LIMIT_COLUMNS), limit_rows(book, journal.entries()))
        ),
        "index.html": folder.write(
            "index.html",
            html_pieces(book, counts, limit_rows(book, journal.entries()), index_rows(book, journal.entries())),
        ),
    }
    write_workbook(
        folder.aside("index.xlsx"), book, index_rows(book, journal.entries()), limit_rows(book, journal.entries())
    )
    digests["index.xlsx"] = folder.take("index.xlsx")
    folder.write(MANIFEST, _manifest(book, journal, counts, digests))
    return counts


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
