"""Free ends that nearly meet: named with their distance, and the gap that would join them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from camwright.bender.piece import Piece
from camwright.profiles.bender.boxes import overlapping
from camwright.profiles.notice import Notice, Number

NEAR = 1e-3
"""Distance (m) up to which free ends nearly meet, whatever the gap."""

_GAPS = 20.0
"""The same in gaps."""

_LONGER = 5.0
"""How many times longer than the distance of its own ends a line is that nearly closes."""


@dataclass(frozen=True)
class NearEnds:
    """Two free ends that are not joined.

    Parameters
    ----------
    first, second
        Names of the lines; alike if one nearly closes.
    distance
        Between the ends (m).
    gap
        A gap that joins them (m).
    place
        Where the first end is (m).
    """

    first: str
    second: str
    distance: float
    gap: float
    place: tuple[float, float]

    @property
    def told(self) -> Notice:
        """What to say of them."""
        x, y = self.place
        return Notice(
            '{first} and {second} end {distance} mm apart at ({x}, {y}) mm and are not joined; gap = "{gap} mm" under [drawing] of '
            "the bender job joins them"
            if self.first != self.second
            else 'the ends of {first} are {distance} mm apart at ({x}, {y}) mm and are not joined; gap = "{gap} mm" under [drawing] '
            "of the bender job joins them",
            first=self.first,
            second=self.second,
            distance=Number(1e3 * self.distance, ".3g"),
            gap=f"{1e3 * self.gap:.2g}",
            x=Number(1e3 * x, ".3f"),
            y=Number(1e3 * y, ".3f"),
        )


def near_ends(paths: Sequence[Piece], gap: float) -> tuple[NearEnds, ...]:
    """Find each free end's nearest other free end within 1 mm or 20 gaps, in the order of the paths (m)."""
    limit = max(NEAR, _GAPS * gap)
    owner = [k for k, path in enumerate(paths) if not path.closed for _ in range(2)]
    at = np.array([path.points[end] for path in paths if not path.closed for end in (0, -1)]).reshape(-1, 2)
    first, second = overlapping(at - 0.5 * limit, at + 0.5 * limit)
    away = np.hypot(*(at[first] - at[second]).T)
    used: set[int] = set()
    found = []
    for k in np.lexsort((second, first, away)).tolist():
        a, b, distance = int(first[k]), int(second[k]), float(away[k])
        one, other = paths[owner[a]], paths[owner[b]]
        short = one is other and one.length < _LONGER * distance
        if distance <= limit and distance > gap and not short and not used & {a, b}:
            used |= {a, b}
            x, y = at[a]
            found.append((a, NearEnds(one.name, other.name, distance, _rounded_up(distance), (float(x), float(y)))))
    return tuple(ends for _, ends in sorted(found, key=lambda entry: entry[0]))


def _rounded_up(distance: float) -> float:
    """Round up to two digits, so that the rounded gap is not below the distance."""
    step = 10.0 ** (math.floor(math.log10(distance)) - 1)
    return step * math.ceil(distance / step * (1 + 1e-9))
