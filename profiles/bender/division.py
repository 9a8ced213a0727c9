"""How an arc becomes bends: the paper's equal steps, or the fewest bends that keep a chord error.

The bends of an arc are the vertices of a polygon that leaves both ends of the arc along its tangents, so that the
arc's bends and the workpiece angles at its joints stay apart. Seen from the centre, the first bend lies ``first``
behind the arc's start, the others ``step`` apart, the last ``first`` before the end: ``alpha = 2 first + (n - 1)
step``. Tangency puts the bends on the radius ``R / cos(first)``, the middles of the sides lie on ``R cos(step / 2) /
cos(first)``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from camwright.profiles.errors import InputError
from camwright.profiles.polynomial.profile import FloatArray

_WIDEST = math.radians(60.0)
"""Widest angle from an arc's end to its first bend, and half the widest step: a bend of an arc turns by 120° at "
"most."""


@dataclass(frozen=True, eq=False)
class Division:
    """Bends of some arcs, one entry an arc.

    Parameters
    ----------
    bends
        Number of bends ``n``.
    first
        Angle at the centre from the arc's end to the nearest bend (rad).
    step
        Angle at the centre between bends (rad); 0 where there is one bend only.
    """

    bends: NDArray[np.int64]
    first: FloatArray
    step: FloatArray

    def error(self, radius: FloatArray) -> FloatArray:
        """Largest distance between arc and polygon (m), outside at the bends or inside at the middle of a side."""
        outside = 1 / np.cos(self.first) - 1
        inside = np.where(self.bends > 1, 1 - np.cos(self.step / 2) / np.cos(self.first), 0.0)
        return radius * np.maximum(outside, inside)


class DivisionRule(Protocol):
    """Divides arcs of given radii (m) and included angles (rad), arrays of one shape, both positive."""

    def __call__(self, radius: FloatArray, included: FloatArray) -> Division:
        """Divide the arcs."""

    def allowed(self, radius: float) -> float:
        """Distance (m) between a long arc of a radius (m) and its bends that the rule takes for good."""


@dataclass(frozen=True)
class EqualSides:
    """The paper's rule: a full circle as a number of sides, so that an arc step is ``2 pi R / sides`` (S4).

    The number of bends is the arc's length over the step, to the nearest whole number, at least 1; each turns alike.
    """

    sides: int = 25

    def __post_init__(self) -> None:
        if self.sides < 3:
            raise InputError(f"a circle needs at least 3 sides; got {self.sides}")

    def __call__(self, radius: FloatArray, included: FloatArray) -> Division:
        """Divide the arcs."""
        del radius  # the step is a part of the circle, whatever its radius
        return _alike(included, included * self.sides / (2 * math.pi))

    def allowed(self, radius: float) -> float:
        """Distance of the bends outside the arc (m)."""
        return radius * (1 / math.cos(math.pi / self.sides) - 1)


@dataclass(frozen=True)
class EqualSteps:
    """The paper's rule with the step set by hand (S4).

    Parameters
    ----------
    step
        Length along the arc between bends (m).
    """

    step: float

    def __post_init__(self) -> None:
        if not self.step > 0:
            raise InputError(f"the step along an arc must be positive; got {1e3 * self.step!r} mm")

    def __call__(self, radius: FloatArray, included: FloatArray) -> Division:
        """Divide the arcs."""
        return _alike(included, radius * included / self.step)

    def allowed(self, radius: float) -> float:
        """Distance of the bends outside the arc (m)."""
        return radius * (1 / math.cos(min(self.step / (2 * radius), _WIDEST)) - 1)


@dataclass(frozen=True)
class FewestBends:
    """The fewest bends whose polygon stays within a distance of the arc, on both sides of it.

    Among the divisions with that number of bends it is the one with the least error: as far outside at the bends as
    inside at the middle of the sides.

    Parameters
    ----------
    chord_error
        Greatest distance between polygon and arc (m).
    """

    chord_error: float

    def allowed(self, radius: float) -> float:
        """Give the chord error, whatever the radius (m)."""
        del radius
        return self.chord_error

    def __post_init__(self) -> None:
        if not self.chord_error > 0:
            raise InputError(f"the chord error must be positive; got {1e3 * self.chord_error!r} mm")

    def __call__(self, radius: FloatArray, included: FloatArray) -> Division:
        """Divide the arcs."""
        most_first, most_step = _balanced(self.chord_error / radius)
        most_first, most_step = np.minimum(most_first, _WIDEST), np.minimum(most_step, 2 * _WIDEST)
        more = np.ceil((included - 2 * most_first) / most_step - 1e-9)  # the allowance keeps a circle of n from n + 1
        bends = 1 + np.maximum(more, 0).astype(np.int64)
        # the error that spends the whole angle: 2 first(e) + (n - 1) step(e) = alpha, growing with e
        low, high = np.zeros_like(radius), np.ones_like(radius)
        for _ in range(60):
            middle = 0.5 * (low + high)
            first, step = _balanced(middle)
            short = 2 * first + (bends - 1) * step < included
            low, high = np.where(short, middle, low), np.where(short, high, middle)
        first, _ = _balanced(high)
        first = np.where(bends == 1, included / 2, first)
        return Division(bends, first, np.where(bends == 1, 0.0, (included - 2 * first) / np.maximum(bends - 1, 1)))


def _alike(included: FloatArray, wanted: FloatArray) -> Division:
    least = np.ceil(included / (2 * _WIDEST) - 1e-9)
    bends = np.maximum(np.maximum(np.floor(wanted + 0.5), least), 1).astype(np.int64)
    step = included / bends
    return Division(bends, step / 2, np.where(bends > 1, step, 0.0))


def _balanced(error: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Angles to the first bend and between bends when the polygon is ``error`` (of the radius) outside and inside.

    ``cos(first) = 1 / (1 + e)`` and ``cos(step / 2) = (1 - e) / (1 + e)``, written with tangents of half angles,
    which keep their digits for small errors.
    """
    first = 2 * np.arctan(np.sqrt(error / (2 + error)))
    return first, 4 * np.arctan(np.sqrt(error))
