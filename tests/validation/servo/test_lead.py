"""Where the cut falls at every line speed: closed forms at constant speed, the simulation of each speed, and lead."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from camwright.profiles.cut import Cut
from camwright.profiles.errors import InputError
from camwright.profiles.limits import Limits
from camwright.profiles.machines import CrankSlider, RotaryKnife
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.returns import baseline
from camwright.profiles.servo import Servo, mean_lag
from camwright.profiles.task import Task
from camwright.validation.servo.lead import SHARES, length_errors
from camwright.validation.servo.response import sync_error
from camwright.validation.servo.simulation import simulate

FREE = Limits(math.inf, math.inf, math.inf)
"""Nothing here asks for limits."""

KNIFE = RotaryKnife(0.4)
CUT = Cut(0.6, 50 / 60, 0.2, 0.04, 0.16, 1e-4)
PAPER = Servo(120.0, 0.7, 35.0, 0.004, 1.0)
SAME_SPEED = replace(CUT, length=0.4)
"""Cut length and circumference alike: the knife runs with the line all the time."""


def line() -> CamProfile:
    return CamProfile.from_arrays([0.0, SAME_SPEED.length], [[0.0, 1.0]])


def test_the_shares_are_those_of_the_answer() -> None:
    found = length_errors(line(), Task(KNIFE, SAME_SPEED, FREE), PAPER)
    assert tuple(error.share for error in found) == SHARES == (0.1, 0.25, 0.5, 1.0)
    assert [error.line_speed for error in found] == pytest.approx([share * 50 / 60 for share in SHARES])


def test_ten_milliseconds_at_fifty_metres_a_minute_are_eight_millimetres() -> None:
    found = length_errors(line(), Task(KNIFE, SAME_SPEED, FREE), replace(PAPER, dead_time=0.010))
    assert found[-1].offset == pytest.approx(8.333e-3, abs=1e-6)


@pytest.mark.parametrize("feedforward", [0.0, 0.8, 1.0])
@pytest.mark.parametrize(("dead_time", "lead_time"), [(0.010, 0.0), (0.0047, 0.002), (0.0, 0.003)])
def test_at_constant_speed_the_offset_is_the_lag_times_the_speed(
    feedforward: float, dead_time: float, lead_time: float
) -> None:
    servo = Servo(120.0, 0.7, 35.0, 0.004, feedforward, dead_time, lead_time)
    lag = dead_time - lead_time + (1 - feedforward) / 35.0
    for error in length_errors(line(), Task(KNIFE, SAME_SPEED, FREE), servo):
        assert error.offset == pytest.approx(error.line_speed * lag, abs=1e-12)
        assert error.variation == pytest.approx(0.0, abs=1e-12)
        assert error.offset_with_lead == pytest.approx(0.0, abs=1e-12)


def test_the_mean_lag_is_the_lead_that_makes_up_for_it() -> None:
    servo = Servo(120.0, 0.7, 35.0, 0.004, 0.8, 0.0047, 0.002)
    assert mean_lag(servo) == pytest.approx(0.0047 + 0.2 / 35.0, rel=1e-15)
    assert mean_lag(replace(servo, lead_time=0.0)) == mean_lag(servo)


@pytest.mark.parametrize("law", ["linear_return", "poly_3_4_5"])
def test_offset_and_variation_are_those_of_the_whole_simulation(law: str) -> None:
    # the shear zone in the middle of the sync zone, where the phases of the linear return still differ
    cut = replace(CUT, line_speed=80 / 60, shear_zone_at=0.08)
    servo = Servo(120.0, 0.7, 35.0, 0.004, 1.0, 0.0037)
    profile = baseline(law, Task(KNIFE, cut, FREE))
    for error in length_errors(profile, Task(KNIFE, cut, FREE), servo):
        slower = replace(cut, line_speed=error.share * cut.line_speed)
        for lead, offset in ((0.0, error.offset), (mean_lag(servo), error.offset_with_lead)):
            run = simulate(profile, slower, replace(servo, lead_time=lead))
            x, off, _ = sync_error(run, profile, Task(KNIFE, slower, FREE), 0.4 + 0.08, 0.4 + 0.12)
            late = [-float(np.trapezoid(e, at)) / 0.04 for at, e in zip(x, off, strict=True)]
            assert offset == pytest.approx(np.mean(late), abs=3e-7)  # the trapezes' error
            if lead == 0.0:
                assert error.variation == pytest.approx(max(late) - min(late), abs=3e-7)
    assert error.variation > 1e-5 or law == "poly_3_4_5"  # smooth commands hardly depend on the phase


def test_a_shear_zone_of_no_length_is_judged_at_its_point() -> None:
    cut = replace(CUT, shear_zone=0.0, shear_zone_at=0.2)
    profile = baseline("poly_3_4_5", Task(KNIFE, cut, FREE))
    servo = replace(PAPER, dead_time=0.005)
    error = length_errors(profile, Task(KNIFE, cut, FREE), servo)[-1]
    run = simulate(profile, cut, servo)
    late = -sync_error(run, profile, Task(KNIFE, cut, FREE), cut.length, cut.length)[1][:, 0]
    assert error.offset == pytest.approx(late.mean(), abs=1e-12)
    assert error.variation == pytest.approx(np.ptp(late), abs=1e-12)


def test_the_offset_of_a_crank_is_that_of_its_carriage() -> None:
    crank = CrankSlider(0.15, 0.6, 0.02, sync_at=1.2)
    cut = replace(CUT, length=1.8, sync_zone=0.1, shear_zone=0.02, shear_zone_at=0.08)
    profile = baseline("poly_3_4_5", Task(crank, cut, FREE))
    fast = Servo(2000.0, 0.8, 300.0, 2e-4, 1.0)
    late, prompt = (
        length_errors(profile, Task(crank, cut, FREE), replace(fast, dead_time=time)) for time in (0.002, 0.0)
    )
    # the carriage is where it was 2 ms ago: in sync then as now, but for the servo's own error
    for with_dead_time, without in zip(late, prompt, strict=True):
        assert with_dead_time.offset - without.offset == pytest.approx(0.002 * with_dead_time.line_speed, rel=1e-3)
        assert with_dead_time.offset_with_lead == pytest.approx(without.offset, abs=1e-12)


def test_an_unstable_servo_is_refused() -> None:
    with pytest.raises(InputError, match="the servo is unstable"):
        length_errors(line(), Task(KNIFE, SAME_SPEED, FREE), replace(PAPER, position_gain=200.0))


def test_a_profile_of_another_cut_is_refused() -> None:
    with pytest.raises(InputError, match="but one cycle of this cut runs"):
        length_errors(line(), Task(KNIFE, CUT, FREE), PAPER)
