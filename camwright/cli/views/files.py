"""The files that a command wrote."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from camwright.cli.views.parts import View, new_text


def files_view(files: Sequence[Path]) -> View:
    """Show the files that were written, one a line."""
    return new_text("\n".join(f"wrote {file}" for file in files))
