"""Small books for the tests, and crews that need no processes."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Sequence
from concurrent.futures import Executor, Future
from pathlib import Path
from typing import Any

from camwright.book.making import Made, make_chunk
from camwright.book.plan import Book, plan_book
from camwright.book.workers import Crew
from camwright.jobs.job import load_job
from camwright.profiles.errors import CamwrightError

ROOT = Path(__file__).resolve().parent.parent.parent
JOB = ROOT / "examples" / "paper-600.toml"
RANGES = ("250:650:200", "60:120:60")
"""Infeasible, passing and settling too late: all ends but a failure."""
OBJECTIVES = ("peak_acceleration", "rms_acceleration")


def small_book(targets: str = "csv", objectives: Sequence[str] = OBJECTIVES, ranges: tuple[str, str] = RANGES) -> Book:
    """Plan a book of 12 combinations."""
    return plan_book(load_job(JOB), *ranges, objectives, targets)


class Inline(Executor):
    """Does the work at once, in this process."""

    def submit(self, work: Any, /, *arguments: Any, **named: Any) -> Future[Any]:
        """Do it."""
        future: Future[Any] = Future()
        try:
            future.set_result(work(*arguments, **named))
        except CamwrightError as error:
            future.set_exception(error)
        return future


def inline_crew(work: Any = make_chunk, chunk: int = 2) -> Crew:
    """Make a crew without processes."""
    return Crew(lambda: contextlib.nullcontext(Inline()), lambda: 1, chunk, work, ())


def contents(root: Path) -> dict[str, bytes]:
    """Every file below a folder."""
    return {str(file.relative_to(root)): file.read_bytes() for file in sorted(root.rglob("*")) if file.is_file()}


def dies_at_3(book: Book, numbers: Sequence[int]) -> list[Made]:
    """Make a chunk; the process dies of combination 3."""
    if 3 in numbers:
        os._exit(1)
    return make_chunk(book, numbers)


def dies_once(book: Book, numbers: Sequence[int]) -> list[Made]:
    """Make a chunk; the first process that comes to combination 3 dies of it."""
    mark = Path(os.environ["CAMWRIGHT_TEST_MARK"])
    if 3 in numbers and not mark.exists():
        mark.touch()
        os._exit(1)
    return make_chunk(book, numbers)
