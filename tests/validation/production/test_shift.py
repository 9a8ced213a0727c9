"""A whole shift at once against one sample after the other."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from camwright.design.optimise import solve
from camwright.jobs.job import Job, load_job
from camwright.profiles.line_run import LineRun
from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.profiles.returns import baseline
from camwright.profiles.servo import Servo, sample_plant
from camwright.validation.production.motion_table import ShiftCam, motion_table
from camwright.validation.production.shift import Disturbance, Shift, run_shift
from camwright.validation.servo.response import greatest_shear_zone_error

LENGTHS = (0.6, 0.35, 0.9)
ORDER = np.array([0, 0, 1, 1, 2, 0, 1, 2, 2, 0])


def cams(job: Job, name: str = "optimised") -> list[CamProfile]:
    tasks = [job.task.with_length(length) for length in LENGTHS]
    if name != "optimised":
        return [baseline(name, task) for task in tasks]
    return [solve(task, "peak_acceleration", suggest=False).profile for task in tasks]


def shift_of(job: Job, profiles: list[CamProfile], order: FloatArray = ORDER) -> Shift:
    zero = job.task.slave_at_start
    table = motion_table([ShiftCam(profile, zero) for profile in profiles], order, job.machine.pitch)
    return Shift(table, [job.task], np.zeros(len(order), dtype=np.intp))


def naive(
    job: Job, profiles: list[CamProfile], line: LineRun, servo: Servo, noise: FloatArray, slip: FloatArray
) -> tuple[list[float], list[float]]:
    """Errors at the cuts and greatest sync errors, one sample after the other, at 200 points a sample."""
    zero, pitch = job.task.slave_at_start, job.machine.pitch
    lengths = np.array([LENGTHS[k] for k in ORDER])
    joints = np.concatenate([[0.0], np.cumsum(lengths)])

    def command(x: float) -> float:
        if x < 0.0:
            return zero + x
        k = min(int(np.searchsorted(joints, x, side="right")) - 1, len(ORDER) - 1)
        if x > joints[-1]:
            return zero + pitch * len(ORDER) + x - joints[-1]
        return zero + pitch * k + float(profiles[ORDER[k]](min(x - joints[k], lengths[k])))

    dt, points = servo.sample_time, 200
    plant, fine = sample_plant(servo, dt), sample_plant(servo, dt / points)
    before, until = 400, int(np.ceil(float(line.when(joints[-1])) / dt)) + 1
    seen = [
        command(float(line.passed(k * dt - servo.delay)) + (noise[k % len(noise)] if len(noise) else 0.0))
        for k in range(-before, until)
    ]
    z = np.array([0.0, 0.0, seen[0]])
    cut = job.cut
    first = joints[1:] - cut.sync_zone + cut.shear_zone_at
    middle, last = first + 0.5 * cut.shear_zone, first + cut.shear_zone
    at_cut, peaks, nearest = [0.0] * len(ORDER), [0.0] * len(ORDER), [np.inf] * len(ORDER)
    for number in range(1, len(seen)):
        c, old = seen[number], seen[number - 1]
        u = servo.position_gain * (c - z[2]) + servo.velocity_feedforward * (c - old) / dt
        state = z.copy()
        here, there = (float(line.passed((number - before + point) * dt)) for point in (0, 1))
        cutting = bool(((first <= there) & (last >= here)).any())
        for point in range(points if cutting else 0):
            x = float(line.passed((number - before + point / points) * dt))
            k = int(np.searchsorted(last, x))
            if x >= 0.0 and k < len(ORDER) and first[k] <= x <= last[k]:
                error = state[2] - (zero + pitch * (k + 1) + x - joints[k + 1])
                error -= (slip[k] if len(slip) else 0.0) * (x - middle[k])
                peaks[k] = max(peaks[k], abs(error))
                if abs(x - middle[k]) < nearest[k]:
                    nearest[k], at_cut[k] = abs(x - middle[k]), error
            state = fine.transition @ state + fine.input * u
        z = plant.transition @ z + plant.input * u
    return at_cut, peaks


@pytest.mark.parametrize(
    ("change", "noisy"),
    [({}, False), ({"velocity_feedforward": 0.8, "dead_time": 0.003, "lead_time": 0.001}, True)],
)
def test_a_shift_is_what_one_sample_after_the_other_makes(change: dict[str, float], noisy: bool) -> None:
    job = load_job()
    servo = replace(job.servo, **change)
    draw = np.random.default_rng(4)
    noise = 1e-5 * draw.standard_normal(500) if noisy else np.zeros(0)
    slip = 1e-3 * draw.standard_normal(len(ORDER)) if noisy else np.zeros(0)
    line = LineRun(np.array([0.0, 1.0, 2.0, 2.6, 4.0]), np.array([1.2, 1.2, 0.2, 0.2, 1.3]))
    profiles = cams(job)
    run = run_shift(shift_of(job, profiles), line, servo, Disturbance(noise, slip))
    at_cut, peaks = naive(job, profiles, line, servo, noise, slip)
    assert run.sync_errors == pytest.approx(peaks, abs=3e-7)
    asked = np.array([LENGTHS[k] for k in ORDER])
    wanted = asked * (1 + (slip if noisy else 0.0)) - np.diff(at_cut, prepend=at_cut[0])
    assert run.lengths == pytest.approx(wanted, abs=6e-7)


def test_pieces_longer_than_a_chunk_of_the_run_are_seen_whole() -> None:
    job = load_job()
    profiles = cams(job)
    slow = LineRun(
        np.array([0.0, 1e6]), np.array([0.002, 0.002])
    )  # a shear zone of 5000 samples, a chunk boundary within
    run = run_shift(shift_of(job, profiles, np.array([1, 1, 1])), slow, job.servo)
    task = job.task.with_length(LENGTHS[1]).at_speed(0.002)
    assert run.sync_errors == pytest.approx(greatest_shear_zone_error(profiles[1], task, job.servo), abs=1e-9)


@pytest.mark.parametrize("name", ["optimised", "linear_return"])
def test_a_steady_shift_of_one_cam_is_its_periodic_response(name: str) -> None:
    job = load_job()
    profile = cams(job, name)[0]
    line = LineRun(np.array([0.0, 1000.0]), np.full(2, job.cut.line_speed))
    run = run_shift(shift_of(job, [profile], np.zeros(200, dtype=np.intp)), line, job.servo)
    known = greatest_shear_zone_error(profile, job.task, job.servo)
    assert run.sync_errors[5:].max() == pytest.approx(known, rel=1e-3)
    assert np.ptp(run.lengths[5:]) < 1e-6


def test_a_longer_piece_stretches_the_return_and_keeps_zone_and_ends() -> None:
    job = load_job()
    profile = cams(job)[0]
    cam = [ShiftCam(profile, 0.0)]
    order, more = np.zeros(3, dtype=np.intp), np.array([0.004, 0.0, -0.003])
    plain = motion_table(cam, order, job.machine.pitch)
    table = motion_table(cam, order, job.machine.pitch, job.cut.sync_zone, more)
    assert np.diff(table.joints) == pytest.approx(0.6 + more)
    zone = np.linspace(0.0, job.cut.sync_zone - 1e-9, 51)
    for piece in range(3):
        assert table(table.joints[piece + 1] - zone) == pytest.approx(plain(plain.joints[piece + 1] - zone), abs=1e-12)
    x = np.linspace(0.0, float(table.joints[-1]), 200_001)
    step = x[1] - x[0]
    rate = np.diff(table(x)) / step
    bend = np.diff(rate) / step
    assert np.abs(np.diff(rate)).max() < 1e-3  # neither position nor speed steps
    assert np.abs(bend).max() < 1.2 * profile.peak(2)
