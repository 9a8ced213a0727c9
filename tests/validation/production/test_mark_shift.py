"""Corrections of a cam that stays: published numbers, the motion run in time as an independent road, other machines."""

import math
from dataclasses import replace

import numpy as np
import pytest

from camwright.design.optimise import solve
from camwright.jobs.examples import example
from camwright.jobs.job import load_job
from camwright.profiles.line import Line
from camwright.profiles.mark_range import MarkRange
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.task import Task
from camwright.validation.production.mark_shift import arc_range, held, offset_range, phase_range

PAPER = load_job().task


def cam_of(task: Task) -> CamProfile:
    return solve(task, "peak_acceleration").profile


@pytest.mark.parametrize(("length", "earliest"), [(0.6, -121.6), (0.45, -101.3), (0.35, -12.17)])
def test_a_phase_by_acceleration_alone(length: float, earliest: float) -> None:
    task = PAPER.with_length(length)
    found = phase_range(cam_of(task), task, held(task, acceleration_alone=True))
    assert found.earliest * 1e3 == pytest.approx(earliest, abs=0.05)


def test_a_cam_that_uses_its_jerk_limit_up_bears_no_phase() -> None:
    assert phase_range(cam_of(PAPER), PAPER, held(PAPER)) == MarkRange(0.0, 0.0)


def test_an_offset_by_acceleration_alone() -> None:
    task = PAPER.with_length(0.35)
    cam = cam_of(task)
    found = offset_range(cam, task, held(task, acceleration_alone=True))
    assert -found.earliest * 1e3 == pytest.approx(27.1, abs=0.05)
    peak = cam.peak(2) * task.cut.line_speed**2
    time = task.cut.return_zone / task.cut.line_speed
    assert -found.earliest == pytest.approx((30.0 - peak) * time**2 / (10 / math.sqrt(3)), rel=1e-3)


def in_time(task: Task, cam: CamProfile, shift: float, *, offset: bool) -> tuple[float, ...]:
    """Run the shifted return in time and take differences: greatest speed, acceleration, jerk and backward speed."""
    v, length = task.cut.line_speed, task.cut.return_zone
    time = length / v if offset else (length + shift) / v
    t = np.linspace(0.0, time, 20_001)
    u = t / time
    q = 10 * u**3 - 15 * u**4 + 6 * u**5
    y = cam(np.clip(v * t, 0.0, length)) - shift * q if offset else cam(np.clip(v * t - shift * q, 0.0, length))
    step = t[1]
    moved = [np.diff(y, order) / step**order for order in (1, 2, 3)]
    return *(float(np.abs(part).max()) for part in moved), -float(moved[0].min())


@pytest.mark.parametrize("offset", [False, True])
@pytest.mark.parametrize("share", [0.5, 0.8])
def test_the_ends_are_those_of_the_motion_in_time(share: float, offset: bool) -> None:
    task = PAPER.at_speed(share * PAPER.cut.line_speed)
    cam, limits = cam_of(PAPER), held(task)
    find = offset_range if offset else phase_range
    found = find(cam, task, limits)
    for end in (found.earliest, found.latest):
        if not end:  # no limit, or none: this cam comes just to a standstill
            continue
        inside, beyond = in_time(task, cam, 0.99 * end, offset=offset), in_time(task, cam, 1.01 * end, offset=offset)
        kept = limits.greatest, limits.acceleration, limits.jerk, 1e-9
        assert all(value <= limit * 1.005 for value, limit in zip(inside, kept, strict=True))
        assert any(value > limit for value, limit in zip(beyond, kept, strict=True))


@pytest.mark.parametrize("offset", [False, True])
def test_where_the_line_ramps_the_shifted_motion_keeps_its_limits_too(offset: bool) -> None:
    """A line that passes each phase at full speed while it ramps: accelerations and jerks by differences over time."""
    full = PAPER.with_length(0.35)
    cam, slower = cam_of(full), full.at_speed(0.9 * full.cut.line_speed)
    task = slower.with_line(Line(acceleration=2.0))
    v, length = task.cut.line_speed, task.cut.return_zone
    find = offset_range if offset else phase_range
    ranges = [find(cam, each, held(each)) for each in (slower, task)]
    steady, found = (each.latest if offset else each.earliest for each in ranges)
    assert abs(steady) > abs(found) > 0.0

    def worst(shift: float) -> float:
        end, step, of_limits = length if offset else length + shift, 2e-5, []
        for a in (2.0, -2.0):
            t = step * np.arange(-2, 3)
            x = np.linspace(0.01, 0.99, 2001)[:, None] * end + v * t + 0.5 * a * t**2
            u = np.clip(x / end, 0.0, 1.0)
            q = 10 * u**3 - 15 * u**4 + 6 * u**5
            y = cam(np.clip(x, 0.0, length)) - shift * q if offset else cam(np.clip(x - shift * q, 0.0, length))
            second = (y[:, 3] - 2.0 * y[:, 2] + y[:, 1]) / step**2
            third = (y[:, 4] - 2.0 * y[:, 3] + 2.0 * y[:, 1] - y[:, 0]) / (2.0 * step**3)
            of_limits += [np.abs(second).max() / 30.0, np.abs(third).max() / 3000.0]
        return max(of_limits)

    assert worst(0.99 * found) <= 1.0 + 2e-3
    assert worst(1.02 * found) > 1.0
    assert worst(steady) > 1.005


def test_an_offset_is_not_in_sync_where_the_ratio_changes() -> None:
    task = load_job(example("thick-product").path).task
    assert offset_range(cam_of(task), task, held(task)) is None


def test_a_carriage_may_run_backwards_and_bears_later_marks() -> None:
    task = load_job(example("flying-saw").path).task
    slower = task.at_speed(0.5 * task.cut.line_speed)
    assert phase_range(cam_of(task), slower, held(slower)).latest is None


def test_the_shear_zone_moves_within_the_sync_zone() -> None:
    """With the shear zone in the middle, half of what the sync zone is longer, less the settling length (S1)."""
    task = PAPER.with_cut(replace(PAPER.cut, shear_zone_at=0.08))
    assert arc_range(task, 0.0) == MarkRange(pytest.approx(-0.08), pytest.approx(0.08))
    assert arc_range(task, 0.03).earliest == pytest.approx(-0.05)
    assert arc_range(task, 0.1).earliest == 0.0
    assert arc_range(PAPER, 0.0) == MarkRange(pytest.approx(-0.16), 0.0)


def test_the_cycle_may_begin_at_the_cut() -> None:
    at_cut = Task(PAPER.machine, replace(PAPER.cut, origin="cut"), PAPER.limits)
    slower = [task.at_speed(1.0) for task in (PAPER, at_cut)]
    ranges = [phase_range(cam_of(whole), task, held(task)) for whole, task in zip((PAPER, at_cut), slower, strict=True)]
    assert ranges[0].earliest == pytest.approx(ranges[1].earliest, rel=1e-6)


def test_what_lies_within_both() -> None:
    assert MarkRange(None, 0.2).within(MarkRange(-0.1, None)) == MarkRange(-0.1, 0.2)
    assert MarkRange(-0.3, 0.2).within(MarkRange(-0.1, 0.5)) == MarkRange(-0.1, 0.2)
    assert MarkRange(None, None).within(MarkRange(None, None)) == MarkRange(None, None)
