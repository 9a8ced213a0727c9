"""Returns that never turn, along their path: the kinetic energy runs straight to a level, stays there, and runs straight to the end.

With the kinetic energy ``E = I u² / 2`` over the slave's travel the inertial torque is ``dE/dy`` whatever the inertia does, so such a
return is a constant torque, a stretch without any, and a constant torque. Where the two stretches begin and end is the family; the level
is what makes the return take its time. It holds what differs in kind: coasting at constant kinetic energy, creeping past one place, and
all but standing there.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from camwright.profiles.polynomial.profile import FloatArray

PLACES = 161
MARKS = (0.03, 0.08, 0.15, 0.25, 0.35, 0.45, 0.55, 0.65, 0.75, 0.85, 0.92, 0.97)
"""Shares of the way at which the first torque may end and the second begin."""
HALVINGS = 14
# Kinetic energies looked at, as powers of e times that of the mean speed.
LEAST, GREATEST = -30.0, 10.0


@dataclass(frozen=True, eq=False)
class PathStarts:
    """A family of returns along the path.

    Parameters
    ----------
    y
        Slave coordinates, shape ``(n,)``.
    speeds
        Speeds there, a row for each return (slave unit per s).
    times
        Times of the intervals (s), a row for each return.
    costs
        Objective of each return at the slave.
    marks
        Where the first torque ends and the second begins, as shares of the way, a row for each return.
    """

    y: FloatArray
    speeds: FloatArray
    times: FloatArray
    costs: FloatArray
    marks: FloatArray

    def valleys(self) -> list[int]:
        """Find the returns none of whose neighbours in the family costs less, the best first."""
        index = {tuple(pair): k for k, pair in enumerate(np.searchsorted(MARKS, self.marks).tolist())}
        found = []
        for (i, j), k in index.items():
            near = [index[i + di, j + dj] for di in (-1, 0, 1) for dj in (-1, 0, 1) if (i + di, j + dj) in index]
            if np.isfinite(self.costs[k]) and self.costs[k] <= min(float(self.costs[other]) for other in near):
                found.append(k)
        return sorted(found, key=lambda k: float(self.costs[k]))

    def states(self, k: int, at: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Acceleration, speed and slave coordinate of a return at times (s) from its start."""
        speed, steps = self.speeds[k], self.times[k]
        t = np.concatenate([[0.0], np.cumsum(steps)])
        acceleration = np.diff(speed) / steps
        i = np.clip(np.searchsorted(t, at, side="right") - 1, 0, len(steps) - 1)
        d = at - t[i]
        return acceleration[i], speed[i] + acceleration[i] * d, self.y[i] + d * (speed[i] + acceleration[i] * d / 2)


def path_starts(
    inertia: Callable[[Any], Any],
    friction: float,
    ends: tuple[float, float],
    speeds: tuple[float, float],
    time: float,
    aim: str,
) -> PathStarts:
    """Make the family.

    Parameters
    ----------
    inertia
        Inertia at slave coordinates.
    friction
        Friction against the motion.
    ends
        Slave coordinates of start and end, in the direction of the motion.
    speeds
        Speeds there (slave unit per s).
    time
        Time of the return (s).
    aim
        ``"rms_torque"`` or ``"rms_acceleration"``, ``"energy"``, or any other, for which the peak of the torque counts.
    """
    y = np.linspace(*ends, PLACES)
    mass = np.asarray(inertia(y)) + 0.0 * y
    share, step = np.linspace(0.0, 1.0, PLACES), float(y[1] - y[0])
    first, second = (
        part[np.less_equal(*np.meshgrid(MARKS, MARKS, indexing="ij"))]
        for part in np.meshgrid(MARKS, MARKS, indexing="ij")
    )
    energies = 0.5 * mass[0] * speeds[0] ** 2, 0.5 * mass[-1] * speeds[1] ** 2
    # between the two torques both are 1: the level
    out, back = np.minimum(share / first[:, None], 1.0), np.minimum((1.0 - share) / (1.0 - second[:, None]), 1.0)
    of_level = np.where(share <= first[:, None], out, back)
    of_ends = (1.0 - of_level) * np.where(share <= first[:, None], *energies)
    per_root = np.sqrt(2.0 / mass)
    mean = 0.5 * float(mass.mean()) * ((y[-1] - y[0]) / time) ** 2

    def along(level: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Kinetic energy, speed and times of the intervals."""
        energy = of_ends + level[:, None] * of_level
        speed = per_root * np.sqrt(np.maximum(energy, 1e-300))
        return energy, speed, 2.0 * step / (speed[:, 1:] + speed[:, :-1])

    low, high = np.full(len(first), LEAST), np.full(len(first), GREATEST)
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        slow = along(mean * np.exp(middle))[2].sum(axis=1) > time
        low, high = np.where(slow, middle, low), np.where(slow, high, middle)
    energy, speed, times = along(mean * np.exp(high))
    # a ramp to nothing and back ends in finite time: the slave stands there for the rest
    slowest = np.argmin(speed[:, 1:] + speed[:, :-1], axis=1)
    times[np.arange(len(times)), slowest] += np.maximum(time - times.sum(axis=1), 0.0)
    torque = np.diff(energy, axis=1) / step + friction
    if aim in ("rms_torque", "rms_acceleration"):
        costs = np.sqrt((torque**2 * times).sum(axis=1) / time)
    elif aim == "energy":
        costs = (np.maximum(torque, 0.0) * step).sum(axis=1) / time
    else:
        costs = np.abs(torque).max(axis=1)
    return PathStarts(y, speed, times, costs, np.stack([first, second], axis=1))
