"""Real worker processes: the same bytes, workers that die, an interrupt, a leading process that is killed."""

from __future__ import annotations

import itertools
import os
import random
import signal
import subprocess
import sys
import threading
import time
import weakref
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any

import pytest
from books import JOB, RANGES, contents, dies_at_3, dies_once, inline_crew, small_book

from camwright.book.entry import Entry
from camwright.book.making import Made
from camwright.book.plan import Book
from camwright.book.run import make_book
from camwright.book.workers import default_jobs, local_crew, make_all
from camwright.house.interrupts import noted_interrupts

COMMAND = [sys.executable, "-c", "import sys; from camwright.cli.main import main; sys.exit(main())", "book", str(JOB)]
ASKED = ["--length", RANGES[0], "--line-speed", RANGES[1], "--objective", "peak_acceleration"]
ASKED += ["--objective", "rms_acceleration", "--jobs", "2", "--quiet"]


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    """Give the bytes of a small book that was made in this process."""
    root = tmp_path_factory.mktemp("book") / "whole"
    make_book(small_book(), root, inline_crew())
    return contents(root)


def test_a_worker_that_died_is_replaced(
    whole: dict[str, bytes], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("CAMWRIGHT_TEST_MARK", str(tmp_path / "mark"))
    before = dict(os.environ)
    make_book(small_book(), tmp_path / "book", local_crew(2, dies_once))
    assert (tmp_path / "mark").exists()
    assert contents(tmp_path / "book") == whole
    assert dict(os.environ) == before


def test_a_design_that_kills_its_worker_twice_has_failed(whole: dict[str, bytes], tmp_path: Path) -> None:
    answer = make_book(small_book(), tmp_path / "book", local_crew(2, dies_at_3))
    assert (answer.counts.failed, answer.counts.designs, answer.exit_code) == (1, 12, 4)
    found = contents(tmp_path / "book")
    assert "the process that designed it died, twice" in found["index.csv"].decode()
    own = {"book.json", "index.csv", "index.html", "index.xlsx", "limits.csv"}
    of_3 = str(Path(small_book().combination(3).folder))
    assert {path: data for path, data in found.items() if path not in own} == {
        path: data for path, data in whole.items() if path not in own and not path.startswith(of_3)
    }


def children(process: subprocess.Popen[bytes]) -> set[int]:
    """Numbers of the processes that a process has started and that are alive."""
    found = set()
    for task in Path(f"/proc/{process.pid}/task").iterdir():
        found |= set(map(int, (task / "children").read_text().split()))
    return found


def begun(root: Path, designs: int) -> subprocess.Popen[bytes]:
    """Start making a book and wait until some designs have their files."""
    process = subprocess.Popen([*COMMAND, *ASKED, "--out", str(root)], stderr=subprocess.DEVNULL)
    until = time.monotonic() + 180
    while process.poll() is None and len(list(root.glob("designs/*/*/*"))) < designs and time.monotonic() < until:
        time.sleep(0.01)
    return process


def resumed(root: Path) -> int:
    """Go on with a book; the exit code."""
    return subprocess.run([*COMMAND, *ASKED, "--resume", "--out", str(root)], check=False).returncode


@pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="needs /proc")
@pytest.mark.parametrize("designs", [1, 5])
def test_a_book_that_was_killed_ends_with_the_same_bytes(whole: dict[str, bytes], tmp_path: Path, designs: int) -> None:
    root = tmp_path / "book"
    process = begun(root, designs)
    workers = children(process)
    process.kill()
    assert process.wait() == -signal.SIGKILL
    assert (root / ".book").exists()
    until = time.monotonic() + 60
    while any(Path(f"/proc/{worker}").exists() for worker in workers) and time.monotonic() < until:
        time.sleep(0.05)
    assert not [worker for worker in workers if Path(f"/proc/{worker}").exists()]
    assert resumed(root) == 1
    assert contents(root) == whole


@pytest.mark.slow
def test_a_book_that_is_killed_at_any_moment_ends_with_the_same_bytes(whole: dict[str, bytes], tmp_path: Path) -> None:
    chance = random.Random(20)  # noqa: S311 - moments, no secrets
    start = time.monotonic()
    subprocess.run([*COMMAND, *ASKED, "--out", str(tmp_path / "whole")], check=False)
    duration = time.monotonic() - start
    assert contents(tmp_path / "whole") == whole
    for moment in range(20):
        root = tmp_path / str(moment)
        process = subprocess.Popen([*COMMAND, *ASKED, "--out", str(root)], stderr=subprocess.DEVNULL)
        time.sleep(chance.uniform(0.1, duration))
        process.kill()
        process.wait()
        if chance.random() < 0.5:  # once more, while going on
            process = subprocess.Popen([*COMMAND, *ASKED, "--resume", "--out", str(root)], stderr=subprocess.DEVNULL)
            time.sleep(chance.uniform(0.1, duration))
            process.kill()
            process.wait()
        assert resumed(root) == 1, moment
        assert contents(root) == whole, moment


def quick(_book: Book, numbers: Sequence[int]) -> list[Made]:
    """Make nothing of a chunk, in a moment."""
    time.sleep(0.02)
    return [Made(Entry(number, "failed"), {}, "", 0) for number in numbers]


def in_a_lock(patch: pytest.MonkeyPatch) -> None:
    """Interrupt where this process takes a lock back for which it waited: raised there the lock would be released without being held."""
    take, times = threading.Condition._acquire_restore, iter([True])  # type: ignore[attr-defined]

    def taken(lock: threading.Condition, state: object) -> None:
        here = threading.current_thread() is threading.main_thread()
        if here and signal.SIGINT not in signal.pthread_sigmask(signal.SIG_BLOCK, ()) and next(times, False):
            signal.raise_signal(signal.SIGINT)
        take(lock, state)

    patch.setattr(threading.Condition, "_acquire_restore", taken)


def in_a_callback(patch: pytest.MonkeyPatch) -> None:
    """Interrupt while something that was dropped is cleared away: what is raised there is printed and forgotten."""

    class Dropped:
        """What is dropped when work is given."""

    def submit(executor: ProcessPoolExecutor, *arguments: Any) -> Any:
        future = given(executor, *arguments)
        if next(times) == 3:  # the processes have started
            dropped = Dropped()
            reference = weakref.ref(dropped, lambda _: signal.raise_signal(signal.SIGINT))
            del dropped
            assert reference() is None
        return future

    given, times = ProcessPoolExecutor.submit, itertools.count(1)
    patch.setattr(ProcessPoolExecutor, "submit", submit)


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
@pytest.mark.parametrize("comes", [in_a_lock, in_a_callback])
def test_an_interrupt_is_not_lost_wherever_it_comes(
    monkeypatch: pytest.MonkeyPatch, comes: Callable[[pytest.MonkeyPatch], None]
) -> None:
    comes(monkeypatch)
    found: list[Made] = []
    with pytest.raises(KeyboardInterrupt):
        found.extend(make_all(small_book(), range(1, 13), local_crew(2, quick)))
    assert len(found) < 12
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    assert signal.SIGINT not in signal.pthread_sigmask(signal.SIG_BLOCK, ())


def interrupt(times: int, passed: list[int]) -> None:
    """Interrupt a few times where interrupts are noted."""
    with noted_interrupts() as interrupted:
        interrupted()
        for time_ in range(times):
            signal.raise_signal(signal.SIGINT)
            passed.append(time_)


@pytest.mark.parametrize(("times", "raised_at"), [(1, 1), (2, 1)])
def test_an_interrupt_is_raised_at_the_end_a_second_one_at_once(times: int, raised_at: int) -> None:
    passed: list[int] = []
    with pytest.raises(KeyboardInterrupt):
        interrupt(times, passed)
    assert len(passed) == raised_at
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


@pytest.mark.parametrize("designs", [0, 3])  # while the workers start, too, who must not tell of it
def test_an_interrupt_keeps_what_is_done(whole: dict[str, bytes], tmp_path: Path, designs: int) -> None:
    root = tmp_path / "book"
    process = subprocess.Popen(
        [*COMMAND, *ASKED, "--out", str(root)], stderr=subprocess.PIPE, text=True, start_new_session=True
    )
    until = time.monotonic() + 180
    while len(list(root.glob("designs/*/*/*"))) < designs and time.monotonic() < until:
        time.sleep(0.01)
    while not children(process) and time.monotonic() < until:
        time.sleep(0.001)
    os.killpg(process.pid, signal.SIGINT)  # as a terminal does it: to the workers, too
    _, message = process.communicate(timeout=180)
    assert process.returncode == 130
    assert f"interrupted; what is done lies in {root}, --resume goes on with it" in message
    assert "Traceback" not in message
    assert resumed(root) == 1
    assert contents(root) == whole


def test_as_many_processes_as_processors() -> None:
    assert 1 <= default_jobs() <= (os.cpu_count() or 1)
