"""The files that a command wrote."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from camwright.cli.views.parts import new_text

if TYPE_CHECKING:
    from rich.console import RenderableType


def files_view(files: Sequence[Path]) -> RenderableType:
    """Show the files that were written, one a line."""
    return new_text("\n".join(f"wrote {file}" for file in files))
