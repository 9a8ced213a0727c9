"""Many rest-to-rest moves of one axis at a time: the double-S and the trapezoid of velocity, in closed form.

A move is written with truncated powers, ``s(t) = sum_k w_k max(t - t_k, 0)**p``: ``p = 3`` and eight changes of
jerk for the double-S, ``p = 2`` and four changes of acceleration for the trapezoid.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from camwright.profiles.closed_forms.reach import fastest
from camwright.profiles.limits import Limits
from camwright.profiles.polynomial.profile import FloatArray

_HALVINGS = 36
"""Bisections of a piece of a move, down to a part of 1e-11 of it."""


@dataclass(frozen=True, eq=False)
class Moves:
    """Moves from rest to rest, one a row.

    Parameters
    ----------
    knots
        Shape ``(n, k)``: times at which the jerk (double-S) or the acceleration (trapezoid) changes (s); the last
        is the duration.
    weights
        Shape ``(n, k)``: change there, over the factorial of the power.
    power
        3 for the double-S, 2 for the trapezoid.
    """

    knots: FloatArray
    weights: FloatArray
    power: int

    @property
    def time(self) -> FloatArray:
        """Durations (s), shape ``(n,)``."""
        return self.knots[:, -1]

    @property
    def distance(self) -> FloatArray:
        """Distances covered, shape ``(n,)``."""
        return self.position(self.time[:, None])[:, 0]

    def position(self, t: FloatArray) -> FloatArray:
        """Distance covered at times ``t`` (s) of shape ``(n, m)``; 0 before the move, the whole of it after."""
        inside = np.minimum(t, self.time[:, None])
        total, since, term = np.zeros(inside.shape), np.empty(inside.shape), np.empty(inside.shape)
        for k in range(self.knots.shape[1] - 1):  # nothing follows the last knot
            np.maximum(np.subtract(inside, self.knots[:, k, None], out=since), 0.0, out=since)
            np.multiply(self.weights[:, k, None], since, out=term)
            for _ in range(self.power - 1):  # three products take a tenth of the time of one power
                term *= since
            total += term
        return total

    def reaching(self, distance: FloatArray) -> FloatArray:
        """Find when (s) double-S moves have covered distances of shape ``(n,)``; the duration if they never do."""
        until = self.position(self.knots[:, 1:-1])
        piece = (until < distance[:, None]).sum(axis=1)
        rows = np.arange(len(piece))
        start, end = self.knots[rows, piece], self.knots[rows, piece + 1]
        # the truncated powers at work in the piece, as one cubic of the time since its start
        since = np.maximum(start[:, None] - self.knots, 0.0)
        weights = np.where(np.arange(self.knots.shape[1]) <= piece[:, None], self.weights, 0.0)
        d = weights.sum(axis=1)
        weights *= since
        c = 3 * weights.sum(axis=1)
        weights *= since
        b = 3 * weights.sum(axis=1)
        a = (weights * since).sum(axis=1) - distance
        low, high = np.zeros(len(piece)), end - start
        for _ in range(_HALVINGS):
            middle = 0.5 * (low + high)
            short = a + middle * (b + middle * (c + middle * d)) < 0
            low, high = np.where(short, middle, low), np.where(short, high, middle)
        return np.asarray(start + high, dtype=np.float64)

    def take(self, rows: NDArray[np.int64]) -> Moves:
        """Pick moves by their row."""
        return Moves(self.knots[rows], self.weights[rows], self.power)


def double_s_moves(distances: FloatArray, limits: Limits) -> Moves:
    """Fastest jerk-limited moves over some distances (`camwright.profiles.closed_forms.reach.fastest`)."""
    unique, rows = np.unique(distances, return_inverse=True)
    found = [fastest(d, limits.speed, limits.acceleration, limits.jerk) for d in unique.tolist()]
    ramp, hold, cruise = (np.array([getattr(move, name) for move in found]) for name in ("ramp", "hold", "cruise"))
    widths = np.stack([0 * ramp, ramp, hold, ramp, cruise, ramp, hold, ramp], axis=1)
    signs = np.array([1.0, -1.0, -1.0, 1.0, -1.0, 1.0, 1.0, -1.0])
    weights = np.tile(signs * limits.jerk / 6, (len(unique), 1))
    return Moves(np.cumsum(widths, axis=1), weights, 3).take(rows)


def trapezoid_moves(distances: FloatArray, limits: Limits) -> Moves:
    """Fastest moves under the speed and acceleration limits alone: the jerk at their corners is unbounded (S4)."""
    ramp = np.minimum(np.sqrt(distances / limits.acceleration), limits.speed / limits.acceleration)
    full = distances > limits.speed**2 / limits.acceleration
    cruise = np.where(full, distances / limits.speed - limits.speed / limits.acceleration, 0.0)
    widths = np.stack([0 * ramp, ramp, cruise, ramp], axis=1)
    signs = np.array([1.0, -1.0, -1.0, 1.0])
    weights = np.tile(signs * limits.acceleration / 2, (len(distances), 1))
    return Moves(np.cumsum(widths, axis=1), weights, 2)
