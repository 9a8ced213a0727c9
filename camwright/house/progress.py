"""What a long piece of work tells a display of progress."""

from __future__ import annotations

from collections.abc import Callable

Step = Callable[[str], None]
"""Told what begins now."""


def ignore(_what: str) -> None:
    """Tell nobody."""
