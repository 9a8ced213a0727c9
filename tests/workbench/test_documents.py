"""docs/workbench.md names the calls that there are, and the page makes no others."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from starlette.testclient import TestClient

from camwright.workbench.calls import NAMES

ROOT = Path(__file__).parents[2]
DOCUMENT = (ROOT / "docs" / "workbench.md").read_text(encoding="utf-8")
DOCUMENTED = sorted(set(re.findall(r"^\| `((?:GET|POST) /api/[a-z]+)`", DOCUMENT, re.MULTILINE)))


@pytest.mark.parametrize("call", DOCUMENTED)
def test_what_is_documented_is_there(call: str, bench: TestClient) -> None:
    method, _, path = call.partition(" ")
    assert bench.request(method, path, json={} if method == "POST" else None).status_code in (200, 422)


def test_what_is_there_is_documented() -> None:
    assert {f"POST /api/{name}" for name in NAMES} <= set(DOCUMENTED)
    page = "".join(file.read_text(encoding="utf-8") for file in (ROOT / "camwright/workbench/page").rglob("*.js"))
    asked = set(re.findall(r'\b(?:post|ask)\((?:\w+, )?"([a-z]+)"', page))
    assert len(asked) > 10
    assert {f"POST /api/{name}" for name in asked} <= set(DOCUMENTED)
