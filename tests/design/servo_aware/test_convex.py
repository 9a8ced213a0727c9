"""Linear and quadratic programmes with dense rows, against scipy's own."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import linprog

from camwright.design.servo_aware import convex
from camwright.design.servo_aware.convex import ACCEPTED, ConvexProgramme
from camwright.profiles.errors import SolverError
from camwright.profiles.polynomial.profile import FloatArray


def random_rows(seed: int, unknowns: int, rows: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return rows about a point that keeps them all, with a box so that a linear cost has a least value."""
    generator = np.random.default_rng(seed)
    matrix = np.vstack([generator.normal(size=(rows, unknowns)), np.eye(unknowns)])
    middle = matrix @ generator.normal(size=unknowns)
    room = generator.uniform(0.1, 2.0, len(matrix))
    return matrix, middle - room, middle + room


@settings(max_examples=25)
@given(st.integers(0, 10_000), st.integers(2, 20), st.integers(5, 60))
def test_a_linear_programme_has_scipys_value(seed: int, unknowns: int, rows: int) -> None:
    matrix, low, high = random_rows(seed, unknowns, rows)
    cost = np.random.default_rng(seed + 1).normal(size=unknowns)
    programme = ConvexProgramme(unknowns)
    programme.add(matrix[:rows], low[:rows], high[:rows])
    programme.add(matrix[rows:], low[rows:], high[rows:])
    found = programme.solve(cost)
    assert found is not None
    reference = linprog(
        cost, A_ub=np.vstack([matrix, -matrix]), b_ub=np.concatenate([high, -low]), bounds=[(None, None)] * unknowns
    )
    assert cost @ found == pytest.approx(reference.fun, rel=1e-7, abs=1e-7)
    assert np.all(matrix @ found <= high + ACCEPTED)
    assert np.all(matrix @ found >= low - ACCEPTED)


@pytest.mark.parametrize("seed", range(4))
def test_a_quadratic_programme_lies_on_its_own_tangent(seed: int) -> None:
    # f >= f(x) + f'(x) (z - x) for a convex f; the least value of the right side is a linear programme
    matrix, low, high = random_rows(seed, 12, 40)
    generator = np.random.default_rng(seed + 1)
    factor, cost = generator.normal(size=(9, 12)), generator.normal(size=12)
    square = factor.T @ factor  # three directions cost nothing of the square
    programme = ConvexProgramme(12)
    programme.add(matrix, low, high)
    found = programme.solve(cost, square)
    assert found is not None
    gradient = cost + square @ found
    least = linprog(
        gradient, A_ub=np.vstack([matrix, -matrix]), b_ub=np.concatenate([high, -low]), bounds=[(None, None)] * 12
    )
    assert gradient @ found == pytest.approx(least.fun, abs=1e-6)
    assert np.all(matrix @ found <= high + ACCEPTED)
    assert np.all(matrix @ found >= low - ACCEPTED)


def test_a_peak_is_the_least_magnitude() -> None:
    # the least peak of (z - 1, z - 4) is half their distance, of (z - 1) alone above -1/2 and below 1 of the peak: zero
    programme = ConvexProgramme(2)
    programme.add_peak(np.ones((2, 1)), np.array([-1.0, -4.0]), -1.0, 1.0)
    found = programme.solve(np.array([0.0, 1.0]))
    assert found == pytest.approx([2.5, 1.5])
    lopsided = ConvexProgramme(2)
    lopsided.add_peak(np.ones((2, 1)), np.array([-1.0, -4.0]), -0.5, 1.0)  # -t/2 <= z - 1, z - 4 <= t
    assert lopsided.solve(np.array([0.0, 1.0])) == pytest.approx([3.0, 2.0])


@pytest.mark.parametrize("contradicted", [False, True])
def test_where_highs_goes_round_without_end_our_own_method_answers(
    monkeypatch: pytest.MonkeyPatch, *, contradicted: bool
) -> None:
    """HiGHS is told to end after no step at all, as it does after ten thousand among vertices that are equally good."""
    monkeypatch.setitem(convex._HIGHS, "simplex_iteration_limit", 0)
    programme = ConvexProgramme(3)
    programme.add(np.eye(3), -1.0, 2.0)
    programme.add(np.ones((1, 3)), -np.inf, -4.0 if contradicted else 1.0)
    found = programme.solve(np.array([1.0, -1.0, 0.0]))
    if contradicted:
        assert found is None
    else:
        assert found is not None
        assert found[:2] == pytest.approx([-1.0, 2.0])


def test_rows_of_fewer_columns_leave_the_last_unknowns_out() -> None:
    programme = ConvexProgramme(3)
    programme.add(np.eye(2), np.array([1.0, 2.0]), np.inf)
    programme.add(np.eye(3), -5.0, 5.0)
    assert programme.solve(np.ones(3)) == pytest.approx([1.0, 2.0, -5.0])


def test_rows_that_contradict_each_other_have_no_answer() -> None:
    for square in (None, np.eye(1)):
        programme = ConvexProgramme(1)
        programme.add(np.ones((1, 1)), 1.0, 2.0)
        programme.add(np.ones((1, 1)), 3.0, 4.0)
        assert programme.solve(np.ones(1), square) is None


def test_a_cost_without_bound_is_the_solvers_failure() -> None:
    programme = ConvexProgramme(1)
    programme.add(np.ones((1, 1)), -np.inf, 1.0)
    with pytest.raises(SolverError, match=r"HiGHS ended a servo-aware design with '.*'; report this job"):
        programme.solve(np.ones(1))


def test_rows_broken_by_rounding_are_refined() -> None:
    # a spline's third differences beside its values: entries from 1 to 1e10 in one row, answered to 1e-9 of the bounds
    count, accepted = 24, 1e-9
    third = np.diff(np.eye(count), 3, axis=0) * 1e10
    values = np.eye(count)
    target = np.sin(np.linspace(0.0, 3.0, count))
    programme = ConvexProgramme(count + 1)
    programme.add(values, target - 1e-3, target + 1e-3, accepted)
    programme.add_peak(third, np.zeros(len(third)), -1e6, 1e6, 1e-6 * 1e6)
    found = programme.solve(np.append(np.zeros(count), 1.0))
    assert found is not None
    assert np.abs(found[:-1] - target).max() <= 1e-3 + accepted
    assert np.abs(third @ found[:-1]).max() <= 1e6 * found[-1] + 1.0


def test_nothing_is_printed(capfd: pytest.CaptureFixture[str]) -> None:
    programme = ConvexProgramme(2)
    programme.add(np.eye(2), 0.0, 1.0)
    programme.solve(np.ones(2))
    programme.solve(np.ones(2), np.eye(2))
    assert capfd.readouterr() == ("", "")
