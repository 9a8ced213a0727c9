"""The sync error while the line ramps: a closed form, a plain loop over the samples, and the steady line as the limit of a slow ramp."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from camwright import load_job
from camwright.design.optimise import solve
from camwright.figures.line_ramp import line_ramp_figure
from camwright.jobs.job import Job
from camwright.profiles.line import STEADY, Line
from camwright.profiles.objective import of_command
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.servo import Servo, closed_loop
from camwright.studies.line_ramps import line_ramps
from camwright.validation.production.ramped_servo import line_travel, ramped_sync
from camwright.validation.servo.line_speeds import line_speed_errors

EXAMPLES = Path(__file__).parents[3] / "examples"


@cache
def designed(name: str) -> tuple[CamProfile, Job]:
    """Design an example without a line's ramp: its cam, and the job with the zone placed."""
    job = load_job(EXAMPLES / f"{name}.toml")
    solution = solve(job.task, of_command(job.objective))
    return solution.profile, replace(job, machine=solution.machine)


def test_a_steady_line_has_no_ramp() -> None:
    profile, job = designed("paper-600")
    assert ramped_sync(profile, job.task.with_line(STEADY), job.servo) is None


@pytest.mark.parametrize(("ramp", "jerk"), [(1.0, 0.0), (-2.0, 5.0), (3.0, 1.0), (-0.5, 0.5)])
def test_the_line_travels_as_its_ramp_says(ramp: float, jerk: float) -> None:
    speed = 4 / 3
    travel = line_travel(speed, ramp, jerk, 0.2)
    start, end = float(travel(travel.start, 1)), float(travel(travel.end, 1, side="left"))
    assert (start, end) == pytest.approx((0.0, speed) if ramp > 0 else (speed, 0.0), abs=1e-12)
    assert float(np.abs(travel(travel.breaks, 2)).max()) <= abs(ramp) * (1 + 1e-12)
    if jerk:
        assert float(np.abs(travel(travel.breaks[:-1], 3)).max()) == pytest.approx(jerk, rel=1e-9)
    # its way is the mean speed times its time, whatever the jerk, and half as long again a steady line goes beside
    duration = travel.end - travel.start - 0.4
    assert float(travel(travel.end)) - float(travel(travel.start)) == pytest.approx(
        speed * (0.5 * duration + 0.2), rel=1e-12
    )


@pytest.mark.parametrize("servo", [Servo(120.0, 0.7, 35.0, 0.004, 1.0), Servo(200.0, 0.9, 20.0, 0.002, 1.0)])
def test_in_a_long_ramp_the_axis_lags_by_its_acceleration(servo: Servo) -> None:
    """With full feed-forward the error of a steady acceleration ``a`` is ``a (2 ζ / ω + dT) / K``."""
    profile, job = designed("paper-600")
    for a in (0.02, 0.04):
        found = ramped_sync(profile, job.task.with_line(Line(a)), servo, phases=4)
        assert found is not None
        slow = found.line_speeds[1] < 0.5 * job.cut.line_speed  # there the return is forgotten before the cut
        expected = a * (2 * servo.damping / servo.bandwidth + servo.sample_time) / servo.position_gain
        assert found.errors[1][slow].max() == pytest.approx(expected, rel=2e-2)


def test_a_plain_loop_over_the_samples_gives_the_same_error() -> None:
    profile, job = designed("paper-600")
    task, servo = job.task.with_line(Line(0.5, jerk=20.0)), job.servo
    found = ramped_sync(profile, task, servo, phases=1)
    assert found is not None
    assert "braking" in found.ways
    speeds, errors = found.line_speeds[found.ways.index("braking")], found.errors[found.ways.index("braking")]
    # the same in a loop: samples from long before the ramp, the sync error at those in the shear zone
    travel = line_travel(job.cut.line_speed, -0.5, 20.0, 2.0)
    step, cut = servo.sample_time, job.cut
    count = int((travel.end - travel.start) / step) - 1
    times = np.arange(-int(1.9 / step), count - int(1.9 / step)) * step
    times = times[(times > travel.start) & (times < travel.end)]
    place = travel(times)
    command = profile(place, outside="repeat")
    a, b = closed_loop(servo)
    axis = np.empty(len(times))
    base = command[0]
    state = np.zeros(3)
    for k in range(len(times)):
        axis[k] = state[2] + base
        state = a @ state + b @ (np.array([command[k], command[k - 1 if k else 0]]) - base)
    along = (place - cut.sync_start) % cut.length
    inside = (along >= cut.shear_zone_at) & (along <= cut.shear_zone_at + cut.shear_zone) & (times > 0.0)
    off = np.abs(axis - command)[inside]
    assert off.max() == pytest.approx(errors.max(), rel=0.02)
    assert len(speeds) >= 1


@pytest.mark.parametrize("name", ["flying-saw", "chasing-shear", "cross-cutter", "thick-product"])
def test_a_slow_ramp_is_a_steady_line_at_each_of_its_speeds(name: str) -> None:
    profile, job = designed(name)
    v, a = job.cut.line_speed, 1e-3 * job.cut.line_speed
    found = ramped_sync(profile, job.task.with_line(Line(a)), job.servo, phases=1)
    assert found is not None
    speeds, errors = found.line_speeds[1], found.errors[1]
    near = np.argsort(np.abs(speeds - 0.9 * v))[:3]
    steady = line_speed_errors(profile, job.task, [job.servo], speeds[near])[0]
    ramp = a / job.servo.position_gain * (2 / job.servo.bandwidth + job.servo.sample_time)
    assert np.all(np.abs(errors[near] - steady) <= 0.15 * steady + 4 * ramp)


def test_the_study_tells_the_worst_and_draws_it() -> None:
    profile, job = designed("paper-600")
    job = replace(job, line=Line(1.0, 5.0, 50.0))
    ramps = line_ramps(profile, job)
    assert ramps.sync is not None
    error, speed, way = ramps.sync.worst
    assert error == pytest.approx(5.0 * (2 * 0.7 / 120 + 0.004) / 35, rel=0.05)
    assert way == "braking"
    assert 0.0 < speed < job.cut.line_speed
    frames = line_ramp_figure(ramps).frames
    assert len(frames) == 2
    assert len(line_ramp_figure(replace(ramps, sync=None)).frames) == 1
