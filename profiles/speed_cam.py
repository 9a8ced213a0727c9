"""`SpeedCam`: a command that knows the line speed, as tables that a controller adds, each times a power of that speed."""

from __future__ import annotations

from dataclasses import dataclass
from functools import reduce

import numpy as np

from camwright.profiles.polynomial.profile import CamProfile


@dataclass(frozen=True, eq=False)
class SpeedCam:
    """Tables whose sum is the command: the first as it is, the second times the line speed, the third times its square, and so on.

    Parameters
    ----------
    tables
        One cycle each over the same master period: slave unit, slave unit per m/s, slave unit per (m/s)², … The first alone advances.
    """

    tables: tuple[CamProfile, ...]

    def at(self, line_speed: float) -> CamProfile:
        """Give the command at a line speed (m/s)."""
        breaks = reduce(np.union1d, [table.breaks for table in self.tables])
        parts = [
            table.over(breaks[0], breaks[-1]).recut(breaks).scale(slave=line_speed**power)
            for power, table in enumerate(self.tables)
        ]
        return reduce(CamProfile.plus, parts)
