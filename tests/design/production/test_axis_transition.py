"""The transition between servo-aware cams: its rows are the simulated servo, and its axis stays in tolerance and limits."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from camwright.design.optimise_axis import solve_axis
from camwright.design.production.axis_transition import design_axis_transition
from camwright.design.production.change_rows import ChangeRows
from camwright.design.production.transition import RunningCam
from camwright.design.servo_aware.command_basis import Command
from camwright.jobs.examples import example
from camwright.jobs.job import parse_job
from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.profiles.servo import Servo
from camwright.profiles.task import Task
from camwright.validation.production.cam_change import CamChange, run_change
from camwright.validation.production.motion_table import ShiftCam
from camwright.validation.production.transition import judge_transition
from camwright.validation.servo.sampled_axis import axis_response

SERVO = Servo(120.0, 0.7, 35.0, 0.004, 1.0)
LEADS = replace(SERVO, dead_time=0.001, lead_time=0.004, acceleration_feedforward=2e-4)
TOLERANCE = 0.2e-3
SPEEDS = (72 / 60, 76 / 60)


def task(command: Command = "shaped") -> Task:
    job = parse_job(example("short-cut").text, "short-cut")
    cut = replace(job.cut, length=0.3, sync_tolerance=TOLERANCE, origin="return", shaped=command == "shaped")
    return job.task.with_cut(cut)


def running(line_speed: float, lowest: float, command: Command) -> RunningCam:
    own = task(command).at_speed(line_speed)
    solution = solve_axis(own, "peak_acceleration", command, (SERVO,), shares=(1.0, lowest / line_speed))
    return RunningCam(own, solution.profile)


@pytest.fixture(scope="module")
def cams() -> tuple[RunningCam, RunningCam]:
    """Give two shaped cams that both hold a few line speeds."""
    return running(SPEEDS[1], 68 / 60, "shaped"), running(80 / 60, SPEEDS[0], "shaped")


@pytest.mark.parametrize("servo", [SERVO, LEADS])
def test_rows_are_the_servo_run_sample_by_sample(cams: tuple[RunningCam, RunningCam], servo: Servo) -> None:
    one, other = cams
    rows, speed = ChangeRows(one, other, "shaped"), 75 / 60
    unknowns = 1e-3 * np.random.default_rng(3).normal(size=rows.basis.matrix.shape[1])
    between, length, zero = rows.profile(unknowns), other.profile.end, one.zero - other.zero

    def command(times: FloatArray) -> FloatArray:
        x = speed * times
        inside = np.clip(x, 0.0, length * (1.0 - 1e-15))
        before, after = one.profile(x, outside="repeat") + zero, other.profile(x, outside="repeat")
        return np.where(x < 0.0, before, np.where(x < length, between(inside), after))

    found = rows.bands(servo, speed)
    values = (found.matrix @ (unknowns * rows.scale) + found.constant).reshape(-1, 4)
    cut = other.task.cut
    inside = np.linspace(cut.shear_start, cut.shear_start + cut.shear_zone, len(values) // (3 if servo is LEADS else 2))
    first = -1 if servo is LEADS else 0
    places = np.concatenate([inside + cycle * length for cycle in range(first, 2)])
    # in sync the knife moves as the material does, and is where the sync zone ends at the end of the cycle
    ideal = np.concatenate([inside - length + (cycle + 1) * other.task.machine.pitch for cycle in range(first, 2)])
    for row in (0, 7, len(values) // 2, len(values) - 1):
        for step in range(4):
            at = places[row] / speed
            clock = at - step * servo.sample_time / 4
            times = np.array([clock - 300 * servo.sample_time, at])
            axis = axis_response(servo, clock, command, times)[0][1]
            assert values[row, step] == pytest.approx(axis - ideal[row], abs=1e-9)


def both_ways(cams: tuple[RunningCam, RunningCam], command: Command) -> list[tuple[CamProfile, float, float]]:
    """Design the change either way and check it; the cycles, the errors that they predict and those that are simulated."""
    made = []
    for one, other in (cams, cams[::-1]):
        found = design_axis_transition(one, other, SPEEDS, command, (SERVO,))
        assert found is not None
        checks = judge_transition(found.profile, other.zero, other.task.at_speed(SPEEDS[1]))
        assert [check.name for check in checks if not check.passed] == []
        start, end = one.last, other.last
        assert found.profile(0.0) + other.zero == pytest.approx(start[0], abs=1e-12)
        assert [float(found.profile(0.0, order)) for order in (1, 2)] == pytest.approx(start[1:], abs=1e-8)
        last = float(found.profile(found.profile.end)) + other.zero - other.task.machine.pitch
        assert [
            last,
            *(float(found.profile(found.profile.end, order, side="left")) for order in (1, 2)),
        ] == pytest.approx(end, abs=1e-8)
        change = CamChange(
            ShiftCam(one.profile, one.zero),
            ShiftCam(other.profile, other.zero),
            (one.task, other.task),
            ShiftCam(found.profile, other.zero),
        )
        run = run_change(change, SERVO, np.linspace(*SPEEDS, 4).tolist())
        limits = other.task.limits
        assert run.peaks.peak_acceleration <= limits.acceleration * 1.001
        assert run.peaks.peak_speed <= limits.speed * 1.001
        made.append((found.profile, found.share * TOLERANCE, run.sync_error))
    return made


def test_the_axis_stays_in_tolerance_through_either_change(cams: tuple[RunningCam, RunningCam]) -> None:
    for _, designed, simulated in both_ways(cams, "shaped"):
        assert simulated <= TOLERANCE
        assert simulated == pytest.approx(designed, rel=0.01)


def test_a_command_in_sync_stays_in_sync_in_the_zone() -> None:
    pair = running(SPEEDS[1], 68 / 60, "in_sync"), running(80 / 60, SPEEDS[0], "in_sync")
    made = both_ways(pair, "in_sync")
    assert max(simulated for _, _, simulated in made) <= TOLERANCE
    zone = np.linspace(pair[1].zone_start, pair[1].profile.end, 50)
    assert made[0][0](zone) == pytest.approx(pair[1].profile(zone), abs=1e-14)


def test_no_transition_where_none_keeps_the_limits(cams: tuple[RunningCam, RunningCam]) -> None:
    one, other = (replace(cam, task=cam.task.with_limits(replace(cam.task.limits, acceleration=0.1))) for cam in cams)
    assert design_axis_transition(one, other, SPEEDS, "shaped", (SERVO,)) is None


@pytest.mark.slow
def test_a_long_shear_zone_of_a_carriage_is_looked_at_closely() -> None:
    job = parse_job(example("flying-saw").text, "flying-saw")
    cut = replace(
        job.cut,
        origin="return",
        shaped=True,
        length=1.6,
        sync_zone=0.6,
        shear_zone=0.4,
        shear_zone_at=0.2,
        sync_tolerance=5e-5,
    )
    own, top = job.task.with_cut(cut), job.cut.line_speed
    speeds = 0.9 * top, 0.95 * top
    pair = []
    for high, low in ((speeds[1], 0.85 * top), (top, speeds[0])):
        there = own.at_speed(high)
        solution = solve_axis(there, "peak_acceleration", "shaped", (job.servo,), shares=(1.0, low / high))
        pair.append(RunningCam(there, solution.profile))
    for one, other in (pair, pair[::-1]):
        found = design_axis_transition(one, other, speeds, "shaped", (job.servo,))
        assert found is not None
        cams = (ShiftCam(each.profile, each.zero) for each in (one, other))
        change = CamChange(*cams, (one.task, other.task), ShiftCam(found.profile, other.zero))
        assert run_change(change, job.servo, list(speeds)).sync_error <= cut.sync_tolerance
