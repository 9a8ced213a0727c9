"""Servo-aware designs that took minutes or gigabytes: answered or refused at once."""

from __future__ import annotations

import re
import time
from dataclasses import replace

import pytest

from camwright.design.optimise_axis import MOST_SAMPLES, _require_samples, solve_axis
from camwright.jobs.wording import words
from camwright.profiles.cut import Cut
from camwright.profiles.errors import InfeasibleError, InputError
from camwright.profiles.limits import Limits
from camwright.profiles.machines import RotaryKnife
from camwright.profiles.servo import Servo
from camwright.profiles.task import Task
from tests.pace import in_time

SERVO = Servo(120.0, 0.7, 35.0, 0.00276, 0.5)
CUT = Cut(0.267, 80 / 60, 0.126, 0.04, 0.086, 0.25e-3, shaped=True)
TASK = Task(RotaryKnife(0.4), CUT, Limits(200 / 60, 100.0, 20_000.0))


@pytest.mark.parametrize("servo", [SERVO, replace(SERVO, position_gain=0.7)])
def test_a_crawling_line_is_refused_at_once_with_the_slowest_that_is_taken(servo: Servo) -> None:
    slow = replace(CUT, line_speed=1e-5)
    began = time.process_time()
    with pytest.raises(InputError, match=r"\d+ here, the limit is 32768; raise the line speed above ") as refused:
        solve_axis(TASK.with_cut(slow), "peak_acceleration", "shaped", (servo,))
    assert in_time(time.process_time() - began, 0.5)
    assert MOST_SAMPLES == 32768
    (message,) = (words(each) for each in refused.value.messages)
    named = float(re.findall(r"above ([\d.]+) m/min", message)[0]) / 60
    _require_samples(replace(CUT, line_speed=named), (servo,))
    with pytest.raises(InputError):
        _require_samples(replace(CUT, line_speed=0.9999 * named), (servo,))


def test_a_range_that_begins_too_slow_is_told_where_it_may_begin() -> None:
    """The job's own line speed was told to be the lowest of the range, and one that did not help to be enough."""
    own = replace(CUT, line_speed=0.05)
    with pytest.raises(InputError) as refused:
        _require_samples(own, (SERVO,), 0.01)
    (message,) = (words(each) for each in refused.value.messages)
    assert re.match(
        r"\[cut\] line_speed = 3 m/min: .* here at 0.03 m/min, the lowest of \[objective\] line_speeds, ", message
    )
    begin, raised = (float(each) / 60 for each in re.findall(r"above ([\d.]+) m/min", message))
    _require_samples(own, (SERVO,), begin / own.line_speed)
    _require_samples(replace(own, line_speed=raised), (SERVO,), 0.01)
    for cut, share in ((own, 0.9999 * begin / own.line_speed), (replace(own, line_speed=0.9999 * raised), 0.01)):
        with pytest.raises(InputError):
            _require_samples(cut, (SERVO,), share)


def test_a_job_that_no_shaped_command_does_is_refused_in_seconds() -> None:
    """The corners of the ranges leave no command; to see that took the dual simplex over 90 s."""
    corners = tuple(
        replace(SERVO, bandwidth=120 * b, damping=0.7 * d, position_gain=35 * k)
        for b in (0.9, 1.1)
        for d in (0.9, 1.1)
        for k in (0.95, 1.05)
    )
    began = time.process_time()
    with pytest.raises(InfeasibleError, match=r"no shaped command within the limits holds the axis"):
        solve_axis(TASK, "rms_jerk", "shaped", (SERVO, *corners))
    assert in_time(time.process_time() - began, 20.0)
