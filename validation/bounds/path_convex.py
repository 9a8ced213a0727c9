"""Lower bound of the squared torque where the time is short: the path's convex programme, by its dual function.

With ``s`` and ``z`` of `camwright.validation.bounds.path_dual` the integral of the squared torque over time is ``16/9 ∫ z_s² ds`` and the
time is ``∫ (I/2) z^(-2/3) ds``, both convex. So for any price ``μ >= 0`` of the time and any function ``p(s)`` ::

    p(0) z(0) - p(S) z(S) - μ T + ∫ [ min over z of (p' z + μ (I/2) z^(-2/3)) - 9/64 p² ] ds

is no greater than the integral of any motion that takes the time ``T`` or less: standing, turning slowly or not. Newton's method makes it
as great as can be with ``p`` a broken line on a grid; of ``p²`` the integral is exact, of the minimum it is Gauss-Legendre's with three
points an interval.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from camwright.profiles.polynomial.profile import FloatArray
from camwright.validation.bounds.path_task import PathTask

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(3)
_SHARES = 0.5 * _WEIGHTS

INTERVALS = 250
SEARCH = 60, 1e-10
"""Steps of Newton's method at most, and the least share of a step that is tried."""
HALVINGS = 26
# Powers of e of the prices looked at, times that of a typical motion; and typical motions, as multiples of the straight line.
LEAST, GREATEST = -18.0, 14.0
FACTORS = (0.5, 1.0, 2.0, 5.0)
ENOUGH = 1e-10
# Least slope of p that counts, relative to its scale: below it z is at its top.
FLAT = 1e-12


def least_square_in_time(task: PathTask) -> float:
    """Lower bound of the integral of the squared torque over time, (N·m)² s, of every motion that takes no longer than the task's time."""
    return PathDual(task).best()


@dataclass(frozen=True)
class _Grid:
    """A motion on the grid: its time (s), the intervals' width, and by Gauss-Legendre's points half the inertia and the greatest ``z``.

    ``ends`` are ``z`` at the ends, ``tail`` the price of coming to rest beyond the end, ``string`` the ``p`` of the shortest way under the
    greatest ``z``.
    """

    time: float
    width: float
    half: FloatArray
    top: FloatArray
    ends: tuple[float, float]
    tail: float
    string: FloatArray


def _grid(task: PathTask, tail: float) -> _Grid:
    nodes = np.linspace(0.0, task.stretched[-1], INTERVALS + 1)
    width = float(nodes[1])
    points = nodes[:-1] + width * (0.5 + 0.5 * _NODES[:, None])
    top = np.interp(points, task.stretched, task.top) ** 0.75
    first, last = (energy**0.75 for energy in task.energies)
    way = np.append(nodes, nodes[-1] + tail) if tail else nodes
    under = np.concatenate([[first], top.min(axis=0)[1:], np.full(len(way) - INTERVALS, last)])
    return _Grid(
        task.time,
        width,
        0.5 * np.interp(points, task.stretched, task.inertia),
        top,
        (first, last),
        9 / 64 * tail,  # over the tail it costs 16/9 z²/tail at least
        32 / 9 * _slopes_of_hull(way, under)[: INTERVALS + 1],
    )


class PathDual:
    """The dual function on a grid.

    Parameters
    ----------
    task
        The motion.
    tail
        Stretched length beyond its end over which it may come to rest, in no time; there ``z`` at its end is free.
    search
        Steps of Newton's method at most, and the least share of a step that is tried.
    """

    def __init__(self, task: PathTask, tail: float = 0.0, search: tuple[int, float] = SEARCH) -> None:
        self._steps, self._least = search
        self._grid = _grid(task, tail)
        self._ended = False

    def best(self) -> float:
        """Greatest value over the price of time."""
        line = self._grid.ends[0] + (self._grid.ends[1] - self._grid.ends[0]) * (np.arange(INTERVALS) + 0.5) / INTERVALS
        typical = float(line.mean())
        unit = typical ** (8 / 3) / float(self._grid.half.mean()) / (self._grid.width * INTERVALS) ** 2
        low, high = LEAST, GREATEST
        p, value, time = self.at_price(unit * math.exp(low), np.zeros(INTERVALS + 1), line)
        greatest = max(value, 0.0)
        if self._ended and time <= self._grid.time:  # there is more time than the softest motion takes
            return greatest
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            price = unit * math.exp(middle)
            p, value, time = self.at_price(price, p, line)
            greatest = max(greatest, value)
            low, high = (middle, high) if time > self._grid.time else (low, middle)
        return greatest

    def at_price(self, price: float, p: FloatArray, line: FloatArray) -> tuple[FloatArray, float, float]:
        """Climb at one price of time, from ``p`` or from a motion of the kind of a line of ``z``: ``p``, the value, the motion's time."""
        starts = [p, self._grid.string, *(self._start(line * factor, price) for factor in FACTORS)]
        return self._climb(max(starts, key=lambda start: self._value(start, price)), price)

    def _start(self, z: FloatArray, price: float) -> FloatArray:
        """``p`` whose inner minimum is at a given ``z``, its mean such that the ends balance."""
        slope = 2.0 / 3.0 * price * self._grid.half[1] * np.minimum(z, self._grid.top[1]) ** (-5 / 3)
        p = np.concatenate([[0.0], np.cumsum(slope * self._grid.width)])
        wanted = (self._grid.ends[0] - self._grid.ends[1]) / (9 / 32 * self._grid.width * INTERVALS)
        return np.asarray(p - 0.5 * (p[:-1] + p[1:]).mean() + wanted)

    def _parts(self, p: FloatArray, price: float) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Give means over each interval: ``z`` of the inner minimum, its value, its second derivative over the slope, and the time."""
        slope = np.diff(p) / self._grid.width
        steep = np.maximum(slope, FLAT * price)
        z = (2.0 / 3.0 * price * self._grid.half / steep) ** 0.6
        at_top = (z >= self._grid.top) | (slope <= 0)
        z = np.where(at_top, self._grid.top, z)
        pace = self._grid.half * z ** (-2 / 3)
        curve = np.where(at_top, 0.0, -0.6 * z / steep)
        return _SHARES @ z, _SHARES @ (slope * z + price * pace), _SHARES @ curve, _SHARES @ pace

    def _value(self, p: FloatArray, price: float) -> float:
        _, value, _, _ = self._parts(p, price)
        square = self._grid.width * float((p[:-1] ** 2 + p[:-1] * p[1:] + p[1:] ** 2).sum()) / 3
        ends = float(p[0]) * self._grid.ends[0] - float(p[-1]) * self._grid.ends[1]
        ends -= self._grid.tail * float(p[-1]) ** 2
        return float(ends + self._grid.width * float(value.sum()) - 9 / 64 * square - price * self._grid.time)

    def _climb(self, p: FloatArray, price: float) -> tuple[FloatArray, float, float]:
        """Newton's method for one price: ``p``, the value, and the time that the motion takes which the price asks for."""
        from scipy.linalg import solveh_banded

        h, value, self._ended = self._grid.width, self._value(p, price), False
        for _ in range(self._steps):
            z, _, curve, _ = self._parts(p, price)
            rise = np.zeros(len(p))
            rise[0], rise[-1] = self._grid.ends[0], -self._grid.ends[1]
            rise[:-1] -= z
            rise[1:] += z
            rise[:-1] -= 9 / 64 * h * (2 * p[:-1] + p[1:]) / 3
            rise[1:] -= 9 / 64 * h * (2 * p[1:] + p[:-1]) / 3
            rise[-1] -= 2 * self._grid.tail * p[-1]
            main, beside = np.zeros(len(p)), np.zeros(len(p))
            for part in (slice(None, -1), slice(1, None)):
                main[part] += 9 / 64 * h * 2 / 3 - curve / h
            main[-1] += 2 * self._grid.tail
            beside[1:] = 9 / 64 * h / 3 + curve / h
            step = solveh_banded(np.stack([beside, main]), rise)
            gain, share = float(rise @ step), 1.0
            while share > self._least:
                new = self._value(p + share * step, price)
                if new >= value + 1e-4 * share * gain:
                    break
                share *= 0.5
            else:
                break
            p, value = p + share * step, new
            if gain < ENOUGH * max(abs(value), 1e-300):
                self._ended = True
                break
        *_, pace = self._parts(p, price)
        return p, value, h * float(pace.sum())


def _slopes_of_hull(x: FloatArray, y: FloatArray) -> FloatArray:
    """Fall per length, at places, of the lower convex hull over them: the string drawn taut below a limit."""
    kept = [0]
    for k in range(1, len(x)):
        while len(kept) > 1:
            i, j = kept[-2:]
            if (y[j] - y[i]) * (x[k] - x[j]) < (y[k] - y[j]) * (x[j] - x[i]):
                break
            kept.pop()
        kept.append(k)
    fall = -np.diff(y[kept]) / np.diff(x[kept])
    return np.asarray(
        fall[np.minimum(np.searchsorted(np.asarray(kept)[1:], np.arange(len(x)), side="right"), len(fall) - 1)]
    )
