"""`BookFolder`: where a book's files lie; nothing half-written ever stands in its place."""

from __future__ import annotations

import hashlib
import os
import shutil
from collections.abc import Iterator, Mapping
from pathlib import Path

from camwright.book.entry import Entry
from camwright.book.plan import Book
from camwright.house.files import fill, flush, put
from camwright.profiles.errors import InputError

MANIFEST = "book.json"
"""Written last: where it stands the book is complete."""


class BookFolder:
    """The folder of a book.

    While the book is being made it holds the folder ``.book`` with the journal and with what is being written; both are gone when it
    is complete.
    """

    def __init__(self, root: Path, book: Book) -> None:
        self.root = root
        self._book = book
        self._work = root / ".book"
        self._aside = self._work / "new"

    @property
    def journal(self) -> Path:
        """The journal."""
        return self._work / "journal.sqlite"

    @property
    def manifest(self) -> Path:
        """The list of all files, written last."""
        return self.root / MANIFEST

    def begin(self, *, resume: bool) -> None:
        """Make the folder, for the journal to be opened in it.

        Raises
        ------
        InputError
            It holds a book, or files, and is not to go on with it; or there is nothing to go on with; or it cannot be written.
        """
        begun = self.journal.exists()
        empty = not self.root.exists() or all(entry == self._work for entry in self.root.iterdir())
        if begun and not resume:
            raise InputError(
                f"{self.root}: holds a book that is not complete; go on with it by --resume, or choose another --out"
            )
        if not begun and not empty:
            advice = "leave out --resume and choose another --out" if resume else "choose another --out"
            raise InputError(f"{self.root}: not empty, and holds no book to go on with; {advice}")
        try:
            self._work.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise InputError(
                f"{self.root}: the folder of the book cannot be made: {error.strerror}; choose another --out"
            ) from error

    def clear(self) -> None:
        """Clear away what was half-written; for who holds the journal alone, else another book's writing would go."""
        shutil.rmtree(self._aside, ignore_errors=True)
        self._aside.mkdir()

    def place(self, entry: Entry, texts: Mapping[str, str]) -> None:
        """Put the files of a combination into their place, all at once."""
        if not texts:
            return
        target = self.root / self._book.combination(entry.number).folder
        aside = self._aside / str(entry.number)
        aside.mkdir()
        fill(aside, texts)
        put(aside, target)  # a folder stands there where the journal did not come to know of it

    def write(self, name: str, pieces: Iterator[str]) -> str:
        """Write a file of the book's own, piece by piece, aside first; gives its SHA-256."""
        aside, digest = self._aside / name, hashlib.sha256()
        with aside.open("wb") as file:
            for piece in pieces:
                data = piece.encode()
                digest.update(data)
                file.write(data)
        flush(aside)
        put(aside, self.root / name)
        return digest.hexdigest()

    def aside(self, name: str) -> Path:
        """Give the place where a file of the book's own is written before it is moved."""
        return self._aside / name

    def take(self, name: str) -> str:
        """Move a file from aside into its place; gives its SHA-256."""
        put(self._aside / name, self.root / name)
        return digest_of(self.root / name)

    def finish(self) -> None:
        """Remove the journal and the place aside: the book is complete, and on the disk."""
        if hasattr(os, "sync"):
            os.sync()
        shutil.rmtree(self._work, ignore_errors=True)

    def differing(self, files: list[dict[str, str]]) -> list[str]:
        """Give the paths of files that are missing or not what their checksum says."""
        return [file["path"] for file in files if not self._is(self.root / file["path"], file["sha256"])]

    def holds(self, entry: Entry) -> bool:
        """Whether all files of an entry lie in their place, byte for byte."""
        place = self.root / self._book.combination(entry.number).folder
        return all(self._is(place / name, digest) for name, digest in entry.files)

    @staticmethod
    def _is(path: Path, digest: str) -> bool:
        try:
            return digest_of(path) == digest
        except OSError:
            return False


def digest_of(path: Path) -> str:
    """SHA-256 of a file's bytes."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
