"""The servo at any times, and its mean over the phases of its clock, against the simulation and a plain loop."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from camwright.profiles.cut import Cut
from camwright.profiles.limits import Limits
from camwright.profiles.machines import RotaryKnife
from camwright.profiles.polynomial.profile import FloatArray
from camwright.profiles.returns import baseline
from camwright.profiles.servo import Servo, sample_plant
from camwright.profiles.task import Task
from camwright.validation.servo.sampled_axis import axis_response, decays, mean_response
from camwright.validation.servo.simulation import simulate

FREE = Limits(math.inf, math.inf, math.inf)
"""Nothing here asks for limits."""

PAPER = Servo(120.0, 0.7, 35.0, 0.004, 1.0)
CUT = Cut(0.6, 80 / 60, 0.2, 0.04, 0.16, 1e-4)
CYCLE = baseline("poly_3_4_5", Task(RotaryKnife(0.4), CUT, FREE))


def cam(time: FloatArray) -> FloatArray:
    return CYCLE(time * CUT.line_speed, outside="repeat")


@pytest.mark.parametrize(
    "servo",
    [
        PAPER,
        replace(PAPER, damping=1.0),
        replace(PAPER, damping=1.6, velocity_feedforward=0.3),
        replace(PAPER, dead_time=0.0027, lead_time=0.001),
    ],
    ids=str,
)
def test_the_axis_is_that_of_the_simulation(servo: Servo) -> None:
    run = simulate(CYCLE, CUT, servo)
    for phase in (0, 5):
        # two seconds of run-in, then the simulated cycle; its first point is a sample
        times = run.master[phase] / CUT.line_speed
        clock = float(times[0])
        early = clock - np.arange(2000, 0, -1) * 1e-3
        position, _ = axis_response(servo, clock, cam, np.concatenate([early, times]))
        assert np.abs(position[2000:] - run.axis[phase]).max() <= 1e-11


def test_another_beginning_adds_a_combination_of_the_rows() -> None:
    # a plain loop that begins elsewhere and moving
    times = np.arange(0.0101, 0.6, 1e-3)
    position, free = axis_response(PAPER, 0.002, cam, times)
    state = np.array([3.0, -0.4, 0.02])
    axis = np.empty_like(times)
    for k in range(2, 200):
        start = 0.002 + k * PAPER.sample_time  # the last sample before the first time is k = 2
        held = PAPER.position_gain * (float(cam(np.array(start))) - state[2])
        held += float(cam(np.array(start)) - cam(np.array(start - PAPER.sample_time))) / PAPER.sample_time
        for n in np.flatnonzero((times >= start) & (times < start + PAPER.sample_time)):
            plant = sample_plant(PAPER, float(times[n]) - start)
            axis[n] = (plant.transition @ state + plant.input * held)[2]
        plant = sample_plant(PAPER, PAPER.sample_time)
        state = plant.transition @ state + plant.input * held
    rows = (free / np.linalg.norm(free, axis=1)[:, None]).T
    rest = axis - position
    assert np.abs(rest).max() > 0.005
    assert np.abs(rest - rows @ np.linalg.lstsq(rows, rest)[0]).max() <= 1e-11
    # and the poles alone make the same at the samples
    at = np.arange(3, 140)
    on = 0.002 + at * PAPER.sample_time
    _, free = axis_response(PAPER, 0.002, cam, on)
    modes = decays(PAPER, on).T
    assert np.abs(free.T - modes @ np.linalg.lstsq(modes, free.T)[0]).max() <= 1e-9 * np.abs(free).max()


@pytest.mark.parametrize("frequency", [0.5, 3.0, 20.0, 60.0])
@pytest.mark.parametrize("servo", [PAPER, Servo(90.0, 1.3, 12.0, 0.007, 0.4, 0.003, 0.001)], ids=str)
def test_the_mean_response_is_the_mean_over_the_phases(frequency: float, servo: Servo) -> None:
    rate = 2 * math.pi * frequency
    period = 5.0 + np.arange(100) / (100 * frequency)
    times = np.concatenate([np.arange(0.0, 5.0, 0.001), period])
    mean = np.zeros(100)
    for phase in range(32):
        axis, _ = axis_response(servo, phase / 32 * servo.sample_time, lambda t: np.cos(rate * t), times)
        mean += axis[-100:] / 32
    response = mean_response(servo, np.array([0.0, rate]))
    assert response[0] == 1.0
    assert np.abs(mean - (response[1] * np.exp(1j * rate * period)).real).max() <= 1e-9


def test_the_mean_response_of_slow_motion_is_the_mean_lag() -> None:
    servo = replace(PAPER, velocity_feedforward=0.8, dead_time=0.003)
    rate = 1e-3
    response = mean_response(servo, np.array([0.0, rate]))[1]
    assert -np.angle(response) / rate == pytest.approx(0.003 + 0.2 / 35, rel=1e-6)


def test_the_poles_decay_as_the_loop_does() -> None:
    times = 0.5 + np.arange(10) * PAPER.sample_time
    found = decays(PAPER, times)
    assert found.shape == (3, 10)
    assert np.allclose(np.sort(np.abs(found[:, 0])), [0.0, 1.0, 1.0], atol=1e-12)  # the sine of a pair begins at zero
    assert np.abs(found[:, 9]).max() < 0.5
