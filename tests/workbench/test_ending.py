"""How the workbench ends, and what it does while it is busy."""

from __future__ import annotations

import asyncio
import json
import multiprocessing
import os
import signal
import socket
import subprocess
import sys
import threading
import time
import urllib.parse
import urllib.request
from pathlib import Path
from typing import Any

import pytest

from camwright.cli.main import main
from camwright.jobs.job import BUNDLED_JOB
from camwright.workbench.runner import Runner, StaleError

PAPER = BUNDLED_JOB.read_text(encoding="utf-8")
DESIGN = ("design", "job.toml", "--brief", "--json", "--out", "out")
SLOW = (Path(__file__).parents[2] / "examples" / "short-cut.toml").read_text(encoding="utf-8")


def ask(url: str, call: str, body: dict[str, Any]) -> Any:
    address, _, query = url.partition("?")
    request = urllib.request.Request(f"{address}api/{call}?{query}", json.dumps(body).encode())  # noqa: S310 - our own
    with urllib.request.urlopen(request, timeout=120) as answer:  # noqa: S310
        return json.load(answer)


def alive() -> dict[int, int]:
    """Look up the processes that run, each with its parent."""
    found = {}
    for place in Path("/proc").glob("[0-9]*"):
        try:
            state, parent = (place / "stat").read_text().rpartition(")")[2].split()[:2]
        except OSError:  # it ended meanwhile
            continue
        if state != "Z":
            found[int(place.name)] = int(parent)
    return found


def end(of: set[int]) -> bool:
    """Wait until none of some processes runs."""
    for _ in range(100):
        if not of & alive().keys():
            return True
        time.sleep(0.1)
    return False


@pytest.mark.skipif(not Path("/proc").is_dir(), reason="processes are looked up in /proc")
@pytest.mark.parametrize("busy", [False, True])
def test_ctrl_c_ends_it_cleanly_with_its_process(busy: bool, tmp_path: Path) -> None:
    command = [sys.executable, "-m", "camwright", "workbench", "--json", "--no-browser"]
    process = subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=tmp_path, start_new_session=True
    )
    assert process.stdout is not None
    url = json.loads(process.stdout.readline())["url"]
    answers: list[Any] = []
    if busy:
        ask(url, "check", {"toml": PAPER})
        caller = threading.Thread(target=lambda: answers.append(ask(url, "design", {"toml": SLOW})))
        caller.start()
        time.sleep(0.5)
    workers = {child for child, parent in alive().items() if parent == process.pid}
    assert workers
    os.killpg(process.pid, signal.SIGINT)  # as a terminal does: to all of them
    _, said = process.communicate(timeout=30)
    assert said == ""
    assert process.returncode == 0
    assert end(of=workers)
    assert list(tmp_path.iterdir()) == []
    if busy:
        caller.join()
        assert answers[0]["status"] == "stale"


def test_who_goes_away_is_not_worked_for(address: str) -> None:
    parts = urllib.parse.urlsplit(address)
    body = json.dumps({"toml": SLOW}).encode()
    head = f"POST /api/design?{parts.query} HTTP/1.1\r\nHost: {parts.netloc}\r\nContent-Length: {len(body)}\r\n\r\n"
    with socket.create_connection((parts.hostname or "", parts.port or 0)) as line:
        line.sendall(head.encode() + body)
        time.sleep(1.0)
    begun = time.perf_counter()
    assert ask(address, "check", {"toml": PAPER})["exit_code"] == 0
    assert time.perf_counter() - begun < 15


def test_a_newer_design_ends_an_older_one_and_leaves_other_calls_alone(address: str) -> None:
    answers: dict[str, Any] = {}

    def asked(name: str, call: str, text: str) -> threading.Thread:
        thread = threading.Thread(target=lambda: answers.update({name: ask(address, call, {"toml": text})}))
        thread.start()
        time.sleep(0.3)
        return thread

    threads = [asked("old", "design", SLOW), asked("beside", "check", PAPER), asked("new", "design", PAPER)]
    for thread in threads:
        thread.join()
    assert answers["old"] == {"status": "stale", "message": "a newer call took its place"}
    assert answers["beside"]["exit_code"] == 0
    assert answers["new"]["passed"] is True


def test_a_process_stands_by_for_who_follows_an_ended_call() -> None:
    others = {child.pid for child in multiprocessing.active_children()}
    runner = Runner(main, quiet=0.0)

    async def follow() -> tuple[set[int | None], set[int | None]]:
        await runner.run("check", (("check", "job.toml", "--json"),), {"job.toml": PAPER.encode()})
        await asyncio.sleep(0.1)
        before = {child.pid for child in multiprocessing.active_children()}
        old = asyncio.create_task(runner.run("design", (DESIGN,), {"job.toml": SLOW.encode()}))
        await asyncio.sleep(0.3)  # it runs
        ran = await runner.run("design", (DESIGN,), {"job.toml": PAPER.encode()})
        assert json.loads(ran.answer)["passed"] is True
        with pytest.raises(StaleError):
            await old
        await asyncio.sleep(0.1)
        return before, {child.pid for child in multiprocessing.active_children()}

    try:
        before, after = (found - others for found in asyncio.run(follow()))
    finally:
        runner.close()
    assert len(before) == len(after) == 2
    assert len(before & after) == 1  # it stood by while the old call ran, and answered the new one
    assert {child.pid for child in multiprocessing.active_children()} == others
