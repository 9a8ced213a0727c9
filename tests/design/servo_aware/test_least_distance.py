"""Quadratic programmes as least-distance problems: against their own optimality conditions, and IPOPT's answer."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camwright.design.returns.ipopt import QUIET
from camwright.design.servo_aware.least_distance import least_distance
from camwright.profiles.polynomial.profile import FloatArray


def some_programme(seed: int, unknowns: int, rows: int) -> tuple[FloatArray, ...]:
    """Return square, cost, matrix, low and high of a programme with a point that keeps its rows; some sides are infinite."""
    generator = np.random.default_rng(seed)
    factor = generator.normal(size=(unknowns, unknowns))
    matrix = generator.normal(size=(rows, unknowns))
    middle = matrix @ generator.normal(size=unknowns)
    low, high = middle - generator.uniform(0.0, 1.0, rows), middle + generator.uniform(0.01, 1.0, rows)
    low[::3], high[1::3] = -np.inf, np.inf
    return factor @ factor.T + 1e-3 * np.eye(unknowns), generator.normal(size=unknowns), matrix, low, high


@settings(max_examples=40)
@given(st.integers(0, 10_000), st.integers(1, 25), st.integers(1, 60))
def test_no_other_point_that_keeps_the_rows_costs_less(seed: int, unknowns: int, rows: int) -> None:
    square, cost, matrix, low, high = some_programme(seed, unknowns, rows)
    found = least_distance(square, cost, matrix, low, high)
    assert found is not None
    values = matrix @ found
    scale = 1.0 + np.abs(found).max()
    assert np.all(values <= high + 1e-7 * scale)
    assert np.all(values >= low - 1e-7 * scale)
    # the gradient is a sum of touched rows, those at their upper side pulling down and those at their lower side pushing up
    gradient = square @ found + cost
    up, down = np.abs(values - low) <= 1e-6 * scale, np.abs(values - high) <= 1e-6 * scale
    touched = np.vstack([matrix[up], -matrix[down]])
    if len(touched):
        multipliers, *_ = np.linalg.lstsq(touched.T, gradient)
        assert np.abs(touched.T @ multipliers - gradient).max() <= 1e-5 * (1.0 + np.abs(gradient).max())
    else:
        assert np.abs(gradient).max() <= 1e-6 * (1.0 + np.abs(cost).max())


@pytest.mark.parametrize("seed", range(4))
def test_the_answer_is_that_of_ipopt(seed: int) -> None:
    square, cost, matrix, low, high = some_programme(seed, 12, 40)
    x = ca.MX.sym("x", 12)
    programme = {"x": x, "f": 0.5 * ca.bilin(ca.DM(square), x, x) + ca.dot(cost, x), "g": ca.DM(matrix) @ x}
    options = QUIET | {"ipopt.tol": 1e-12, "ipopt.bound_relax_factor": 0.0}
    reference = ca.nlpsol("reference", "ipopt", programme, options)(lbg=low, ubg=high)
    found = least_distance(square, cost, matrix, low, high)
    assert found is not None
    np.testing.assert_allclose(found, np.asarray(reference["x"]).ravel(), atol=1e-6)


def test_without_rows_that_matter_it_is_the_bare_minimum() -> None:
    square, cost, matrix, _, _ = some_programme(3, 6, 9)
    free = least_distance(square, cost, matrix, np.full(9, -1e6), np.full(9, 1e6))
    assert free is not None
    np.testing.assert_allclose(free, np.linalg.solve(square, -cost), rtol=1e-9)


def test_rows_that_exclude_each_other_have_no_answer() -> None:
    rows = np.array([[1.0, 0.0], [1.0, 0.0]])
    assert least_distance(np.eye(2), np.zeros(2), rows, np.array([1.0, -np.inf]), np.array([np.inf, -1.0])) is None


def test_a_square_that_is_not_definite_has_no_answer() -> None:
    assert least_distance(np.diag([1.0, -1.0]), np.zeros(2), np.eye(2), -np.ones(2), np.ones(2)) is None
