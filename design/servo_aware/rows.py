"""Rows of a servo-aware programme: where the axis must be in the shear zone, and how fast, over the unknowns of a command."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from camwright.profiles.polynomial.profile import FloatArray

RATIO = 2.0
"""Error of the axis' ratio allowed in the shear zone, times its length over the sync tolerance: along the zone the tool could at most go
from one edge of its band to the other."""

# Most rows added at a time, of one servo and of each of several.
MOST_ROWS, MOST_EACH = 12, 8
_EVERYWHERE = 1e300


@dataclass(frozen=True, eq=False)
class AxisRows:
    """Rows ``low <= matrix @ z + constant <= high``, in slave units."""

    matrix: FloatArray
    constant: FloatArray
    low: FloatArray
    high: FloatArray

    @property
    def size(self) -> FloatArray:
        """What rows are divided by, so that their bounds are about one."""
        return np.maximum(np.abs(self.low), np.abs(self.high))


def merged(blocks: Sequence[AxisRows]) -> list[AxisRows]:
    """Put blocks of rows together to one, if there are any."""
    if len(blocks) < 2:
        return list(blocks)
    return [
        AxisRows(
            np.vstack([block.matrix for block in blocks]),
            *(np.concatenate([getattr(block, name) for block in blocks]) for name in ("constant", "low", "high")),
        )
    ]


def worst_places(excess: FloatArray, most: int = MOST_ROWS) -> NDArray[np.intp]:
    """Find the local maxima above zero, the worst first."""
    padded = np.concatenate([[-_EVERYWHERE], excess, [-_EVERYWHERE]])
    found = np.nonzero((excess > 0.0) & (excess >= padded[:-2]) & (excess > padded[2:]))[0]
    return np.asarray(found[np.argsort(-excess[found], kind="stable")][:most])
