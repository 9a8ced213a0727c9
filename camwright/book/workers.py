"""Making a book with several processes: in chunks, results as they come, processes that die replaced."""

from __future__ import annotations

import contextlib
import gc
import multiprocessing
import os
import signal
import threading
from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, CancelledError, Executor, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from functools import partial
from itertools import islice
from multiprocessing.synchronize import Event
from pathlib import Path

from camwright.book.entry import Entry
from camwright.book.making import Made, make_chunk
from camwright.book.plan import Book
from camwright.house.interrupts import noted_interrupts
from camwright.house.threads import VARIABLES
from camwright.profiles.errors import InputError

_AHEAD = 2
"""Chunks that lie ready for each worker."""

_PAUSE = 0.2
"""Time after which it is looked whether somebody interrupts (s), though nothing is done."""

Work = Callable[[Book, Sequence[int]], list[Made]]
"""Makes a chunk of combinations, given by their numbers."""


@dataclass(frozen=True)
class Crew:
    """Who makes a book.

    Parameters
    ----------
    start
        Starts an executor; called again when the one before broke.
    size
        Gives the number of chunks that can be worked on at the same time.
    chunk
        Combinations that are given at a time.
    work
        Makes a chunk, in the worker.
    lost
        Errors by which an executor tells that a worker died.
    """

    start: Callable[[], contextlib.AbstractContextManager[Executor]]
    size: Callable[[], int]
    chunk: int
    work: Work
    lost: tuple[type[Exception], ...]


def default_jobs() -> int:
    """Count the processors that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def local_crew(jobs: int, work: Work = make_chunk) -> Crew:
    """Make a crew of processes on this machine.

    They are given one combination at a time: a chunk saves nothing where nothing is sent over a network, and would be lost whole.

    Parameters
    ----------
    jobs
        Number of processes.
    work
        Makes a chunk.
    """

    @contextlib.contextmanager
    def start() -> Iterator[Executor]:
        context = multiprocessing.get_context("fork" if _alone() else "spawn")
        stop = context.Event()
        with _environment(dict.fromkeys(VARIABLES, "1")):
            executor = ProcessPoolExecutor(jobs, context, _settle, (stop,))
            try:
                with _interrupts_held():
                    for _ in range(jobs):  # each starts a process
                        executor.submit(os.getpid)
                yield executor
            finally:
                stop.set()
                executor.shutdown(wait=True, cancel_futures=True)

    return Crew(start, lambda: jobs, 1, partial(_unless_stopped, work), (BrokenProcessPool,))


def _alone() -> bool:
    """Whether this process has a single thread, as the system counts: a copy of it is whole, and has imported everything already."""
    threads = Path("/proc/self/task")
    return threads.is_dir() and len(list(threads.iterdir())) == 1


@contextlib.contextmanager
def _environment(values: dict[str, str]) -> Iterator[None]:
    """Set environment variables for the processes that are started meanwhile: two workers on two cores need no more threads."""
    before = {name: os.environ.get(name) for name in values}
    os.environ.update(values)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value


@contextlib.contextmanager
def _interrupts_held() -> Iterator[None]:
    """Hold an interrupt back until the end; processes that are started meanwhile get none, not even before they can ignore it."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


_stop: Event | None = None


def _settle(stop: Event) -> None:
    """Begin a worker: an interrupt is for the process that leads, and when that is gone nobody waits for results."""
    global _stop  # noqa: PLW0603 - what a worker process is told once
    _stop = stop
    gc.freeze()  # what is imported stays: nobody need look through it again and again
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    leader = multiprocessing.parent_process()
    if leader is not None:

        def follow() -> None:
            leader.join()
            os._exit(1)

        threading.Thread(target=follow, daemon=True).start()


def _unless_stopped(work: Work, book: Book, numbers: Sequence[int]) -> list[Made]:
    """Make a chunk; nothing of what still waited when the leading process stopped."""
    return [] if _stop is not None and _stop.is_set() else work(book, numbers)


def make_all(book: Book, numbers: Iterable[int], crew: Crew) -> Generator[Made, None, None]:
    """Make combinations, in any order.

    Parameters
    ----------
    crew
        Who makes them.

    Yields
    ------
    Made
        Each combination when it is done. One whose worker died is tried again alone; if that worker dies, too, it has failed.
    """
    rest = iter(numbers)
    chunks = deque(iter(lambda: tuple(islice(rest, crew.chunk)), ()))
    suspects: list[tuple[int, ...]] = []
    with noted_interrupts() as interrupted:
        while chunks:
            yield from _round(book, chunks, suspects, crew, interrupted, together=True)
        chunks.extend((number,) for chunk in suspects for number in chunk)
        suspects.clear()
        while chunks:
            yield from _round(book, chunks, suspects, crew, interrupted, together=False)
    for (number,) in suspects:
        yield Made(Entry(number, "failed", reason="the process that designed it died, twice"), {}, "", 0)


def _round(
    book: Book,
    chunks: deque[tuple[int, ...]],
    lost: list[tuple[int, ...]],
    crew: Crew,
    interrupted: Callable[[], None],
    *,
    together: bool,
) -> Iterator[Made]:
    """Run chunks on one executor, together or one after another, until none is left or it broke; what died with it is lost.

    An interrupt that was noted is raised where no lock is held.
    """
    with crew.start() as executor:
        running: dict[Future[list[Made]], tuple[int, ...]] = {}
        broken = False
        while running or (chunks and not broken):
            interrupted()
            ahead = _AHEAD * max(1, crew.size()) if together else 1
            while chunks and not broken and len(running) < ahead:
                chunk = chunks.popleft()
                try:
                    running[executor.submit(crew.work, book, chunk)] = chunk
                except crew.lost:
                    chunks.appendleft(chunk)
                    broken = True
            done, _ = wait(running, _PAUSE, FIRST_COMPLETED)
            for future in done:
                chunk = running.pop(future)
                try:
                    found = future.result()
                except crew.lost as error:
                    lost.append(chunk)
                    broken = broken or isinstance(error, BrokenProcessPool)
                    continue
                except CancelledError as error:
                    raise InputError("the workers are gone; what is done is kept, --resume goes on with it") from error
                except ImportError as error:
                    raise InputError(f"a worker cannot run camwright: {error}; install it there, too") from error
                yield from found
