"""`PathSpline`: a spline over the path and the kinetic energy in a tube of motions, with its rows for a cone programme."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from camwright.profiles.polynomial.profile import FloatArray
from camwright.validation.bounds.path_task import PathTask

KNOTS = (20, 6)
"""Pieces of the spline along the path, and across it."""
_POWER = 0.5
"""Power of the kinetic energy across the tube: the speed."""
EMPTY = 1e-12
"""Share of the greatest kinetic energy by which a tube's bounds may cross by rounding."""


@dataclass(frozen=True, eq=False)
class Tube:
    """Where motions below a level stay: kinetic energies at the places of the path (J)."""

    low: FloatArray
    high: FloatArray

    @property
    def empty(self) -> bool:
        """Whether no motion stays in it."""
        return bool((self.low > self.high + EMPTY * float(self.high.max())).any())


class PathSpline:
    """A tensor spline over ``s`` and a power of the kinetic energy, and ``λ``, on a tube."""

    def __init__(self, task: PathTask, tube: Tube) -> None:
        self._task, self._tube = task, tube
        self._s = task.stretched
        self.whole = float(self._s[-1])
        self._range = float(tube.low.min()) ** _POWER, float(tube.high.max()) ** _POWER

    def places(self, along: int, across: int) -> tuple[FloatArray, FloatArray]:
        """Places in the tube: shares of the path, a column for each, and kinetic energies (J)."""
        line = 0.5 - 0.5 * np.cos(np.pi * np.linspace(0, 1, along))
        low, high = (
            np.interp(line * self.whole, self._s, part) ** _POWER for part in (self._tube.low, self._tube.high)
        )
        floor = (1e-6 * max(self._task.energies)) ** _POWER
        energy = np.maximum(low + np.linspace(0.0, 1.0, across)[:, None] * (high - low), floor) ** (1 / _POWER)
        return np.broadcast_to(line, energy.shape), energy

    def inertia(self, x: FloatArray) -> FloatArray:
        """Inertia at shares of the path."""
        return np.interp(x * self.whole, self._s, self._task.inertia)

    def rubbed(self, x: FloatArray) -> FloatArray:
        """Energy that friction takes per stretched length, at shares of the path."""
        return self._task.friction * np.sqrt(self.inertia(x) / 2)

    def rows(self, x: FloatArray, energy: FloatArray) -> tuple[NDArray[np.intp], FloatArray, FloatArray]:
        """Give a row for each place: which weights count, that of ``λ`` the last, and their factors in two sums.

        The sums are ``φ_s - F √(I/2) φ_E + λ (I/2) E^(-1/2)`` and ``φ_E``.
        """
        y, steep = self._across(energy)
        (i, at_x), (j, at_y) = _local(KNOTS[0], x), _local(KNOTS[1], y)
        columns = (i[:, None, None] + np.arange(4)[:, None]) * (KNOTS[1] + 3) + j[:, None, None] + np.arange(4)
        slope = _products(at_x[0], at_y[1] * steep[:, None])
        linear = _products(at_x[1], at_y[0]) / self.whole - self.rubbed(x)[:, None] * slope
        return (
            np.column_stack([columns.reshape(len(x), -1), np.full(len(x), self.size - 1)]),
            np.column_stack([linear, self.inertia(x) / 2 / np.sqrt(energy)]),
            np.column_stack([slope, np.zeros(len(x))]),
        )

    def factors(self, x: FloatArray, energy: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Give the splines at places, those along the path apart from those across it.

        Parameters
        ----------
        x
            Shares of the path, one of each column.
        energy
            Kinetic energies (J), a column for each.

        Returns
        -------
        along, across
            Derivatives by the stretched length and values, (2, columns, splines along); values and derivatives by the kinetic energy,
            (2, columns, heights, splines across).
        """
        y, steep = self._across(energy.T)
        found = []
        for count, at in zip(KNOTS, (x, y.ravel()), strict=True):
            first, local = _local(count, at)
            each = np.zeros((2, len(at), count + 3))
            np.put_along_axis(each, np.broadcast_to(first[:, None] + np.arange(4), local.shape), local, 2)
            found.append(each)
        along, across = found
        scale = np.array([1.0, 1.0 / self.whole])[:, None, None]
        return (scale * along)[::-1], across.reshape(2, *y.shape, -1) * np.stack([np.ones_like(y), steep])[..., None]

    def values(self, x: FloatArray, energy: FloatArray, weights: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Give what the two sums come to with weights, at places as `places` gives them, without their rows."""
        y, steep = self._across(energy)
        i, at_x = _local(KNOTS[0], x[0])
        sheet = weights[:-1].reshape(KNOTS[0] + 3, KNOTS[1] + 3)[i[:, None] + np.arange(4)]
        column = np.arange(len(i))
        j = np.minimum((y * KNOTS[1]).astype(np.intp), KNOTS[1] - 1)
        d = y - j / KNOTS[1]
        inner = np.arange(KNOTS[1])[:, None] + np.arange(4)
        # of each column and piece across the Taylor coefficients
        by_s, value = (
            np.einsum("cpi,pki->cpk", np.einsum("ci,cij->cj", of, sheet)[:, inner], _pieces(KNOTS[1]))
            for of in (at_x[1] / self.whole, at_x[0])
        )
        zero, one, two, three = np.moveaxis(by_s[column, j], -1, 0)
        linear = zero + d * (one + d * (two + d * three))
        _, one, two, three = np.moveaxis(value[column, j], -1, 0)
        slope = (one + d * (2.0 * two + d * 3.0 * three)) * steep
        linear += weights[-1] * self.inertia(x[0]) / 2 / np.sqrt(energy) - self.rubbed(x[0]) * slope
        return linear, slope

    @property
    def size(self) -> int:
        """Number of weights."""
        return (KNOTS[0] + 3) * (KNOTS[1] + 3) + 1

    def _across(self, energy: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Where kinetic energies lie across the tube, from 0 to 1, and the derivative of that."""
        bottom, top = self._range
        place = np.clip((energy**_POWER - bottom) / (top - bottom), 0.0, 1.0)
        return place, _POWER * energy ** (_POWER - 1) / (top - bottom)

    def rises(self) -> tuple[FloatArray, FloatArray]:
        """Coefficients of the spline's derivative across the tube, a row each, and the least of them for ``φ_E >= -1`` everywhere.

        The derivative over the speed's share is a spline whose coefficients are not negative where it is not, and ``φ_E >= -1`` is one
        that is linear in the share. Those of no place of the tube are left out.
        """
        bottom, top = self._range
        along, across = (_knots(count) for count in KNOTS)
        room = top - bottom
        middle = 0.5 * (across[2:-3] + across[3:-2])
        low, high = (side**_POWER for side in (self._tube.low, self._tube.high))
        rows, least = [], []
        for i in range(KNOTS[0] + 3):
            inside = (self._s >= along[i] * self.whole) & (self._s <= along[i + 4] * self.whole)
            bounds = float(low[inside].min()), float(high[inside].max())
            for j in range(KNOTS[1] + 2):
                first, last = (bottom + room * float(across[k]) for k in (j + 1, j + 4))
                if last < bounds[0] or first > bounds[1]:
                    continue
                row = np.zeros(self.size)
                at = i * (KNOTS[1] + 3) + j
                row[at : at + 2] = np.array([-3.0, 3.0]) / (across[j + 4] - across[j + 1])
                rows.append(row)
                least.append(-2.0 * room * (bottom + room * float(middle[j])))
        return np.array(rows), np.array(least)

    def ends(self) -> FloatArray:
        """Give what the bound is made of: the spline at the start less that at the end, less ``λ`` times the time."""
        found = np.zeros(self.size)
        for x, energy, sign in zip((0.0, 1.0), self._task.energies, (1.0, -1.0), strict=True):
            (i, along), (j, across) = (
                _local(count, np.array([at]))
                for count, at in zip(KNOTS, (x, self._across(np.asarray(energy))[0]), strict=True)
            )
            sheet = found[:-1].reshape(KNOTS[0] + 3, KNOTS[1] + 3)
            sheet[i[0] : i[0] + 4, j[0] : j[0] + 4] += sign * np.outer(along[0], across[0])
        found[-1] = -self._task.time
        return found

    @property
    def stands(self) -> bool:
        """Whether the tube holds standstill somewhere: then time may pass for nothing, and ``λ`` must not be negative."""
        return bool((self._tube.low[1:-1] <= 0.0).any())


def _knots(count: int) -> FloatArray:
    return np.concatenate([np.zeros(3), np.linspace(0.0, 1.0, count + 1), np.ones(3)])


@lru_cache
def _pieces(count: int) -> FloatArray:
    """Taylor coefficients, at the start of each of so many even pieces, of the four cubic B-splines that live there."""
    from scipy.interpolate import BSpline

    splines = BSpline(_knots(count), np.eye(count + 3), 3)
    taylor = np.stack([splines(_knots(count)[3:-4], nu=order) / math.factorial(order) for order in range(4)])
    return np.stack([taylor[:, k, k : k + 4] for k in range(count)])


def _local(count: int, x: FloatArray) -> tuple[NDArray[np.intp], FloatArray]:
    """First of the four B-splines that live at places, and their values and derivatives, a row for each place."""
    piece = np.minimum((x * count).astype(np.intp), count - 1)
    d = (x - piece / count)[:, None]
    zero, one, two, three = np.moveaxis(_pieces(count)[piece], 1, 0)
    return piece, np.stack([zero + d * (one + d * (two + d * three)), one + d * (2.0 * two + d * 3.0 * three)])


def _products(along: FloatArray, across: FloatArray) -> FloatArray:
    return (along[:, :, None] * across[:, None, :]).reshape(len(along), -1)
