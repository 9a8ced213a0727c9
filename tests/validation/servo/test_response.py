"""Response of the servo: the figures of the paper, and hand-made axes whose crossing and settling are known."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camwright.profiles.cut import Cut
from camwright.profiles.limits import Limits
from camwright.profiles.machines import CrankSlider, RotaryKnife
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.returns import baseline
from camwright.profiles.servo import Servo
from camwright.profiles.task import Task
from camwright.validation.servo.axis_run import ServoRun
from camwright.validation.servo.response import measure_response, servo_response, sync_error
from camwright.validation.servo.simulation import simulate
from camwright.validation.servo.sweep import servo_sweep, sweep_servos

FREE = Limits(math.inf, math.inf, math.inf)
"""Nothing here asks for limits."""

KNIFE = RotaryKnife(0.4)
CUT = Cut(0.6, 80 / 60, 0.2, 0.04, 0.16, 1e-4)
FAST = replace(CUT, line_speed=120 / 60)
PAPER = Servo(120.0, 0.7, 35.0, 0.004, 1.0)


def linear(cut: Cut) -> CamProfile:
    return baseline("linear_return", Task(KNIFE, cut, FREE))


def test_crossing_of_the_paper() -> None:
    slow, fast = (servo_response(linear(cut), Task(KNIFE, cut, FREE), PAPER).crossing for cut in (CUT, FAST))
    assert slow == pytest.approx(81.5e-3, abs=1.5e-3)
    assert fast == pytest.approx(122e-3, abs=2e-3)
    assert fast / slow == pytest.approx(1.5, rel=1e-3)  # the same time after the sync zone begins


def test_overshoot_and_settling_of_the_linear_return() -> None:
    response = servo_response(linear(CUT), Task(KNIFE, CUT, FREE), PAPER)
    assert response.overshoot == pytest.approx(0.76e-3, abs=0.01e-3)
    assert response.settling == pytest.approx(136e-3, abs=3e-3)
    assert servo_response(linear(CUT), Task(KNIFE, CUT, FREE), PAPER, tolerance=0.5e-3).settling == pytest.approx(
        117e-3, abs=3e-3
    )
    assert response.phases == 16


def test_response_does_not_depend_on_the_origin() -> None:
    other = replace(CUT, origin="cut")
    here = servo_response(linear(CUT), Task(KNIFE, CUT, FREE), PAPER)
    there = servo_response(linear(other), Task(KNIFE, other, FREE), PAPER)
    for name in ("crossing", "settling", "overshoot", "peak_following_error", "shear_zone_error"):
        assert getattr(there, name) == pytest.approx(getattr(here, name), rel=1e-8)


@settings(deadline=None, max_examples=20)
@given(st.floats(0.5, 2.0))
def test_response_lengths_do_not_depend_on_the_line_speed_beyond_the_time_they_take(factor: float) -> None:
    # the servo and the linear return are linear: twice the speed is twice the error and twice the way
    cut = replace(CUT, length=2.0, sync_zone=0.39, shear_zone_at=0.35)
    quick = replace(cut, line_speed=factor * cut.line_speed)
    one = servo_response(linear(cut), Task(KNIFE, cut, FREE), PAPER, tolerance=1e-3)
    other = servo_response(linear(quick), Task(KNIFE, quick, FREE), PAPER, tolerance=factor * 1e-3)
    # to the spacing of the phases, which lie elsewhere in the sync zone when the cycle time changes
    assert other.crossing == pytest.approx(factor * one.crossing, rel=2e-3)
    assert other.settling == pytest.approx(factor * one.settling, rel=2e-3)
    assert other.overshoot == pytest.approx(factor * one.overshoot, rel=2e-3)
    assert other.peak_following_error == pytest.approx(factor * one.peak_following_error, rel=2e-2)


def test_constant_speed_is_always_in_sync() -> None:
    cut = replace(CUT, length=0.4)
    response = servo_response(CamProfile.from_arrays([0.0, 0.4], [[0.0, 1.0]]), Task(KNIFE, cut, FREE), PAPER)
    assert (response.crossing, response.settling, response.overshoot) == (0.0, 0.0, 0.0)
    assert response.peak_following_error < 1e-15
    assert response.shear_zone_error < 1e-15


def test_a_lagging_axis_never_meets_the_line_and_never_settles() -> None:
    response = servo_response(linear(CUT), Task(KNIFE, CUT, FREE), replace(PAPER, velocity_feedforward=0.0))
    assert (response.crossing, response.settling, response.overshoot) == (None, None, 0.0)
    assert response.peak_following_error == pytest.approx(CUT.line_speed / 35, rel=0.05)


def made(errors: list[object]) -> tuple[ServoRun, CamProfile]:
    """One row for each phase: an axis that is off the ideal line by given polynomials of the distance (m)."""
    master = np.linspace(-0.001, 0.605, 607) + np.linspace(0.0, 0.0009, len(errors))[:, None]
    polynomials = [np.polynomial.Polynomial(e) for e in errors]
    rows = [e(x - 0.4) for e, x in zip(polynomials, master, strict=True)]
    slopes = [e.deriv()(x - 0.4) for e, x in zip(polynomials, master, strict=True)]
    command = master - 0.2
    return ServoRun(master, command + np.array(rows), 1.0 + np.array(slopes), command), linear(CUT)


def test_crossing_settling_overshoot_and_shear_zone_error_of_a_straight_error() -> None:
    # error 1 mm - 10 mm/m * d: crosses at 100 mm, within 0.25 mm from 75 mm to 125 mm
    run, profile = made([[1e-3, -1e-2]])
    response = measure_response(run, profile, Task(KNIFE, CUT, FREE), tolerance=2e-3)
    assert response.crossing == pytest.approx(0.1, abs=1e-12)
    assert response.overshoot == pytest.approx(1e-3, rel=1e-9)
    assert response.settling == 0.0
    assert response.shear_zone_error == pytest.approx(1e-3, rel=1e-9)
    assert measure_response(run, profile, Task(KNIFE, CUT, FREE), tolerance=0.25e-3).settling is None


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize("left", [1e-7, 1e-5, 2e-4])
def test_crossing_is_the_end_of_the_swing_and_not_of_what_was_left_over(side: float, left: float) -> None:
    """Off by a little to the one side at first, then a swing to the other that ends at 100 mm, then 0.2 mm to spare."""
    zeros = np.polynomial.Polynomial.fromroots([left, 0.1, 0.19])
    run, profile = made([side * zeros.coef * (1e-3 / 1e-4)])
    response = measure_response(run, profile, Task(KNIFE, CUT, FREE))
    assert response.crossing == pytest.approx(0.1, abs=1e-9)
    assert 0 < response.overshoot < 1e-2


@pytest.mark.parametrize("length", [0.26, 0.275, 0.3, 0.35, 0.39, 0.45, 0.5, 0.6, 0.8])
def test_crossing_takes_as_long_whatever_the_cut_length(length: float) -> None:
    """The servo is linear: the jump of the ratio decides the time to the crossing, whether the knife lags or runs ahead."""
    cut = replace(CUT, length=length, sync_zone=0.6 * min(length, 1 / 3), shear_zone=0.0, shear_zone_at=0.0)
    crossing = servo_response(linear(cut), Task(KNIFE, cut, FREE), PAPER).crossing
    assert crossing == pytest.approx(81.47e-3, abs=1e-3)


def test_settling_is_the_last_leaving_and_that_of_the_worst_phase() -> None:
    # parabolas with their zero beyond the end of the zone: |e| <= tolerance beyond 0.21 - sqrt(tolerance / a)
    run, profile = made([[a * 0.0441, -a * 0.42, a] for a in (0.05, 0.1)])
    response = measure_response(run, profile, Task(KNIFE, CUT, FREE), tolerance=1e-4)
    assert response.settling == pytest.approx(0.21 - np.sqrt(1e-4 / 0.1), abs=1e-11)
    assert response.crossing is None
    assert response.phases == 2


def test_crossing_is_that_of_the_worst_phase_and_none_if_one_phase_never_crosses() -> None:
    crossing = [[1e-3, -1e-2], [-1.2e-3, 1e-2]]
    response = measure_response(*made(crossing), Task(KNIFE, CUT, FREE))
    assert response.crossing == pytest.approx(0.12, abs=1e-12)
    assert response.overshoot == pytest.approx(1e-3, rel=1e-9)
    assert measure_response(*made([*crossing, [1e-3, 0.0]]), Task(KNIFE, CUT, FREE)).crossing is None


def test_a_shear_zone_of_no_length_is_judged_at_its_point() -> None:
    run, profile = made([[1e-3, -1e-2]])
    for at in (0.0, 0.03, 0.2):
        point = replace(CUT, shear_zone=0.0, shear_zone_at=at)
        found = measure_response(run, profile, Task(KNIFE, point, FREE)).shear_zone_error
        assert found == pytest.approx(abs(1e-3 - 1e-2 * at), rel=1e-9)


def test_sync_error_is_zero_for_the_command_itself() -> None:
    profile = linear(CUT)
    run = simulate(profile, CUT, PAPER)
    perfect = ServoRun(run.master, run.command, np.ones_like(run.master), run.command)
    master, error, _ = sync_error(perfect, profile, Task(KNIFE, CUT, FREE), 0.4, 0.6)
    inside = (master > 0.4) & (master < 0.6)  # the ends are interpolated, across the corners of this command
    assert inside.sum() > 1000
    assert np.abs(error[inside]).max() < 1e-15


def test_sweep_has_all_corners_and_the_centre() -> None:
    servos = sweep_servos(replace(PAPER, velocity_feedforward=0.5, dead_time=0.003, lead_time=0.002))
    assert len(set(servos)) == 17
    assert servos[-1] == Servo(115.0, 0.8, 30.0, pytest.approx(0.0045), 0.5, 0.003, 0.002)
    assert {servo.sample_time for servo in servos[:-1]} == {1e-3, 8e-3}


def test_sweep_responses_are_those_of_each_servo() -> None:
    profile = baseline("cycloid", Task(KNIFE, CUT, FREE))
    found = servo_sweep(profile, Task(KNIFE, CUT, FREE), PAPER)
    assert len(found.responses) == len(found.cases)
    assert found.cases[-1].response == servo_response(profile, Task(KNIFE, CUT, FREE), found.cases[-1].servo)
    best, worst = found.shear_zone_error
    errors = [response.shear_zone_error for response in found.responses]
    assert (best, worst) == (min(errors), max(errors))
    assert found.settling[1] is None  # the slowest servo does not settle in 200 mm
    assert found.settling[0] == min(r.settling for r in found.responses if r.settling is not None)


def test_sweep_tells_unstable_servos_apart(monkeypatch: pytest.MonkeyPatch) -> None:
    wild = replace(PAPER, position_gain=300.0)
    monkeypatch.setattr("camwright.validation.servo.sweep.sweep_servos", lambda _: (wild, PAPER))
    found = servo_sweep(linear(CUT), Task(KNIFE, CUT, FREE), PAPER)
    assert [case.servo for case in found.cases if case.response is None] == [wild]
    assert found.settling[0] == found.settling[1] == found.responses[0].settling


def test_errors_of_a_crank_are_those_of_its_carriage() -> None:
    crank = CrankSlider(0.15, 0.6, 0.02, sync_at=1.2)
    cut = replace(CUT, length=0.9, sync_zone=0.1, shear_zone_at=0.05)
    off = 1e-3  # an axis that is ahead by a milliradian throughout
    cycle = baseline("poly_3_4_5", Task(crank, cut, FREE))
    run = simulate(cycle, cut, PAPER)
    position, ratio = (cycle(run.master, order, outside="repeat") for order in (0, 1))
    ahead = replace(run, command=position, axis=position + off, axis_ratio=ratio)
    zone = cut.return_zone
    master, error, slope = sync_error(ahead, cycle, Task(crank, cut, FREE), zone + 0.01, zone + 0.09)
    alpha = crank.sync_start(cut) + crank.sync_profile(cut)(master - zone)
    assert error == pytest.approx(crank.tool(alpha + off) - crank.tool(alpha), abs=1e-9)
    per_material = crank.sync_profile(cut)(master - zone, 1)
    assert slope == pytest.approx((crank.tool_ratio(alpha + off) - crank.tool_ratio(alpha)) * per_material, abs=1e-6)
    response = measure_response(ahead, cycle, Task(crank, cut, FREE))
    angle = Task(crank, cut, FREE).slave_at_start + position
    assert response.peak_following_error == pytest.approx(
        np.abs(crank.tool(angle + off) - crank.tool(angle)).max(), rel=1e-9
    )


def test_response_of_two_blades_in_horizontal_sync_does_not_depend_on_the_origin() -> None:
    knife = RotaryKnife(0.8, blades=2, sync="horizontal")
    cut = replace(CUT, length=0.5)
    other = replace(cut, origin="cut")
    quick = Servo(1000.0, 0.8, 120.0, 0.0005, 1.0)
    here = servo_response(baseline("poly_3_4_5", Task(knife, cut, FREE)), Task(knife, cut, FREE), quick)
    there = servo_response(baseline("poly_3_4_5", Task(knife, other, FREE)), Task(knife, other, FREE), quick)
    assert here.crossing is not None
    for name in ("crossing", "overshoot", "peak_following_error", "shear_zone_error"):
        assert getattr(there, name) == pytest.approx(getattr(here, name), rel=1e-7)
