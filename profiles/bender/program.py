"""`NcProgram`: feeds and bends in the numbers of the program, thousandths of a millimetre and of a degree."""

from __future__ import annotations

from dataclasses import dataclass, field

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
    feeds
        Shape ``(m + 1,)``: feeds in µm, before each bend and after the last. A feed of 0 is not written.
    bends
        Shape ``(m,)``: mould angles in thousandths of a degree, positive to the left, within ±180°. The mould returns
        to zero after each.
    cuts
        Shape ``(k,)``: how much rule has been fed (µm) where the machine cuts a bridge, in order; a cut at a bend comes
        before it.
    """

    name: str
    feeds: IntArray
    bends: IntArray
    cuts: IntArray = field(default_factory=lambda: np.zeros(0, dtype=np.int64))

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

        if len(self.cuts) and not (
            self.cuts[0] >= 0 and self.cuts[-1] <= self.feeds.sum() and (np.diff(self.cuts) > 0).all()
        ):
            raise InputError(
                f"cuts from {self.cuts.min() / 1e3:.3f} to {self.cuts.max() / 1e3:.3f} mm of the rule: they must come one after "
                f"the other within its {self.feeds.sum() / 1e3:.3f} mm"
            )

    @property
    def rule_length(self) -> float:
        """Length of rule used (m)."""
        return float(self.feeds.sum()) * 1e-6

    @property
    def blocks(self) -> int:
        """Number of motion lines written."""
        return int(self._feed_blocks().sum()) + 2 * len(self.bends)

    def bend_blocks(self) -> IntArray:
        """Return the index of each bend's line among the motion lines and cuts, from 0, shape ``(m,)``."""
        fed = np.cumsum(self._feed_blocks()[:-1])
        return np.asarray(fed + 2 * np.arange(len(self.bends)), dtype=np.int64)

    def cut_blocks(self) -> IntArray:
        """Return the index of each cut's line among the motion lines and cuts, from 0, shape ``(k,)``."""
        begins = np.concatenate([[0], self.bend_blocks() + 2])
        found = []
        for k, feeds in self.split_feeds().items():
            place = int(begins[k])
            for fed in feeds[:-1]:
                place += int(fed > 0)
                found.append(place)
                place += 1
        return np.array(found, dtype=np.int64)

    def split_feeds(self) -> dict[int, list[int]]:
        """Return the feeds that are stopped for cuts: their numbers, and the parts (µm) before, between and after the cuts."""
        if not len(self.cuts):
            return {}
        ends = np.cumsum(self.feeds)
        owner = np.searchsorted(ends, self.cuts, side="left")
        found: dict[int, list[int]] = {}
        for k in np.unique(owner).tolist():
            start = int(ends[k] - self.feeds[k])
            found[k] = np.diff([start, *self.cuts[owner == k].tolist(), int(ends[k])]).tolist()
        return found

    def _feed_blocks(self) -> IntArray:
        """Lines of each feed, its cuts among them, shape ``(m + 1,)``."""
        lines = (self.feeds > 0).astype(np.int64)
        for k, parts in self.split_feeds().items():
            lines[k] = sum(part > 0 for part in parts) + len(parts) - 1
        return lines
