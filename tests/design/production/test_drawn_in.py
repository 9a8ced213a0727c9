"""Cams that bear the line's ramps by drawn-in limits: published peaks, and the check that knows every phase."""

from __future__ import annotations

import pytest

from camwright.design.production.drawn_in import solve_drawn_in, surely_bears
from camwright.jobs.job import load_job
from camwright.profiles.line import Line
from camwright.profiles.task import Task
from camwright.validation.production.line_ramp import line_ramp


def ramping(length: float, acceleration: float, jerk: float) -> Task:
    return load_job().task.with_length(length).with_line(Line(acceleration=acceleration, jerk=jerk))


@pytest.mark.parametrize(
    ("length", "acceleration", "jerk", "peak"),
    [(0.6, 1.0, 5.0, 9.0734), (0.6, 5.0, 50.0, 9.0820), (0.35, 1.0, 5.0, 17.686), (0.35, 5.0, 50.0, 17.900)],
)
def test_peaks_of_the_closed_form(length: float, acceleration: float, jerk: float, peak: float) -> None:
    task = ramping(length, acceleration, jerk)
    found = solve_drawn_in(task, "peak_acceleration")
    assert found is not None
    assert found.minimised == pytest.approx(peak, rel=3e-5)
    assert line_ramp(found.profile, task).ramp.value >= acceleration
    assert surely_bears(task) == (length == 0.6 or acceleration == 1.0)  # enough, not needed


def test_where_limits_leave_nothing_there_is_none() -> None:
    hard = ramping(0.6, 40.0, 0.0)
    assert solve_drawn_in(hard, "peak_acceleration") is None
    assert not surely_bears(hard)


def test_a_steady_line_asks_nothing() -> None:
    task = load_job().task
    found = solve_drawn_in(task, "rms_acceleration")
    assert found is not None
    assert surely_bears(task)
