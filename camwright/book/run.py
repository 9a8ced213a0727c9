"""Making a whole book, or what is missing of it."""

from __future__ import annotations

import contextlib
import json
import platform
import sqlite3
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from camwright.book.folder import MANIFEST, BookFolder
from camwright.book.journal import Journal, other_book
from camwright.book.making import peak_rss
from camwright.book.plan import Book
from camwright.book.rows import Counts
from camwright.book.workers import Crew, make_all
from camwright.book.writing import INDEX, write_index
from camwright.profiles.errors import InputError

Told = Callable[[int], None]
"""Told how many combinations are done."""


def nothing(_done: int) -> None:
    """Show no progress."""


@dataclass(frozen=True)
class BookAnswer:
    """What making a book came to.

    Parameters
    ----------
    counts
        How many combinations ended how.
    rate
        Combinations made a second, from the start of the command to the last file; 0 if none was missing.
    peak_rss
        Peak memory of this process and of its workers on this machine, added up (bytes).
    resumed
        Combinations that were done before.
    files
        The book's own files.
    """

    book: Book
    counts: Counts
    rate: float
    peak_rss: int
    resumed: int
    files: tuple[Path, ...]

    @property
    def exit_code(self) -> int:
        """What the command ends with: 4 if the solver failed, 1 if a check failed, 3 if nothing is feasible, else 0."""
        if self.counts.failed:
            return 4
        if self.counts.check_failed:
            return 1
        return 3 if self.counts.infeasible == self.counts.designs else 0

    def to_dict(self) -> dict[str, Any]:
        """Give the object that ``--json`` prints."""
        return {
            "job": self.book.name,
            "designs": self.counts.designs,
            "passed": self.counts.passed,
            "check_failed": self.counts.check_failed,
            "infeasible": self.counts.infeasible,
            "failed": self.counts.failed,
            "designs_per_s": self.rate,
            "peak_rss_mb": self.peak_rss / 2**20,
            "resumed": self.resumed,
            "files": [str(file) for file in self.files],
        }


def make_book(book: Book, root: Path, crew: Crew, *, resume: bool = False, told: Told = nothing) -> BookAnswer:
    """Make a book, or what is missing of it.

    Parameters
    ----------
    root
        Its folder; empty or missing, unless the book is resumed.
    crew
        Who makes the designs.
    resume
        Whether to go on with the book that the folder holds.
    told
        Told how many combinations are done, at first how many were before.

    Raises
    ------
    InputError
        The folder holds something else, or cannot be written; the workers are gone.
    """
    begun = time.perf_counter()
    folder = BookFolder(root, book)
    files = tuple(root / name for name in (*INDEX, MANIFEST))
    if folder.manifest.exists():
        counts = _complete(book, folder, resume=resume)
        told(counts.designs)
        return BookAnswer(book, counts, 0.0, peak_rss(), counts.designs, files)
    folder.begin(resume=resume)
    with Journal(folder.journal, book) as journal:
        with _writing(root):
            folder.clear()
        for number in [entry.number for entry in journal.entries() if not folder.holds(entry)]:
            journal.forget(number)
        known = journal.numbers()
        told(len(known))
        memory = _make_missing(book, folder, journal, crew, known, told)
        with _writing(root):
            counts = write_index(book, journal, folder)
    folder.finish()
    rate = (len(book) - len(known)) / (time.perf_counter() - begun)
    return BookAnswer(book, counts, rate, peak_rss() + memory, len(known), files)


def _make_missing(book: Book, folder: BookFolder, journal: Journal, crew: Crew, known: set[int], told: Told) -> int:
    """Make what is not known; the peak memory of the workers on this machine, added up (bytes)."""
    here, peaks, done = f"{platform.node()}:", {}, len(known)
    missing: Iterator[int] = (number for number in range(1, len(book) + 1) if number not in known)
    with contextlib.closing(make_all(book, missing, crew)) as results:
        for made in results:
            with _writing(folder.root):
                folder.place(made.entry, made.texts)
                journal.add(made.entry)
            done += 1
            told(done)
            if made.worker.startswith(here):
                peaks[made.worker] = made.peak_rss
    return sum(peaks.values())


@contextlib.contextmanager
def _writing(root: Path) -> Iterator[None]:
    """Tell of a disk that is full, or gone."""
    try:
        yield
    except (OSError, sqlite3.Error) as error:
        raise InputError(
            f"{root}: the book cannot be written: {error}; what is done is kept, --resume goes on with it"
        ) from error


def _complete(book: Book, folder: BookFolder, *, resume: bool) -> Counts:
    """Answer for a folder whose book is complete."""
    if not resume:
        raise InputError(f"{folder.root}: holds a complete book; choose another --out")
    try:
        listed = json.loads(folder.manifest.read_text(encoding="utf-8"))
        fingerprint, parameters, files = listed["fingerprint"], listed["parameters"], listed["files"]
        counts = Counts(**listed["counts"])
        differing = folder.differing(files)
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise InputError(f"{folder.manifest}: not the list of a book's files; choose another --out") from error
    if fingerprint != book.fingerprint:
        raise other_book(folder.root, parameters, book)
    if differing:
        raise InputError(
            f"{folder.root}: the book is complete, but {len(differing)} of its files are missing or were changed, the first "
            f"{differing[0]}; make it anew in another --out"
        )
    folder.finish()
    return counts
