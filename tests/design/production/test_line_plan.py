"""The fastest line over a list of pieces: published values, a dense dynamic programme, and what a plan must keep."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camwright.design.feasible.extremes import max_line_speed
from camwright.design.production.line_plan import HARDEST, fastest_plan
from camwright.jobs.job import load_job
from camwright.profiles.errors import InputError
from camwright.profiles.polynomial.profile import FloatArray

CAP = 80 / 60


@pytest.mark.parametrize(
    ("length", "speed"),
    [(0.25, 19.8), (0.3, 47.66), (0.35, 97.6), (0.45, 162.6), (0.6, 138.24), (0.9, 138.24)],
)
def test_highest_speed_of_the_papers_machine_by_length(length: float, speed: float) -> None:
    found = max_line_speed(load_job().task.with_length(length))
    assert found is not None
    assert found * 60 == pytest.approx(speed, abs=0.05 if speed < 30 or speed > 90 else 0.005)


def the_list() -> tuple[FloatArray, FloatArray]:
    lengths = np.repeat([0.6, 0.3, 0.6], 3)
    task = load_job().task
    speeds = {length: min(CAP, max_line_speed(task.with_length(length)) or 0.0) for length in (0.3, 0.6)}
    return lengths, np.array([speeds[length] for length in lengths.tolist()])


@pytest.mark.parametrize(("ramp", "time"), [(0.2, 4.813), (0.5, 4.269), (1.0, 4.051), (2.0, 3.942)])
def test_times_of_the_list_by_the_lines_ramp(ramp: float, time: float) -> None:
    assert fastest_plan(*the_list(), ramp).time == pytest.approx(time, abs=5e-4)


def test_time_at_the_slowest_pieces_speed() -> None:
    lengths, speeds = the_list()
    assert lengths.sum() / speeds.min() == pytest.approx(5.666, abs=5e-4)


def dense(lengths: FloatArray, highest: FloatArray, ramp: float, levels: int = 301) -> float:
    """Least time by dynamic programming over the joints, on a grid of squared speeds: never quicker than the truth."""
    top = float(highest.max()) ** 2
    grid = np.unique(np.concatenate([np.linspace(0.0, top, levels)[1:], highest**2]))
    cost = np.where(grid <= highest[0] ** 2 * (1 + 1e-12), 0.0, math.inf)
    for length, speed in zip(lengths.tolist(), highest.tolist(), strict=True):
        first, last = grid[:, None], grid[None, :]
        peak = np.minimum(speed**2, 0.5 * (first + last) + ramp * length)
        v0, v1, vp = np.sqrt(first), np.sqrt(last), np.sqrt(peak)
        ramps = (peak - first) / (2 * ramp) + (peak - last) / (2 * ramp)
        time = (2 * vp - v0 - v1) / ramp + (length - ramps) / vp
        ok = (np.abs(first - last) <= 2 * ramp * length * (1 + 1e-12)) & (
            np.maximum(first, last) <= speed**2 * (1 + 1e-12)
        )
        cost = np.where(ok, cost[:, None] + time, math.inf).min(axis=0)
    return float(cost.min())


pieces = st.lists(st.tuples(st.floats(0.2, 1.5), st.floats(0.2, 2.5)), min_size=1, max_size=12)


@settings(max_examples=40, deadline=None)
@given(pieces, st.floats(0.1, 5.0))
def test_never_slower_than_a_dense_dynamic_programme(found: list[tuple[float, float]], ramp: float) -> None:
    lengths, highest = (np.array(column) for column in zip(*found, strict=True))
    plan = fastest_plan(lengths, highest, ramp)
    twin = dense(lengths, highest, ramp)
    assert plan.time <= twin * 1.001
    assert plan.time >= twin * 0.97  # the grid is coarse; the twin is never quicker than the truth


@settings(deadline=None)
@given(pieces, st.floats(0.05, 50.0))
def test_a_plan_keeps_speeds_and_ramp(found: list[tuple[float, float]], ramp: float) -> None:
    lengths, highest = (np.array(column) for column in zip(*found, strict=True))
    plan = fastest_plan(lengths, highest, ramp)
    assert plan.length == pytest.approx(lengths.sum(), rel=1e-9)
    assert (np.diff(plan.times) > 0).all()
    assert np.abs(np.diff(plan.speeds)).max() <= ramp * np.diff(plan.times).max() * (1 + 1e-6) + 1e-9
    assert (np.abs(np.diff(plan.speeds)) <= ramp * np.diff(plan.times) * (1 + 1e-6) + 1e-7).all()
    ends = np.concatenate([[0.0], np.cumsum(lengths)])
    for piece, speed in enumerate(highest.tolist()):
        places = np.linspace(ends[piece], ends[piece + 1], 41)[1:-1]
        assert plan.speed(plan.when(places)).max() <= speed * (1 + 1e-6)


def test_what_is_no_plan_is_refused() -> None:
    one = np.array([1.0])
    for lengths, highest, ramp in (
        (one, one, 0.0),
        (one, one, 2 * HARDEST),
        (one, 0 * one, 1.0),
        (one[:0], one[:0], 1.0),
    ):
        with pytest.raises(InputError, match="a plan of the line needs at least one piece"):
            fastest_plan(lengths, highest, ramp)
