"""A change run at every phase: into the same cam it is the cam itself, into another what a whole shift makes of it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from camwright.jobs.examples import example
from camwright.jobs.job import parse_job
from camwright.profiles.errors import InputError
from camwright.profiles.line_run import LineRun
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.returns import baseline
from camwright.profiles.servo import Servo
from camwright.profiles.task import Task
from camwright.validation.production.cam_change import AFTER, CamChange, change_checks, run_change
from camwright.validation.production.motion_table import ShiftCam
from camwright.validation.production.shift import run_shift
from camwright.validation.servo.axis_motion import axis_peaks
from camwright.validation.servo.line_speeds import line_speed_errors

SERVO = Servo(120.0, 0.7, 35.0, 0.004, 1.0)
LATE = replace(SERVO, dead_time=0.003)


def task() -> Task:
    found = parse_job(example("paper-600").text, "paper-600").task
    return found.with_cut(replace(found.cut, origin="return", length=0.45))


def cams() -> tuple[CamProfile, CamProfile]:
    return baseline("poly_3_4_5", task()), baseline("cycloid", task())


def change(before: CamProfile, after: CamProfile, between: CamProfile | None = None) -> CamChange:
    zero = task().slave_zero(before)
    middle = None if between is None else ShiftCam(between, zero)
    return CamChange(ShiftCam(before, zero), ShiftCam(after, zero), (task(), task()), middle)


@pytest.mark.parametrize("servo", [SERVO, LATE])
@pytest.mark.parametrize("speed", [0.2, 80 / 60])
def test_a_change_into_the_same_cam_is_that_cam(servo: Servo, speed: float) -> None:
    cam = cams()[0]
    run = run_change(change(cam, cam, cam), servo, [speed])
    expected = line_speed_errors(cam, task(), [servo], np.array([speed]), 64)[0, 0]
    assert run.sync_error == pytest.approx(expected, rel=1e-3)
    peaks = axis_peaks(cam, task().at_speed(speed).cut, servo)
    assert run.peaks.peak_acceleration == pytest.approx(peaks.peak_acceleration, rel=1e-3)
    assert run.peaks.greatest_velocity == pytest.approx(peaks.greatest_velocity, rel=1e-5)
    assert run.peaks.least_velocity == pytest.approx(peaks.least_velocity, abs=1e-6)


def test_a_change_is_what_a_shift_makes_of_it_at_its_phases() -> None:
    before, after = cams()
    given, speed = change(before, after), 80 / 60
    shift = given.shift(6)
    time = float(shift.table.joints[-1]) / speed
    # a shift begins with the servo's clock at its first joint: later cycles meet it at other phases
    run = run_shift(shift, LineRun(np.array([0.0, time]), np.full(2, speed)), SERVO)
    found = run_change(given, SERVO, [speed])
    assert run.sync_errors[6 - 1 :].max() <= found.sync_error * (1.0 + 1e-6)
    assert len(run.sync_errors) == 6 + AFTER


def test_the_worst_of_speeds_is_told() -> None:
    given = change(*cams())
    each = [run_change(given, SERVO, [speed], 16) for speed in (0.5, 1.0)]
    both = run_change(given, SERVO, [0.5, 1.0], 16)
    assert both.sync_error == max(run.sync_error for run in each)
    assert both.peaks.peak_acceleration == max(run.peaks.peak_acceleration for run in each)


def test_a_step_at_the_seam_fails_the_checks() -> None:
    cam = cams()[0]
    high = cam.shift(slave=2e-3)
    failed = {
        check.name for check in change_checks(change(cam, cam, high), (SERVO, LATE), [80 / 60]) if not check.passed
    }
    assert "sync" in failed
    assert {check.name for check in change_checks(change(cam, cam), (SERVO,), [80 / 60])} == {
        "sync", "axis_speed", "axis_acceleration", "axis_reversal",
    }  # fmt: skip


def test_a_line_too_slow_to_run_is_refused() -> None:
    with pytest.raises(InputError, match=r"a change between cams at 0\.0001 m/s has .* samples .* the limit is 131072"):
        run_change(change(*cams()), SERVO, [1e-4])
