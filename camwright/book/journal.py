"""`Journal`: what a book has done so far, in SQLite, so that nothing that is done is lost or done twice."""

from __future__ import annotations

import hashlib
import json
import sqlite3
from collections.abc import Iterator
from pathlib import Path
from types import TracebackType

from camwright.book.entry import Entry
from camwright.book.plan import Book
from camwright.profiles.errors import InputError

VERSION = "2"
"""Version of the journal's layout."""

_SCHEMA = {
    "book": "CREATE TABLE book (key TEXT PRIMARY KEY, value TEXT NOT NULL) STRICT",
    "designs": "CREATE TABLE designs (number INTEGER PRIMARY KEY, entry TEXT NOT NULL, sha256 TEXT NOT NULL) STRICT",
}


class Journal:
    """The journal of one book.

    One process writes it. Every entry is a transaction of its own in write-ahead mode: a process that is killed loses none that
    `add` has returned from, and leaves no half entry. Each entry has a SHA-256 of book, number and values, so that none is
    taken for what it is not.

    Parameters
    ----------
    path
        The database; made when it is missing.
    book
        The book that it belongs to.

    Raises
    ------
    InputError
        It is the journal of another book, of another program, damaged, or in use.
    """

    def __init__(self, path: Path, book: Book) -> None:
        self._path = path
        self._fingerprint = book.fingerprint
        self._most = len(book)
        own = {"version": VERSION, "fingerprint": book.fingerprint, "parameters": json.dumps(book.parameters())}
        if path.exists() and not path.stat().st_size and (path.parent.parent / "designs").exists():
            raise damaged(path, "it is empty, but designs are there")
        try:
            self._base = sqlite3.connect(path, timeout=1.0, isolation_level=None)
        except sqlite3.Error as error:
            raise InputError(
                f"{path}: the journal of the book cannot be opened: {error}; choose another --out"
            ) from error
        try:
            self._open(own)
            self._require_own(own, book)
            for _ in self.entries():  # every one is looked at before the first is built upon
                pass
        except sqlite3.Error as error:
            self.close()
            if "locked" in str(error) or "readonly" in str(error) or "unable to open" in str(error):
                raise InputError(
                    f"{path}: the journal of the book cannot be written: {error}; is another camwright book at work in this folder?"
                ) from error
            raise damaged(path, f"not the journal of a book: {error}") from error
        except InputError:
            self.close()
            raise

    def _open(self, own: dict[str, str]) -> None:
        """Take the database for this process alone; make the tables where there are none at all."""
        self._base.execute("PRAGMA journal_mode = WAL")
        self._base.execute("PRAGMA synchronous = NORMAL")
        self._base.execute("PRAGMA locking_mode = EXCLUSIVE")
        self._base.execute("BEGIN IMMEDIATE")
        if not self._base.execute("SELECT count(*) FROM sqlite_master").fetchone()[0]:
            for statement in _SCHEMA.values():
                self._base.execute(statement)
            self._base.executemany("INSERT INTO book VALUES (?, ?)", own.items())
        self._base.execute("COMMIT")

    def _require_own(self, own: dict[str, str], book: Book) -> None:
        """Refuse what is damaged, of another layout, or of another book."""
        found = [line for (line,) in self._base.execute("PRAGMA quick_check(1)")]
        if found != ["ok"]:
            raise damaged(self._path, found[0] if found else "it cannot be checked")
        tables = dict(self._base.execute("SELECT name, sql FROM sqlite_master WHERE sql IS NOT NULL"))
        stored = dict(self._base.execute("SELECT key, value FROM book")) if "book" in tables else {}
        version = stored.get("version", "1" if "fingerprint" in stored else "unknown")
        if version != VERSION:
            raise damaged(self._path, f"its layout is of version {version:.20}, this camwright reads {VERSION}")
        if tables != _SCHEMA:
            raise damaged(self._path, "its tables are not those of a journal")
        if stored.get("fingerprint") != own["fingerprint"]:
            try:
                parameters = dict(json.loads(stored["parameters"]))
            except (KeyError, ValueError, TypeError) as error:
                raise damaged(self._path, "what book it belongs to cannot be read") from error
            raise other_book(self._path.parent.parent, parameters, book)
        if stored != own:
            raise damaged(self._path, "what it says of its book differs from the book's fingerprint")

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
        text = entry.to_json()
        self._base.execute(
            "INSERT OR REPLACE INTO designs VALUES (?, ?, ?)", (entry.number, text, self._sum(entry.number, text))
        )

    def forget(self, number: int) -> None:
        """Take an entry back, so that its combination is done again."""
        self._base.execute("DELETE FROM designs WHERE number = ?", (number,))

    def numbers(self) -> set[int]:
        """Numbers of the combinations that are done."""
        return {number for (number,) in self._base.execute("SELECT number FROM designs")}

    def entries(self) -> Iterator[Entry]:
        """Read the entries one after another, by number.

        Raises
        ------
        InputError
            One of them is not what was entered under its number.
        """
        for number, text, digest in self._base.execute("SELECT number, entry, sha256 FROM designs ORDER BY number"):
            if digest != self._sum(number, text) or not 1 <= number <= self._most:
                raise damaged(self._path, f"entry {number} is not what was entered")
            yield Entry.from_json(text)

    def _sum(self, number: int, text: str) -> str:
        """SHA-256 of what an entry says, of which combination of which book."""
        return hashlib.sha256(f"{self._fingerprint} {number} {text}".encode()).hexdigest()


def damaged(path: Path, what: str) -> InputError:
    """Say what is wrong with a journal, and the way out."""
    return InputError(
        f"{path}: the journal of the book is damaged: {what}; --resume cannot go on with it and nothing was changed: make the book "
        "anew in another --out, or move this folder away"
    )


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
