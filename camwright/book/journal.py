"""`Journal`: what a book has done so far, in SQLite, so that nothing that is done is lost or done twice."""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path
from types import TracebackType

from camwright.book.entry import Entry
from camwright.book.plan import Book
from camwright.profiles.errors import InputError

_SCHEMA = """
CREATE TABLE IF NOT EXISTS book (key TEXT PRIMARY KEY, value TEXT NOT NULL) STRICT;
CREATE TABLE IF NOT EXISTS designs (number INTEGER PRIMARY KEY, entry TEXT NOT NULL) STRICT;
"""


class Journal:
    """The journal of one book.

    One process writes it. Every entry is a transaction of its own in write-ahead mode: a process that is killed loses none that
    `add` has returned from, and leaves no half entry.

    Parameters
    ----------
    path
        The database; made when it is missing.
    book
        The book that it belongs to.

    Raises
    ------
    InputError
        It is the journal of another book, of another program, or in use.
    """

    def __init__(self, path: Path, book: Book) -> None:
        self._path = path
        with ExitStack() as undone:
            try:
                self._base = sqlite3.connect(path, timeout=1.0, isolation_level=None)
                undone.callback(self._base.close)
                self._base.execute("PRAGMA journal_mode = WAL")
                self._base.execute("PRAGMA synchronous = NORMAL")
                self._base.execute("PRAGMA locking_mode = EXCLUSIVE")
                self._base.execute("BEGIN IMMEDIATE")
                for statement in _SCHEMA.strip().splitlines():
                    self._base.execute(statement)
                stored = dict(self._base.execute("SELECT key, value FROM book"))
                if not stored:
                    rows = [("fingerprint", book.fingerprint), ("parameters", json.dumps(book.parameters()))]
                    self._base.executemany("INSERT INTO book VALUES (?, ?)", rows)
                self._base.execute("COMMIT")
            except sqlite3.OperationalError as error:
                raise InputError(
                    f"{path}: the journal of the book cannot be written: {error}; is another camwright book at work in this folder?"
                ) from error
            except sqlite3.DatabaseError as error:
                raise InputError(f"{path}: not the journal of a book: {error}; choose another --out") from error
            if stored and stored.get("fingerprint") != book.fingerprint:
                raise other_book(path.parent.parent, json.loads(stored.get("parameters", "{}")), book)
            undone.pop_all()

    def __enter__(self) -> Journal:
        """Use the journal for a while."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Close it."""
        self.close()

    def close(self) -> None:
        """Close the database."""
        self._base.close()

    def add(self, entry: Entry) -> None:
        """Keep an entry for good; its files must lie in their place."""
        self._base.execute("INSERT OR REPLACE INTO designs VALUES (?, ?)", (entry.number, entry.to_json()))

    def forget(self, number: int) -> None:
        """Take an entry back, so that its combination is done again."""
        self._base.execute("DELETE FROM designs WHERE number = ?", (number,))

    def numbers(self) -> set[int]:
        """Numbers of the combinations that are done."""
        return {number for (number,) in self._base.execute("SELECT number FROM designs")}

    def entries(self) -> Iterator[Entry]:
        """Read the entries one after another, by number."""
        for (text,) in self._base.execute("SELECT entry FROM designs ORDER BY number"):
            yield Entry.from_json(text)


def other_book(folder: Path, stored: dict[str, object], book: Book) -> InputError:
    """Say in what the book in a folder differs from the one asked for."""
    own = book.parameters()
    words = {
        "layout": "the layout of books",
        "job_sha256": "the job file (SHA-256)",
        "length": "--length",
        "line_speed": "--line-speed",
        "objective": "--objective",
        "targets": "--targets",
        "versions": "the versions of camwright and its libraries",
    }
    differences = [
        f"{words[key]} {_shown(stored.get(key))} there, {_shown(value)} now"
        for key, value in own.items()
        if stored.get(key) != value
    ]
    return InputError(
        f"{folder}: holds another book, --resume cannot go on with it: {'; '.join(differences) or 'its values differ'}; "
        "ask for the same book, or choose another --out"
    )


def _shown(value: object) -> str:
    """Write a parameter for a message."""
    if isinstance(value, dict):
        return " ".join(f"{name} {entry}" for name, entry in value.items())
    return ",".join(map(str, value)) if isinstance(value, list) else str(value)
