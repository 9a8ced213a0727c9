"""Who may speak to the workbench, and what nobody gets: other pages, callers without the token, files outside, too much, too slow."""

from __future__ import annotations

import asyncio
import base64
import json
import socket
import time
from pathlib import Path
from typing import Any
from urllib.parse import parse_qs, urlsplit

import pytest
from starlette.testclient import TestClient

from camwright.jobs.job import BUNDLED_JOB
from camwright.workbench import guard
from camwright.workbench.calls import call_of
from camwright.workbench.guard import MOST_BYTES, Guard

PAPER = BUNDLED_JOB.read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("headers", "status"),
    [
        ({"X-Camwright-Token": "wrong"}, 403),
        ({"X-Camwright-Token": ""}, 403),
        ({"Origin": "http://example.com"}, 403),
        ({"Origin": "null"}, 403),
        ({"Host": "example.com"}, 403),
        ({"Host": "127.0.0.1:1"}, 403),
        ({"Origin": "http://127.0.0.1:8765"}, 200),
    ],
)
def test_only_the_page_itself_may_call(headers: dict[str, str], status: int, bench: TestClient) -> None:
    assert bench.get("/api/job", headers=headers).status_code == status
    assert bench.post("/api/check", json={"toml": PAPER}, headers=headers).status_code == status


def test_large_calls_are_refused_before_they_are_read(bench: TestClient) -> None:
    assert bench.post("/api/check", content=b" " * (MOST_BYTES + 1)).status_code == 413
    pieces = (b" " * (1 << 20) for _ in range(MOST_BYTES // (1 << 20) + 1))  # of no stated length
    assert bench.post("/api/check", content=pieces).status_code == 413


@pytest.mark.parametrize(
    "path", ["/page/../server.py", "/page/%2e%2e/server.py", "/page//etc/passwd", "/page/..%2fserver.py"]
)
def test_nothing_outside_the_page_is_served(path: str, bench: TestClient) -> None:
    assert bench.get(path).status_code == 404


def test_every_answer_has_the_policy(bench: TestClient) -> None:
    for path in ("/", "/api/job", "/page/main.js", "/nowhere"):
        headers = bench.get(path).headers
        assert "default-src 'none'" in headers["content-security-policy"]
        assert "unsafe" not in headers["content-security-policy"]
        assert headers["x-content-type-options"] == "nosniff"


@pytest.mark.parametrize("call", ["preview", "check", "design", "cam", "servo", "overlay", "bend", "save", "words"])
def test_no_call_is_answered_without_the_token(call: str, bench: TestClient, folder: Path) -> None:
    before = sorted(folder.iterdir())
    for ask in (bench.post, bench.get):
        answer = ask(f"/api/{call}", headers={"X-Camwright-Token": ""})
        assert answer.status_code == 403
        assert "the token is missing or wrong" in answer.json()["message"]
    assert sorted(folder.iterdir()) == before


def test_the_token_of_one_start_is_not_that_of_another(address: str) -> None:
    token = parse_qs(urlsplit(address).query)["token"][0]
    assert len(token) >= 43  # 256 bits


@pytest.mark.parametrize(
    "name",
    ["../../etc/passwd", "C:\\Windows\\x.csv", "/etc/passwd", "..", "-rf", "job.toml", "a\0b.csv", "\u202egpj.csv", ""],
)
def test_a_name_from_the_page_opens_nothing_outside_its_folder(name: str) -> None:
    body = {"toml": PAPER, "name": name, "base64": base64.b64encode(b"x").decode()}
    for call in ("audit", "bend"):
        made = call_of(call, body)
        (path,) = (path for path in made.inputs if path != "job.toml")
        folder, _, file = path.partition("/")
        assert folder == "dropped"
        assert file not in ("", ".", "..")
        assert not file.startswith("-")
        assert all(sign.isascii() and (sign.isalnum() or sign in "_. -") for sign in file)
        assert not any(argument.startswith("-") for argument in made.commands[0] if argument == path)


def test_a_job_cannot_name_a_file(bench: TestClient) -> None:
    text = PAPER.replace("points = 361", 'points = 361\ntargets = ["/etc/passwd"]')
    answer = bench.post("/api/check", json={"toml": text}).json()
    assert answer["exit_code"] == 2
    assert "/etc/passwd" in answer["message"]
    assert "root:" not in json.dumps(answer)


def test_names_are_data_in_the_sheets(bench: TestClient) -> None:
    name = "<script>alert(1)</script>"
    text = PAPER.replace('"paper-600"', json.dumps(name))
    answer = bench.post("/api/recipe", json={"toml": text, "targets": ["csv"]}).json()
    if answer.get("exit_code", 0) > 1:  # the name is refused
        assert name not in answer.get("contents", {})
        return
    page = next(data for path, data in answer["contents"].items() if path.endswith("recipe.html"))
    assert b"<script>alert" not in base64.b64decode(page)


def deep(levels: int) -> str:
    return "[" * levels + "]" * levels


def test_nested_and_broken_bodies_are_refused(bench: TestClient) -> None:
    for body in (deep(100_000), '{"toml": ' + deep(100_000) + "}", "{", "null", "1e999", '"text"'):
        answer = bench.post("/api/check", content=body.encode())
        assert answer.status_code == 422
        assert answer.json()["exit_code"] == 2
    answer = bench.post("/api/check", json={"toml": "a = " + deep(50_000)})
    assert answer.json()["exit_code"] == 2


def raw(address: str) -> tuple[socket.socket, str]:
    """Open a connection of one's own; gives it and the head of a call with the token."""
    parts = urlsplit(address)
    line = socket.create_connection((parts.hostname or "", parts.port or 0), timeout=20)
    head = f"POST /api/check?{parts.query} HTTP/1.1\r\nHost: {parts.netloc}\r\nContent-Type: application/json\r\n"
    return line, head


def test_a_body_of_100_megabytes_is_refused_at_once(address: str) -> None:
    line, head = raw(address)
    with line:
        line.sendall(f"{head}Content-Length: {100 << 20}\r\n\r\n".encode())
        assert line.recv(100).startswith(b"HTTP/1.1 413")
    line, head = raw(address)
    with line:
        line.sendall(f"{head}Transfer-Encoding: chunked\r\n\r\n".encode())
        piece = b"100000\r\n" + b" " * (1 << 20) + b"\r\n"
        sent = 0
        try:
            while sent < 100:
                line.sendall(piece)
                sent += 1
        except OSError:  # it stopped to listen
            pass
        assert sent < 30


def test_a_slow_caller_keeps_nobody_waiting(address: str) -> None:
    line, head = raw(address)
    with line:
        line.sendall(f"{head}Content-Length: 1000\r\n\r\n{{".encode())
        begun = time.perf_counter()
        other, head = raw(address)
        with other:
            body = json.dumps({"toml": PAPER}).encode()
            other.sendall(f"{head}Content-Length: {len(body)}\r\n\r\n".encode() + body)
            assert other.recv(100).startswith(b"HTTP/1.1 200")
        assert time.perf_counter() - begun < 15


def test_a_body_that_does_not_come_is_given_up(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(guard, "MOST_SECONDS", 0.05)
    sent: list[Any] = []

    async def never() -> Any:
        await asyncio.sleep(60)

    async def send(message: Any) -> None:
        sent.append(message)

    async def app(*_: Any) -> None:
        raise AssertionError("the call must not go on")

    scope = {
        "type": "http", "method": "POST", "path": "/api/check", "query_string": b"token=t", "server": ("127.0.0.1", 80),
        "headers": [(b"host", b"127.0.0.1:80")],
    }  # fmt: skip
    asyncio.run(Guard(app, "t")(scope, never, send))
    assert sent[0]["status"] == 408
    assert b"did not come within" in sent[1]["body"]


def test_the_page_loads_nothing_of_others() -> None:
    page = Path(guard.__file__).parent / "page"
    for file in page.rglob("*"):
        if file.suffix in (".js", ".html", ".css"):
            text = file.read_text(encoding="utf-8").replace("http://www.w3.org/2000/svg", "")
            assert "http:" not in text, file
            assert "https:" not in text, file
            assert "innerHTML" not in text, file
            assert "eval(" not in text, file
