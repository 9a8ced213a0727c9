"""A motion along a path in a given time: what bounds of torque and energy know of it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from camwright.profiles.polynomial.profile import FloatArray
from camwright.validation.bounds.path_reach import fastest, slowest

ROUNDING = 1e-9
"""Share of the way by which a motion may miss its end: rounding."""


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
    acceleration, jerk
        Greatest acceleration and jerk allowed, either way.
    slopes
        Accelerations at the ends; they count where the jerk is limited.
    friction
        Force or torque against the motion while it moves; only the energy drawn knows it.
    """

    inertia: FloatArray
    way: float
    speeds: tuple[float, float]
    time: float
    greatest: float
    acceleration: float = math.inf
    jerk: float = math.inf
    slopes: tuple[float, float] = (0.0, 0.0)
    friction: float = 0.0

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

    @cached_property
    def reach(self) -> tuple[FloatArray, FloatArray]:
        """Least and greatest kinetic energy at the places (J) of a motion that never turns and keeps to its limits."""
        if not math.isfinite(self.acceleration):
            return np.zeros(len(self.inertia)), self.top
        q = np.linspace(0.0, self.way, len(self.inertia))
        limits = self.acceleration, self.jerk
        # from its end backwards a motion is one from there with the opposite acceleration
        first, last = (self.speeds[0], self.slopes[0]), (self.speeds[1], -self.slopes[1])
        low = np.maximum(slowest(q, first, *limits), slowest(q, last, *limits)[::-1])
        high = np.minimum(fastest(q, first, *limits, low), fastest(q, last, *limits, low[::-1])[::-1])
        return 0.5 * self.inertia * low, np.minimum(0.5 * self.inertia * high, self.top)

    @property
    def may_rest(self) -> bool:
        """Whether a motion that keeps to speed and acceleration can come to rest on the way, or turn, and still arrive in time.

        From ``v`` to rest in ``t`` it covers at most ``V²/A - v²/(2 A)`` with ``V = (A t + v)/2``, or goes on at its greatest speed.
        That is convex in ``t``, so of all times of the rest the earliest or the latest leaves most.
        """
        if not math.isfinite(self.acceleration):
            return True
        earliest, latest = self.speeds[0] / self.acceleration, self.time - self.speeds[1] / self.acceleration
        if earliest > latest:
            return False
        farthest = max(
            self._farthest(self.speeds[0], t) + self._farthest(self.speeds[1], self.time - t)
            for t in (earliest, latest)
        )
        return farthest >= self.way * (1 - ROUNDING)

    def _farthest(self, speed: float, time: float) -> float:
        """Longest way from a speed to rest in a time."""
        limit = self.acceleration
        top = min(0.5 * (limit * time + speed), self.greatest)
        spare = max(time - (2 * top - speed) / limit, 0.0)
        return (top**2 - 0.5 * speed**2) / limit + top * spare
