"""The interior-point method against scipy's HiGHS and against its own tangent."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import linprog

from camwright.design.servo_aware.interior_point import interior_point


def some_rows(seed: int, rows: int, unknowns: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Rows that a point keeps, most with two sides, some with one."""
    random = np.random.default_rng(seed)
    matrix = random.normal(size=(rows, unknowns))
    middle = matrix @ random.normal(size=unknowns)
    low, high = middle - random.uniform(0.1, 1.0, rows), middle + random.uniform(0.1, 1.0, rows)
    low[::5], high[1::7] = -np.inf, np.inf
    return matrix, low, high


@pytest.mark.parametrize("seed", range(6))
def test_a_linear_programme_has_scipys_value(seed: int) -> None:
    matrix, low, high = some_rows(seed, 700, 20)
    cost = np.random.default_rng(seed + 100).normal(size=20)
    found = interior_point(matrix, low, high, cost)
    assert found is not None
    assert np.maximum(matrix @ found - high, low - matrix @ found).max() <= 1e-9
    above, below = np.isfinite(high), np.isfinite(low)
    sides, bounds = np.vstack([matrix[above], -matrix[below]]), np.concatenate([high[above], -low[below]])
    other = linprog(cost, A_ub=sides, b_ub=bounds, bounds=(None, None))
    assert cost @ found == pytest.approx(other.fun, rel=1e-7)


@pytest.mark.parametrize("seed", range(6))
def test_a_quadratic_programme_lies_on_its_own_tangent(seed: int) -> None:
    matrix, low, high = some_rows(seed, 600, 15)
    root = np.random.default_rng(seed + 50).normal(size=(15, 15))
    square, cost = root @ root.T, np.random.default_rng(seed + 60).normal(size=15)
    found = interior_point(matrix, low, high, cost, square)
    assert found is not None
    assert np.maximum(matrix @ found - high, low - matrix @ found).max() <= 1e-9
    slope = cost + square @ found  # no point that keeps the rows lies below the tangent there
    tangent = interior_point(matrix, low, high, slope)
    assert tangent is not None
    assert slope @ tangent == pytest.approx(float(slope @ found), abs=1e-7)


def test_rows_that_contradict_each_other_have_no_answer() -> None:
    matrix = np.array([[1.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
    low, high = np.array([-np.inf, 3.0, -1.0]), np.array([1.0, np.inf, 1.0])
    assert interior_point(matrix, low, high, np.array([0.0, 1.0])) is None
