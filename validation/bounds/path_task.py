"""A motion along a path in a given time: what bounds of torque and energy know of it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from camwright.profiles.polynomial.profile import FloatArray


@dataclass(frozen=True, eq=False)
class PathTask:
    """A motion along a path in a given time.

    Parameters
    ----------
    inertia
        Inertia at even places of the path (kg or kg·m²).
    way
        Length of the path (m or rad), positive.
    speeds
        Speeds at its ends (m/s or rad/s), positive.
    time
        Time that the motion takes (s).
    greatest
        Greatest speed allowed.
    """

    inertia: FloatArray
    way: float
    speeds: tuple[float, float]
    time: float
    greatest: float

    @cached_property
    def stretched(self) -> FloatArray:
        """``s = ∫ √(2/I) dq`` at the places: the path, long where the inertia is small."""
        root = np.sqrt(2.0 / self.inertia)
        step = self.way / (len(root) - 1)
        return np.concatenate([[0.0], np.cumsum(0.5 * step * (root[1:] + root[:-1]))])

    @property
    def energies(self) -> tuple[float, float]:
        """Kinetic energies at the ends (J)."""
        return 0.5 * float(self.inertia[0]) * self.speeds[0] ** 2, 0.5 * float(self.inertia[-1]) * self.speeds[1] ** 2

    @property
    def top(self) -> FloatArray:
        """Greatest kinetic energy allowed at the places (J)."""
        return 0.5 * self.inertia * self.greatest**2
