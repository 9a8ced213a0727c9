"""The axis on a slow line in closed form against the simulation of every sample, which it must equal at any line speed."""

from __future__ import annotations

import math
import time
import tracemalloc
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

from camwright.profiles.cut import Cut
from camwright.profiles.limits import Limits
from camwright.profiles.machines import CrankSlider, LinearCarriage, Machine, RotaryKnife
from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.profiles.returns import baseline
from camwright.profiles.servo import Servo, spectral_radius
from camwright.profiles.task import Task
from camwright.validation.servo import monte_carlo, simulation
from camwright.validation.servo.axis_motion import axis_peaks
from camwright.validation.servo.lead import length_errors
from camwright.validation.servo.monte_carlo import shear_zone_errors
from camwright.validation.servo.response import greatest_sync_error, servo_response, shear_zone_of
from camwright.validation.servo.simulation import SUBSTEPS, simulate, slow_cycle, slow_run
from camwright.validation.servo.slow_axis import Samples, SlowAxis
from tests.pace import in_time

FREE = Limits(math.inf, math.inf, math.inf)
PAPER = Servo(120.0, 0.7, 35.0, 0.004, 1.0)
SLOW = Cut(0.6, 0.02, 0.2, 0.04, 0.16, 1e-4)
"""30 s a cycle, 7500 samples of 4 ms."""

CRANK = CrankSlider(0.15, 0.5, 0.0, sync_at=1.2)
ROUNDING = 2e-12
"""What closed form and simulation may differ by (m): the simulation begins from rest, which it has forgotten to 1e-12."""


def whole(monkeypatch: pytest.MonkeyPatch, most: float) -> None:
    """Simulate sample by sample up to so many samples."""
    monkeypatch.setattr(simulation, "WHOLE", most)
    for module in (simulation, monte_carlo):
        monkeypatch.setattr(module, "WHOLE_PART", most)


def both(monkeypatch: pytest.MonkeyPatch, measure):  # type: ignore[no-untyped-def]
    """Measure in closed form and with every sample."""
    found = []
    for most in (0.0, math.inf):
        with monkeypatch.context() as patch:
            whole(patch, most)
            simulation.lifted_cycle.cache_clear()
            found.append(measure())
    simulation.lifted_cycle.cache_clear()
    return found


servos = st.builds(
    Servo,
    bandwidth=st.floats(60.0, 400.0),
    damping=st.floats(0.3, 1.4),
    position_gain=st.floats(8.0, 45.0),
    sample_time=st.floats(1e-3, 6e-3),
    velocity_feedforward=st.floats(0.0, 1.0),
    dead_time=st.floats(0.0, 0.01),
)


def test_every_sample_of_the_closed_form_is_that_of_the_simulation(monkeypatch: pytest.MonkeyPatch) -> None:
    profile = baseline("poly_3_4_5", Task(RotaryKnife(0.4), SLOW, FREE))
    whole(monkeypatch, 0.0)
    slow = slow_cycle(profile, SLOW, replace(PAPER, dead_time=0.0013))
    assert slow is not None
    whole(monkeypatch, math.inf)
    monkeypatch.setattr(simulation, "_MOST_VALUES", 0)  # as few phases
    simulation.lifted_cycle.cache_clear()
    run = simulate(profile, SLOW, replace(PAPER, dead_time=0.0013))
    simulation.lifted_cycle.cache_clear()
    samples = np.arange(run.master.shape[1] // SUBSTEPS)
    found = slow_run(profile, *slow.at(samples))
    assert np.abs(found.master - run.master).max() <= ROUNDING
    assert np.abs(found.axis - run.axis).max() <= ROUNDING
    assert np.abs(found.axis_ratio - run.axis_ratio).max() * SLOW.line_speed <= 1e-9
    assert np.abs(found.command - run.command).max() <= ROUNDING


@settings(max_examples=15, deadline=None, phases=[Phase.explicit, Phase.generate])
@given(
    servos,
    st.sampled_from(["linear_return", "poly_3_4_5"]),
    st.sampled_from(["return", "cut"]),
    st.floats(0.02, 0.1),
    st.sampled_from([RotaryKnife(0.4), RotaryKnife(0.4, sync="horizontal"), LinearCarriage(2.0), CRANK]),
)
def test_responses_are_those_of_the_whole_simulation(
    servo: Servo, law: str, origin: str, line_speed: float, machine: Machine
) -> None:
    cut = replace(SLOW, origin=origin, line_speed=line_speed, sync_zone=0.1, shear_zone_at=0.05)
    if spectral_radius(servo) >= 1.0 or (law == "linear_return" and not machine.pitch):
        return
    task = Task(machine, cut, FREE)
    profile = baseline(law, task)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(simulation, "_MOST_VALUES", 0)
        closed, full = both(patch, lambda: servo_response(profile, task, servo))
    assert (closed.crossing is None, closed.settling is None) == (full.crossing is None, full.settling is None)
    assert closed.phases == full.phases == SUBSTEPS
    for name in ("overshoot", "peak_following_error", "shear_zone_error"):
        assert abs(getattr(closed, name) - getattr(full, name)) <= ROUNDING, name
    for name in ("crossing", "settling"):
        if getattr(full, name) is not None:  # places are as good as the errors that they are read from
            assert abs(getattr(closed, name) - getattr(full, name)) <= 1e-7 * cut.length, name


@pytest.mark.parametrize("feedforward", [0.5, 1.0])
def test_every_measure_of_a_slow_line_is_that_of_the_whole_simulation(
    monkeypatch: pytest.MonkeyPatch, feedforward: float
) -> None:
    servo = replace(PAPER, velocity_feedforward=feedforward, dead_time=0.002)
    cut = replace(SLOW, shear_zone_at=0.01, shear_zone=0.1)
    task = Task(RotaryKnife(0.4), cut, FREE)
    profile = baseline("poly_3_4_5", task)
    start, end = cut.return_start + cut.return_zone + 0.003, cut.return_start + cut.length

    def measure() -> list[float]:
        peaks = axis_peaks(profile, cut, servo)
        lengths = length_errors(profile, task, servo)
        return [
            greatest_sync_error(profile, task, servo, start, end),
            *shear_zone_errors(profile, task, [servo, replace(servo, position_gain=30.0)]).tolist(),
            *(value for length in lengths for value in (length.offset, length.variation, length.offset_with_lead)),
            peaks.greatest_velocity * servo.sample_time,
            peaks.least_velocity * servo.sample_time,
            peaks.peak_acceleration * servo.sample_time**2,
        ]

    closed, full = both(monkeypatch, measure)
    assert np.abs(np.subtract(closed, full)).max() <= ROUNDING
    assert sum(abs(value) > ROUNDING for value in full) >= 8


@pytest.mark.parametrize(
    ("line_speed", "length", "servo"),
    [
        (1e-4, 6.0, replace(PAPER, sample_time=1e-3)),  # 6e7 samples
        (1e-4, 1000.0, replace(PAPER, sample_time=1e-3)),  # 1e10 samples
        (0.5, 0.6, replace(PAPER, sample_time=1e-6)),
        (0.01, 0.6, replace(PAPER, position_gain=0.1)),  # remembers 350 s
    ],
)
def test_any_line_speed_takes_little_time_and_memory(line_speed: float, length: float, servo: Servo) -> None:
    cut = Cut(length, line_speed, length / 4, length / 10, 0.1 * length, 1e-4)
    task = Task(RotaryKnife(0.8 * length), cut, FREE)
    profile = baseline("poly_3_4_5", task)
    tracemalloc.start()
    began = time.process_time()
    response = servo_response(profile, task, servo)
    took, most = time.process_time() - began, tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert in_time(took, 3.0)
    assert most < 100e6
    if servo.position_gain == 35.0 and line_speed < 0.1:
        # at constant speed without dead time the axis is on the command; in the return it is late by what the acceleration takes
        assert response.shear_zone_error <= 1e-9
        assert response.settling is not None


def test_what_is_rounding_is_not_looked_at_again_and_again(monkeypatch: pytest.MonkeyPatch) -> None:
    # with full feedforward the error of a crawling line is 1e-13 m at most: sixteen rounds went from hump to hump of its rounding
    looks: list[int] = []
    at = SlowAxis.at

    def counted(axis: SlowAxis, samples: Samples) -> tuple[FloatArray, FloatArray]:
        looks.append(len(samples))
        return at(axis, samples)

    monkeypatch.setattr(SlowAxis, "at", counted)
    cut = Cut(3.0, 1e-4, 0.7, 0.1, 0.4, 2e-4)
    task = Task(LinearCarriage(1.2), cut, replace(FREE, reversal=True))
    error = greatest_sync_error(baseline("poly_3_4_5", task), task, PAPER, *shear_zone_of(cut))
    assert error < 1e-12
    assert len(looks) <= 6


def test_the_response_of_a_crawling_line_is_its_own_expansion() -> None:
    """Far below the servo's speed the axis lags by ``(1 - alpha) / K`` times the velocity: eq. 2 of S1 at every place."""
    servo = replace(PAPER, velocity_feedforward=0.25)
    cut = replace(SLOW, line_speed=1e-4)
    task = Task(RotaryKnife(0.4), cut, FREE)
    profile = baseline("poly_3_4_5", task)
    greatest = profile.peak(1)
    response = servo_response(profile, task, servo)
    expected = 0.75 / servo.position_gain * greatest * cut.line_speed
    assert math.isclose(response.peak_following_error, expected, rel_tol=1e-4)
    assert math.isclose(response.shear_zone_error, 0.75 / servo.position_gain * cut.line_speed, rel_tol=1e-9)


def test_a_table_of_many_pieces_is_no_harder() -> None:
    x = np.linspace(0.0, 0.6, 3001)
    wave = 0.4 / 0.6 * x + 0.01 * np.sin(2 * np.pi * x / 0.6)
    slope = 0.4 / 0.6 + 0.01 * 2 * np.pi / 0.6 * np.cos(2 * np.pi * x / 0.6)
    h = np.diff(x)
    rise = np.diff(wave) / h
    cubic = (slope[:-1] + slope[1:] - 2 * rise) / h**2
    square = (3 * rise - 2 * slope[:-1] - slope[1:]) / h
    profile = CamProfile(x, np.column_stack([wave[:-1], slope[:-1], square, cubic]))
    cut = replace(SLOW, line_speed=1e-4, sync_zone=0.1, shear_zone_at=0.05)
    began = time.process_time()
    response = servo_response(profile, Task(RotaryKnife(0.4), cut, FREE), PAPER)
    assert in_time(time.process_time() - began, 5.0)
    assert response.peak_following_error > 0.0


def test_what_decides_may_lie_where_a_zone_begins() -> None:
    # beside the rows of the sync zone that are filled up with its first place
    cut = Cut(6.0, 1e-4, 0.2, 0.1, 0.1, 1e-4)
    task = Task(LinearCarriage(0.8), cut, FREE)
    response = servo_response(baseline("poly_4_5_6_7", task), task, replace(PAPER, sample_time=1e-3))
    assert response.settling == 0.0
    assert response.shear_zone_error <= 1e-12
