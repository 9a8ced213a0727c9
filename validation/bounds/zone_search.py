"""`ZoneSearch`: the shortest cut over all sync zones, whatever decides whether a cut holds."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from camwright.profiles.cut import Cut

_COARSE = 8
"""Parts into which the room between shear zone and pitch is divided by the sync zones that are tried first."""


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
    holds
        Whether a cut holds. Its shear zone lies at the end of the sync zone.
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
    holds: Callable[[Cut], bool]
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
        if low > high or not self.holds(self.shape(high, sync_zone)):
            return None
        if self.holds(self.shape(low, sync_zone)):
            return low
        while high - low > resolution:
            middle = 0.5 * (low + high)
            if self.holds(self.shape(middle, sync_zone)):
                high = middle
            else:
                low = middle
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
