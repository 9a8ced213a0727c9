"""`Bound`: what an objective cannot go below, and how that was found."""

from __future__ import annotations

from dataclasses import dataclass

NONE = "none"


@dataclass(frozen=True)
class Bound:
    """A lower bound of an objective (m/s², m/s³, N·m or J at the motor), and how it was found; not a number with method "none"."""

    value: float
    method: str
