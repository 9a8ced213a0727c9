"""A workbench without a browser, and one that listens for a real one."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from starlette.testclient import TestClient

from camwright.cli.main import main
from camwright.jobs.job import BUNDLED_JOB
from camwright.workbench.server import application

PAPER = BUNDLED_JOB.read_text(encoding="utf-8")
TOKEN = "t0ken"  # noqa: S105 - of a test


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("bench")


@pytest.fixture(scope="module")
def bench(folder: Path) -> Iterator[TestClient]:
    with TestClient(application(PAPER, folder, TOKEN, main), base_url="http://127.0.0.1:8765") as client:
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
