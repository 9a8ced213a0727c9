"""The loop of print marks: published numbers, and the loop run for itself."""

import math

import numpy as np
import pytest

from camwright.profiles.closed_forms.mark_loop import best_gain, gain_without_overshoot, greatest_gain, noise_share


def errors(gain: float, delay: int, noise: np.ndarray, start: float) -> np.ndarray:
    """Run the loop: the naive twin."""
    error = [start] * (delay + 1)
    for k in range(len(noise)):
        error.append(error[-1] - gain * (error[-1 - delay] + noise[k]))
    return np.array(error[delay + 1 :])


def test_gains_of_the_first_delays() -> None:
    assert [greatest_gain(n) for n in range(5)] == pytest.approx([2, 1, 0.618, 0.445, 0.347], abs=5e-4)
    assert [gain_without_overshoot(n) for n in range(5)] == pytest.approx([1, 1 / 4, 0.148, 0.105, 0.082], abs=5e-4)
    assert gain_without_overshoot(1000) == pytest.approx(
        1 / (1000.5 * math.e), rel=1e-6
    )  # beyond what whole numbers can be divided by


@pytest.mark.parametrize("delay", range(5))
def test_the_loop_is_stable_just_below_and_not_just_above(delay: int) -> None:
    still = np.zeros(6000)
    limit = greatest_gain(delay)
    assert np.abs(errors(0.99 * limit, delay, still, 1.0)[-200:]).max() < 1e-3
    assert np.abs(errors(1.01 * limit, delay, still, 1.0)[-200:]).max() > 1e3


@pytest.mark.parametrize("delay", range(5))
def test_no_overshoot_up_to_the_gain_and_some_beyond(delay: int) -> None:
    still = np.zeros(3000)
    gain = gain_without_overshoot(delay)
    assert errors(gain, delay, still, 1.0).min() >= -1e-9
    assert errors(1.1 * gain, delay, still, 1.0).min() < -1e-9


def test_noise_passes_by_the_formula() -> None:
    assert [noise_share(k) for k in (1.0, 0.5, 0.3)] == pytest.approx([1, 0.333, 0.176], abs=5e-4)
    assert noise_share(0.4) == pytest.approx(0.4 / (2 - 0.4), rel=1e-12)


@pytest.mark.parametrize("delay", [0, 1, 3])
def test_noise_passes_as_in_a_long_run(delay: int) -> None:
    noise = np.random.default_rng(3).normal(size=200_000)
    gain = 0.7 * greatest_gain(delay)
    assert errors(gain, delay, noise, 0.0).var() == pytest.approx(noise_share(gain, delay), rel=0.02)


def test_a_loop_that_is_not_stable_has_no_variance() -> None:
    assert noise_share(2.0) == math.inf
    assert noise_share(0.62, 2) == math.inf
    assert noise_share(0.0) == 0.0


def test_the_best_gain_weighs_stretch_against_noise() -> None:
    assert [best_gain(math.sqrt(share), 1.0) for share in (0.01, 0.1, 1.0)] == pytest.approx(
        [0.095, 0.270, 0.618], abs=5e-4
    )
    assert best_gain(1.0, 0.0) == 1.0
    # a walk's error grows by the stretch each cut: the variance of the best gain is least
    stretch, noise = 0.3, 1.0
    chance = np.random.default_rng(5)
    walk, seen = chance.normal(size=300_000) * stretch, chance.normal(size=300_000) * noise

    def variance(gain: float) -> float:
        error, total = 0.0, 0.0
        for step, w in zip(walk, seen, strict=True):
            error += step - gain * (error + w)
            total += error * error
        return total

    gain = best_gain(stretch, noise)
    assert variance(gain) < min(variance(0.7 * gain), variance(1.4 * gain))
