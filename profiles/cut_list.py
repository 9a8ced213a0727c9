"""`CutList`: what is to be cut one after the other, and the gaps on the material that follow from it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from camwright.profiles.polynomial.profile import FloatArray

PieceKind = Literal["cut", "crop", "skip"]
"""A good piece; a piece that is thrown away; a length at whose end nothing is cut, so that it stays with the next."""

PIECE_KINDS: tuple[PieceKind, ...] = get_args(PieceKind)

_SAME = 9
"""Decimals of a metre to which lengths are the same: a nanometre is no other cam."""


@dataclass(frozen=True)
class ListRow:
    """A row of a cut list.

    Parameters
    ----------
    length
        Length on the material (m).
    quantity
        How many of them.
    kind
        What they are.
    line
        Line of the file, 0 where there is none.
    """

    length: float
    quantity: int = 1
    kind: PieceKind = "cut"
    line: int = 0


@dataclass(frozen=True)
class CutList:
    """Rows in the order in which they are cut; the last is no skip.

    Lengths, crops and skips are one thing: places on the material at which the slave must be in sync. A *gap* is the material from one
    such place to the next; a skip joins its length to the gap behind it.

    Parameters
    ----------
    rows
        The rows, one at least.
    place
        What messages about it begin with: its file.

    Examples
    --------
    >>> asked = CutList((ListRow(0.3, 2), ListRow(0.2, 1, "skip"), ListRow(0.5, 1), ListRow(0.3, 1, "crop")))
    >>> asked.gaps.tolist(), asked.crops.tolist(), round(asked.scrap, 9)
    ([0.3, 0.3, 0.7, 0.3], [False, False, False, True], 0.3)
    """

    rows: tuple[ListRow, ...]
    place: str = "cut list"

    @property
    def pieces(self) -> int:
        """Cuts made: good pieces and crops."""
        return sum(row.quantity for row in self.rows if row.kind != "skip")

    @cached_property
    def _gathered(self) -> tuple[FloatArray, NDArray[np.bool_], NDArray[np.intp]]:
        lengths: list[float] = []
        counts: list[int] = []
        crops: list[bool] = []
        lines: list[int] = []
        waiting = 0.0
        for row in self.rows:
            if row.kind == "skip":
                waiting += row.length * row.quantity
                continue
            first = 1 if waiting else 0
            for length, count in ((row.length + waiting, first), (row.length, row.quantity - first)):
                if count:
                    lengths.append(round(length, _SAME))
                    counts.append(count)
                    crops.append(row.kind == "crop")
                    lines.append(row.line)
            waiting = 0.0
        return np.repeat(lengths, counts), np.repeat(crops, counts), np.repeat(lines, counts)

    @property
    def gaps(self) -> FloatArray:
        """Material from each cut to the next (m), shape ``(pieces,)``."""
        return self._gathered[0]

    @property
    def crops(self) -> NDArray[np.bool_]:
        """Whether what lies before each cut is thrown away, shape ``(pieces,)``."""
        return self._gathered[1]

    @property
    def lines(self) -> NDArray[np.intp]:
        """Line of the file that each cut comes from, shape ``(pieces,)``."""
        return self._gathered[2]

    def where(self, piece: int) -> str:
        """Name file and line of a cut, counted from 0, for messages."""
        return f"{self.place}, line {self.lines[piece]}"

    @property
    def scrap(self) -> float:
        """Material of the crops (m)."""
        return float(self.gaps[self.crops].sum())
