"""Outlines as tests write them."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from camwright.profiles.bender.outline import Outline


def outline_of(points: ArrayLike, bulges: ArrayLike | None = None, name: str = "outline") -> Outline:
    """Make an outline from anything array-like; without bulges all segments are straight."""
    p = np.array(points, dtype=np.float64)
    return Outline(p, np.zeros(max(0, len(p) - 1)) if bulges is None else np.array(bulges, dtype=np.float64), name)
