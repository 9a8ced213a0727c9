"""Polynomials in rows: the Taylor shift and the roots in intervals, against numpy's one polynomial at a time."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.polynomial.roots import roots_between
from camwright.profiles.polynomial.rows import recentred

NUMBER = st.integers(-40, 40).map(lambda tenths: tenths / 10)


def tables(width: int) -> st.SearchStrategy[list[list[float]]]:
    return st.lists(st.lists(NUMBER, min_size=width, max_size=width), min_size=1, max_size=5)


@settings(deadline=None)
@given(st.integers(1, 7).flatmap(tables), st.lists(NUMBER, min_size=5, max_size=5))
def test_a_shifted_polynomial_has_the_same_values(rows: list[list[float]], by: list[float]) -> None:
    table, offset = np.array(rows), np.array(by[: len(rows)])
    moved = recentred(table, offset)
    for before, after, origin in zip(table, moved, offset, strict=True):
        for x in (-1.0, 0.0, 0.7, 2.0):
            expected = np.polynomial.polynomial.polyval(origin + x, before)
            size = np.polynomial.polynomial.polyval(abs(origin) + abs(x), abs(before))
            assert abs(np.polynomial.polynomial.polyval(x, after) - expected) <= 1e-13 * max(1.0, size)


@settings(deadline=None)
@given(st.lists(st.lists(st.integers(1, 39), max_size=4, unique=True), min_size=1, max_size=5), st.integers(-3, 3))
def test_simple_roots_inside_are_found_and_no_others(places: list[list[int]], start: int) -> None:
    """Polynomials made of their roots, tenths from the start of an interval that is two long."""
    table = np.zeros((len(places), 6))
    for row, roots in zip(table, places, strict=True):
        made = np.polynomial.polynomial.polyfromroots([start + tenths / 10 for tenths in roots])
        row[: len(made)] = made
    a = np.full(len(places), float(start))
    found = roots_between(table, a, a + 2.05)
    assert found.shape == (len(places), 5)
    for row, roots in zip(found, places, strict=True):
        inside = sorted(start + tenths / 10 for tenths in roots if tenths / 10 < 2.05)
        kept = row[~np.isnan(row)]
        assert np.isnan(row[len(kept) :]).all()  # first the roots, then nothing
        np.testing.assert_allclose(kept, inside, atol=1e-6)


def test_zero_constants_and_empty_intervals_have_no_roots() -> None:
    table = np.array([[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [-1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]])
    found = roots_between(table, np.array([0.0, 0.0, 0.0, 2.0]), np.array([2.0, 2.0, 2.0, 2.0]))
    assert np.isnan(found[[0, 1, 3]]).all()
    assert found[2, 0] == 1.0


def test_a_double_root_is_found() -> None:
    found = roots_between(np.array([[0.25, -1.0, 1.0]]), np.zeros(1), np.ones(1))
    np.testing.assert_allclose(found[0], [0.5, 0.5], atol=1e-7)


def test_what_a_profile_has_found_is_not_looked_for_again() -> None:
    profile = CamProfile.from_arrays([0.0, 1.0, 2.0], [[0.0, 1.0, 0.5, -0.2], [1.3, 1.4, -0.1, 0.3]])
    assert profile.extrema(1) is profile.extrema(1)
    assert profile.extrema(1) == CamProfile.from_arrays(profile.breaks, profile.coefficients).extrema(1)


def test_what_is_clear_of_zero_is_told_by_its_coefficients_and_loses_no_root() -> None:
    """Hundreds of polynomials of degree 13 about zero, raised step by step: those with a root have it, whatever is skipped."""
    rng = np.random.default_rng(5)
    table = rng.normal(size=(400, 14)) * 0.5 ** np.arange(14)
    table[:, 0] = np.repeat(np.linspace(-0.8, 0.8, 40), 10)
    found = roots_between(table, np.full(400, 0.2), np.full(400, 1.1))
    for row, kept in zip(table, found, strict=True):
        all_roots = np.polynomial.polynomial.polyroots(row)
        real = np.sort(all_roots[np.abs(all_roots.imag) < 1e-9].real)
        inside = real[(real > 0.2 + 1e-9) & (real < 1.1 - 1e-9)]
        np.testing.assert_allclose(kept[~np.isnan(kept)], inside, atol=1e-7)
    assert 50 < np.isnan(found).all(axis=1).sum() < 350


def test_a_double_root_that_rounding_lifts_is_found_still() -> None:
    lifted = np.array([[0.25 + 1e-13, -1.0, 1.0, 0.0], [0.25 + 1e-6, -1.0, 1.0, 0.0]])
    found = roots_between(lifted, np.zeros(2), np.ones(2))
    np.testing.assert_allclose(found[0, :2], [0.5, 0.5], atol=1e-6)
    assert np.isnan(found[1]).all()
