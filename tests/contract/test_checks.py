"""What the checks of a profile allow: just below the promised number they pass, just above it they fail."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from camwright import load_job, validate
from camwright.jobs.job import Job
from camwright.profiles.limits import Limits
from camwright.profiles.machines import RotaryKnife
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.returns import baseline
from camwright.validation.motor import measure_motor
from camwright.validation.servo.axis_motion import AxisPeaks, axis_checks

JOB = load_job()
"""The paper's job: 400 mm around the drum, cuts of 600 mm at 80 m/min, 200 mm of them in sync."""

CYCLE = baseline("poly_3_4_5", JOB.task)
"""From rest to rest over the correction of 200 mm, in 400 mm of return zone; the correction makes up for what the line misses."""

BELOW, ABOVE = 0.9, 1.1
"""Shares of what is allowed."""


def passed(profile: CamProfile, name: str, job: Job = JOB) -> bool:
    (check,) = (check for check in validate(profile, job).checks if check.name == name)
    return check.passed


def changed(piece: int, power: int, by: float) -> CamProfile:
    """Change one coefficient of a profile."""
    table = CYCLE.coefficients.copy()
    table[piece, power] += by
    return CamProfile(CYCLE.breaks.copy(), table)


@pytest.mark.parametrize("name", ["speed", "acceleration", "jerk"])
def test_a_limit_may_be_exceeded_by_a_billionth(name: str) -> None:
    v, height, length = 80 / 60, -0.2, 0.4
    u = np.array([0.0, 0.5 - math.sqrt(1 / 12), 0.5, 1.0])  # where the quintic's derivatives have their extremes
    peaks = {
        "speed": np.abs(v * (1 + height / length * 30 * u**2 * (1 - u) ** 2)),
        "acceleration": np.abs(v**2 * height / length**2 * 60 * u * (1 - 3 * u + 2 * u**2)),
        "jerk": np.abs(v**3 * height / length**3 * 60 * (1 - 6 * u + 6 * u**2)),
    }
    peak = float(peaks[name].max())
    for share, expected in ((BELOW, True), (ABOVE, False)):
        limits = replace(Limits(1e3, 1e3, 1e6), **{name: peak / (1 + share * 1e-9)})
        assert passed(CYCLE, name, replace(JOB, limits=limits)) is expected


@pytest.mark.parametrize("share", [BELOW, ABOVE])
def test_backwards_by_a_billionth_of_the_line_speed_is_no_reversal(share: float) -> None:
    # least ratio of the quintic with its correction scaled by c: 1 - c * 30 / 16 * 0.2 / 0.4, in the middle of the return
    factor = (1 + share * 1e-9) / (30 / 16 * 0.5)
    deviation = CYCLE.add_line(-1.0)
    slower = deviation.scale(slave=factor).add_line(1.0)
    assert passed(slower, "reversal") is (share < 1)


@pytest.mark.parametrize("share", [BELOW, ABOVE])
def test_the_advance_may_be_off_the_pitch_by_rounding(share: float) -> None:
    assert passed(CYCLE.add_line(share * 1e-12 * 0.4 / 0.6), "position_closure") is (share < 1)


@pytest.mark.parametrize("share", [BELOW, ABOVE])
@pytest.mark.parametrize(
    ("name", "power", "allowed"),
    [
        ("position_joins", 0, 1e-12 * 0.6),  # of the cut length
        ("ratio_joins", 1, 1e-9),
        (
            "ratio_slope_joins",
            2,
            1e-9 * 0.2 / 0.4**2 * 10 / math.sqrt(3) / 2,
        ),  # of its peak; the coefficient is half of it
    ],
)
def test_joins_may_jump_by_rounding(name: str, power: int, allowed: float, share: float) -> None:
    last = CYCLE.pieces - 1  # the sync zone
    assert passed(changed(last, power, share * allowed), name) is (share < 1)


@pytest.mark.parametrize("share", [BELOW, ABOVE])
def test_the_ratio_in_sync_may_be_off_by_a_billionth(share: float) -> None:
    assert passed(changed(CYCLE.pieces - 1, 1, share * 1e-9), "sync_ratio") is (share < 1)


@pytest.mark.parametrize("share", [BELOW, ABOVE])
def test_the_axis_may_exceed_its_limits_by_a_thousandth(share: float) -> None:
    peaks = AxisPeaks(2.0 * (1 + share * 1e-3), -share * 1e-3 * 2.0, 30.0 * (1 + share * 1e-3))
    checks = {check.name: check.passed for check in axis_checks(peaks, 2.0, 30.0, 0.0, "m")}
    assert checks == dict.fromkeys(("axis_speed", "axis_acceleration", "axis_reversal"), share < 1)


def test_below_a_billionth_of_the_greatest_ratio_the_slave_stands() -> None:
    """A third of the cycle is slow; there friction asks for its torque, unless the slave stands."""
    machine = RotaryKnife(0.4, drum_friction=6.0)
    torque = measure_motor(slow_for_a_third(0.5), JOB.task.with_machine(machine)).rms_torque
    assert torque is not None
    for slow, moving in ((1.1e-9, 1.0), (0.9e-9, 2 / 3)):
        found = measure_motor(slow_for_a_third(slow), JOB.task.with_machine(machine)).rms_torque
        assert found == pytest.approx(torque * math.sqrt(moving), rel=1e-6)


def slow_for_a_third(ratio: float) -> CamProfile:
    """Make a cycle that runs at ratio 1, goes down to another, stays there for a third of the cycle, and comes up again."""
    ramp, third = 0.1, 0.2
    down = (ratio - 1) / (2 * ramp)
    table = [[0.0, 1.0, 0.0], [0.1, 1.0, down], [0.0, ratio, 0.0], [0.0, ratio, -down], [0.0, 1.0, 0.0]]
    breaks = [0.0, 0.1, 0.1 + ramp, 0.1 + ramp + third, 0.1 + 2 * ramp + third, 0.6]
    for i in range(4):  # each piece begins where the one before ends
        width = breaks[i + 1] - breaks[i]
        table[i + 1][0] = sum(c * width**k for k, c in enumerate(table[i]))
    return CamProfile(np.array(breaks), np.array(table))
