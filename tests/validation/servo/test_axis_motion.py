"""How fast the axis itself moves, against the designs' own rows, closed forms and plain differences of the simulation."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from camwright.design.servo_aware.axis_response import Axis
from camwright.profiles.cut import Cut
from camwright.profiles.errors import InputError
from camwright.profiles.limits import Limits
from camwright.profiles.machines import (
    CrankSlider,
    LinearCarriage,
    Machine,
    RotaryKnife,
)
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.returns import baseline
from camwright.profiles.servo import Servo
from camwright.profiles.task import Task
from camwright.validation.servo.axis_motion import (
    ALLOWANCE,
    AxisPeaks,
    axis_checks,
    axis_peaks,
)
from camwright.validation.servo.simulation import simulate

KNIFE = RotaryKnife(0.4)
PAPER = Servo(120.0, 0.7, 35.0, 0.004, 1.0)
LATE = replace(PAPER, velocity_feedforward=0.8, dead_time=0.0037, lead_time=0.001)
FREE = Limits(float("inf"), float("inf"), float("inf"))  # nothing here asks for limits
CUT = Cut(0.6, 80 / 60, 0.2, 0.04, 0.13, 1e-4)
MACHINES: dict[str, tuple[Machine, Cut]] = {
    "knife": (KNIFE, CUT),
    "from the cut": (KNIFE, replace(CUT, origin="cut")),
    "carriage": (LinearCarriage(0.9), CUT),
    "crank": (CrankSlider(0.15, 0.6, 0.02, sync_at=1.2), replace(CUT, length=0.9, sync_zone=0.1, shear_zone_at=0.05)),
}


@pytest.mark.parametrize("name", MACHINES)
@pytest.mark.parametrize("servo", [PAPER, LATE], ids=["paper", "late"])
def test_the_peaks_are_those_of_the_designs_rows(name: str, servo: Servo) -> None:
    machine, cut = MACHINES[name]
    profile = baseline("poly_3_4_5", Task(machine, cut, FREE))
    peaks = axis_peaks(profile, cut, servo)
    from_return = profile.roll(cut.return_start) if cut.return_start else profile
    axis = Axis(Task(machine, replace(cut, origin="return"), FREE), servo)
    count = round(cut.length / (axis.sample / 16)) + 1
    v = cut.line_speed
    velocity = axis.on_grid(from_return, 0, count, 1) * v
    acceleration = axis.on_grid(from_return, 0, count, 2) * v**2
    # the axis is looked at on a grid of its own phases, from whose ends the two differ by less than a step
    assert peaks.greatest_velocity == pytest.approx(velocity.max(), rel=2e-3)
    assert peaks.least_velocity == pytest.approx(velocity.min(), abs=2e-3 * velocity.max())
    assert peaks.peak_acceleration == pytest.approx(np.abs(acceleration).max(), rel=5e-3)


def test_the_velocity_is_the_slope_of_the_simulated_axis() -> None:
    profile = baseline("poly_3_4_5", Task(KNIFE, CUT, FREE))
    run = simulate(profile, CUT, PAPER)
    inside = (run.master >= 0) & (run.master <= CUT.length)
    ratio = run.axis_ratio[inside]
    peaks = axis_peaks(profile, CUT, PAPER)
    assert peaks.greatest_velocity == pytest.approx(ratio.max() * CUT.line_speed, rel=1e-9)
    assert peaks.least_velocity == pytest.approx(ratio.min() * CUT.line_speed, rel=1e-9)
    # acceleration: central differences of the velocity, which between two samples is smooth
    step = float(run.master[0, 1] - run.master[0, 0]) / CUT.line_speed
    rise = np.abs(np.diff(run.axis_ratio * CUT.line_speed, axis=1)).max() / step
    assert peaks.peak_acceleration == pytest.approx(rise, rel=0.05)
    assert peaks.peak_acceleration >= rise * (1 - 1e-9)


def test_a_line_is_followed_at_its_own_speed() -> None:
    cut = replace(CUT, length=0.4)
    peaks = axis_peaks(CamProfile.from_arrays([0.0, 0.4], [[0.0, 1.0]]), cut, LATE)
    assert peaks.greatest_velocity == pytest.approx(cut.line_speed, rel=1e-12)
    assert peaks.least_velocity == pytest.approx(cut.line_speed, rel=1e-12)
    assert peaks.peak_acceleration == pytest.approx(0.0, abs=1e-9)
    assert peaks.peak_speed == pytest.approx(cut.line_speed, rel=1e-12)


def test_peak_speed_counts_either_way() -> None:
    assert AxisPeaks(1.0, -2.0, 3.0).peak_speed == 2.0


def test_checks_allow_what_lies_between_the_points_and_no_more() -> None:
    for share, passed in ((1 + 0.9 * ALLOWANCE, True), (1 + 1.1 * ALLOWANCE, False)):
        checks = axis_checks(AxisPeaks(2.0 * share, 0.5, 30.0 * share), 2.0, 30.0, 0.0, "m")
        assert {check.name: check.passed for check in checks} == {
            "axis_speed": passed,
            "axis_acceleration": passed,
            "axis_reversal": True,
        }
        assert [check.unit for check in checks] == ["m/s", "m/s^2", "m/s"]


def test_running_backwards_is_judged_by_what_is_allowed() -> None:
    back = AxisPeaks(1.0, -0.5, 1.0)
    for least, passed in ((0.0, False), (-2.0, True), (-0.4, False)):
        check = axis_checks(back, 2.0, 30.0, least, "rad")[2]
        assert (check.value, check.limit, check.passed, check.unit) == (0.5, -least, passed, "rad/s")


def test_an_unstable_servo_and_a_foreign_profile_are_refused() -> None:
    profile = baseline("poly_3_4_5", Task(KNIFE, CUT, FREE))
    with pytest.raises(InputError, match="the servo is unstable"):
        axis_peaks(profile, CUT, replace(PAPER, position_gain=200.0))
    with pytest.raises(InputError, match="but one cycle of this cut runs"):
        axis_peaks(profile, replace(CUT, length=0.5), PAPER)
