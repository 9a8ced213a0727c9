"""Real worker processes: the same bytes, workers that die, an interrupt, a leading process that is killed."""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from books import JOB, RANGES, contents, dies_at_3, dies_once, inline_crew, small_book

from camwright.book.run import make_book
from camwright.book.workers import default_jobs, local_crew

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


@pytest.mark.parametrize("designs", [0, 3])  # while the workers start, too, who must not tell of it
def test_an_interrupt_keeps_what_is_done(whole: dict[str, bytes], tmp_path: Path, designs: int) -> None:
    root = tmp_path / "book"
    process = subprocess.Popen(
        [*COMMAND, *ASKED, "--out", str(root)], stderr=subprocess.PIPE, text=True, start_new_session=True
    )
    until = time.monotonic() + 180
    while len(list(root.glob("designs/*/*/*"))) < designs and time.monotonic() < until:
        time.sleep(0.01)
    while not (root / ".book" / "journal.sqlite").exists() and time.monotonic() < until:
        time.sleep(0.01)
    if not designs:
        time.sleep(0.2)
    os.killpg(process.pid, signal.SIGINT)  # as a terminal does it: to the workers, too
    _, message = process.communicate(timeout=180)
    assert process.returncode == 130
    assert f"interrupted; what is done lies in {root}, --resume goes on with it" in message
    assert "Traceback" not in message
    assert resumed(root) == 1
    assert contents(root) == whole


def test_as_many_processes_as_processors() -> None:
    assert 1 <= default_jobs() <= (os.cpu_count() or 1)
