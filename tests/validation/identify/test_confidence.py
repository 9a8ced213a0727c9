"""What widens the confidence: rounding, noise that is not white, a clock that nobody recorded."""

from __future__ import annotations

import math
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from camwright.profiles.servo import Servo
from camwright.profiles.trace import Trace
from camwright.validation.identify.clock import _mixed, with_clock
from camwright.validation.identify.colour import with_colour
from camwright.validation.identify.fit import CONFIDENCE, Minimum, TraceFit, coordinate, value_at
from camwright.validation.identify.rounding import count_of, with_rounding
from camwright.validation.servo.sampled_axis import axis_response, mean_response, ripple_response

PAPER = Servo(120.0, 0.7, 35.0, 0.004, 1.0, 0.002)
VALUES = {
    "bandwidth": 120.0,
    "damping": 0.7,
    "position_gain": 35.0,
    "sample_time": 0.004,
    "dead_time": 0.002,
    "velocity_feedforward": 1.0,
}
NAMES = ("bandwidth", "damping", "position_gain", "sample_time", "dead_time")
TIMES = 1e-3 * np.arange(2000)


def sweep(time: np.ndarray) -> np.ndarray:
    return np.asarray(0.02 * np.sin(2 * math.pi * (0.5 + 14.5 * time / 4.0) * time))


def recorded(noise: np.ndarray, count: float = 0.0) -> Trace:
    """Record the mean of the axis over all phases of its clock, by its frequency response: there is no ripple in it."""
    fit = TraceFit.of(Trace(0.0, 1e-3, sweep(TIMES), sweep(TIMES), "m"))
    actual = sweep(TIMES)
    actual[fit.rows] = fit.mean(PAPER)
    actual = actual + noise
    command = sweep(TIMES)
    if count:
        command, actual = (count * np.round(signal / count) for signal in (command, actual))
    return Trace(0.0, 1e-3, command, actual, "m")


def fitted(trace: Trace, count: float = 0.0) -> tuple[TraceFit, Minimum]:
    fit = TraceFit.of(trace, count)
    return fit, fit.minimum(VALUES, NAMES, None, 30)


@pytest.mark.parametrize("count", [1e-5, 9.25e-6, 2.5e-4])
def test_counts_are_found(count: float) -> None:
    assert count_of(count * np.round(sweep(TIMES) / count)) == pytest.approx(count, rel=1e-6)
    written = np.round(count * np.round(sweep(TIMES) / count), 10)  # as digits in a file
    assert count_of(written) == pytest.approx(count, rel=1e-4)


def test_what_is_not_rounded_has_no_count() -> None:
    assert count_of(sweep(TIMES)) == 0.0
    assert count_of(np.zeros(10)) == 0.0
    assert count_of(np.cumsum(np.where(np.arange(900) % 450 < 300, 1.0, 2.0)) / 1500) == 0.0  # two speeds are no grid
    assert count_of(np.arange(100) * 0.25 + 1e-3 * np.sin(np.arange(100))) == 0.0


def test_the_ripple_is_what_the_clock_adds_to_the_mean() -> None:
    """Of a sine: the sum of the parts about the harmonics is the simulated axis, at any phase."""
    rate, servo = 2 * math.pi * 9.0, replace(PAPER, sample_time=0.006)
    late = TIMES[1500:]
    for clock in (0.0, 0.0021):
        position, _ = axis_response(servo, clock, lambda t: np.sin(rate * t), TIMES)
        found = np.zeros(len(late))
        for sign in (1.0, -1.0):
            for harmonic in range(-4, 5):
                answer = ripple_response(servo, np.array([0.0, sign * rate]), harmonic)[1]
                turn = 2 * math.pi * harmonic / servo.sample_time * (late - clock)
                found += np.real(sign * 0.5 / 1j * answer * np.exp(1j * (sign * rate * late + turn)))
        assert position[1500:] == pytest.approx(found, abs=2e-6)
    assert ripple_response(servo, np.array([0.0, rate]), 0) == pytest.approx(
        mean_response(servo, np.array([0.0, rate]))
    )


def test_white_noise_is_hardly_widened() -> None:
    factors = []
    for seed in range(6):
        fit, found = fitted(recorded(np.random.default_rng(seed).normal(0.0, 1e-5, len(TIMES))))
        factors.append(with_colour(fit, found).errors["bandwidth"] / found.errors["bandwidth"])
        assert with_rounding(fit, found, 0.0, 0.0) is found
        assert with_clock(fit, found).errors["bandwidth"] == pytest.approx(found.errors["bandwidth"], rel=0.2)
    assert min(factors) >= 1.0
    assert np.median(factors) < 1.25


def test_slow_noise_widens() -> None:
    white = np.random.default_rng(3).normal(0.0, 1e-5, len(TIMES) + 40)
    slow = np.convolve(white, np.ones(40) / math.sqrt(40), "valid")[: len(TIMES)]  # the same rms, all below 25 Hz
    fit, found = fitted(recorded(slow))
    assert with_colour(fit, found).errors["bandwidth"] > 2.0 * found.errors["bandwidth"]


def test_rounding_widens_as_far_as_it_moves_the_parameters() -> None:
    """The spread over many zeros of the counts is no more than what is said of one of them."""
    count, moved, said = 2e-5, [], []
    for zero in np.linspace(0.0, 1.0, 9)[:-1]:
        plain = recorded(np.zeros(len(TIMES)))
        trace = replace(
            plain,
            command=count * np.round(plain.command / count + zero) - count * zero,
            actual=count * np.round(plain.actual / count + 3.0 * zero) - count * 3.0 * zero,
        )
        counts = count_of(trace.command), count_of(trace.actual)
        assert counts == pytest.approx((count, count), rel=1e-6)
        fit, found = fitted(trace, counts[0])
        moved.append(math.log(found.values["bandwidth"] / 120.0))
        widened = with_rounding(fit, found, *counts), with_colour(fit, found)
        said.append(max(each.errors["bandwidth"] for each in widened))
    assert float(np.sqrt(np.mean(np.square(moved)))) < 1.5 * float(np.sqrt(np.mean(np.square(said))))


def test_teeth_of_the_clock_that_the_trace_cannot_tell_apart_are_all_in_the_interval() -> None:
    """A linear return under 50 um of noise: two sample times 4 % apart fit alike, each known to a microsecond by itself."""
    noise = 2.8e-9
    fit: Any = SimpleNamespace(times=np.empty(2000), doubt=lambda _: 0.0)

    def tooth(step: float, worse: float) -> Minimum:
        at, error = coordinate("sample_time", step), 1e-4
        bounds = {"sample_time": tuple(value_at("sample_time", at + side * CONFIDENCE * error) for side in (-1, 1))}
        cost = 2000 * noise + worse * noise
        return Minimum({"sample_time": step}, ("sample_time",), 0.1, cost, {"sample_time": error}, bounds)

    best, other, worst = tooth(6.4081e-3, 0.0), tooth(6.1433e-3, 3.0), tooth(5.9e-3, 9.0)
    mixed = _mixed(fit, [best, other, worst], noise)
    low, high = mixed.bounds["sample_time"]
    assert mixed.values == best.values
    assert low == pytest.approx(6.1433e-3, rel=1e-3)
    assert low < 6.1433e-3 < 6.4081e-3 < high < 6.42e-3
    likelihoods = np.exp([0.0, -1.5, -4.5])
    weights = likelihoods / likelihoods.sum()
    apart = np.log([1.0, 6.1433 / 6.4081, 5.9 / 6.4081])
    assert mixed.errors["sample_time"] == pytest.approx(float(np.sqrt(weights @ apart**2)), rel=1e-2)
    alone = _mixed(fit, [best, tooth(6.1433e-3, 60.0)], noise).bounds["sample_time"]
    assert alone == pytest.approx(best.bounds["sample_time"], rel=1e-6)


def test_the_doubt_of_a_corner_hardly_hangs_on_where_between_the_rows_it_lies() -> None:
    def doubt(offset: float) -> float:
        command = np.abs(TIMES - 1.0 - offset * 1e-3)
        fit = TraceFit.of(Trace(0.0, 1e-3, command, command, "m"))
        return fit.doubt(SimpleNamespace(values=VALUES))  # type: ignore[arg-type]

    found = [doubt(offset) for offset in np.linspace(0.0, 1.0, 9)]
    assert max(found) < 3.0 * min(found)
    assert min(found) > 0.0  # every second row alone differed by hundreds
