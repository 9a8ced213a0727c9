"""Linear programmes with many dense rows over few unknowns: a dual simplex method that goes on from the vertex of the programme before.

A vertex is where as many rows bind as there are unknowns. When rows are added, the old vertex stays optimal for the old ones, so only the
new rows that it breaks have to be exchanged in: some tens of exchanges where a programme from nothing takes a thousand (Lemke, *The dual
method of solving the linear programming problem*, Naval Res. Logist. Q. 1, 1954). Of a programme without a point it ends with the proof:
rows whose sum contradicts another.

It may begin at a vertex that is only near to the optimum, of a programme a little beside: prices below zero are lifted by another cost, and
when no row is broken any more the primal method takes the true one down.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from camwright.profiles.polynomial.profile import FloatArray

# Rows are kept to this; bounds are about one.
_ACCURATE = 1e-9
# A programme from nothing begins in the corner of a box so wide, where no answer of use lies.
_BOX = 1e3
# Costs are shifted by about this share of the greatest, by a different one each: where many vertices are equally good a method of vertices
# might go round among them for ever. The answer's cost is off by less than that share of the greatest unknown.
_SHIFT = 1e-8
_GOLDEN = 0.6180339887498949
# Rows that are looked at in a pass, and how many of them are those that are broken most.
_PASS, _WORST = 200, 60
# Exchanges after which the inverse is made anew, and at most in all.
_FRESH, _MOST = 100, 20_000
# Exchanges of the primal method at most: where it takes more the vertex was not near.
_MOST_PRIMAL = 500
# Shares of a row below this of its greatest are rounding; prices may fall below zero by so much for the sake of a greater share.
_SMALL, _SLACK = 1e-9, 1e-10


@dataclass(frozen=True, eq=False)
class Vertex:
    """Optimum of a linear programme.

    Parameters
    ----------
    x
        The unknowns, shape ``(n,)``.
    matrix, bound
        Rows ``matrix @ x <= bound`` that bind there, shapes ``(n, n)`` and ``(n,)``.
    names
        What each of them is called, shape ``(n, k)``; nothing where nobody said.
    """

    x: FloatArray
    matrix: FloatArray
    bound: FloatArray
    names: FloatArray | None = None

    def among(self, matrix: FloatArray, bound: FloatArray, names: FloatArray) -> Vertex | None:
        """Find rows called alike among those of a programme a little beside, the last two numbers of a name as near as may be.

        They need not be its optimum, nor keep its rows. ``None`` where some of them have no like there.
        """
        if self.names is None or self.matrix.shape[1] != matrix.shape[1]:
            return None
        alike: dict[bytes, list[int]] = {}
        for number, name in enumerate(names):
            alike.setdefault(name[:-2].tobytes(), []).append(number)
        chosen: list[int] = []
        for name in self.names:
            left = alike.get(name[:-2].tobytes())
            if not left:
                return None
            chosen.append(left.pop(int(np.abs(names[left][:, -2:] - name[-2:]).sum(axis=1).argmin())))
        return Vertex(self.x, matrix[chosen], bound[chosen], names[chosen])


@dataclass(frozen=True)
class NoPoint:
    """No point keeps the rows: all would have to be widened by ``least`` at least to leave one."""

    least: float


def dual_simplex(
    matrix: FloatArray,
    bound: FloatArray,
    cost: FloatArray,
    start: Vertex | None = None,
    names: FloatArray | None = None,
) -> Vertex | NoPoint | None:
    """Minimise ``cost @ x`` where ``matrix @ x <= bound``.

    Parameters
    ----------
    matrix, bound
        Shapes ``(rows, n)`` and ``(rows,)``, scaled so that bounds are about one.
    cost
        Shape ``(n,)``.
    start
        Optimum of the same programme with some of these rows, or a vertex of some of them that is near to the optimum.
    names
        What the rows are called, shape ``(rows, k)``.

    Returns
    -------
    Vertex, NoPoint or None
        ``None`` where rounding or the number of exchanges leaves no answer, or the answer has no bound.
    """
    shifted = cost + _SHIFT * (np.abs(cost).max() or 1.0) * (0.5 + (_GOLDEN * np.arange(len(cost))) % 1.0)
    first = start if start is not None else _corner(shifted)
    try:
        state = _State(np.vstack([first.matrix, matrix]), np.concatenate([first.bound, bound]), shifted)
        proof = state.run() if state.price.min() >= -_ACCURATE else state.run_beside(shifted)
    except np.linalg.LinAlgError:
        return None if start is None else dual_simplex(matrix, bound, cost, names=names)
    if proof is not None:
        return proof if proof.least > 0.0 else None
    active = state.active
    if start is None and active.min() < len(cost):
        return None  # the box binds
    if names is not None:
        before = np.full((len(cost), names.shape[1]), np.nan) if first.names is None else first.names
        names = np.vstack([before, names])[active]
    return Vertex(state.x, state.of.matrix[active], state.of.bound[active], names)


def _corner(cost: FloatArray) -> Vertex:
    """Give the best corner of the box."""
    sign = np.where(cost >= 0.0, -1.0, 1.0)
    return Vertex(sign * _BOX, np.diag(sign), np.full(len(cost), _BOX))


@dataclass(frozen=True, eq=False)
class _Programme:
    """Rows ``matrix @ x <= bound``, their lengths, and the cost."""

    matrix: FloatArray
    bound: FloatArray
    size: FloatArray
    cost: FloatArray


class _State:
    """A vertex on the way: rows that bind there, the inverse of their matrix, their prices."""

    def __init__(self, matrix: FloatArray, bound: FloatArray, cost: FloatArray) -> None:
        self.of = _Programme(matrix, bound, np.maximum(np.linalg.norm(matrix, axis=1), 1e-300), cost)
        self.active: NDArray[np.intp] = np.arange(len(cost))
        self._since = 0
        self._renew()

    def _renew(self) -> None:
        """Make the inverse anew, and of it the point and the prices."""
        held, bound = self.of.matrix[self.active], self.of.bound[self.active]
        self._inverse = np.linalg.inv(held)
        x = self._inverse @ bound
        self.x = x + self._inverse @ (bound - held @ x)
        self.price = -(self.of.cost @ self._inverse)
        self._since = 0

    def run(self) -> NoPoint | None:
        """Exchange rows until none is broken; of rows that leave no point give the proof, not positive where it is none.

        Raises
        ------
        numpy.linalg.LinAlgError
            Rows that bind are parallel by rounding, or there were too many exchanges.
        """
        most = _MOST
        while most > 0:
            broken = self.of.matrix @ self.x - self.of.bound
            broken[self.active] = 0.0
            share = broken / self.of.size
            rows = np.nonzero(broken > _ACCURATE)[0]
            if not len(rows):
                if not self._since:
                    return None
                self._renew()
                continue
            if len(rows) > _WORST:
                rows = rows[np.argpartition(-share[rows], _WORST)[:_WORST]]
            rows = np.union1d(rows, np.linspace(0, len(broken) - 1, _PASS).astype(np.intp))
            since = self._since
            proof = self._among(rows, broken[rows])
            if proof is not None:
                return proof
            most -= max(1, self._since - since)
            if self._since >= _FRESH:
                self._renew()
        raise np.linalg.LinAlgError("too many exchanges")

    def run_beside(self, cost: FloatArray) -> NoPoint | None:
        """Exchange rows as `run` from a vertex with prices below zero, then those with such prices of the true cost.

        Raises
        ------
        numpy.linalg.LinAlgError
            As `run`, or the answer has no bound.
        """
        held = self.of.matrix[self.active]
        least = _SHIFT * float(np.abs(cost).max() or 1.0)
        self.of = replace(self.of, cost=-(np.maximum(self.price, least) @ held))
        self._renew()
        proof = self.run()
        if proof is not None:
            return proof
        self.of = replace(self.of, cost=cost)
        self._renew()
        for number in range(_MOST_PRIMAL):
            out = int(self.price.argmin())
            if self.price[out] >= -_ACCURATE:
                return self.run()
            way = -self._inverse[:, out]
            rising = self.of.matrix @ way
            room = np.maximum(self.of.bound - self.of.matrix @ self.x, 0.0)
            rising[self.active] = 0.0
            ahead = np.nonzero(rising > _SMALL * np.abs(rising).max())[0]
            if not len(ahead):
                break
            steps = room[ahead] / rising[ahead]
            near = ahead[steps <= ((room[ahead] + _ACCURATE) / rising[ahead]).min()]
            self.active[out] = near[rising[near].argmax()]
            if number % _FRESH == _FRESH - 1:
                self._renew()
            else:
                self._exchange(out)
        raise np.linalg.LinAlgError("the vertex was not near")

    def _exchange(self, out: int) -> None:
        """Bring inverse, point and prices up to date after one of the rows that bind was exchanged."""
        shares = self.of.matrix[self.active[out]] @ self._inverse
        column = self._inverse[:, out] / shares[out]
        shares[out] -= 1.0
        self._inverse = self._inverse - np.outer(column, shares)
        self.x = self._inverse @ self.of.bound[self.active]
        self.price = -(self.of.cost @ self._inverse)
        self._since += 1

    def _among(self, rows: NDArray[np.intp], broken: FloatArray) -> NoPoint | None:
        """Exchange some rows among those given: that which is broken most for how far the prices have to move for it.

        Goldfarb and Forrest, *Steepest-edge simplex algorithms for linear programming* (Math. Programming 57, 1992).
        """
        from scipy.linalg.blas import dger

        count = len(rows)
        # the rows as sums of those that bind, and the inverse below them, so that an exchange is one product for both
        table = np.concatenate([self.of.matrix[rows] @ self._inverse, self._inverse])
        squares = np.einsum("ij,ij->i", table[:count], table[:count])
        for _ in range(_FRESH):
            worst = int((broken * np.abs(broken) / (1.0 + squares)).argmax())
            if broken[worst] <= _ACCURATE:
                break
            shares = table[worst].copy()
            rising = np.nonzero(shares > _SMALL * np.abs(shares).max())[0]
            if not len(rising):
                if self._since:  # looked at again without rounding
                    self._renew()
                    return None
                return NoPoint(self._least(int(rows[worst]), shares))
            prices, each = np.maximum(self.price[rising], 0.0), shares[rising]
            near = prices / each <= ((prices + _SLACK) / each).min()
            out = int(rising[near][each[near].argmax()])
            column = table[:, out] / shares[out]
            step = float(broken[worst])
            aside = column[:count]
            grown = aside * (aside * (float(shares @ shares) + 1.0) - 2.0 * (table[:count] @ shares))
            squares = np.maximum(squares + grown, aside * aside)
            # in place: what is made anew each time costs ten times as much
            dger(-1.0, shares, column, a=table.T, overwrite_a=1)
            table[:, out] = column
            broken = broken - step * aside
            broken[worst], squares[worst] = 0.0, 1.0
            self.x = self.x - step * column[count:]
            price = max(float(self.price[out]), 0.0) / shares[out]
            self.price = self.price - price * shares
            self.price[out] = price
            self.active[out] = rows[worst]
            self._since += 1
        self._inverse = table[count:]
        return None

    def _least(self, row: int, shares: FloatArray) -> float:
        """By how much rows contradict each other, one being a sum of those that bind, whatever rounding left of that sum; in the box.

        The sum is made of the rows themselves: their inverse may be all rounding, where they are nearly parallel.
        """
        of, falling = self.of, np.minimum(shares, 0.0)
        off = of.matrix[row] - falling @ of.matrix[self.active]
        broken = float(falling @ of.bound[self.active]) - float(of.bound[row]) - _BOX * float(np.abs(off).sum())
        return broken / (1.0 - float(falling.sum())) - _ACCURATE
