"""How short a piece can be cut with the axis in sync at every line speed of a job."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from shaped_job import JOB

from camwright.answers.limits import shortest_cuts_answer
from camwright.design.optimise_axis import solve_axis
from camwright.jobs.job import Job, parse_job
from camwright.profiles.machines import LinearCarriage
from camwright.profiles.returns import baseline
from camwright.studies.axis_lengths import AxisLengths, axis_lengths
from camwright.studies.axis_study import cam_for_one_speed, shares_of
from camwright.studies.band_lengths import BandLengths, band_lengths
from camwright.validation.bounds.minimum_length import over_line_speeds
from camwright.validation.servo.line_speeds import line_speed_errors

MANY = np.linspace(8.0, 80.0, 120) / 60


def job() -> Job:
    return parse_job(JOB, "band")


@pytest.fixture(scope="module")
def found() -> tuple[AxisLengths, BandLengths]:
    single = axis_lengths(job())
    band = band_lengths(job(), single)
    assert single is not None
    assert band is not None
    return single, band


@pytest.mark.slow
def test_the_issues_shortest_cuts_over_its_band(found: tuple[AxisLengths, BandLengths]) -> None:
    single, band = found
    assert band.line_speeds == pytest.approx((8 / 60, 80 / 60))
    assert band.shaped is not None
    assert band.shaped <= 0.263
    assert band.linear_return == pytest.approx(0.3004, abs=1e-3)
    assert band.poly_3_4_5 == pytest.approx(0.3163, abs=1e-3)
    assert band.in_sync is not None
    assert band.shaped < band.in_sync < 0.28
    # none is shorter over the band than at one speed
    assert single.linear_return <= band.linear_return + 2e-4
    assert (single.shaped_axis_limits or 0.0) < band.shaped
    told = shortest_cuts_answer(single, band)
    assert told["over_band"]["shaped"] == pytest.approx(band.shaped * 1e3)
    assert told["at_line_speed"]["shaped"] == pytest.approx((single.shaped_axis_limits or 0.0) * 1e3)


def test_at_the_length_that_is_told_a_cam_keeps_the_tolerance_and_shorter_none(
    found: tuple[AxisLengths, BandLengths],
) -> None:
    asked, shaped = job(), found[1].shaped
    assert shaped is not None
    for factor, holds in ((1.001, True), (0.98, False)):
        cut = replace(asked.cut, length=factor * shaped, sync_zone=0.04, shear_zone_at=0.0, shaped=True)
        task = asked.task.with_cut(cut)
        solution = solve_axis(task, "sync_error", "shaped", (asked.servo,), shares=shares_of(0.1), suggest=False)
        assert solution.axis is not None
        worst = line_speed_errors(solution.profile, task, [asked.servo], MANY).max()
        assert (worst <= 1e-4 * (1 + 5e-3) and solution.axis.axis_limits) is holds


def test_a_law_is_judged_at_every_line_speed_and_the_slowest_speed_matters() -> None:
    task, servo = job().task, job().servo
    one = over_line_speeds(task, servo, "linear_return", (1.0,))
    quick = over_line_speeds(task, replace(servo, velocity_feedforward=0.9), "linear_return", (1.0, 0.5))
    assert one is not None
    assert quick is None or quick > one  # with lag another offset at each speed
    # another search, on a grid of its own
    best = 1.0
    for length in np.arange(0.295, 0.306, 5e-4):
        for zone in np.linspace(0.2, 0.29, 31):
            if zone < length:
                cut = replace(task.cut, length=float(length), sync_zone=float(zone), shear_zone_at=float(zone) - 0.04)
                shape = task.with_cut(replace(cut, origin="return", shaped=False))
                if cut.return_zone * 200 / 60 < (0.4 - zone) * 80 / 60:
                    continue  # faster than the knife may run
                cam = baseline("linear_return", shape)
                if line_speed_errors(cam, shape, [servo], np.array([0.1, 0.4, 0.7, 1.0]) * 80 / 60).max() <= 1e-4:
                    best = min(best, float(length))
    over = over_line_speeds(task, servo, "linear_return", tuple(np.linspace(1.0, 0.1, 13).tolist()))
    assert over == pytest.approx(best, abs=1e-3)


def test_jobs_of_one_line_speed_and_other_machines_have_none() -> None:
    single = axis_lengths(job())
    assert band_lengths(replace(job(), slowest=1.0), single) is None
    carriage = replace(job(), machine=LinearCarriage(0.9))
    assert band_lengths(carriage, axis_lengths(carriage)) is None
    assert shortest_cuts_answer(None, None) == {"at_line_speed": None, "over_band": None, "band_m_per_s": None}


def test_the_cam_for_one_line_speed_is_far_off_at_the_others() -> None:
    alone = cam_for_one_speed(job())
    assert alone is not None
    errors = line_speed_errors(*alone, [job().servo], MANY)[0]
    assert errors[-1] < 1e-6
    assert errors.max() > 2.5e-3
    assert cam_for_one_speed(replace(job(), slowest=1.0)) is None
