"""`NcProgram`: feeds and bends in the numbers of the program, thousandths of a millimetre and of a degree."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from camwright.profiles.errors import InputError

IntArray = NDArray[np.int64]

FULL_TURN = 360_000
"""A full turn of the mould in thousandths of a degree."""


@dataclass(frozen=True, eq=False)
class NcProgram:
    """What the bender does, in order: feed, bend and return, feed, bend and return, …, feed.

    Parameters
    ----------
    name
        Name of the program.
    feeds
        Shape ``(m + 1,)``: feeds in µm, before each bend and after the last. A feed of 0 is not written.
    bends
        Shape ``(m,)``: mould angles in thousandths of a degree, positive to the left, within ±180°. The mould returns
        to zero after each.
    """

    name: str
    feeds: IntArray
    bends: IntArray

    def __post_init__(self) -> None:
        if len(self.feeds) != len(self.bends) + 1:
            raise InputError(
                f"a program of m bends needs m + 1 feeds; got {len(self.bends)} bends and {len(self.feeds)} feeds"
            )
        if (self.feeds < 0).any():
            i = int(np.argmax(self.feeds < 0))
            raise InputError(f"feed {i + 1} is {self.feeds[i] / 1e3:.3f} mm; the rule is fed forwards only")
        if ((np.abs(self.bends) >= FULL_TURN // 2) | (self.bends == 0)).any():
            i = int(np.argmax((np.abs(self.bends) >= FULL_TURN // 2) | (self.bends == 0)))
            raise InputError(f"bend {i + 1} is {self.bends[i] / 1e3:.3f}°; a bend lies between 0 and 180° to one side")

    @property
    def rule_length(self) -> float:
        """Length of rule used (m)."""
        return float(self.feeds.sum()) * 1e-6

    @property
    def blocks(self) -> int:
        """Number of motion lines written."""
        return int(np.count_nonzero(self.feeds)) + 2 * len(self.bends)

    def bend_blocks(self) -> IntArray:
        """Return the index of each bend's line among the motion lines, from 0, shape ``(m,)``."""
        fed = np.cumsum(self.feeds[:-1] > 0)
        return np.asarray(fed + 2 * np.arange(len(self.bends)), dtype=np.int64)
