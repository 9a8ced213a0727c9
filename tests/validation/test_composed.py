"""Formulas along a cycle as polynomials."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camwright.profiles.errors import InputError
from camwright.profiles.polynomial.profile import CamProfile
from camwright.validation.composed import compose

WAVE = CamProfile.from_arrays([0.0, 0.4, 1.0], [[0.0, 1.0, 2.0, -3.0], [0.528, 1.16, -1.6, 2.0]])


@settings(deadline=None, max_examples=40)
@given(st.floats(0.1, 30.0), st.floats(-3.0, 3.0))
def test_a_smooth_formula_to_thirteen_digits(pitch: float, phase: float) -> None:
    found = compose(lambda y, ratio, slope: np.sin(pitch * y + phase) * ratio + np.cos(slope), WAVE)
    x = np.linspace(0.0, 1.0, 3001)
    truth = np.sin(pitch * WAVE(x) + phase) * WAVE(x, 1) + np.cos(WAVE(x, 2))
    assert np.abs(found(x) - truth).max() <= 2e-13 * np.abs(truth).max()
    assert set(WAVE.breaks) <= set(found.breaks)


def test_a_jump_of_the_profile_is_a_jump_of_the_formula() -> None:
    kinked = CamProfile.from_arrays([0.0, 0.5, 1.0], [[0.0, 1.0], [0.5, 3.0]])
    found = compose(lambda y, ratio, _: ratio + 0.0 * y, kinked)
    assert (float(found(0.5, side="left")), float(found(0.5))) == (pytest.approx(1.0), pytest.approx(3.0))


def test_a_formula_that_rounds_is_taken_to_its_rounding() -> None:
    """What is lost in a difference of large numbers no halving brings back."""

    def rounded(y: np.ndarray, ratio: np.ndarray, _: np.ndarray) -> np.ndarray:
        return (y + 2e3) - 2e3 + np.cos(ratio)

    found = compose(rounded, WAVE)
    x = np.linspace(0.0, 1.0, 3001)
    truth = WAVE(x) + np.cos(WAVE(x, 1))
    assert np.abs(found(x) - truth).max() <= 2e-12 * np.abs(truth).max()
    with pytest.raises(InputError, match="not smooth"):
        compose(lambda y, ratio, _: (y + 2e5) - 2e5 + np.cos(ratio), WAVE)


def test_a_sliver_left_by_rounding_does_no_harm() -> None:
    breaks = np.array([0.0, 0.4, 0.4 + 1e-15, 1.0])
    sliver = CamProfile(breaks, WAVE.coefficients[[0, 1, 1]])
    found = compose(lambda y, ratio, _: np.cos(y) * ratio, sliver)
    greatest = found.peak(2)
    plain = compose(lambda y, ratio, _: np.cos(y) * ratio, WAVE)
    assert greatest == pytest.approx(plain.peak(2), rel=1e-6)


def test_formulas_without_a_value_or_not_smooth_are_refused() -> None:
    with (
        np.errstate(invalid="ignore"),
        pytest.raises(InputError, match="no finite value: the machine cannot take all positions"),
    ):
        compose(lambda y, *_: np.sqrt(y - 0.5), WAVE)
    with pytest.raises(InputError, match=r"not smooth at master 0\.\d+ m"):
        compose(lambda y, *_: np.sign(y - 0.3), WAVE)
