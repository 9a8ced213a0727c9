"""The files that a command wrote."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from rich.console import RenderableType
from rich.text import Text


def files_view(files: Sequence[Path]) -> RenderableType:
    """Show the files that were written, one a line."""
    return Text("\n".join(f"wrote {file}" for file in files))
