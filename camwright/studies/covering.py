"""The fewest bands that together cover a range of line speeds: greedily, from the top down."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

Holds = Callable[[float, float], bool]
"""Tells of a band of line speeds, its lower end first (m/s), whether one cam holds it."""

FOUND_TO = 5e-3
"""Share to which the lower end of a band is found."""

MOST_BANDS = 12
"""Most bands of a covering."""

_LOWER = (0, 1, 2, 4, 8)
"""By so many times `FOUND_TO` a lower end is lowered until no cam is shown to reach it."""


@dataclass(frozen=True)
class Overlap:
    """How far two neighbouring bands lie over each other.

    Parameters
    ----------
    share
        Share of the line speed that lies between switching down and switching up.
    length
        Material that passes from the switching speed to the end of the change (m).
    ramp
        Acceleration of the line while it passes, up or down (m/s²); 0 of a line that keeps its speed until then.

    Examples
    --------
    >>> Overlap(0.05, 0.5, 0.0).top(1.0)
    1.05
    >>> ramped = Overlap(0.05, 0.5, 0.3)
    >>> round(ramped.top(1.0), 6), round(ramped.least(ramped.top(1.0)), 12)
    (1.304799, 1.0)
    """

    share: float
    length: float
    ramp: float

    @property
    def _gained(self) -> float:
        """What the line's ramp adds to the square of its speed on the way, or takes from it (m²/s²)."""
        return 2.0 * self.length * self.ramp

    def top(self, low: float) -> float:
        """Upper end of the next slower band (m/s), of the lower end of the one above it."""
        return math.sqrt(((1.0 + self.share) * low) ** 2 + 2.0 * self._gained)

    def least(self, top: float) -> float:
        """Lower end (m/s) to which a band of an upper end must reach, else the next one is no slower; 0 where standstill would not do."""
        return math.sqrt(max(0.0, top**2 - 2.0 * self._gained)) / (1.0 + self.share)

    def switching(self, low: float, top: float) -> tuple[float, float]:
        """Line speeds at which to switch down and up (m/s), so that the change is over between two ends."""
        down = math.sqrt(low**2 + self._gained)
        up = math.sqrt(max(0.0, top**2 - self._gained))
        return down, up


@dataclass(frozen=True)
class Covering:
    """Bands of line speeds that cover a range.

    Parameters
    ----------
    bands
        Lower and upper end of each (m/s), ascending.
    at_least
        So many bands any covering with this overlap has, shown by bands that no cam holds.
    """

    bands: tuple[tuple[float, float], ...]
    at_least: int

    @property
    def fewest(self) -> bool:
        """Whether no covering has fewer bands."""
        return len(self.bands) == self.at_least


@dataclass(frozen=True)
class Uncovered:
    """A range of line speeds that no bands cover.

    Parameters
    ----------
    top
        Line speed (m/s) below which no cam holds a band that is wide enough for an overlap, or where there were `MOST_BANDS` already.
    """

    top: float


def cover(holds: Holds, excludes: Holds, low: float, high: float, overlap: Overlap) -> Covering | Uncovered:
    """Cover a range of line speeds with the fewest bands.

    A cam that holds a band holds every part of it. So a band that begins at the top and reaches down as far as any can leaves the others
    the least to do: no covering has fewer bands. The lower ends are found to `FOUND_TO` and therefore a little above the least; how many
    bands any covering has is counted by `excludes` alone, from below the ends that were found.

    Parameters
    ----------
    holds
        Whether a cam was found that holds a band.
    excludes
        Whether no cam can hold it; with ``holds`` false it may still not be known to.
    low, high
        The range (m/s).
    overlap
        By how much neighbours overlap.
    """
    bands: list[tuple[float, float]] = []
    top = high
    while not holds(low, top):
        end = _least(holds, low, top, overlap) if len(bands) < MOST_BANDS - 1 else None
        if end is None:
            return Uncovered(top)
        bands.append((end, top))
        top = overlap.top(end)
    bands.append((low, top))
    return Covering(tuple(reversed(bands)), _at_least(excludes, low, high, overlap, bands[:-1]))


def _least(holds: Holds, low: float, top: float, overlap: Overlap) -> float | None:
    """Find the least lower end of a band with an upper one (m/s), which is above ``low``; nothing where the overlap is wider than it."""
    reached = overlap.least(top * (1.0 - FOUND_TO))
    if reached <= low or not holds(reached, top):
        return None
    while reached - low > FOUND_TO * reached:
        middle = math.sqrt(low * reached)
        low, reached = (low, middle) if holds(middle, top) else (middle, reached)
    return reached


def _at_least(excludes: Holds, low: float, high: float, overlap: Overlap, bands: list[tuple[float, float]]) -> int:
    """Count bands that any covering has: down from the top, from one line speed to the next that no cam reaches from there."""
    top, count = high, 1
    for end, below in bands:
        lowered = (end * (top / below) * (1.0 - times * FOUND_TO) for times in _LOWER)
        beyond = next((each for each in lowered if each > low and excludes(each, top)), None)
        if beyond is None:  # the whole of what is left may still be excluded
            return count + (excludes(low, top) if top > low else 0)
        top, count = overlap.top(beyond), count + 1
    return count
