"""The golden run tells what changed, and nothing where nothing did."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from camwright.cli.commands import COMMANDS

HERE = Path(__file__).parent


def golden(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, str(HERE), *map(str, arguments)], capture_output=True, text=True, check=False
    )


def recorded(file: Path, only: str) -> dict[str, Any]:
    done = golden("record", file, "--only", only)
    assert done.returncode == 0, done.stderr
    record: dict[str, Any] = json.loads(file.read_text(encoding="utf-8"))
    return record


def test_every_command_and_example_is_asked() -> None:
    listed = golden("list")
    assert listed.returncode == 0, listed.stderr
    cases = dict(line.split(": ", 1) for line in listed.stdout.splitlines() if not line.endswith(": "))
    commands = {arguments.split()[0] for name, arguments in cases.items() if name.startswith("help/")}
    assert commands == set(COMMANDS)
    assert commands <= {arguments.split()[0] for name, arguments in cases.items() if not name.startswith("help/")}
    for example in (HERE.parents[1] / "examples").glob("*.toml"):
        assert f"examples/{example.name}" in listed.stdout


def test_two_runs_agree_and_a_change_is_told(tmp_path: Path) -> None:
    """A rounding is no change; another digit, another text and another file are."""
    before = tmp_path / "before.json"
    record = recorded(before, "quick/600-mm")
    assert golden("compare", before, "--only", "quick/600-mm").returncode == 0
    (case,) = record.values()
    answer = case["stdout"]
    key = next(key for key, value in answer.items() if isinstance(value, float))
    answer[key] *= 1 + 1e-12
    before.write_text(json.dumps(record), encoding="utf-8")
    assert golden("compare", before, "--only", "quick/600-mm").returncode == 0
    answer[key] *= 1 + 1e-6
    (file, _), *_ = case["files"].items()
    case["files"][file] = "0" * 64
    case["exit_code"] = 7
    before.write_text(json.dumps(record), encoding="utf-8")
    told = golden("compare", before, "--only", "quick/600-mm")
    assert told.returncode == 1
    for what in (f"stdout > {key}", f"files > {file}", "exit_code", "3 differences in 1 cases"):
        assert what in told.stdout


@pytest.mark.slow
@pytest.mark.parametrize("only", ["paper-600/", "bend/", "identify/"])
def test_a_part_recorded_twice_is_the_same(only: str, tmp_path: Path) -> None:
    first = recorded(tmp_path / "first.json", only)
    second = recorded(tmp_path / "second.json", only)
    assert len(first) > 10
    assert first == second
