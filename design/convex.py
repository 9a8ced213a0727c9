"""Linear and quadratic programmes with dense rows: HiGHS and qpOASES, both through CasADi, with IPOPT behind them."""

from __future__ import annotations

import contextlib
import io
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import casadi as ca
import numpy as np

from design.ipopt import QUIET
from profiles.errors import SolverError
from profiles.polynomial import FloatArray

# Loaded now: a HiGHS that another library of the process brings along would else be taken for CasADi's own, which crashes.
ca.load_conic("highs")

ACCEPTED = 1e-6
"""What a row of an answer may be broken by where nothing else is said; rows are scaled so that their bounds are about one."""

_TOLERANCE = 1e-9

_HIGHS: dict[str, Any] = {
    "output_flag": False,
    "threads": 1,
    "parallel": "off",
    "primal_feasibility_tolerance": _TOLERANCE,
    "dual_feasibility_tolerance": _TOLERANCE,
}
# Roads to the vertex, tried in turn: where one ends with rows broken by rounding, another need not.
_HIGHS_ROADS: tuple[dict[str, Any], ...] = ({}, {"presolve": "off"}, {"simplex_strategy": 4})
_QPOASES: dict[str, Any] = {
    "printLevel": "none",
    "sparse": False,
    "hessian_type": "posdef",
    "initialStatusBounds": "inactive",
}
_IPOPT: dict[str, Any] = {
    "nlpsol": "ipopt",
    "nlpsol_options": QUIET
    | {
        "error_on_fail": False,
        "ipopt.mu_strategy": "adaptive",
        "ipopt.tol": 1e-9,
        "ipopt.constr_viol_tol": _TOLERANCE,
        "ipopt.bound_relax_factor": 0.0,
        "ipopt.max_iter": 300,
        "ipopt.jac_d_constant": "yes",
        "ipopt.hessian_constant": "yes",
    },
}
_NAMES = {"highs": "HiGHS", "qpoases": "qpOASES", "nlpsol": "IPOPT"}
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
    """

    unknowns: int
    _matrices: list[FloatArray] = field(default_factory=list)
    _low: list[FloatArray] = field(default_factory=list)
    _high: list[FloatArray] = field(default_factory=list)
    _accepted: list[FloatArray] = field(default_factory=list)

    def add(
        self, matrix: FloatArray, low: FloatArray | float, high: FloatArray | float, accepted: float = ACCEPTED
    ) -> None:
        """Add rows, and what an answer may break them by; a matrix of fewer columns leaves the last unknowns out."""
        wide = np.zeros((len(matrix), self.unknowns))
        wide[:, : matrix.shape[1]] = matrix
        self._matrices.append(wide)
        self._low.append(np.broadcast_to(np.asarray(low, dtype=np.float64), len(matrix)))
        self._high.append(np.broadcast_to(np.asarray(high, dtype=np.float64), len(matrix)))
        self._accepted.append(np.full(len(matrix), accepted))

    def add_peak(
        self,
        matrix: FloatArray,
        constant: FloatArray,
        below: FloatArray | float,
        above: FloatArray | float,
        accepted: float = ACCEPTED,
    ) -> None:
        """Add rows ``below * t <= matrix @ z + constant <= above * t`` with the last unknown ``t``."""
        low, high = (
            np.broadcast_to(np.asarray(side, dtype=np.float64), len(matrix))[:, None] for side in (below, above)
        )
        self.add(np.hstack([matrix, -high]), -np.inf, -constant, accepted)
        self.add(np.hstack([matrix, -low]), -constant, np.inf, accepted)

    def solve(self, cost: FloatArray, square: FloatArray | None = None, *, sure: bool = True) -> FloatArray | None:
        """Minimise ``cost @ x``, plus ``x @ square @ x / 2``.

        Parameters
        ----------
        cost, square
            Shapes ``(n,)`` and ``(n, n)``.
        sure
            Whether IPOPT, a hundred times slower, is asked where qpOASES fails.

        Returns
        -------
        ndarray or None
            The minimiser; ``None`` if no point keeps the rows.

        Raises
        ------
        SolverError
            Every solver ended without an answer.
        """
        matrix = np.vstack(self._matrices)
        matrix[np.abs(matrix) < _ROUNDING * np.abs(matrix).max(axis=1, keepdims=True)] = 0.0
        low, high, accepted = (np.concatenate(parts) for parts in (self._low, self._high, self._accepted))
        if square is None:
            rows, quadratic = ca.sparsify(ca.DM(matrix)), ca.DM(self.unknowns, self.unknowns)
            roads = [("highs", {"highs": _HIGHS | road}) for road in _HIGHS_ROADS]
        else:
            steady = _STEADY * np.trace(square) / self.unknowns * np.eye(self.unknowns)
            rows, quadratic = ca.DM(matrix), ca.DM(square + steady)
            roads = [("qpoases", _QPOASES), ("nlpsol", _IPOPT)][: 1 + sure]
        form = {"h": quadratic.sparsity(), "a": rows.sparsity()}
        for plugin, options in roads:
            found, factor = np.zeros(self.unknowns), 1.0
            for _ in range(1 + (square is None) * _REFINEMENTS):
                with _silenced():
                    solver = ca.conic("camwright", plugin, form, options | {"error_on_fail": False})
                    shifted = [factor * (side - matrix @ found) for side in (low, high)]
                    answer = solver(
                        h=quadratic, g=cost, a=rows, lba=shifted[0], uba=shifted[1], lbx=-np.inf, ubx=np.inf
                    )
                statistics = solver.stats()
                status = str(statistics.get("solver_stats", statistics).get("return_status", ""))
                if not statistics["success"]:
                    break
                found = found + np.asarray(answer["x"], dtype=np.float64).ravel() / factor
                missed = _missed(matrix @ found, low, high, accepted)
                if missed <= 0.0:
                    return found
                factor = min(_GREATEST_FACTOR, 1.0 / missed)
            if square is None and factor == 1.0 and "infeasible" in status.lower():
                return None
            if square is not None and self.solve(np.zeros(self.unknowns)) is None:  # HiGHS tells sooner than IPOPT
                return None
        raise SolverError(f"{_NAMES[plugin]} ended a servo-aware design with {status!r}; report this job")


def _missed(values: FloatArray, low: FloatArray, high: FloatArray, accepted: FloatArray) -> float:
    """By how much the rows are broken beyond what is accepted; 0 or less where all are kept."""
    return float(np.maximum(values - high - accepted, low - accepted - values).max())


@contextlib.contextmanager
def _silenced() -> Iterator[None]:
    """Keep qpOASES' banner, which no option of it turns off, from standard output."""
    with contextlib.redirect_stdout(io.StringIO()):
        yield
