"""Linear and convex quadratic programmes with many dense rows: a primal-dual interior-point method.

Mehrotra, *On the implementation of a primal-dual interior point method* (SIAM J. Optim. 2, 1992). Each step costs one Gram matrix of the
rows, so thousands of rows over a hundred unknowns take some 25 steps of a few milliseconds; an active-set method visits more vertices the
more rows there are.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from camwright.profiles.polynomial.profile import FloatArray

# Accuracy of the rows, and of the cost: of its gap to the prices' and of its last change, relative to it, or to `_LEAST` where it is less.
_ACCURATE = 1e-9
_LEAST = 1e-5
_MOST_STEPS = 60
# A gap that has grown to so many times its least grows without end: no point keeps the rows.
_LOST = 1e4
# Share of the way to the edge that a step goes.
_SHORT = 0.995
# Rows of a block: products so small that the linear algebra library takes no threads for them, which cost more than
# they bring, the more so where other processes work.
_BLOCK = 24
# Added to the diagonal of the scaled Gram matrix.
_STEADY = 1e-14


@dataclass(frozen=True, eq=False)
class _Sides:
    """Sides of rows: ``matrix[above] @ x <= bound``, then ``-matrix[below] @ x <= bound``; the matrix is padded to whole blocks."""

    matrix: FloatArray
    above: NDArray[np.intp]
    below: NDArray[np.intp]
    bound: FloatArray

    @cached_property
    def blocks(self) -> FloatArray:
        """The matrix in blocks of rows."""
        return self.matrix.reshape(-1, _BLOCK, self.matrix.shape[1])

    def of(self, x: FloatArray) -> FloatArray:
        """Values of the sides."""
        found: FloatArray = np.matmul(self.blocks, x).ravel()
        return np.concatenate([found[self.above], -found[self.below]])

    def pull(self, prices: FloatArray) -> FloatArray:
        """Sum the sides by their prices."""
        found: FloatArray = np.matmul(self._both(prices, -1.0).reshape(-1, 1, _BLOCK), self.blocks).sum(axis=0)[0]
        return found

    def gram(self, weights: FloatArray) -> FloatArray:
        """Sum the squares of the sides by weights: both sides of a row at once."""
        turned = self.blocks.transpose(0, 2, 1) * self._both(weights, 1.0).reshape(-1, 1, _BLOCK)
        found: FloatArray = np.matmul(turned, self.blocks).sum(axis=0)
        return found

    def _both(self, values: FloatArray, sign: float) -> FloatArray:
        """Put what the sides have together by row, those below times a sign."""
        found = np.zeros(len(self.matrix))
        found[self.above] = values[: len(self.above)]
        found[self.below] += sign * values[len(self.above) :]
        return found


@dataclass(frozen=True, eq=False)
class _Point:
    """Unknowns, room that they leave in every row, and the prices of the rows; or a step of all three."""

    x: FloatArray
    room: FloatArray
    price: FloatArray


def interior_point(
    matrix: FloatArray, low: FloatArray, high: FloatArray, cost: FloatArray, square: FloatArray | None = None
) -> FloatArray | None:
    """Minimise ``cost @ x``, plus ``x @ square @ x / 2``, where ``low <= matrix @ x <= high``.

    Parameters
    ----------
    matrix, low, high
        Shapes ``(rows, n)`` and ``(rows,)``, scaled so that bounds are about one; infinite sides are no rows.
    cost, square
        Shapes ``(n,)`` and ``(n, n)``, positive semidefinite.

    Returns
    -------
    ndarray or None
        The minimiser, rows kept to 1e-9 and the cost to 1e-9 of itself; ``None`` where it does not come so far, as where no point
        keeps the rows.
    """
    count = len(cost)
    curved = np.zeros((count, count)) if square is None else square
    sides = _sides(matrix, low, high)
    at = _Point(np.zeros(count), np.maximum(sides.bound, 1.0), np.ones(len(sides.bound)))
    before = least = np.inf
    for _ in range(_MOST_STEPS):
        over = sides.of(at.x) + at.room - sides.bound
        gradient = cost + curved @ at.x + sides.pull(at.price)
        middle = float(at.room @ at.price) / len(at.room)
        value = float(cost @ at.x) + 0.5 * float(at.x @ curved @ at.x)
        gap = middle * len(at.room)
        # the prices' rounding keeps the gradient from vanishing where rows are nearly parallel, long after the cost has come to rest
        small = _ACCURATE * max(abs(value), _LEAST)
        if gap < small and abs(value - before) < small and np.abs(over).max() < _ACCURATE:
            return at.x
        before, least = value, min(gap, least)
        if not gap < _LOST * least:
            return None
        moved = _moved(sides, curved, at, over, gradient, middle)
        if moved is None:
            return None
        at = moved
    return None


def _sides(matrix: FloatArray, low: FloatArray, high: FloatArray) -> _Sides:
    """Find the finite sides of rows; rows of zeros fill up the last block."""
    rows = np.zeros((-(-len(matrix) // _BLOCK) * _BLOCK, matrix.shape[1]))
    rows[: len(matrix)] = matrix
    above, below = np.nonzero(np.isfinite(high))[0], np.nonzero(np.isfinite(low))[0]
    return _Sides(rows, above, below, np.concatenate([high[above], -low[below]]))


def _moved(
    sides: _Sides, curved: FloatArray, at: _Point, over: FloatArray, gradient: FloatArray, middle: float
) -> _Point | None:
    """Take a step: towards the optimum as if nothing were curved, then with what that step tells; ``None`` where rounding forbids it."""
    from scipy.linalg import cho_factor, cho_solve

    system = sides.gram(at.price / at.room) + curved
    scale = 1.0 / np.sqrt(np.maximum(system.diagonal(), 1e-300))
    try:
        factor = cho_factor(system * scale * scale[:, None] + _STEADY * np.eye(len(scale)))
    except np.linalg.LinAlgError:
        return None

    def step(target: FloatArray) -> _Point:
        """Solve for products of room and price that change by so much."""
        pull = -gradient - sides.pull((target + at.price * over) / at.room)
        x = scale * cho_solve(factor, scale * pull)
        x = x + scale * cho_solve(factor, scale * (pull - system @ x))  # refined once
        room = -over - sides.of(x)
        return _Point(x, room, (target - at.price * room) / at.room)

    straight = step(-at.room * at.price)
    far = _far(at.room, straight.room), _far(at.price, straight.price)
    reached = float((at.room + far[0] * straight.room) @ (at.price + far[1] * straight.price)) / len(at.room)
    centre = (reached / middle) ** 3 * middle
    ahead = step(centre - at.room * at.price - straight.room * straight.price)
    room_far, price_far = _far(at.room, ahead.room), _far(at.price, ahead.price)
    if curved.any():
        room_far = price_far = min(room_far, price_far)
    room_far, price_far = _SHORT * room_far, _SHORT * price_far
    return _Point(at.x + room_far * ahead.x, at.room + room_far * ahead.room, at.price + price_far * ahead.price)


def _far(value: FloatArray, step: FloatArray) -> float:
    """How far a step can go with all values above zero, at most once."""
    down = step < -value  # what falls by less than all of itself bounds no whole step
    return min(1.0, float((-value[down] / step[down]).min(initial=np.inf)))
