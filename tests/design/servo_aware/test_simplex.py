"""The dual simplex method against scipy's HiGHS, going on from a vertex, and its proofs that there is no point."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import linprog

from camwright.design.servo_aware.simplex import NoPoint, Vertex, dual_simplex
from camwright.profiles.polynomial.profile import FloatArray


def some_rows(seed: int, rows: int, unknowns: int) -> tuple[FloatArray, FloatArray]:
    """Rows that a point keeps, in a box."""
    random = np.random.default_rng(seed)
    matrix = np.vstack([random.normal(size=(rows, unknowns)), np.eye(unknowns), -np.eye(unknowns)])
    return matrix, matrix @ random.normal(size=unknowns) + random.uniform(0.1, 1.0, len(matrix))


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 10_000), st.integers(2, 25), st.integers(5, 400))
def test_a_linear_programme_has_scipys_value(seed: int, unknowns: int, rows: int) -> None:
    matrix, bound = some_rows(seed, rows, unknowns)
    cost = np.random.default_rng(seed + 1).normal(size=unknowns)
    found = dual_simplex(matrix, bound, cost)
    assert isinstance(found, Vertex)
    assert (matrix @ found.x - bound).max() <= 1e-9
    assert (found.matrix @ found.x) == pytest.approx(found.bound, abs=1e-9)
    other = linprog(cost, A_ub=matrix, b_ub=bound, bounds=(None, None))
    assert cost @ found.x == pytest.approx(other.fun, rel=1e-6, abs=1e-6)


@pytest.mark.parametrize("seed", range(4))
def test_going_on_from_the_vertex_before_ends_where_beginning_anew_does(seed: int) -> None:
    matrix, bound = some_rows(seed, 800, 30)
    cost = np.random.default_rng(seed + 1).normal(size=30)
    order = np.random.default_rng(seed + 2).permutation(len(bound))
    matrix, bound = matrix[order], bound[order]
    vertex: Vertex | None = None
    for count in (300, 500, 700, len(bound)):
        rows = np.concatenate([np.arange(count), np.flatnonzero(order >= 800)])  # the box is always there
        found = dual_simplex(matrix[rows], bound[rows], cost, vertex)
        assert isinstance(found, Vertex)
        vertex = found
    anew = dual_simplex(matrix, bound, cost)
    assert isinstance(anew, Vertex)
    assert vertex is not None
    assert cost @ vertex.x == pytest.approx(float(cost @ anew.x), rel=1e-9)


@pytest.mark.parametrize("moved", [1e-3, 1e-2, 0.3])
@pytest.mark.parametrize("seed", range(4))
def test_from_the_vertex_of_a_programme_beside_it_ends_where_beginning_anew_does(seed: int, moved: float) -> None:
    matrix, bound = some_rows(seed, 800, 30)
    random = np.random.default_rng(seed + 1)
    cost = random.normal(size=30)
    names = np.column_stack([np.ones(len(bound)), np.zeros(len(bound)), np.arange(len(bound)), np.zeros(len(bound))])
    before = dual_simplex(matrix, bound, cost, names=names)
    assert isinstance(before, Vertex)
    assert before.names is not None
    assert matrix[before.names[:, 2].astype(int)] == pytest.approx(before.matrix)
    order = random.permutation(len(bound))
    other = (matrix + moved * random.normal(size=matrix.shape))[order]
    other_bound, other_cost = bound[order], cost + moved * random.normal(size=30)
    start = before.among(other, other_bound, names[order])
    assert start is not None
    found = dual_simplex(other, other_bound, other_cost, start, names[order])
    anew = dual_simplex(other, other_bound, other_cost)
    assert type(found) is type(anew) is (Vertex if moved < 0.1 else NoPoint)
    if isinstance(found, Vertex) and isinstance(anew, Vertex):
        assert (other @ found.x - other_bound).max() <= 1e-9
        assert other_cost @ found.x == pytest.approx(float(other_cost @ anew.x), rel=1e-7)
    assert before.among(other[:400], other_bound[:400], np.full((400, 4), 2.0)) is None


def test_among_many_vertices_that_are_equally_good_it_ends() -> None:
    # the peak of a vector with a known sum: only the last unknown costs, and the others are free to be exchanged for ever
    count = 40
    sums = np.vstack([np.ones(count), -np.ones(count)])
    rows = np.vstack([np.eye(count), -np.eye(count)])
    matrix = np.vstack([np.hstack([rows, -np.ones((2 * count, 1))]), np.hstack([sums, np.zeros((2, 1))])])
    bound = np.concatenate([np.zeros(2 * count), [1.0, -1.0]])
    found = dual_simplex(matrix, bound, np.append(np.zeros(count), 1.0))
    assert isinstance(found, Vertex)
    assert found.x[-1] == pytest.approx(1.0 / count, rel=1e-7)


def test_rows_that_contradict_each_other_are_proved_to() -> None:
    matrix, bound = np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]]), np.array([1.0, -3.0, 1.0, 1.0])
    proof = dual_simplex(matrix, bound, np.array([0.0, 1.0]))
    assert isinstance(proof, NoPoint)
    # widened by 1 they leave a point, by less they do not
    assert proof.least == pytest.approx(1.0, abs=1e-6)
    assert isinstance(dual_simplex(matrix, bound + 0.99, np.array([0.0, 1.0])), NoPoint)
    assert isinstance(dual_simplex(matrix, bound + 1.01, np.array([0.0, 1.0])), Vertex)


@pytest.mark.parametrize("seed", range(6))
def test_a_proof_never_asks_for_more_than_is_missing(seed: int) -> None:
    matrix, bound = some_rows(seed, 300, 12)
    bound = bound - 1.5
    proof = dual_simplex(matrix, bound, np.random.default_rng(seed).normal(size=12))
    assert isinstance(proof, NoPoint)
    wide = np.hstack([matrix, -np.ones((len(bound), 1))])
    least = linprog(np.append(np.zeros(12), 1.0), A_ub=wide, b_ub=bound, bounds=(None, None)).fun
    assert 0.0 < proof.least <= least * (1 + 1e-9)


@pytest.mark.parametrize("seed", range(4))
def test_rows_that_are_parallel_but_for_rounding_prove_nothing(seed: int) -> None:
    # bells so wide that they are nearly one another; the rows have a point by their making
    rng = np.random.default_rng(seed)
    place = np.linspace(0.0, 1.0, 300)
    bells = np.exp(-(((place[:, None] - np.linspace(0.0, 1.0, 12)) / 0.6) ** 2))
    matrix = np.vstack([bells, -bells])
    bound = matrix @ rng.normal(scale=0.1, size=12) + 1e-6 * rng.random(len(matrix))
    assert not isinstance(dual_simplex(matrix, bound, np.append(np.zeros(11), 1.0)), NoPoint)


def test_a_cost_without_bound_has_no_answer() -> None:
    assert dual_simplex(np.array([[1.0, 0.0], [0.0, -1.0]]), np.ones(2), np.array([1.0, 0.0])) is None
