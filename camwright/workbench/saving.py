"""`Saved`: the two files that the page writes where the workbench was started."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import Any

from camwright.house.files import staged
from camwright.profiles.errors import InputError
from camwright.workbench.runner import JOB_FILE

DESIGN_FILE = "design.json"


class Saved:
    """Writes ``job.toml`` and ``design.json`` of a folder, and over nobody else's.

    Parameters
    ----------
    text
        The job that the page began with: its own file may be written over, like in any editor.
    """

    def __init__(self, folder: Path, text: str) -> None:
        self._folder = folder
        self._ours = {_digest(text.encode())}

    def put(self, text: str, design: bytes) -> None:
        """Write a job and its design, both or none.

        Raises
        ------
        InputError
            One of them is of another job, which the page neither began with nor saved; or the folder cannot be written.
        """
        job, other = self._folder / JOB_FILE, self._folder / DESIGN_FILE
        if job.exists() and _digest(job.read_bytes()) not in self._ours:
            raise _foreign(job)
        if other.exists() and _job_of(other) not in self._ours:
            raise _foreign(other)
        with staged(self._folder) as aside:
            (aside / JOB_FILE).write_bytes(text.encode())
            (aside / DESIGN_FILE).write_bytes(design)
        self._ours.add(_digest(text.encode()))


def _foreign(path: Path) -> InputError:
    """Refuse to write over a file."""
    return InputError(
        f"{path.name}: another job stands in the folder where the workbench was started; move it away, or start the workbench on it"
    )


def _digest(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()


def _job_of(path: Path) -> Any:
    """Find the SHA-256 of the job that a design is of; nothing where the file is none."""
    try:
        return json.loads(path.read_bytes())["provenance"]["job_sha256"]
    except (ValueError, KeyError, TypeError):
        return None
