"""How views write numbers."""

from __future__ import annotations


def number(value: float | None, without: str = "–") -> str:
    """Write a number with five digits."""
    return without if value is None else f"{value:.5g}"


def millimetres(length: float | None) -> str:
    """Write a length in millimetres."""
    return "–" if length is None else f"{length * 1e3:.4g}"
