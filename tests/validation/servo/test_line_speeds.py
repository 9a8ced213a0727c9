"""The sync error over line speed against the simulation of each line speed by itself."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camwright.profiles.cut import Cut
from camwright.profiles.limits import Limits
from camwright.profiles.machines import CrankSlider, LinearCarriage, Machine, RotaryKnife
from camwright.profiles.returns import baseline
from camwright.profiles.servo import Servo, spectral_radius
from camwright.profiles.task import Task
from camwright.validation.servo.line_speeds import line_speed_errors, worst_line_speed_error
from camwright.validation.servo.response import greatest_sync_error, servo_response
from camwright.validation.servo.simulation import simulate

KNIFE = RotaryKnife(0.4)
CUT = Cut(0.6, 80 / 60, 0.2, 0.04, 0.16, 1e-4)
PAPER = Servo(120.0, 0.7, 35.0, 0.004, 1.0)
FREE = Limits(1e3, 1e6, 1e9)
TASK = Task(KNIFE, CUT, FREE)
SPEEDS = np.array([8.0, 9.3, 31.0, 80.0, 96.0]) / 60


@settings(max_examples=50, deadline=None)
@given(
    bandwidth=st.floats(80.0, 150.0),
    gain=st.floats(10.0, 50.0),
    sample=st.floats(1e-3, 8e-3),
    feedforward=st.floats(0.0, 1.0),
    share=st.floats(0.05, 2.0),
)
def test_scaled_servo_does_over_the_master_what_the_servo_does_at_that_speed(
    bandwidth: float, gain: float, sample: float, feedforward: float, share: float
) -> None:
    servo = Servo(bandwidth, 0.8, gain, sample, feedforward, dead_time=0.003, lead_time=0.001)
    if not spectral_radius(servo) < 0.99:
        return
    profile = baseline("poly_3_4_5", Task(KNIFE, CUT, FREE))
    real = simulate(profile, replace(CUT, line_speed=share * CUT.line_speed), servo)
    scaled = simulate(profile, CUT, servo.at_speed(share))
    assert real.axis.shape == scaled.axis.shape
    assert np.abs(real.axis - scaled.axis).max() <= 1e-9
    assert np.abs(real.axis_ratio - scaled.axis_ratio).max() <= 1e-7


@pytest.mark.parametrize(
    ("machine", "cut", "law"),
    [
        (KNIFE, CUT, "poly_3_4_5"),
        (KNIFE, replace(CUT, origin="cut"), "linear_return"),
        (KNIFE, replace(CUT, shear_zone=0.0, shear_zone_at=0.13), "cycloid"),
        (RotaryKnife(0.8, blades=2, sync="horizontal"), replace(CUT, length=0.5), "poly_3_4_5"),
        (LinearCarriage(0.8), CUT, "poly_3_4_5"),
        (
            CrankSlider(0.15, 0.6, 0.02, sync_at=1.2),
            replace(CUT, length=0.9, sync_zone=0.1, shear_zone_at=0.05),
            "poly_3_4_5",
        ),
    ],
)
def test_errors_are_those_of_each_line_speed_by_itself(machine: Machine, cut: Cut, law: str) -> None:
    profile = baseline(law, Task(machine, cut, FREE))
    servos = [replace(PAPER, dead_time=0.002, velocity_feedforward=0.95), replace(PAPER, bandwidth=90.0)]
    found = line_speed_errors(profile, Task(machine, cut, FREE), servos, SPEEDS)
    assert found.shape == (2, len(SPEEDS))
    for row, servo in zip(found, servos, strict=True):
        for value, speed in zip(row, SPEEDS, strict=True):
            alone = servo_response(profile, Task(machine, cut, FREE).at_speed(float(speed)), servo)
            assert value == pytest.approx(alone.shear_zone_error, abs=1e-9)


def test_more_phases_see_at_least_what_fewer_see() -> None:
    profile = baseline("linear_return", Task(KNIFE, CUT, FREE))
    few, many = (line_speed_errors(profile, TASK, [PAPER], SPEEDS, phases)[0] for phases in (16, 64))
    assert (many >= few - 1e-12).all()
    assert (many <= 1.05 * few + 1e-12).all()
    assert (many > few + 1e-9).any()


def test_a_servo_that_is_unstable_is_infinitely_far_off_at_every_speed() -> None:
    found = line_speed_errors(
        baseline("cycloid", Task(KNIFE, CUT, FREE)), TASK, [replace(PAPER, position_gain=300.0), PAPER], SPEEDS
    )
    assert np.isinf(found[0]).all()
    assert np.isfinite(found[1]).all()


def test_a_line_that_hardly_moves_is_followed() -> None:
    found = line_speed_errors(baseline("cycloid", Task(KNIFE, CUT, FREE)), TASK, [PAPER], np.array([1e-6, 1e-3]))
    assert (found < 1e-9).all()


@pytest.mark.parametrize("name", ["linear_return", "poly_3_4_5"])
def test_the_worst_line_speed_is_that_of_all_phases(name: str) -> None:
    servos = [PAPER, replace(PAPER, bandwidth=108.0), replace(PAPER, damping=0.77, position_gain=36.75)]
    profile, speeds = baseline(name, TASK), np.linspace(8.0, 80.0, 30) / 60
    every = line_speed_errors(profile, TASK, servos, speeds)
    assert worst_line_speed_error(profile, TASK, servos, speeds) == pytest.approx(every.max(), rel=1e-12)
    assert worst_line_speed_error(profile, TASK, [replace(PAPER, position_gain=1e4)], speeds) == np.inf


def test_parts_of_the_zone_at_one_line_speed_are_those_of_each_by_itself() -> None:
    profile, start = baseline("poly_3_4_5", TASK), CUT.return_start + CUT.return_zone
    at, length, speeds = np.array([0.0, 0.155, 0.16]), np.full(3, 0.04), np.array([80.0, 80.0, 2.0]) / 60
    for servo in (PAPER, replace(PAPER, bandwidth=90.0, dead_time=0.002)):
        found = line_speed_errors(profile, TASK, [servo], speeds, zones=(at, length))[0]
        for value, speed, begin, long in zip(found, speeds.tolist(), at, length, strict=True):
            part = start + begin, start + begin + long
            assert value == pytest.approx(greatest_sync_error(profile, TASK.at_speed(speed), servo, *part), abs=1e-12)
