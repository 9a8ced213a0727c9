"""Weak duality for a motion of least mean square jerk or acceleration: a lower bound that any multipliers give.

The motion is a quadratic programme. On a grid an interior point method gives its multipliers, and these are put into the dual function in
continuous time: what the grid misses makes the bound a little lower, never wrong. The quadratic stays in the dual function, so an error of
the multipliers enters squared. Limits of speed and position are asked for at the nodes only, which can only lower a bound.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from camwright.profiles.polynomial.profile import FloatArray
from camwright.validation.bounds.quadratic import multipliers

GREATEST = 1e6
"""Largest limit that the quadratic programme is told, in its units; a greater one counts as none there."""


@dataclass(frozen=True)
class DualTask:
    """A motion over a time from a state to another, and its limits, in any consistent units.

    Parameters
    ----------
    time
        How long it lasts.
    start
        Velocity and acceleration at its start; its position there is zero.
    end
        Position, velocity and acceleration at its end; the velocity None where it is free.
    velocities, positions
        Least and greatest; positions infinite where there is no limit.
    acceleration, jerk
        Limits of the magnitudes.
    """

    time: float
    start: tuple[float, float]
    end: tuple[float, float | None, float]
    velocities: tuple[float, float]
    acceleration: float
    jerk: float
    positions: tuple[float, float] = (-math.inf, math.inf)

    def scaled(self, unit: float) -> DualTask:
        """Give the motion in unit time, with a jerk that counts as 1."""
        t = self.time
        slope, pace, way = unit * t, unit * t**2, unit * t**3
        place, velocity, acceleration = self.end
        return DualTask(
            1.0,
            (self.start[0] / pace, self.start[1] / slope),
            (place / way, None if velocity is None else velocity / pace, acceleration / slope),
            (self.velocities[0] / pace, self.velocities[1] / pace),
            self.acceleration / slope,
            self.jerk / unit,
            (self.positions[0] / way, self.positions[1] / way),
        )


@dataclass(frozen=True)
class _Prices:
    """Multipliers: of the acceleration's change on each interval; of limits at the nodes, upper less lower; of the end's state."""

    jerk: FloatArray
    acceleration: FloatArray
    velocity: FloatArray
    position: FloatArray
    end: tuple[float, float, float]
    limits: float


def least_square_jerk(task: DualTask, nodes: FloatArray, unit: float) -> float:
    """Lower bound of half the integral of the squared jerk.

    The dual function is the integral of the least of ``j² / 2 + c j`` over ``|j| <= J``, with the price ``c(s)`` of all that lies ahead.

    Parameters
    ----------
    task
        The motion.
    nodes
        Times from 0 to its end, shape ``(n + 1,)``.
    unit
        Jerk that counts as 1 in the programme: about the motion's.
    """
    own, x = task.scaled(unit), nodes / task.time
    h, n = np.diff(x), len(x) - 1
    found = _prices(own, x, np.append(h, np.zeros(3 * n)))
    cell: NDArray[np.intp] = np.arange(n)
    atoms, spread = _spread(found.acceleration)
    ahead, lever, later = (_beyond(values)[cell + 1] for values in (atoms, found.velocity, found.velocity * x))
    holds = [_beyond(found.position * x**power)[cell + 1] for power in range(3)]
    place, pace, slope = found.end

    def price(s: FloatArray) -> FloatArray:
        held = 0.5 * (holds[2] - 2.0 * s * holds[1] + s**2 * holds[0])
        at_end = slope + pace * (1.0 - s) + 0.5 * place * (1.0 - s) ** 2
        return np.asarray(ahead + _spread_ahead(spread, x, cell, s) + later - s * lever + held + at_end)

    inside = 1e-9 * h  # three values on each interval make the quadratic that the price is there
    prices = price(x[:-1] + inside), price(0.5 * (x[:-1] + x[1:])), price(x[1:] - inside)
    start, end = own.start[1], own.end[2]
    given = start * float(found.acceleration.sum()) + slope * (start - end)
    given -= own.acceleration * float(np.abs(found.acceleration).sum()) if np.isfinite(own.acceleration) else 0.0
    dual = given + _carried(own, x, found, start) - float(integral_of_least(*prices, h, own.jerk).sum())
    return dual * unit**2 * task.time


def least_square_acceleration(task: DualTask, nodes: FloatArray, unit: float) -> float:
    """Lower bound of half the integral of the squared acceleration; arguments as of `least_square_jerk`.

    With a price ``p(s)`` of the jerk the dual function is the integral of the least of ``a² / 2 + (b + p') a`` over ``|a| <= A``, less that
    of ``J |p|``, with the price ``b(s)`` of velocities and positions that lie ahead; ``p`` is linear between mid intervals. No price of the
    jerk at all is tried too: where the jerk is all but free it is the better one.
    """
    own, x = task.scaled(unit), nodes / task.time
    h, n = np.diff(x), len(x) - 1
    weight = np.concatenate([np.zeros(n), 0.5 * (h + np.append(h[1:], 0.0)), np.zeros(2 * n)])
    found = _prices(own, x, weight)
    corners, line = _price_line(x, found.jerk)
    best = max(_with_prices(own, x, found, corners, values) for values in (line, 0.0 * line))
    return best * unit**2 * task.time**3


def _price_line(x: FloatArray, values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Corners and values of the line through values at mid intervals, going on straight to both ends."""
    corners = 0.5 * (x[:-1] + x[1:])
    first = values[0] - corners[0] * (values[1] - values[0]) / (corners[1] - corners[0])
    last = values[-1] + (1.0 - corners[-1]) * (values[-1] - values[-2]) / (corners[-1] - corners[-2])
    return np.concatenate([[0.0], corners, [1.0]]), np.concatenate([[first], values, [last]])


def _with_prices(own: DualTask, x: FloatArray, found: _Prices, corners: FloatArray, values: FloatArray) -> float:
    """Dual function of the squared acceleration for a price of the jerk, linear between corners."""
    edges = np.union1d(x, corners)
    low, wide = edges[:-1], np.diff(edges)
    middle = low + 0.5 * wide
    cell = np.clip(np.searchsorted(x, middle) - 1, 0, len(x) - 2)
    slope = (np.diff(values) / np.diff(corners))[np.clip(np.searchsorted(corners, middle) - 1, 0, len(corners) - 2)]
    ahead, lever, later = (_beyond(each)[cell + 1] for each in (found.velocity, found.position, found.position * x))
    place, pace, _ = found.end

    def price(s: FloatArray) -> FloatArray:
        return np.asarray(slope + ahead + later - s * lever + pace + place * (1.0 - s))

    least = integral_of_least(price(low), price(middle), price(low + wide), wide, own.acceleration)
    first, last = values[:-1], values[1:]
    total = np.abs(first) + np.abs(last)
    areas = np.where(first * last < 0, (first**2 + last**2) / np.where(total > 0, total, 1.0), total) / 2
    jerk = own.jerk * float(areas @ np.diff(corners))
    ends = own.start[1] * float(values[0]) - own.end[2] * float(values[-1])
    return ends + _carried(own, x, found, 0.0) - float(least.sum()) - jerk


def _carried(own: DualTask, x: FloatArray, found: _Prices, acceleration: float) -> float:
    """Sum what velocities, positions and the end cost where the motion goes on with its velocity and an acceleration from the start."""
    velocity = own.start[0] + acceleration * x
    position = own.start[0] * x + 0.5 * acceleration * x**2
    place, pace, _ = found.end
    carried = float(found.velocity @ velocity + found.position @ position) + place * (float(position[-1]) - own.end[0])
    if own.end[1] is not None:
        carried += pace * (float(velocity[-1]) - own.end[1])
    return carried - found.limits


def _prices(own: DualTask, x: FloatArray, weight: FloatArray) -> _Prices:
    """Solve the quadratic programme on a grid with the jerk constant on each interval.

    The unknowns are the jerk of each interval, then acceleration, velocity and position at its end, shape ``(4 n,)``, as the weights.
    """
    from scipy.sparse import block_array, csr_array, diags_array, eye_array

    n, h = len(x) - 1, np.diff(x)
    step, before = eye_array(n) - eye_array(n, k=-1), eye_array(n, k=-1)
    last = np.zeros((1, n))
    last[0, -1] = 1.0
    end = csr_array(last)
    free = own.end[1] is None
    rows = [
        [-diags_array(h), step, None, None],
        [-diags_array(h**2 / 2), -diags_array(h) @ before, step, None],
        [-diags_array(h**3 / 6), -diags_array(h**2 / 2) @ before, -diags_array(h) @ before, step],
        [None, end, None, None],
        *([] if free else [[None, None, end, None]]),
        [None, None, None, end],
    ]
    v0, a0 = own.start
    goal = np.zeros(3 * n)
    goal[0], goal[n], goal[2 * n] = a0, v0 + h[0] * a0, h[0] * v0 + 0.5 * h[0] ** 2 * a0
    goal = np.concatenate([goal, [own.end[2]], [] if own.end[1] is None else [own.end[1]], [own.end[0]]])
    low, high = _limits(own, n)
    told = np.clip(low, -GREATEST, GREATEST), np.clip(high, -GREATEST, GREATEST)
    none = (told[0] <= -GREATEST) & (told[1] >= GREATEST)
    bottom, top = np.where(none, -np.inf, told[0]), np.where(none, np.inf, told[1])
    upper, lower, prices = multipliers(weight, bottom, top, block_array(rows, format="csr"), goal)
    net = upper - lower
    net = np.where(np.isfinite(np.where(net > 0, high, low)), net, 0.0)
    acceleration, velocity, position = (np.append(0.0, net[part * n : (part + 1) * n]) for part in (1, 2, 3))
    priced = np.nonzero(net[2 * n :])[0] + 2 * n  # acceleration and jerk the dual function itself knows
    limits = float(net[priced] @ np.where(net[priced] > 0, high[priced], low[priced]))
    jerk = prices[:n] + h / 2 * prices[n : 2 * n] + h**2 / 6 * prices[2 * n : 3 * n]
    ends = -prices[3 * n :]
    pace = 0.0 if free else float(ends[1])
    return _Prices(jerk, acceleration, velocity, position, (float(ends[-1]), pace, float(ends[0])), limits)


def _limits(own: DualTask, n: int) -> tuple[FloatArray, FloatArray]:
    """Limits of the unknowns; what the end gives has none there."""
    low = np.repeat([-own.jerk, -own.acceleration, own.velocities[0], own.positions[0]], n)
    high = np.repeat([own.jerk, own.acceleration, own.velocities[1], own.positions[1]], n)
    fixed = [2 * n - 1, 4 * n - 1] + ([] if own.end[1] is None else [3 * n - 1])
    low[fixed], high[fixed] = -np.inf, np.inf
    return low, high


def _beyond(values: FloatArray) -> FloatArray:
    """Add up from each place on; last comes zero."""
    return np.append(np.cumsum(values[::-1])[::-1], 0.0)


def _spread(price: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Split prices at nodes into single ones and such as belong to an arc along which the limit is active.

    On an arc the true price is a density; left at the nodes it would make the price of the jerk a saw-tooth.
    """
    active = np.abs(price) > 1e-9 * np.abs(price).max(initial=1e-300)
    same = np.sign(price[1:]) == np.sign(price[:-1])
    inner = np.zeros(len(price), dtype=bool)
    inner[1:-1] = active[1:-1] & active[:-2] & active[2:] & same[:-1] & same[1:]
    inner[[1, -2]] = False  # the ends are fixed, their prices are no part of an arc
    return np.where(inner, 0.0, price), np.where(inner, price, 0.0)


def _spread_ahead(spread: FloatArray, x: FloatArray, cell: NDArray[np.intp], s: FloatArray) -> FloatArray:
    """Integral beyond ``s`` of densities that rise from the node before and fall to the node after, one for each price."""
    h = np.concatenate([[0.0], np.diff(x), [0.0]])  # h[k + 1] is the cell after node k
    width = h[:-1] + h[1:]  # the two cells at each node
    here = h[cell + 1]
    beyond = np.append(np.cumsum(spread[::-1])[::-1], [0.0, 0.0])[cell + 2]
    rising = spread[cell + 1] * (1.0 - (s - x[cell]) ** 2 / (here * width[cell + 1]))
    falling = spread[cell] * (x[cell + 1] - s) ** 2 / (here * width[cell])
    return np.asarray(beyond + rising + falling)


def integral_of_least(
    first: FloatArray, centre: FloatArray, last: FloatArray, h: FloatArray, limit: float
) -> FloatArray:
    """Integral of ``-min(j² / 2 + c j)`` over ``|j| <= limit``, ``c`` quadratics given at both ends and the middle of intervals ``h``.

    That is ``c² / 2`` up to ``|c| = limit``, beyond it ``limit |c| - limit² / 2``; between the places where it changes Gauss-Legendre
    with three points is exact.
    """
    b = -3 * first + 4 * centre - last
    a = 2 * first - 4 * centre + 2 * last
    places = [np.zeros_like(h), np.ones_like(h)]
    for level in (limit, -limit):
        c = first - level
        root = np.sqrt(np.maximum(b * b - 4 * a * c, 0.0))
        q = -0.5 * (b + np.where(b >= 0, root, -root))
        with np.errstate(divide="ignore", invalid="ignore"):
            found = np.nan_to_num(q / a), np.nan_to_num(c / q)
        places += [np.where((b * b > 4 * a * c) & (r > 0) & (r < 1), r, 0.0) for r in found]
    edges = np.sort(np.stack(places), axis=0)
    node, weight = np.polynomial.legendre.leggauss(3)
    s = edges[:-1, None] + np.diff(edges, axis=0)[:, None] * (0.5 * (node + 1))[:, None]
    size = np.abs(first + s * (b + s * a))
    least = np.where(size <= limit, 0.5 * size**2, limit * size - 0.5 * limit**2)
    return np.asarray((np.diff(edges, axis=0) * (least * weight[:, None] / 2).sum(axis=1)).sum(axis=0) * h)
