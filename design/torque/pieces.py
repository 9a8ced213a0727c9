"""Programmes made of pieces: one function of few unknowns, at many places, whose derivatives are worked out once and put together.

A programme over a mesh is the same small function at every interval and point. Differentiated as a whole its Hessian is found by colours,
each of which goes through all places again; here the small function's own Hessian, all in one with what its parts share, is evaluated at
every place and added where its unknowns lie. An iteration then takes half the time.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from camwright.design.torque.columns import Steps
from camwright.profiles.polynomial.profile import FloatArray

NONE = ca.SX(0, 1)
"""A column of nothing."""
Places = NDArray[np.intp]
"""Where something lies, a column for each place."""


@dataclass(frozen=True, eq=False)
class ProgrammePiece:
    """What is the same at many places, in scalar symbols (`casadi.SX`), each a column.

    Parameters
    ----------
    unknowns, given
        Unknowns that it is made of, and numbers that differ from place to place or from one solution to the next.
    cost
        What it adds to the objective.
    equal, above
        What must be zero, and what must not be negative.
    between, made
        Symbols in which cost and constraints are stated besides, and what the unknowns make of them; none where there are none.
    about, settled
        Symbols of the place about which cost and constraints are stated as they are to the second order, and what these are, in what lies
        between: derivatives look at them as at constants.
    """

    unknowns: Any
    given: Any
    cost: Any
    equal: Any
    above: Any
    between: Any = NONE
    made: Any = NONE
    about: Any = NONE
    settled: Any = NONE

    @property
    def rows(self) -> Any:
        """Constraints, equations first."""
        return ca.vertcat(self.equal, self.above)

    def _plain(self, *parts: Any) -> list[Any]:
        """Say all in the unknowns alone, what is the same once."""
        settled = ca.substitute(list(parts), [self.about], [self.settled])
        return list(ca.cse(ca.substitute(settled, [self.between], [self.made])))

    @cached_property
    def chain(self) -> Any:
        """Derivatives of the unknowns and of what lies between by the unknowns."""
        return ca.vertcat(ca.SX.eye(self.unknowns.numel()), ca.jacobian(self.made, self.unknowns))

    @cached_property
    def value(self) -> Steps:
        """Function of unknowns and what is given: cost and rows."""
        return Steps([self.unknowns, self.given], self._plain(self.cost, self.rows))

    @cached_property
    def slope(self) -> Steps:
        """Function that has the cost and its gradient."""
        slope = self.chain.T @ ca.gradient(self.cost, ca.vertcat(self.unknowns, self.between))
        return Steps([self.unknowns, self.given], self._plain(self.cost, ca.densify(slope)))

    @cached_property
    def bend(self) -> tuple[Steps, Any]:
        """Function that has the rows and what their Jacobian holds, and its pattern."""
        bend = ca.jacobian(self.rows, ca.vertcat(self.unknowns, self.between)) @ self.chain
        return Steps([self.unknowns, self.given], self._plain(self.rows, _held(bend))), bend.sparsity()

    @cached_property
    def curve(self) -> tuple[Steps, Any]:
        """Function that has what the upper triangle of the Lagrangian's Hessian holds, of multipliers too, and its pattern.

        By the chain rule through what lies between: half of the work of differentiating it as a whole.
        """
        of_cost, of_rows = ca.SX.sym("of_cost"), ca.SX.sym("of_rows", self.rows.numel())
        lagrangian, count = of_cost * self.cost + ca.dot(of_rows, self.rows), self.unknowns.numel()
        whole, slope = ca.hessian(lagrangian, ca.vertcat(self.unknowns, self.between))
        paid = ca.SX.sym("paid", self.made.numel())
        own, _ = ca.hessian(ca.dot(paid, self.made), self.unknowns)
        bend = self.chain.T @ whole @ self.chain + ca.substitute(own, paid, slope[count:])
        upper: Any = ca.triu(bend)
        held = self._plain(_held(upper))
        return Steps([self.unknowns, self.given, of_cost, of_rows], held), upper.sparsity()


@dataclass(frozen=True, eq=False)
class Laid:
    """A piece and where it lies.

    Parameters
    ----------
    piece
        What is the same at all places.
    unknowns, given
        Where its unknowns lie among the programme's, none twice at a place, and its numbers among the programme's parameters.
    """

    piece: ProgrammePiece
    unknowns: Places
    given: Places

    @property
    def count(self) -> int:
        """Number of places."""
        return int(self.unknowns.shape[1])

    @property
    def lower(self) -> FloatArray:
        """Least values of its rows: zero."""
        return np.zeros(self.piece.rows.numel() * self.count)

    @property
    def upper(self) -> FloatArray:
        """Greatest values of its rows: zero, or none."""
        each = np.repeat([0.0, np.inf], [self.piece.equal.numel(), self.piece.above.numel()])
        return np.tile(each, self.count)

    def gathered(self, x: Any, p: Any) -> list[list[Any]]:
        """Unknowns and numbers of the piece, each a column of a number for each place, or the one that is the same at all."""
        return [
            [of[[int(row[0])] if (row == row[0]).all() else row.tolist()] for row in where]
            for of, where in ((x, self.unknowns), (p, self.given))
        ]


def programme(laid: list[Laid], unknowns: int, parameters: int) -> tuple[dict[str, Any], dict[str, Any]]:
    """Put pieces together: the programme as `casadi.nlpsol` takes it, and its derivatives as options.

    Rows lie piece by piece, and place by place within.
    """
    x, p = ca.MX.sym("x", unknowns), ca.MX.sym("p", parameters)
    first_row = np.concatenate([[0], np.cumsum([len(each.lower) for each in laid])])
    rows = int(first_row[-1])
    of_cost, of_rows = ca.MX.sym("lam_f"), ca.MX.sym("lam_g", rows)
    costs, costs_too, values, values_too, slopes, bends, curves = ([] for _ in range(7))
    slope_at, bend_at, curve_at = [], [], []
    for each, begin, end in zip(laid, first_row[:-1], first_row[1:], strict=True):
        count, height, own = each.count, each.piece.rows.numel(), each.gathered(x, p)
        (cost,), value = each.piece.value.at(count, own)
        costs.append(ca.sum1(cost))
        values.append(_by_place(value))
        (cost,), slope = each.piece.slope.at(count, own)
        costs_too.append(ca.sum1(cost))
        slopes += slope
        slope_at.append(each.unknowns.ravel())
        steps, pattern = each.piece.bend
        value, bend = steps.at(count, own)
        values_too.append(_by_place(value))
        bends += bend
        row, column = (np.array(part, dtype=np.intp)[:, None] for part in pattern.get_triplet())
        row = begin + height * np.arange(count)[None, :] + row
        bend_at.append((row + rows * each.unknowns[column[:, 0]]).ravel())
        steps, pattern = each.piece.curve
        multipliers = [of_rows[int(begin) + k : int(end) : height] for k in range(height)]
        (curve,) = steps.at(count, [*own, [of_cost], multipliers])
        curves += curve
        one, other = (each.unknowns[list(part)] for part in pattern.get_triplet())
        curve_at.append((np.minimum(one, other) + unknowns * np.maximum(one, other)).ravel())
    f, g = sum(costs), ca.vertcat(*values)
    slope = _added(slopes, slope_at, unknowns, 1)
    bend = _added(bends, bend_at, rows, unknowns)
    curve = _added(curves, curve_at, unknowns, unknowns)
    names = ["x", "p"]
    return {"x": x, "p": p, "f": f, "g": g}, {
        "grad_f": ca.Function("grad_f", [x, p], [sum(costs_too), ca.densify(slope)], names, ["f", "grad_f_x"]),
        "jac_g": ca.Function("jac_g", [x, p], [ca.vertcat(*values_too), bend], names, ["g", "jac_g_x"]),
        "hess_lag": ca.Function(
            "hess_lag", [x, p, of_cost, of_rows], [curve], [*names, "lam_f", "lam_g"], ["triu_hess_gamma_x_x"]
        ),
    }


def _by_place(rows: list[Any]) -> Any:
    """Rows of a number for each place as one column, place by place."""
    return ca.vec(ca.horzcat(*rows).T)


def _held(matrix: Any) -> Any:
    """Give what a sparse matrix of symbols holds, as a column."""
    return ca.vertcat(NONE, *matrix.nonzeros())


def _added(parts: list[Any], places: list[Places], rows: int, columns: int) -> Any:
    """Matrix that holds numbers at places, counted along its columns; what lies at the same place is added."""
    where, at = np.unique(np.concatenate(places), return_inverse=True)
    pattern = ca.Sparsity.triplet(rows, columns, (where % rows).tolist(), (where // rows).tolist())
    adding = ca.DM.ones(ca.Sparsity.triplet(len(where), len(at), at.tolist(), list(range(len(at)))))
    return ca.MX(pattern, ca.mtimes(ca.MX(adding), ca.vertcat(*parts)))
