"""Weights of a value function of the squared torque: an interior point method that knows how its inequality is made.

At each of some thousand places ``l >= s²`` is asked for, with ``l`` and ``s`` linear in the weights of a tensor spline. All places of a
column share their splines along the path, so the products of a step are made of each column's own, which are small, and they are banded.
Every iterate keeps the inequality at its places; it is ended early, where it is still away from them, for there it breaks the least
between them. What is left broken is looked at by `camwright.validation.bounds.path_dual`: no bound trusts this method.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from camwright.profiles.polynomial.profile import FloatArray
from camwright.validation.bounds.path_spline import PathSpline

STEPS = 60
ENOUGH = 3e-3
"""Sum of the products of slacks and multipliers at which it is ended, as a share of the level: about as much is left to be gained."""
MOST = 1.1
"""Multiple of the level at which it is ended: where no motion at all is in a tube its spline would run away."""
FIRST = 6.0
"""Price of the time that is begun with, without a spline, as a multiple of level over time."""
PRODUCTS = 10.0
"""Sum of the products of slacks and multipliers that is begun with, as a multiple of that price."""
SHORT = 0.98
"""Share of the way to the nearest inequality that a step goes at most."""
REGULAR = 1e-9
"""Weight that keeps what no place asks for from running away."""
ROUNDING = 1e-9
"""Share of that multiple."""


@dataclass(frozen=True, eq=False)
class _Places:
    """The inequality at places in columns, scaled.

    Parameters
    ----------
    along
        Splines along the path at the columns: derivatives, then values; (2, columns, splines along).
    linear
        ``l`` of a place from what its column's weights come to by the derivatives, by the values, and from the price of the time;
        (columns, heights, 2 splines across + 1).
    root
        ``s`` of a place from what its column's weights come to by the values; (columns, heights, splines across).
    """

    along: FloatArray
    linear: FloatArray
    root: FloatArray

    def at(self, weights: FloatArray) -> tuple[FloatArray, FloatArray]:
        """``l`` and ``s`` of weights, (columns, heights) each."""
        size, across = self.along.shape[2], self.root.shape[2]
        by_slope, by_value = self.along @ weights[:-1].reshape(size, across)
        whole = np.column_stack([by_slope, by_value, np.full(len(by_slope), weights[-1])])
        return (self.linear @ whole[:, :, None])[:, :, 0], (self.root @ by_value[:, :, None])[:, :, 0]

    def sums(self, of_linear: FloatArray, of_root: FloatArray) -> FloatArray:
        """Give the sums of the gradients of ``l`` and ``s`` over the places, each with its factors (columns, heights)."""
        across = self.root.shape[2]
        whole = (of_linear[:, None, :] @ self.linear)[:, 0]
        by_value = whole[:, across:-1] + (of_root[:, None, :] @ self.root)[:, 0]
        by_slope, of_value = self.along[0].T @ whole[:, :across], self.along[1].T @ by_value
        return np.append((by_slope + of_value).ravel(), whole[:, -1].sum())


@dataclass(frozen=True, eq=False)
class _Band:
    """Where the products of a spline's weights lie: pairs of splines along that share a piece, and their place in a band's lower half."""

    first: NDArray[np.intp]
    second: NDArray[np.intp]
    kept: NDArray[np.bool_]
    place: NDArray[np.intp]
    shape: tuple[int, int]


def _band(along: int, across: int) -> _Band:
    """Band of a spline of so many weights along the path and across it."""
    first = np.concatenate([np.arange(along - k) for k in range(4)])
    second = np.concatenate([np.arange(k, along) for k in range(4)])
    row = second[:, None, None] * across + np.arange(across)
    column = first[:, None, None] * across + np.arange(across)[:, None]
    kept = row >= column
    return _Band(first, second, kept, ((row - column) * along * across + column)[kept], (4 * across, along * across))


class _System:
    """Equations of a step, ready to be solved: a banded matrix with a border.

    Parameters
    ----------
    places
        The inequality.
    root
        ``s`` at the places.
    products
        Factors of the products of the slacks' gradients, multipliers over slacks.
    multipliers
        Multipliers.
    """

    def __init__(self, places: _Places, root: FloatArray, products: FloatArray, multipliers: FloatArray) -> None:
        from scipy.linalg import cholesky_banded

        across, (slope, value) = places.root.shape[2], places.along
        gradient = places.linear.copy()
        gradient[:, :, across:-1] -= 2.0 * root[:, :, None] * places.root
        own = gradient.transpose(0, 2, 1) @ (products[:, :, None] * gradient)
        own[:, across:-1, across:-1] += places.root.transpose(0, 2, 1) @ (2.0 * multipliers[:, :, None] * places.root)
        band = _band(places.along.shape[2], across)
        pairs = [one[:, band.first] * other[:, band.second] for one in (slope, value) for other in (slope, value)]
        parts = [own[:, one, other] for one in _halves(across) for other in _halves(across)]
        blocks = np.concatenate(pairs).T @ np.concatenate(parts).reshape(-1, across * across)
        lower = np.zeros(math.prod(band.shape))
        lower[band.place] = blocks.reshape(-1, across, across)[band.kept]
        lower = lower.reshape(band.shape)
        lower[0] += REGULAR
        self._factor = cholesky_banded(lower, lower=True, overwrite_ab=True, check_finite=False)
        self._border = (slope.T @ own[:, :across, -1] + value.T @ own[:, across:-1, -1]).ravel()
        self._beside = self._banded(self._border)
        self._corner = float(own[:, -1, -1].sum()) + REGULAR - float(self._border @ self._beside)

    def _banded(self, right: FloatArray) -> FloatArray:
        from scipy.linalg import cho_solve_banded

        return np.asarray(cho_solve_banded((self._factor, True), right, check_finite=False))

    def solved(self, right: FloatArray) -> FloatArray:
        """Weights that meet the equations."""
        alone = self._banded(right[:-1])
        last = (right[-1] - float(self._border @ alone)) / self._corner
        return np.append(alone - last * self._beside, last)


def _halves(across: int) -> tuple[slice, slice]:
    """Give where the weights' sums by derivatives and by values lie among those of a column."""
    return slice(0, across), slice(across, 2 * across)


def square_weights(spline: PathSpline, x: FloatArray, energy: FloatArray, level: float) -> FloatArray:
    """Weights of a value function that is all but the best of those that keep its inequality at places.

    Parameters
    ----------
    spline
        Of the tube.
    x
        Shares of the path, one of each column.
    energy
        Kinetic energies (J) of the places, a column each.
    level
        Integral of the squared torque over time of the tube, (N·m)² s.
    """
    # the spline in units of the level, the price of the time in those of level over time
    unit, ends = np.full(spline.size, level), spline.ends()
    unit[-1] = level / -float(ends[-1])
    return unit * _best(_scaled(spline, x, energy, level, unit), ends * unit / level)


def _scaled(spline: PathSpline, x: FloatArray, energy: FloatArray, level: float, unit: FloatArray) -> _Places:
    """Inequality per share of the path and level; a column of its own asks that the price of the time be positive."""
    whole = spline.whole
    along, (value, slope) = spline.factors(x, energy)
    slope = slope * whole
    time = spline.inertia(x)[:, None] / 2 / np.sqrt(energy.T) * (float(unit[-1]) * whole / level)
    rubbed = spline.rubbed(x)[:, None, None]
    linear = np.concatenate([value, -rubbed * slope, time[:, :, None]], axis=2)
    root = 0.5 * slope * (math.sqrt(level / whole) * energy.T**0.25)[:, :, None]
    along = along * np.array([whole, 1.0])[:, None, None]
    if spline.stands:
        alone = np.zeros((1, *linear.shape[1:]))
        alone[:, :, -1] = 1.0
        linear, root = np.concatenate([linear, alone]), np.concatenate([root, np.zeros((1, *root.shape[1:]))])
        along = np.concatenate([along, np.zeros((2, 1, along.shape[2]))], axis=1)
    return _Places(along, linear, root)


def _best(places: _Places, goal: FloatArray) -> FloatArray:
    """Weights near the greatest sum with a goal, by Mehrotra's predictor and corrector; those reached where they are no better.

    Both steps of a slack ``f = l - s²`` know that it is bent: it changes by ``f' d`` less the square of what ``s`` changes by.
    """
    weights = np.zeros(len(goal))
    weights[-1] = FIRST
    linear, root = places.at(weights)
    slack = linear - root**2
    multipliers = PRODUCTS * FIRST / slack.size / slack
    for _ in range(STEPS):
        gap, room = float((slack * multipliers).sum()), MOST - float(goal @ weights)
        rise = goal - REGULAR * weights
        left = rise + places.sums(multipliers, -2.0 * root * multipliers)
        if room <= ROUNDING * MOST or (gap < ENOUGH and float(np.abs(left).max()) < ENOUGH):
            break
        over = multipliers / slack
        try:
            system = _System(places, root, over, multipliers)
        except np.linalg.LinAlgError:  # rounding
            break
        target = np.zeros_like(slack)
        for centred in (False, True):
            price = target / slack
            step = system.solved(rise + places.sums(price, -2.0 * root * price))
            by_linear, by_root = places.at(step)
            change = by_linear - 2.0 * root * by_root
            change_multipliers = price - multipliers - over * change
            share, other = _longest(slack, change, by_root), _longest(multipliers, change_multipliers)
            if centred:
                break
            share, other = min(share, 1.0), min(other, 1.0)
            after = (slack + share * change - (share * by_root) ** 2) * (multipliers + other * change_multipliers)
            target = (
                gap / slack.size * (float(after.sum()) / gap) ** 3
                - change * change_multipliers
                + multipliers * by_root**2
            )
        if not np.isfinite(step).all():
            break
        share = min(SHORT * share, 1.0)
        gain = share * float(goal @ step)
        share *= min(1.0, room / gain) if gain > 0.0 else 1.0
        weights = weights + share * step
        root = root + share * by_root
        linear = linear + share * by_linear
        slack = linear - root**2
        multipliers = multipliers + min(SHORT * other, 1.0) * change_multipliers
    return weights


def _longest(values: FloatArray, change: FloatArray, bend: FloatArray | float = 0.0) -> float:
    """Longest step ``t`` with which ``values + t change - (t bend)²`` is positive."""
    root = np.sqrt(change**2 + 4.0 * np.square(bend) * values)
    return float(2.0 / max(float(((root - change) / values).max()), 1e-300))
