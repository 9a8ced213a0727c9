"""Rows of a servo-aware programme: where the axis must be in the shear zone, and how fast, over the unknowns of a command."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from camwright.profiles.polynomial.profile import FloatArray

RATIO = 2.0
"""Error of the axis' ratio allowed in the shear zone, times its length over the sync tolerance: along the zone the tool could at most go
from one edge of its band to the other."""

BINDING = 0.05
"""Rows of an answer nearly bind where so great a share of their bound is left beyond what is left of the nearest."""

# Most rows added at a time, of one servo and of each of several.
MOST_ROWS, MOST_EACH = 12, 8
_EVERYWHERE = 1e300


@dataclass(frozen=True, eq=False)
class AxisRows:
    """Rows ``low <= matrix @ z + constant <= high``, in slave units.

    Parameters
    ----------
    matrix, constant, low, high
        Shapes ``(rows, n)`` and ``(rows,)``.
    origin
        What each row is of, so that a problem beside can have the like: the number of the servo, or the order of the axis' own motion; its
        line speed as a share; the place, from the start of the shear zone, or for the axis' own motion from that of the cycle (m); and the
        time since the sampling instant before (s). Shape ``(rows, 4)``, empty where no problem is beside.
    """

    matrix: FloatArray
    constant: FloatArray
    low: FloatArray
    high: FloatArray
    origin: FloatArray = field(default_factory=lambda: np.zeros((0, 4)))

    def near(self, unknowns: FloatArray) -> dict[tuple[int, float], FloatArray]:
        """Give places and times of the rows that nearly bind at an answer (slave units), each shape ``(2, m)``, by servo and line speed.

        Where no row is at its bound, those nearest to theirs are.
        """
        values = self.matrix @ unknowns + self.constant
        room = np.minimum(self.high - values, values - self.low) / self.size
        binds = self.origin[room <= room.min() + BINDING]
        keys = {(int(number), float(share)) for number, share in binds[:, :2]}
        return {key: binds[(binds[:, 0] == key[0]) & (binds[:, 1] == key[1])][:, 2:].T for key in sorted(keys)}

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
            *(
                np.concatenate([getattr(block, name) for block in blocks])
                for name in ("constant", "low", "high", "origin")
            ),
        )
    ]


def worst_places(excess: FloatArray, most: int = MOST_ROWS) -> NDArray[np.intp]:
    """Find the local maxima above zero, the worst first."""
    padded = np.concatenate([[-_EVERYWHERE], excess, [-_EVERYWHERE]])
    found = np.nonzero((excess > 0.0) & (excess >= padded[:-2]) & (excess > padded[2:]))[0]
    return np.asarray(found[np.argsort(-excess[found], kind="stable")][:most])
