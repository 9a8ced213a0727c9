"""The servo written out as a sum over the command's samples, against the loop itself."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camwright.design.servo_aware.servo_weights import (
    MOST_SAMPLES,
    greatest_gains,
    memory,
    servo_weights,
    state_weights,
)
from camwright.profiles.cut import Cut
from camwright.profiles.errors import InputError
from camwright.profiles.limits import Limits
from camwright.profiles.machines import RotaryKnife
from camwright.profiles.polynomial.profile import FloatArray
from camwright.profiles.returns import baseline
from camwright.profiles.servo import (
    Servo,
    gain_margin,
    sample_plant,
)
from camwright.profiles.task import Task
from camwright.validation.servo.simulation import simulate

FREE = Limits(math.inf, math.inf, math.inf)
"""Nothing here asks for limits."""

PAPER = Servo(120.0, 0.7, 35.0, 0.004, 1.0)
CUT = Cut(0.6, 80 / 60, 0.2, 0.04, 0.16, 1e-4)


def plant_matrices(servo: Servo) -> tuple[np.ndarray, np.ndarray]:
    """Continuous plant ``z' = A z + b u``: ``omega² / (s² + 2 zeta omega s + omega²)`` and an integrator (S1)."""
    w, z = servo.bandwidth, servo.damping
    return np.array([[-2 * z * w, -w * w, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]), np.array([w * w, 0.0, 0.0])


def plain_loop(servo: Servo, command: list[float], part: float, steps: int = 200) -> tuple[float, float, float]:
    """Position, velocity, acceleration a part of a sample after the last command: controller of S1, classical Runge-Kutta steps."""
    a, b = plant_matrices(servo)
    state = np.zeros(3)
    before = 0.0
    for k, c in enumerate(command):
        u = servo.position_gain * (c - state[2]) + servo.velocity_feedforward * (c - before) / servo.sample_time
        share = part if k == len(command) - 1 else 1.0
        h = share * servo.sample_time / steps
        for _ in range(steps):
            k1 = a @ state + b * u
            k2 = a @ (state + h / 2 * k1) + b * u
            k3 = a @ (state + h / 2 * k2) + b * u
            k4 = a @ (state + h * k3) + b * u
            state = state + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        before = c
    acceleration, velocity, position = state
    return position, velocity, acceleration


@pytest.mark.parametrize("part", [0.0, 0.3, 1.0])
@pytest.mark.parametrize(
    "servo", [PAPER, replace(PAPER, velocity_feedforward=0.6), replace(PAPER, damping=1.0), replace(PAPER, damping=2.5)]
)
def test_weighted_samples_are_the_plain_loop(servo: Servo, part: float) -> None:
    command = np.random.default_rng(3).normal(size=12)
    weights = servo_weights(servo, part * servo.sample_time)
    newest_first = command[::-1]
    position, velocity, acceleration = plain_loop(servo, command.tolist(), part)
    assert weights[0][:12] @ newest_first == pytest.approx(position, abs=1e-9)
    assert weights[1][:12] @ newest_first == pytest.approx(velocity, abs=1e-7)
    assert weights[2][:12] @ newest_first == pytest.approx(acceleration, abs=1e-5)


@given(
    st.floats(80.0, 150.0), st.floats(0.6, 1.2), st.floats(10.0, 50.0), st.sampled_from([0.001, 0.004]), st.floats(0, 1)
)
def test_a_standing_command_is_reached_and_a_steady_one_lags_as_eq_2_says(
    bandwidth: float, damping: float, gain: float, sample: float, feedforward: float
) -> None:
    servo = Servo(bandwidth, damping, gain, sample, feedforward)
    weights = servo_weights(servo, 0.5 * sample)
    ages = -sample * np.arange(len(weights[0]))
    assert weights[0].sum() == pytest.approx(1.0, abs=1e-11)
    assert weights[1].sum() == pytest.approx(0.0, abs=1e-8)
    assert weights[2].sum() == pytest.approx(0.0, abs=1e-6)
    # c = t: at half a sample past the newest one the axis is at that time less (1 - alpha) / K
    lag = (1.0 - feedforward) / gain
    assert weights[0] @ ages == pytest.approx(0.5 * sample - lag, abs=1e-11)
    assert weights[1] @ ages == pytest.approx(1.0, abs=1e-8)


def test_position_is_continuous_over_a_sampling_instant() -> None:
    end, start = servo_weights(PAPER, PAPER.sample_time), servo_weights(PAPER, 0.0)
    for before, after in zip(end, start, strict=True):
        # at an instant the newest sample has no part in the state yet
        assert after[0] == 0.0
        assert np.abs(after[1:] - before[:-1]).max() <= 1e-12 * np.abs(before).max()


def test_what_is_left_out_is_forgotten() -> None:
    weights = servo_weights(PAPER, 0.001)
    assert np.abs(weights[0][-20:]).max() < 1e-12


def test_the_sum_is_the_validations_simulation() -> None:
    profile = baseline("poly_3_4_5", Task(RotaryKnife(0.4), CUT, FREE))
    run = simulate(profile, CUT, PAPER)
    for phase, point in ((0, 0), (3, 41), (11, 500)):
        sub = point % 8
        weights = servo_weights(PAPER, sub * PAPER.sample_time / 8)[0]
        x = run.master[phase, point]
        past = x - CUT.line_speed * (sub * PAPER.sample_time / 8 + PAPER.sample_time * np.arange(len(weights)))
        assert weights @ profile(past, outside="repeat") == pytest.approx(run.axis[phase, point], abs=1e-11)


def test_an_unstable_servo_is_refused_with_the_gain_that_would_do() -> None:
    fast = replace(PAPER, position_gain=200.0)
    with pytest.raises(InputError, match="the servo is unstable, its largest pole") as refused:
        memory(fast)
    allowed = 200.0 * gain_margin(fast)
    assert f"{allowed:.6g} 1/s" in str(refused.value)
    assert memory(replace(PAPER, position_gain=0.95 * allowed)) > 1000


def test_a_servo_that_hardly_forgets_is_refused() -> None:
    slow = Servo(120.0, 0.7, 0.01, 0.001, 1.0)
    with pytest.raises(InputError, match=rf"the limit for a servo-aware design is {MOST_SAMPLES}"):
        memory(slow)


def response(servo: Servo, time: float, samples: FloatArray, order: int) -> FloatArray:
    """Axis, or a derivative over time, a time after a sampling instant, from the state and the reference held there."""
    found = samples @ state_weights(servo.loop, samples.shape[1] - 1)
    states, reference = found[:, :3], found[:, 3]
    part = sample_plant(servo.loop, time)
    return np.asarray(states @ part.transition[2 - order] + part.input[2 - order] * reference)


@pytest.mark.parametrize("order", [0, 1, 2])
def test_the_response_at_several_times_is_that_of_the_weights(order: int) -> None:
    servo = replace(PAPER, velocity_feedforward=0.6, dead_time=0.01)
    times = np.array([0.0, 0.001, 0.0033, 0.004])
    samples = np.random.default_rng(7).normal(size=(4, memory(servo.loop) + 1))
    found = [response(servo, time, row[None], order)[0] for time, row in zip(times.tolist(), samples, strict=True)]
    for time, row, value in zip(times.tolist(), samples, found, strict=True):
        weights = servo_weights(servo.loop, time)
        expected = row @ weights[order]
        assert value == pytest.approx(expected, abs=1e-12 * 120**order)


@given(
    st.integers(0, 10_000),
    st.floats(0.0, 1.0),
    st.sampled_from([PAPER, replace(PAPER, damping=0.4, position_gain=60.0)]),
)
def test_the_axis_stays_within_what_its_gains_allow(seed: int, feedforward: float, servo: Servo) -> None:
    servo = replace(servo, velocity_feedforward=feedforward)
    generator = np.random.default_rng(seed)
    count = memory(servo) + 1
    # accelerations between samples as they come; the first samples stand still
    acceleration = np.where(np.arange(2 * count) < count, 0.0, generator.uniform(-3.0, 5.0, 2 * count))
    velocity = np.cumsum(acceleration) * servo.sample_time
    command = (np.cumsum(velocity) * servo.sample_time)[::-1]  # newest first
    windows = np.lib.stride_tricks.sliding_window_view(command, count)
    for order, demanded in ((1, velocity), (2, acceleration)):
        up, down = greatest_gains(servo, order, 8)
        least, greatest = float(demanded.min()), float(demanded.max())
        for sub in range(8):
            found = response(servo, sub * servo.sample_time / 8, windows, order)
            assert found.max() <= up * greatest - down * least + 1e-9
            assert found.min() >= up * least - down * greatest - 1e-9
        assert up - down == pytest.approx(1.0, abs=0.02 if order == 2 else 1e-9)
