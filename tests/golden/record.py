"""A record of the golden run: one line of JSON a case, written as soon as it ends."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import Any


def code_of(root: Path, command: str) -> str:
    """Hash the code and the examples that a record is made of, and how camwright is started."""
    found = hashlib.sha256(command.encode())
    for folder in ("camwright", "design", "profiles", "validation", "examples"):
        for file in sorted((root / folder).rglob("*")):
            if file.suffix in (".py", ".toml"):
                found.update(file.relative_to(root).as_posix().encode() + b"\0" + file.read_bytes())
    return found.hexdigest()


class Record:
    """What was recorded, by the name of the case.

    Parameters
    ----------
    path
        Where it is kept; nowhere if None. A record that is there is read and gone on with.
    code
        Hash of the code that is run now; None to read only. A record of other code is refused.
    """

    def __init__(self, path: Path | None, code: str | None = None) -> None:
        self.cases: dict[str, dict[str, Any]] = {}
        self._path = path
        if path is None:
            return
        kept = path.read_bytes() if code is None or path.exists() else b""
        whole = kept[: kept.rfind(b"\n") + 1]  # a run killed while it wrote leaves a part of a line
        first, *lines = whole.splitlines() or [b"{}"]
        head = json.loads(first)
        if code is not None:
            if head and head != {"code": code}:
                raise SystemExit(f"golden: {path} is a record of other code; name another file or remove it")
            path.write_bytes(whole or json.dumps({"code": code}).encode() + b"\n")
        for line in lines:
            self.cases.update(json.loads(line))

    def add(self, name: str, result: dict[str, Any]) -> None:
        """Add a case and write its line."""
        self.cases[name] = result
        if self._path is not None:
            with self._path.open("a", encoding="utf-8") as stream:
                stream.write(json.dumps({name: result}, ensure_ascii=False, allow_nan=False) + "\n")
