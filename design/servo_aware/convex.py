"""Linear and quadratic programmes with dense rows: by simplex methods the former, by least squares or an interior point the latter."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import casadi as ca
import numpy as np

from camwright.design.servo_aware.interior_point import interior_point
from camwright.design.servo_aware.least_distance import least_distance
from camwright.design.servo_aware.simplex import NoPoint, Vertex, dual_simplex
from camwright.profiles.errors import SolverError
from camwright.profiles.polynomial.profile import FloatArray

# Loaded now: a HiGHS that another library of the process brings along would else be taken for CasADi's own, which crashes.
ca.load_conic("highs")

ACCEPTED = 1e-6
"""What a row of an answer may be broken by where nothing else is said; rows are scaled so that their bounds are about one."""

_TOLERANCE = 1e-9

_HIGHS: dict[str, Any] = {
    "output_flag": False,
    "presolve": "off",
    "simplex_strategy": 4,
    "threads": 1,
    "parallel": "off",
    "primal_feasibility_tolerance": _TOLERANCE,
    "dual_feasibility_tolerance": _TOLERANCE,
    "simplex_iteration_limit": 10_000,  # ten times what a programme takes; where many vertices are equally good it has none of its own
}
# More rows than these are asked of our own methods first: linear programmes of the simplex method, quadratic ones of the
# interior-point one.
MANY, MANY_SQUARE = 500, 800
NAME = 5
"""Numbers of a name: kinds of rows are told apart by the first three; the last two are where a row is of its kind."""
# HiGHS' words for a programme without an answer.
_INFEASIBLE, _UNBOUNDED = "Infeasible", "Unbounded"
# Added to the diagonal of a quadratic cost, relative to its mean: directions that cost nothing are left where they are.
_STEADY = 1e-11
# A linear answer that breaks rows by rounding is refined: what is missing is solved for, with the room that is left magnified by at most
# this factor, so that the solver's tolerance shrinks by it.
_REFINEMENTS = 2
_GREATEST_FACTOR = 1e6
# Coefficients below this share of the largest of their row are rounding.
_ROUNDING = 1e-13


@dataclass
class ConvexProgramme:
    """Rows ``low <= matrix @ x <= high``, gathered one block after another.

    Parameters
    ----------
    unknowns
        Number of unknowns.
    vertex
        Optimum of a programme before with the same cost and some of these rows, from which a linear programme of many rows goes on; after
        `solve` that of this one.
    beside
        Optimum of a programme a little beside with rows called alike, near which this one's is expected where there is no vertex before.
    own
        Whether a linear programme of few rows, too, is asked of our own method, which leaves a vertex.
    """

    unknowns: int
    vertex: Vertex | None = None
    beside: Vertex | None = None
    own: bool = False
    _blocks: list[tuple[FloatArray, ...]] = field(default_factory=list)

    def add(
        self,
        matrix: FloatArray,
        low: FloatArray | float,
        high: FloatArray | float,
        accepted: float = ACCEPTED,
        *,
        names: FloatArray | None = None,
    ) -> None:
        """Add rows, and what an answer may break them by; a matrix of fewer columns leaves the last unknowns out.

        By their names, shape ``(rows, NAME)``, rows of another programme are known for being alike.
        """
        wide = np.zeros((len(matrix), self.unknowns))
        wide[:, : matrix.shape[1]] = matrix
        low, high, broken = (
            np.broadcast_to(np.asarray(each, dtype=np.float64), len(matrix)) for each in (low, high, accepted)
        )
        self._blocks.append((wide, low, high, broken, np.full((len(matrix), NAME), np.nan) if names is None else names))

    def add_peak(
        self,
        matrix: FloatArray,
        constant: FloatArray,
        below: FloatArray | float,
        above: FloatArray | float,
        accepted: float = ACCEPTED,
        *,
        names: FloatArray | None = None,
    ) -> None:
        """Add rows ``below * t <= matrix @ z + constant <= above * t`` with the last unknown ``t``."""
        low, high = (
            np.broadcast_to(np.asarray(side, dtype=np.float64), len(matrix))[:, None] for side in (below, above)
        )
        self.add(np.hstack([matrix, -high]), -np.inf, -constant, accepted, names=names)
        self.add(np.hstack([matrix, -low]), -constant, np.inf, accepted, names=names)

    def rows(self) -> Rows:
        """Stack what was gathered."""
        matrix = np.vstack([block[0] for block in self._blocks])
        matrix[np.abs(matrix) < _ROUNDING * np.abs(matrix).max(axis=1, keepdims=True)] = 0.0
        return Rows(matrix, *(np.concatenate([block[part] for block in self._blocks]) for part in (1, 2, 3)))

    def solve(self, cost: FloatArray, square: FloatArray | None = None) -> FloatArray | None:
        """Minimise ``cost @ x``, plus ``x @ square @ x / 2``.

        Parameters
        ----------
        cost, square
            Shapes ``(n,)`` and ``(n, n)``.

        Returns
        -------
        ndarray or None
            The minimiser; ``None`` if no point keeps the rows.

        Raises
        ------
        SolverError
            Every solver ended without an answer.
        """
        rows = self.rows()
        few = len(rows.matrix) <= (MANY if square is None else MANY_SQUARE) and not (self.own and square is None)
        if square is not None:
            return _quadratic(rows, cost, square, few=few)
        return _linear(rows, cost) if few else self._many_linear(rows, cost)

    def _many_linear(self, rows: Rows, cost: FloatArray) -> FloatArray | None:
        """Solve a linear programme of many rows from the vertex before; by the interior-point method where rounding forbids it."""
        matrix, bound = rows.one_sided
        names = np.concatenate([block[4] for block in self._blocks])
        above, below = np.isfinite(rows.high), np.isfinite(rows.low)
        sides = np.repeat([1.0, -1.0], [above.sum(), below.sum()])
        names = np.column_stack([sides, np.vstack([names[above], names[below]])])
        start = self.vertex
        if start is None and self.beside is not None:
            start = self.beside.among(matrix, bound, names)
        found = dual_simplex(matrix, bound, cost, start, names)
        if isinstance(found, NoPoint):
            return None
        self.vertex = found
        if found is not None and rows.missed(found.x) <= 0.0:
            return found.x
        answer = interior_point(rows.matrix, rows.low, rows.high, cost)
        return answer if answer is not None and rows.missed(answer) <= 0.0 else _linear(rows, cost)


@dataclass(frozen=True, eq=False)
class Rows:
    """Rows ``low <= matrix @ x <= high``.

    Parameters
    ----------
    matrix
        Shape ``(rows, n)``.
    low, high
        Shape ``(rows,)``; infinite sides are no rows.
    accepted
        What an answer may break each by.
    """

    matrix: FloatArray
    low: FloatArray
    high: FloatArray
    accepted: FloatArray

    @property
    def one_sided(self) -> tuple[FloatArray, FloatArray]:
        """The rows as ``matrix @ x <= bound``."""
        above, below = np.isfinite(self.high), np.isfinite(self.low)
        return np.vstack([self.matrix[above], -self.matrix[below]]), np.concatenate(
            [self.high[above], -self.low[below]]
        )

    def missed(self, found: FloatArray) -> float:
        """By how much an answer breaks rows beyond what is accepted; 0 or less where it keeps them all."""
        values = self.matrix @ found
        return float((np.maximum(values - self.high, self.low - values) - self.accepted).max())


def _linear(rows: Rows, cost: FloatArray) -> FloatArray | None:
    """Solve a linear programme; its answer is refined where it breaks rows by rounding."""
    status = ""
    for road in (_by_its_dual, _by_our_own):
        found, factor = np.zeros(len(cost)), 1.0
        for _ in range(1 + _REFINEMENTS):
            low, high = (factor * (side - rows.matrix @ found) for side in (rows.low, rows.high))
            step, status = road(rows.matrix, low, high, cost)
            if step is None:
                break
            found = found + step / factor
            missed = rows.missed(found)
            if missed <= 0.0:
                return found
            factor = min(_GREATEST_FACTOR, 1.0 / missed)
        if factor == 1.0 and status == _INFEASIBLE:
            return None
    raise SolverError(f"HiGHS ended a servo-aware design with {status!r}; report this job")


def _by_its_dual(
    matrix: FloatArray, low: FloatArray, high: FloatArray, cost: FloatArray
) -> tuple[FloatArray | None, str]:
    """Ask HiGHS for the dual, whose basis is as small as the unknowns are few; its multipliers are the answer.

    By its primal simplex: the dual one takes seconds to minutes to tell that such a programme has no bound.
    """
    above, below = np.isfinite(high), np.isfinite(low)
    columns = sparse(np.vstack([-matrix[above], matrix[below]]).T)
    prices = np.concatenate([high[above], -low[below]])
    form = {"h": ca.Sparsity(len(prices), len(prices)), "a": columns.sparsity()}
    solver = ca.conic("camwright", "highs", form, {"highs": _HIGHS, "error_on_fail": False})
    answer = solver(g=prices, a=columns, lba=cost, uba=cost, lbx=0.0, ubx=np.inf)
    statistics = solver.stats()
    status = str(statistics.get("solver_stats", statistics).get("return_status", ""))
    if not statistics["success"]:  # no answer of a programme is too much of its dual, and the other way round
        return None, {_UNBOUNDED: _INFEASIBLE, _INFEASIBLE: _UNBOUNDED}.get(status, status)
    return np.asarray(answer["lam_a"], dtype=np.float64).ravel(), status


def _by_our_own(
    matrix: FloatArray, low: FloatArray, high: FloatArray, cost: FloatArray
) -> tuple[FloatArray | None, str]:
    """Ask our own simplex method, which does not go round among vertices that are equally good."""
    found = dual_simplex(*Rows(matrix, low, high, np.zeros(len(low))).one_sided, cost)
    if isinstance(found, NoPoint):
        return None, _INFEASIBLE
    return (None, _UNBOUNDED) if found is None else (found.x, "")


def _quadratic(rows: Rows, cost: FloatArray, square: FloatArray, *, few: bool) -> FloatArray | None:
    """Solve a quadratic programme by least squares, one of many rows by an interior point; by the other where rounding forbids that."""

    def nearest() -> FloatArray | None:
        return least_distance(_definite(square), cost, rows.matrix, rows.low, rows.high)

    def within() -> FloatArray | None:
        return interior_point(rows.matrix, rows.low, rows.high, cost, square)

    for number, road in enumerate((nearest, within) if few else (within, nearest)):
        found = road()
        if found is not None and rows.missed(found) <= 0.0:
            return found
        if not number and isinstance(dual_simplex(*rows.one_sided, np.zeros(len(cost))), NoPoint):
            return None
    raise SolverError(
        "neither least squares nor an interior point ended a servo-aware design with an answer; report this job"
    )


def _definite(square: FloatArray) -> FloatArray:
    """Make directions that cost nothing cost a little."""
    found: FloatArray = square + _STEADY * np.trace(square) / len(square) * np.eye(len(square))
    return found


def sparse(matrix: FloatArray) -> ca.DM:
    """Hand a matrix to CasADi without its zeros: in a fraction of the time that all its numbers would take."""
    columns, rows = np.nonzero(matrix.T)
    starts = np.searchsorted(columns, np.arange(matrix.shape[1] + 1))
    pattern = ca.Sparsity(matrix.shape[0], matrix.shape[1], starts.tolist(), rows.tolist())
    return ca.DM(pattern, matrix.T[columns, rows])
