"""Feed-forward of acceleration and jerk: the loop stepped by hand, all roads against it, and what it is good for."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from camwright.design.optimise_axis import solve_axis
from camwright.design.servo_aware.axis_response import Axis
from camwright.jobs.job import BUNDLED_JOB, parse_job
from camwright.jobs.numbers import job_numbers
from camwright.jobs.tables import servo_table
from camwright.profiles.cut import Cut
from camwright.profiles.errors import InputError
from camwright.profiles.limits import Limits
from camwright.profiles.machines import RotaryKnife
from camwright.profiles.returns import baseline
from camwright.profiles.servo import Servo, closed_loop, sample_plant
from camwright.profiles.task import Task
from camwright.validation.servo.line_speeds import line_speed_errors
from camwright.validation.servo.monte_carlo import shear_zone_errors
from camwright.validation.servo.response import servo_response
from camwright.validation.servo.sampled_axis import axis_response, mean_response

PAPER = Servo(120.0, 0.7, 35.0, 0.004, 1.0)
FED = replace(PAPER, acceleration_feedforward=2.5e-4, jerk_feedforward=1.5e-6)
WHOLE = replace(
    PAPER,
    sample_time=0.0005,
    acceleration_feedforward=2 * 0.7 / (120.0 * 35.0),
    jerk_feedforward=1 / (120.0**2 * 35.0),
)
CUT = Cut(0.6, 80 / 60, 0.2, 0.04, 0.16, 1e-4)
TASK = Task(RotaryKnife(0.4), CUT, Limits(200 / 60, 100.0, 20_000.0))


def stepped(servo: Servo, command: np.ndarray, ends: int) -> np.ndarray:
    """Position at the last samples of a command that is given at the samples: the equations one after another."""
    plant, step = sample_plant(servo, servo.sample_time), servo.sample_time
    state = np.array([0.0, (command[1] - command[0]) / step, command[3]])
    found = []
    for k in range(3, len(command)):
        found.append(state[2])
        first = (command[k] - command[k - 1]) / step
        second = (command[k] - 2 * command[k - 1] + command[k - 2]) / step**2
        third = (command[k] - 3 * command[k - 1] + 3 * command[k - 2] - command[k - 3]) / step**3
        asked = command[k] + servo.acceleration_feedforward * second + servo.jerk_feedforward * third
        reference = servo.position_gain * (asked - state[2]) + servo.velocity_feedforward * first
        state = plant.transition @ state + plant.input * reference
    return np.array(found[-ends:])


@pytest.mark.parametrize("servo", [PAPER, FED, replace(FED, jerk_feedforward=0.0), replace(FED, sample_time=0.0021)])
def test_every_road_is_the_loop_stepped_by_hand(servo: Servo) -> None:
    profile = baseline("poly_3_4_5", TASK)
    sample = servo.sample_time * CUT.line_speed
    count = 900
    last = CUT.length - 1e-4
    places = last - sample * np.arange(count)[::-1]
    by_hand = stepped(servo, profile(places, outside="repeat"), 1)[0]
    # the design's rows
    axis = Axis(TASK, servo)
    weights = axis._weights(0.0, 0)
    seen = profile(last - sample * np.arange(len(weights)), outside="repeat")
    assert float(weights @ seen) == pytest.approx(by_hand, abs=1e-10)
    # the recorded trace's road
    times = np.array([0.0, servo.sample_time])
    clock = -count * servo.sample_time

    def command(at: np.ndarray) -> np.ndarray:
        return profile(last + CUT.line_speed * (at - servo.sample_time), outside="repeat")

    position, free = axis_response(servo, clock, command, np.concatenate([np.linspace(clock, 0.0, 7), times[1:]]))
    assert position[-1] == pytest.approx(by_hand, abs=1e-8)
    assert np.abs(free[:, -1]).max() < 1e-9
    # many servos side by side against one alone
    together = shear_zone_errors(profile, TASK, [servo, PAPER], 16)
    alone = servo_response(profile, TASK, servo).shear_zone_error
    assert together[0] == pytest.approx(alone, abs=1e-9)


def test_the_design_predicts_what_the_validation_simulates() -> None:
    profile = baseline("poly_3_4_5", TASK)
    for servo in (PAPER, FED, replace(FED, dead_time=0.0013)):
        found = float(np.abs(Axis(TASK, servo).zone_errors(profile)[2]).max())
        assert servo_response(profile, TASK, servo).shear_zone_error == pytest.approx(found, abs=1e-9)
        slower = Axis(TASK, servo.at_speed(0.3), 0.3)
        simulated = line_speed_errors(profile, TASK, [servo], np.array([0.3 * CUT.line_speed]))[0, 0]
        assert simulated == pytest.approx(float(np.abs(slower.zone_errors(profile)[2]).max()), abs=1e-9)


def test_without_it_the_equations_are_those_of_the_paper() -> None:
    assert PAPER.drive == (35.0 + 250.0, -250.0)
    assert closed_loop(PAPER)[1].shape == (3, 2)
    assert sum(FED.drive) == pytest.approx(35.0)  # at rest only the position counts
    ramp = np.arange(4) * FED.sample_time  # and at constant speed the velocity with it
    assert float(np.dot(FED.drive, -ramp)) == pytest.approx(1.0)


def test_mean_response_follows_the_command_up_to_sampling() -> None:
    rates = np.array([0.0, 5.0, 20.0, 40.0])
    without = replace(WHOLE, acceleration_feedforward=0.0, jerk_feedforward=0.0)
    plain, whole = (np.abs(mean_response(servo, rates) - 1.0) for servo in (without, WHOLE))
    assert np.all(whole[1:] < 0.15 * plain[1:])


def test_it_makes_the_axis_follow_and_shaping_needless() -> None:
    profile = baseline("poly_3_4_5", TASK)
    without = replace(WHOLE, acceleration_feedforward=0.0, jerk_feedforward=0.0)
    speeds = np.linspace(0.2, 1.0, 9) * CUT.line_speed
    assert (
        line_speed_errors(profile, TASK, [WHOLE], speeds).max()
        < 0.2 * line_speed_errors(profile, TASK, [without], speeds).max()
    )
    shares = tuple(np.linspace(1.0, 0.2, 17).tolist())
    short = TASK.with_cut(replace(CUT, length=0.3, sync_zone=0.1, shear_zone_at=0.06, shaped=True))
    found = [
        solve_axis(short, "peak_acceleration", "shaped", (servo,), shares=shares, suggest=False).minimised
        for servo in (WHOLE, without)
    ]
    assert found[0] < 0.9 * found[1]


def test_a_job_takes_it_and_says_nothing_of_it_where_there_is_none() -> None:
    text = BUNDLED_JOB.read_text(encoding="utf-8")
    plain = parse_job(text, "paper")
    assert plain.servo.acceleration_feedforward == plain.servo.jerk_feedforward == 0.0
    assert "acceleration_feedforward" not in job_numbers(plain)["servo"]
    assert "jerk_feedforward" not in servo_table(plain.servo, None)
    more = 'velocity_feedforward = 1.0\nacceleration_feedforward = "250 ms^2"\njerk_feedforward = "1500 ms^3"'
    fed = parse_job(text.replace("velocity_feedforward = 1.0", more), "paper")
    assert fed.servo.acceleration_feedforward == pytest.approx(2.5e-4)
    assert fed.servo.jerk_feedforward == pytest.approx(1.5e-6)
    assert job_numbers(fed)["servo"]["acceleration_feedforward"] == pytest.approx(2.5e-4)
    with pytest.raises(InputError, match=r"\[servo\] acceleration_feedforward"):
        parse_job(text.replace("velocity_feedforward = 1.0", more.replace("250 ms^2", "3 ms")), "paper")
