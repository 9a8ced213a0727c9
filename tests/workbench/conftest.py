"""A workbench without a browser, and one that listens for a real one."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from starlette.testclient import TestClient

from camwright.cli.main import main
from camwright.jobs.job import BUNDLED_JOB
from camwright.workbench.runner import Runner
from camwright.workbench.server import application

PAPER = BUNDLED_JOB.read_text(encoding="utf-8")
TOKEN = "t0ken"  # noqa: S105 - of a test


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("bench")


@pytest.fixture(scope="module")
def bench(folder: Path) -> Iterator[TestClient]:
    with TestClient(application(PAPER, folder, TOKEN, Runner(main)), base_url="http://127.0.0.1:8765") as client:
        client.headers["X-Camwright-Token"] = TOKEN
        yield client


@pytest.fixture(scope="module")
def address(folder: Path) -> Iterator[str]:
    """Start the command as a user does."""
    command = [sys.executable, "-m", "camwright", "workbench", "--json", "--no-browser"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, cwd=folder, env={**os.environ}) as process:
        assert process.stdout is not None
        yield str(json.loads(process.stdout.readline())["url"])
        process.terminate()


CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser")
PATIENCE = 60_000


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    """Start Debian's Chromium by Playwright; who asks for it is skipped where one of them is missing.

    A module long: its event loop runs in this thread, and other modules have loops of their own.
    """
    api = pytest.importorskip("playwright.sync_api", reason="Playwright is not installed")
    if CHROMIUM is None:
        pytest.skip("no Chromium is installed: apt-get install chromium")
    with api.sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield browser
        browser.close()


@pytest.fixture
def page(browser: Any, address: str) -> Iterator[Any]:
    """Open the page on the bundled job, proved; nothing may reach another host or the console's errors."""
    page = browser.new_page(viewport={"width": 1280, "height": 900}, accept_downloads=True)
    page.set_default_timeout(PATIENCE)
    faults: list[str] = []
    foreign: list[str] = []
    page.on("pageerror", lambda error: faults.append(str(error)))
    page.on("console", lambda message: message.type == "error" and faults.append(message.text))
    page.on("request", lambda request: foreign.append(request.url) if _foreign(request.url) else None)
    page.goto(address)
    page.locator("#badge.proved").wait_for()
    yield page
    assert faults == []
    assert foreign == []
    page.close()


def _foreign(url: str) -> bool:
    return url.startswith("http") and not url.startswith("http://127.0.0.1:")


@pytest.fixture
def put(page: Any) -> Callable[[str, str], None]:
    """Type a value into a field of the form."""

    def typed(path: str, value: str) -> None:
        field = page.locator(f'[id="field-{path}"]')
        field.evaluate("element => { element.closest('details').open = true }")
        field.fill(value)
        field.press("Tab")

    return typed
