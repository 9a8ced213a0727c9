"""The programme's coordinates: Bernstein pieces against numpy's polynomials and naive integration."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.polynomial import Polynomial
from numpy.typing import NDArray

from camwright.design.returns.bernstein import ScaledMotion, gram, inner, piece_coefficients, power_basis, subdivision
from camwright.design.returns.ipopt import programme
from camwright.design.returns.scaling import ScaledProblem
from camwright.design.returns.transcription import Arc, Programme, Shape

FloatArray = NDArray[np.float64]
QUIET = {"print_time": False, "ipopt.print_level": 0, "ipopt.sb": "yes"}
FREE = ScaledProblem(1.0, 0.0, 0.0, 0.0, -100.0, 100.0, 1e4, 1e6, "rms_acceleration")


def bernstein(coefficients: FloatArray) -> Polynomial:
    """Naive twin: the sum of the basis polynomials on the unit interval."""
    n, s = len(coefficients) - 1, Polynomial([0.0, 1.0])
    return sum(
        (float(c) * math.comb(n, k) * s**k * (1 - s) ** (n - k) for k, c in enumerate(coefficients)), Polynomial([0.0])
    )


@st.composite
def motions(draw: st.DrawFn) -> ScaledMotion:
    degree, pieces = draw(st.sampled_from([1, 2, 3])), draw(st.integers(1, 6))
    raw = np.array(draw(st.lists(st.floats(0.05, 1.0), min_size=pieces, max_size=pieces)))
    count = pieces * degree + 1
    a = draw(st.lists(st.floats(-50, 50, allow_subnormal=False), min_size=count, max_size=count))
    return ScaledMotion(raw / raw.sum(), np.array(a), 0.0)


@pytest.mark.parametrize("degree", range(6))
def test_power_basis_is_the_definition(degree: int) -> None:
    for k in range(degree + 1):
        unit = np.eye(degree + 1)[k]
        expected = np.zeros(degree + 1)
        found = bernstein(unit).coef
        expected[: len(found)] = found
        assert np.abs(power_basis(degree) @ unit - expected).max() <= 1e-12


@pytest.mark.parametrize("degree", range(5))
def test_gram_matrix_is_the_integrals(degree: int) -> None:
    for k in range(degree + 1):
        for m in range(degree + 1):
            product = (bernstein(np.eye(degree + 1)[k]) * bernstein(np.eye(degree + 1)[m])).integ()
            assert gram(degree)[k, m] == pytest.approx(product(1.0) - product(0.0), rel=1e-12)


@pytest.mark.parametrize("degree", range(5))
@pytest.mark.parametrize("parts", [1, 2, 3, 8])
def test_subdivision_gives_the_same_polynomial_on_each_part(degree: int, parts: int) -> None:
    rng = np.random.default_rng(degree)
    coefficients = rng.normal(size=degree + 1)
    whole = bernstein(coefficients)
    rows = (subdivision(degree, parts) @ coefficients).reshape(parts, degree + 1)
    s = np.linspace(0, 1, 21)
    for i, row in enumerate(rows):
        assert np.abs(bernstein(row)(s) - whole((i + s) / parts)).max() <= 1e-13
    # the hull holds the polynomial, and shrinks
    assert rows.max() >= whole(np.linspace(0, 1, 1001)).max() - 1e-12
    assert rows.max() <= coefficients.max() + 1e-12


@pytest.mark.parametrize("degree", range(1, 5))
@pytest.mark.parametrize("parts", [1, 2, 8])
def test_parts_that_meet_share_a_coefficient(degree: int, parts: int) -> None:
    rows = inner(degree, parts)
    assert rows.shape == (parts * degree + 1, degree + 1)
    assert {tuple(row) for row in subdivision(degree, parts).round(12)} == {tuple(row) for row in rows.round(12)}


@given(motions())
def test_neighbours_share_a_coefficient(motion: ScaledMotion) -> None:
    p = motion.degree
    rows = piece_coefficients(motion.accelerations, p)
    assert rows.shape == (len(motion.lengths), p + 1)
    assert np.array_equal(rows[1:, 0], rows[:-1, -1])
    assert np.array_equal(np.append(rows[:, :-1].ravel(), rows[-1, -1]), motion.accelerations)


@given(motions())
def test_profile_is_the_integral_of_the_acceleration(motion: ScaledMotion) -> None:
    """Naive twin: integrate each Bernstein piece twice with numpy's polynomials, from rest at zero."""
    profile = motion.profile()
    q, v = 0.0, 0.0
    nodes_q, nodes_v = motion.nodes()
    size = 1e-12 * (1 + np.abs(motion.accelerations).max())
    start = 0.0
    for i, (h, row) in enumerate(
        zip(motion.lengths, piece_coefficients(motion.accelerations, motion.degree), strict=True)
    ):
        piece = bernstein(row)
        ratio = (piece * h).integ(lbnd=0) + v
        position = (ratio * h).integ(lbnd=0) + q
        assert nodes_q[i] == pytest.approx(q, abs=size)
        assert nodes_v[i] == pytest.approx(v, abs=size)
        s = np.linspace(0.01, 0.99, 9)
        x = np.minimum(start + h * s, 1.0)
        assert np.abs(profile(x) - position(s)).max() <= 10 * size
        assert np.abs(profile(x, 1) - ratio(s)).max() <= 10 * size
        assert np.abs(profile(x, 2) - piece(s)).max() <= 1e3 * size
        q, v, start = float(position(1.0)), float(ratio(1.0)), start + h
    assert nodes_q[-1] == pytest.approx(q, abs=size)
    assert nodes_v[-1] == pytest.approx(v, abs=size)
    assert np.abs(profile.jumps(2, seam=False)).max(initial=0.0) <= 1e3 * size


def test_pieces_of_no_length_are_left_out() -> None:
    for nothing in (0.0, 1e-17):
        motion = ScaledMotion(np.array([0.5, nothing, 0.5]), np.array([0.0, 1.0, 1.0, 0.0]), 0.0)
        assert motion.profile().breaks.tolist() == [0.0, 0.5, 1.0]


@pytest.mark.parametrize("degree", [1, 3])
@pytest.mark.parametrize("free_lengths", [False, True])
def test_layout_is_undone(degree: int, free_lengths: bool) -> None:
    programme = Programme(Shape(("free",) * 3, degree, free_lengths, "rms_jerk"), QUIET)
    rng = np.random.default_rng(1)
    parts = {name: rng.normal(size=count) for name, count in programme._sizes.items()}
    flat = programme._pack(parts)
    assert len(flat) == programme._solver.size1_in("x0")
    back = programme._unpack(flat)
    assert set(back) == set(parts)
    for name, values in parts.items():
        assert np.array_equal(back[name], values)


@pytest.mark.parametrize("degree", [1, 3])
def test_free_optimum_of_the_programme(degree: int) -> None:
    """Least mean square of the acceleration: the cubic, 12; on a grid that holds it but for the ends at rest, a little more."""
    lengths = np.full(20, 1 / 20)
    programme = Programme(Shape(("free",) * 20, degree, False, "rms_acceleration"), QUIET)
    start = ScaledMotion(lengths, np.zeros(20 * degree + 1), 0.0)
    motion, statistics = programme.solve(FREE, start)
    assert statistics["success"]
    profile = motion.profile()
    assert 12 <= motion.objective <= 13.5
    assert profile.mean_square(2) == pytest.approx(motion.objective, rel=1e-7)
    assert float(profile(1.0)) == pytest.approx(1.0, abs=1e-8)
    assert float(profile(1.0, 1)) == pytest.approx(0.0, abs=1e-8)


def test_one_quintic_piece_is_the_least_rms_jerk() -> None:
    programme = Programme(Shape(("free",), 3, True, "rms_jerk"), QUIET)
    problem = ScaledProblem(1.0, 0.0, 0.0, 0.0, -100.0, 100.0, 1e4, 1e6, "rms_jerk")
    motion, statistics = programme.solve(problem, ScaledMotion(np.ones(1), np.array([0.0, 15.0, -15.0, 0.0]), 700.0))
    assert statistics["success"]
    assert motion.objective == pytest.approx(720, rel=1e-9)
    assert motion.accelerations == pytest.approx([0.0, 20.0, -20.0, 0.0], abs=1e-6)


def test_known_arcs_are_what_they_say() -> None:
    shape = Shape(("ramp", "hold", "cruise"), 3, True, "rms_jerk")
    programme = Programme(shape, QUIET)
    start = ScaledMotion(np.array([0.3, 0.3, 0.4]), np.zeros(10), 0.0)
    motion, _ = programme.solve(ScaledProblem(1.0, 3.0, 0.0, 0.0, -9.0, 9.0, 1e4, 1e6, "rms_jerk"), start)
    ramp, hold, cruise = piece_coefficients(motion.accelerations, 3)
    assert np.abs(np.diff(ramp, 2)).max() <= 1e-6
    assert np.ptp(hold) <= 1e-6
    assert np.abs(cruise).max() <= 1e-6


def test_limits_at_the_nodes_put_arcs_on_them_and_keep_the_jerk_continuous() -> None:
    """Least RMS jerk with the speed held at 1.3: free, cruise, free, without a row for the speed between the nodes."""
    shape = Shape(("free", "cruise", "free"), 3, True, "rms_jerk", at_nodes=True)
    problem = ScaledProblem(1.0, 0.0, 0.0, 0.0, -9.0, 1.3, 1e4, 1e6, "rms_jerk")
    a = np.array([0.0, 12.0, 3.0, 0.0, 0.0, 0.0, 0.0, -3.0, -12.0, 0.0])
    motion, statistics = Programme(shape, QUIET).solve(problem, ScaledMotion(np.array([0.3, 0.4, 0.3]), a, 3000.0))
    assert statistics["success"]
    profile = motion.profile()
    assert profile.extrema(1)[1].value == pytest.approx(1.3, rel=1e-6)
    assert np.abs(profile.jumps(3, seam=False)).max() <= 1e-4 * math.sqrt(motion.objective)
    # to 1.3 in the time h and over 0.65 h in it, the half that is a quintic: a jerk that ends at zero
    h = float(motion.lengths[0])
    assert 1.3 * (1 - 2 * h) + 2 * float(profile(h)) == pytest.approx(1.0, rel=1e-6)
    assert float(profile(h, 3, side="left")) == pytest.approx(0.0, abs=1e-4 * math.sqrt(motion.objective))


@pytest.mark.parametrize(
    ("arcs", "too_many"),
    [
        (("free",), False),
        (("free", "cruise", "free"), False),
        (("ramp", "free", "hold", "free", "ramp"), False),
        (("hold", "cruise"), True),
        (("hold", "cruise", "ramp", "hold"), True),
    ],
)
def test_arcs_that_leave_nothing_to_choose(arcs: tuple[Arc, ...], too_many: bool) -> None:
    assert Shape(arcs, 3, True, "rms_jerk").overdetermined is too_many
    assert not Shape(arcs, 3, False, "rms_jerk").overdetermined  # on a grid the arcs are not told


def test_a_try_that_leaves_nothing_to_choose_ends_without_a_word_of_its_solver(
    capfd: pytest.CaptureFixture[str],
) -> None:
    """Three stretches of constant speed, one held on its limit: one equation more than unknowns, of which CasADi warns on its own."""
    shape = Shape(("cruise", "free", "cruise", "free", "cruise"), 3, True, "rms_jerk", at_nodes=True)
    assert not shape.overdetermined  # but for the limit that is held
    problem = ScaledProblem(1.0, 0.0, 0.0, 0.0, -9.0, 1.3, 1e4, 1e6, "rms_jerk")
    start = ScaledMotion(np.full(5, 0.2), np.zeros(16), 0.0)
    assert not programme(shape).solve(problem, start)[1]["success"]
    assert capfd.readouterr() == ("", "")
