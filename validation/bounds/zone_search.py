"""`ZoneSearch`: the shortest cut over all sync zones, whatever decides whether a cut holds."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

from camwright.profiles.cut import Cut

_COARSE = 8
"""Parts into which the room between shear zone and pitch is divided by the sync zones that are tried first."""

_GUESSES = 3
"""How often an edge is looked for by a straight line before the place itself that is asked about is looked at."""


@dataclass
class _Edge:
    """Where a quantity that falls over a range reaches zero, as closely as it is known.

    Parameters
    ----------
    spare
        Room left beside a guess, for it to lie on the other side of the edge than the last place did.
    low, high
        Place where the quantity is known to be above zero, and place where it is not, each with what it is there: infinite if only its
        sign is known.
    """

    excess: Callable[[float], float]
    spare: float
    low: tuple[float, float]
    high: tuple[float, float]
    _low_moved: bool | None = None

    def reached(self, place: float) -> bool:
        """Whether the quantity is at most zero at a place; it is not looked at there if that is known from places beside it."""
        guesses = _GUESSES
        while self.low[0] < place < self.high[0]:
            self._look(self._guess() if guesses and self._guessable else place)
            guesses -= guesses > 0
        return place >= self.high[0]

    @property
    def _guessable(self) -> bool:
        return self.high[0] - self.low[0] > 2 * self.spare and math.isfinite(self.low[1] - self.high[1])

    def _guess(self) -> float:
        """Give the place where the straight line between both ends reaches zero, and a little on to the end that stayed."""
        (low, above), (high, below) = self.low, self.high
        zero = low + (high - low) * above / (above - below)
        zero += -self.spare if self._low_moved is False else self.spare
        return min(max(zero, low + self.spare), high - self.spare)

    def _look(self, place: float) -> None:
        """Look at a place between the ends, and move one of them there; an end that stays twice counts half (Illinois)."""
        found = self.excess(place)
        if found > 0.0:
            self.low = place, found
            self.high = self.high[0], self.high[1] * (0.5 if self._low_moved else 1.0)
        else:
            self.high = place, found
            self.low = self.low[0], self.low[1] * (0.5 if self._low_moved is False else 1.0)
        self._low_moved = found > 0.0


@dataclass(frozen=True, eq=False)
class ZoneSearch:
    """A search for the shortest cut of a machine that carries the tool on by a pitch each cycle.

    At ``x_c = y_c`` the tool runs at line speed throughout, so no minimum lies above the pitch.

    Parameters
    ----------
    cut
        Line speed, shear zone and tolerance; its own lengths are not used.
    pitch
        Slave travel per cycle ``y_c`` (m).
    lower
        Shortest cut length (m) beside a sync zone (m) that the return allows at all.
    excess
        By how much a cut, its shear zone at the end of the sync zone, misses what it must hold: at most zero where it holds, infinite
        where nothing but that is known.
    fine
        Parts into which the room is divided in the end; 8 times a power of two.
    length_resolution
        Accuracy of the cut length found for a sync zone, relative to the pitch; no smaller gain is looked for.
    zone_resolution
        Step of the sync zone with which the search ends, relative to the pitch.
    """

    cut: Cut
    pitch: float
    lower: Callable[[float], float]
    excess: Callable[[Cut], float]
    fine: int
    length_resolution: float
    zone_resolution: float

    def shape(self, length: float, sync_zone: float) -> Cut:
        """Cut with its shear zone at the end of the sync zone."""
        at = sync_zone - self.cut.shear_zone
        return replace(self.cut, length=length, sync_zone=sync_zone, shear_zone_at=at, origin="return")

    def shorter(self, sync_zone: float, best: float) -> float | None:
        """Shortest cut length of a sync zone, ``None`` if it is not below the best by the resolution."""
        resolution = self.length_resolution * self.pitch
        high, low = best - resolution, self.lower(sync_zone)

        def excess(length: float) -> float:
            return self.excess(self.shape(length, sync_zone))

        if low > high or (below := excess(high)) > 0.0:
            return None
        if (above := excess(low)) <= 0.0:
            return low
        edge = _Edge(excess, 0.25 * resolution, (low, above), (high, below))
        while high - low > resolution:  # halved, so that the answer does not depend on how the edge was found
            middle = 0.5 * (low + high)
            low, high = (low, middle) if edge.reached(middle) else (middle, high)
        return high

    def find(self) -> tuple[float, float]:
        """Best cut length (m) and its sync zone (m) over the whole room; the pitch twice if there is none."""
        return self.refine(*self._scan())

    def refine(self, best: float, zone: float) -> tuple[float, float]:
        """Best cut length and sync zone about those given, by steps of the sync zone that are halved."""
        step = 0.5 * (self.pitch - self.cut.shear_zone) / self.fine
        while step > self.zone_resolution * self.pitch:
            for trial in (zone - step, zone + step):
                found = self.shorter(trial, best) if self.cut.shear_zone < trial < self.pitch else None
                if found is not None:
                    best, zone = found, trial
                    break
            else:
                step *= 0.5
        return best, zone

    def _scan(self) -> tuple[float, float]:
        """Best cut length and its sync zone on ever finer grids of sync zones."""
        best, zone = self.pitch, self.pitch
        room = self.pitch - self.cut.shear_zone
        parts = _COARSE
        while parts <= self.fine:
            for i in range(1, parts):
                if i % 2 == 0 and parts > _COARSE:
                    continue  # tried on the grid before
                trial = self.cut.shear_zone + room * i / parts
                found = self.shorter(trial, best)
                if found is not None:
                    best, zone = found, trial
            parts *= 2
        return best, zone
