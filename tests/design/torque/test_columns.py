"""Functions at many places: steps on columns against CasADi's own evaluation, place by place."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np

from camwright.design.torque.columns import Steps

COUNT = 7


def functions() -> tuple[list[Any], list[Any]]:
    """Give some of every kind: powers, angles, lines between points, cases, constants, what is given through."""
    x, p = ca.SX.sym("x", 3), ca.SX.sym("p", 2)
    line = ca.pw_lin(ca.fabs(x[0]), ca.DM([0.0, 0.5, 2.0]), ca.DM([3.0, 2.0, 0.5]))
    first = ca.vertcat(x[0] * x[1] - p[0], ca.sin(x[2]) / x[1], 2.5, x[2], p[1] ** 3, line)
    second = ca.vertcat(ca.if_else(x[0] > 1.0, x[1], -x[2]), ca.sqrt(x[0]) ** 1.5, ca.fmax(x[0], p[0]), 0.0)
    return [x, p], [first, second]


def by_columns(steps: Steps, given: list[np.ndarray], shared: tuple[int, ...] = ()) -> list[np.ndarray]:
    """Values at all places; a row of the last that is given by its number is handed over once for all of them."""
    symbols = [ca.MX.sym(f"g{k}", COUNT, len(rows)) for k, rows in enumerate(given)]
    rows = [list(ca.horzsplit(symbol)) for symbol in symbols]
    for k in shared:
        rows[-1][k] = rows[-1][k][0]
    told = [ca.horzcat(*each) for each in steps.at(COUNT, rows)]
    return [np.array(each).T for each in ca.Function("told", symbols, told)(*(each.T for each in given))]


def test_steps_on_columns_are_the_function_at_each_place() -> None:
    asked, told = functions()
    rng = np.random.default_rng(2)
    given = [rng.uniform(0.3, 2.5, (3, COUNT)), rng.uniform(0.3, 2.5, (2, COUNT))]
    own = ca.Function("own", asked, told)
    for k, found in enumerate(by_columns(Steps(asked, told), given)):
        places = [np.array(own(given[0][:, j], given[1][:, j])[k]).ravel() for j in range(COUNT)]
        assert np.array_equal(found, np.array(places).T)


def test_what_is_the_same_everywhere_may_be_given_once() -> None:
    asked, told = functions()
    rng = np.random.default_rng(3)
    given = [rng.uniform(0.3, 2.5, (3, COUNT)), np.repeat(rng.uniform(0.3, 2.5, (2, 1)), COUNT, axis=1)]
    steps = Steps(asked, told)
    for one, other in zip(by_columns(steps, given, shared=(0, 1)), by_columns(steps, given), strict=True):
        assert np.array_equal(one, other)
        assert one.shape[1] == COUNT
