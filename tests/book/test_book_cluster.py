"""A book on a cluster: a real scheduler and real workers on this machine, one of which is killed at work."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from books import JOB, contents, inline_crew, small_book

from camwright.book.cluster import cluster_crew
from camwright.book.run import make_book
from camwright.profiles.errors import InputError, MissingExtraError

RANGES = ("250:650:50", "60:120:30")
"""27 combinations and an objective: seven chunks, so that both workers have some."""

pytest.importorskip("distributed")
needs_proc = pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="needs /proc")


def children(process: int) -> list[int]:
    """Numbers of the processes that a process has started and that are alive."""
    found: list[int] = []
    for task in Path(f"/proc/{process}/task").iterdir():
        found += map(int, (task / "children").read_text().split())
    return found


def waited_for(what: str, condition: object, seconds: float = 180.0) -> None:
    """Wait until a condition holds."""
    until = time.monotonic() + seconds
    while not condition():  # type: ignore[operator]
        assert time.monotonic() < until, what
        time.sleep(0.02)


@pytest.fixture
def cluster(tmp_path: Path) -> Iterator[tuple[str, list[int]]]:
    """Give the address of a scheduler, and the numbers of its worker processes, each with a nanny that replaces it."""
    environment = {**os.environ, "DASK_DISTRIBUTED__WORKER__DAEMON": "False"}
    file = tmp_path / "scheduler.json"
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, "env": environment}
    own = ["--scheduler-file", str(file), "--no-dashboard", "--host", "127.0.0.1"]
    started = [subprocess.Popen([sys.executable, "-m", "distributed.cli.dask_scheduler", *own, "--port", "0"], **quiet)]  # type: ignore[call-overload]
    try:
        waited_for("a scheduler", lambda: file.exists() and file.read_text().strip().endswith("}"))
        for _ in range(2):
            worker = [sys.executable, "-m", "distributed.cli.dask_worker", *own, "--nthreads", "1", "--nworkers", "1"]
            started.append(subprocess.Popen([*worker, "--local-directory", str(tmp_path)], **quiet))  # type: ignore[call-overload]
        yield json.loads(file.read_text())["address"], [nanny.pid for nanny in started[1:]]
    finally:
        for process in reversed(started):
            process.send_signal(signal.SIGTERM)
        for process in reversed(started):
            try:
                process.wait(20)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()


def serving(nanny: int) -> list[int]:
    """Give the worker processes of a nanny, without the helper of multiprocessing."""
    return [
        child for child in children(nanny) if "spawn_main" in Path(f"/proc/{child}/cmdline").read_text(errors="replace")
    ]


@needs_proc
def test_a_worker_that_is_killed_changes_no_byte(cluster: tuple[str, list[int]], tmp_path: Path) -> None:
    address, nannies = cluster
    root = tmp_path / "book"
    command = [
        sys.executable,
        "-c",
        "import sys; from camwright.cli.main import main; sys.exit(main())",
        "book",
        str(JOB),
    ]
    command += ["--length", RANGES[0], "--line-speed", RANGES[1], "--out", str(root), "--cluster", address, "--json"]
    waited_for("two workers", lambda: all(serving(nanny) for nanny in nannies))
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    waited_for("a design", lambda: list(root.glob("designs/*/*/*")) or process.poll() is not None)
    (victim,) = serving(nannies[0])
    os.kill(victim, signal.SIGKILL)
    assert process.poll() is None  # it was killed at work
    output, message = process.communicate(timeout=300)
    assert process.returncode == 1, message
    waited_for("another worker", lambda: serving(nannies[0]) not in ([], [victim]))
    answer = json.loads(output)
    assert (answer["designs"], answer["failed"]) == (27, 0)
    make_book(small_book(objectives=(), ranges=RANGES), tmp_path / "here", inline_crew())
    assert contents(root) == contents(tmp_path / "here")


def test_without_a_scheduler_the_address_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("camwright.book.cluster._PATIENCE", 0.3)
    for address in ("tcp://127.0.0.1:9", "nonsense://x"):
        with (
            pytest.raises(InputError, match=f"--cluster {address}: no scheduler answers there: .*dask scheduler"),
            cluster_crew(address),
        ):
            pass


def test_without_the_library_the_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(MissingExtraError, match=r"camwright\[cluster\]"), cluster_crew("tcp://127.0.0.1:8786"):
        pass
