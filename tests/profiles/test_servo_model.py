"""The discrete servo's matrices against the matrix exponential and against what is known of the loop."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import expm

from camwright.profiles.servo import (
    Servo,
    closed_loop,
    sample_plant,
    spectral_radius,
)

PAPER = Servo(120.0, 0.7, 35.0, 0.004, 1.0)
ROUNDING = 2e-12
"""Relative rounding of the closed forms and of expm, over the ranges below."""


def plant_matrices(servo: Servo) -> tuple[np.ndarray, np.ndarray]:
    """Continuous plant ``z' = A z + b u``: ``omega² / (s² + 2 zeta omega s + omega²)`` and an integrator (S1)."""
    w, z = servo.bandwidth, servo.damping
    return np.array([[-2 * z * w, -w * w, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]), np.array([w * w, 0.0, 0.0])


def exponential(servo: Servo, time: float) -> tuple[np.ndarray, np.ndarray]:
    """Exact discretisation by the matrix exponential of plant and held input together."""
    a, b = plant_matrices(servo)
    block = np.zeros((4, 4))
    block[:3, :3], block[:3, 3] = a, b
    whole = expm(block * time)
    return whole[:3, :3], whole[:3, 3]


def assert_same_plant(servo: Servo, time: float) -> None:
    transition, held = exponential(servo, time)
    plant = sample_plant(servo, time)
    # state (v', v, p) in comparable sizes: omega², omega, 1
    size = np.array([servo.bandwidth**2, servo.bandwidth, 1.0])
    scale = size[:, None] / size
    assert np.abs((plant.transition - transition) / scale).max() <= ROUNDING
    assert np.abs((plant.input - held) / (size / servo.bandwidth)).max() <= ROUNDING


@pytest.mark.parametrize("damping", [0.05, 0.7, 0.9, 0.999999, 1.0 - 1e-9, 1.0, 1.0 + 1e-9, 1.000001, 1.3, 4.0])
@pytest.mark.parametrize("time", [0.0, 1e-5, 5e-4, 4e-3, 8e-3])
def test_plant_in_all_damping_regimes(damping: float, time: float) -> None:
    assert_same_plant(Servo(120.0, damping, 35.0, 0.004, 1.0), time)


@settings(deadline=None, max_examples=200)
@given(st.floats(40.0, 300.0), st.floats(0.1, 3.0), st.floats(1e-4, 1e-2))
def test_plant_over_the_ranges(bandwidth: float, damping: float, time: float) -> None:
    assert_same_plant(Servo(bandwidth, damping, 35.0, 0.004, 1.0), time)


@settings(deadline=None, max_examples=50)
@given(st.floats(0.1, 3.0), st.floats(1e-4, 8e-3), st.floats(1e-4, 8e-3))
def test_plant_steps_compose(damping: float, first: float, second: float) -> None:
    servo = Servo(120.0, damping, 35.0, 0.004, 1.0)
    a, b, both = (sample_plant(servo, t) for t in (first, second, first + second))
    assert np.allclose(b.transition @ a.transition, both.transition, rtol=1e-9, atol=1e-9)
    assert np.allclose(b.transition @ a.input + b.input, both.input, rtol=1e-9, atol=1e-9)


def test_plant_runs_at_the_held_velocity_for_ever() -> None:
    plant = sample_plant(PAPER, 0.004)
    state = np.array([0.0, 1.5, 2.0])
    assert np.allclose(plant.transition @ state + plant.input * 1.5, [0.0, 1.5, 2.0 + 1.5 * 0.004], rtol=0, atol=1e-13)


def test_closed_loop_is_the_controller_around_the_plant() -> None:
    servo = Servo(90.0, 0.8, 20.0, 0.003, 0.6)
    a, b = closed_loop(servo)
    plant = sample_plant(servo, servo.sample_time)
    state, now, before = np.array([3.0, -0.2, 0.05]), 0.07, 0.066
    held = servo.position_gain * (now - state[2]) + servo.velocity_feedforward * (now - before) / servo.sample_time
    expected = plant.transition @ state + plant.input * held
    assert np.allclose(a @ state + b @ [now, before], expected, rtol=1e-13, atol=1e-13)


def test_spectral_radius_of_a_slow_position_loop_is_its_own_decay() -> None:
    # far below the bandwidth the loop is p[k+1] = p[k] + K dT (c[k] - p[k])
    servo = Servo(1e4, 0.7, 1.0, 0.01, 1.0)
    assert spectral_radius(servo) == pytest.approx(1 - 0.01, rel=1e-5)


def test_spectral_radius_tells_where_the_gain_is_too_high() -> None:
    # continuous loop: K = 2 zeta omega is the limit of stability (Routh); fast sampling comes close to it from below
    limit = 2 * 0.7 * 120.0
    assert spectral_radius(Servo(120.0, 0.7, 0.97 * limit, 1e-4, 1.0)) < 1.0
    assert spectral_radius(Servo(120.0, 0.7, 1.01 * limit, 1e-4, 1.0)) > 1.0


@settings(deadline=None, max_examples=300)
@given(
    st.floats(0.5, 4.0).map(lambda power: 10**power),
    st.floats(-2.0, 1.5).map(lambda power: 10**power),
    st.floats(-2.0, 3.5).map(lambda power: 10**power),
    st.floats(-5.0, -1.0).map(lambda power: 10**power),
)
def test_spectral_radius_is_that_of_the_matrix(bandwidth: float, damping: float, gain: float, time: float) -> None:
    servo = Servo(bandwidth, damping, gain, time, 1.0)
    poles = np.linalg.eigvals(closed_loop(servo)[0])
    assert spectral_radius(servo) == pytest.approx(np.abs(poles).max(), rel=1e-9, abs=1e-5)


def test_spectral_radius_of_the_published_servo_is_exact_to_rounding() -> None:
    for gain in (1e-6, 1.0, 35.0, 128.0, 200.0, 1e9):
        servo = Servo(120.0, 0.7, gain, 0.004, 1.0)
        expected = np.abs(np.linalg.eigvals(closed_loop(servo)[0])).max()
        assert spectral_radius(servo) == pytest.approx(expected, rel=1e-13)


@pytest.mark.parametrize("bandwidth", [1e6, 1e8])
def test_poles_near_the_origin_are_those_of_the_lag_of_the_velocity_loop(bandwidth: float) -> None:
    # so fast a velocity loop only lags by 2 zeta / omega; with K dT = 1 what is left of a step is this times K, a sample later
    servo = Servo(bandwidth, 0.7, 100.0, 0.01, 1.0)
    assert spectral_radius(servo) == pytest.approx(np.sqrt(2 * 0.7 / bandwidth * 100.0), rel=1e-2)
