"""Profiles fitted to a smooth ratio, against closed forms of its integral."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camwright.profiles.errors import InputError
from camwright.profiles.polynomial.fitting import DEGREE, MOST_PIECES, fit_profile
from camwright.profiles.polynomial.profile import FloatArray


@settings(deadline=None, max_examples=30)
@given(st.floats(0.1, 40.0), st.floats(0.01, 3.0), st.floats(-1.0, 1.0))
def test_sine_of_any_pitch_with_its_derivatives(pitch: float, length: float, start: float) -> None:
    profile = fit_profile(lambda x: pitch * np.cos(pitch * x), start, start + length)
    x = np.linspace(start, start + length, 501)
    assert (profile.start, profile.end) == (start, start + length)
    assert np.abs(profile(x) - (np.sin(pitch * x) - math.sin(pitch * start))).max() <= 1e-12 * max(1.0, pitch * length)
    assert np.abs(profile(x, 1) - pitch * np.cos(pitch * x)).max() <= 1e-12 * pitch


def test_joins_of_the_fit_do_not_jump() -> None:
    profile = fit_profile(lambda x: 1 / np.sqrt(1 - x**2), -0.95, 0.95)
    assert profile.pieces > 2
    assert profile.degree == DEGREE + 1
    assert np.abs(profile.jumps(0, seam=False)).max() <= 1e-15
    assert np.abs(profile.jumps(1, seam=False)).max() <= 1e-12
    assert np.abs(profile.jumps(2, seam=False)).max() <= 1e-9 * 0.95 / (1 - 0.95**2) ** 1.5
    assert profile.advance == pytest.approx(2 * math.asin(0.95), rel=1e-13)


def test_a_ratio_that_is_not_smooth_is_refused_with_the_number_of_pieces() -> None:
    def step(x: FloatArray) -> FloatArray:
        return np.where(x < 1 / 3, 1.0, 2.0)

    with pytest.raises(InputError, match=rf"too abrupt .* {MOST_PIECES} pieces of degree {DEGREE}"):
        fit_profile(step, 0.0, 1.0)
