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
    return read(file)


def read(file: Path) -> dict[str, Any]:
    """Read the cases of a record, one a line after the hash of the code."""
    _, *lines = file.read_text(encoding="utf-8").splitlines()
    return {name: case for line in lines for name, case in json.loads(line).items()}


def write(file: Path, record: dict[str, Any]) -> None:
    lines = [{"code": "another"}, *({name: case} for name, case in record.items())]
    file.write_text("".join(json.dumps(line) + "\n" for line in lines), encoding="utf-8")


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
    before = tmp_path / "before.jsonl"
    record = recorded(before, "quick/600-mm")
    assert golden("compare", before, "--only", "quick/600-mm").returncode == 0
    (case,) = record.values()
    answer = case["stdout"]
    key = next(key for key, value in answer.items() if isinstance(value, float))
    answer[key] *= 1 + 1e-12
    write(before, record)
    assert golden("compare", before, "--only", "quick/600-mm").returncode == 0
    answer[key] *= 1 + 1e-6
    (file, _), *_ = case["files"].items()
    case["files"][file] = "0" * 64
    case["exit_code"] = 7
    write(before, record)
    told = golden("compare", before, "--only", "quick/600-mm")
    assert told.returncode == 1
    for what in (f"stdout > {key}", f"files > {file}", "exit_code", "3 differences in 1 cases"):
        assert what in told.stdout


def test_a_killed_run_goes_on_where_it_stopped(tmp_path: Path) -> None:
    """A half line is dropped, a case that stands there is not run again, and other code is refused."""
    file = tmp_path / "half.jsonl"
    assert recorded(file, "targets-spoken").keys() == {"targets-spoken"}
    kept = file.read_bytes()
    file.write_bytes(kept + b'{"targets": {"arg')
    assert "0 cases in" in golden("record", file, "--only", "targets-spoken").stderr
    assert file.read_bytes() == kept
    file.write_bytes(kept.replace(b'"code": "', b'"code": "0'))
    refused = golden("record", file, "--only", "targets")
    assert refused.returncode == 1
    assert "a record of other code" in refused.stderr


@pytest.mark.slow
@pytest.mark.parametrize("only", ["paper-600/", "bend/", "identify/"])
def test_a_part_recorded_twice_is_the_same(only: str, tmp_path: Path) -> None:
    first = recorded(tmp_path / "first.jsonl", only)
    second = recorded(tmp_path / "second.jsonl", only)
    assert len(first) > 10
    assert first == second
