"""Transfers between two states: the ends of the interval of distances, against a linear programme and the formulas from rest to rest."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.optimize import linprog

from camwright.profiles.closed_forms.reach import greatest_reach
from camwright.profiles.closed_forms.transfer import (
    Bounds,
    State,
    Transfer,
    farthest,
    nearest,
)


def programme(time: float, start: State, end: State, bounds: Bounds, sign: int, n: int = 40) -> float | None:
    """Naive twin: the farthest motion whose acceleration is linear between the nodes of a grid."""
    h = time / n
    velocity, place = np.zeros((n + 1, n + 1)), np.zeros((n + 1, n + 1))
    for i in range(n):
        velocity[i + 1] = velocity[i]
        velocity[i + 1, i : i + 2] += h / 2
        place[i + 1] = place[i] + h * velocity[i]
        place[i + 1, i : i + 2] += [h * h / 3, h * h / 6]
    jerk = np.diff(np.eye(n + 1), axis=0) / h
    hull = velocity[:-1] + h / 2 * np.eye(n, n + 1)  # between the nodes the velocity stays within its control points
    velocities = np.vstack([velocity, hull])
    rows = np.vstack([velocities, -velocities, jerk, -jerk])
    most = np.concatenate(
        [
            np.full(2 * n + 1, bounds.greatest_velocity - start.velocity),
            np.full(2 * n + 1, start.velocity - bounds.least_velocity),
            np.full(2 * n, bounds.jerk),
        ]
    )
    equal = np.vstack([velocity[-1], np.eye(n + 1)[0], np.eye(n + 1)[-1]])
    target = [end.velocity - start.velocity, start.acceleration, end.acceleration]
    answer = linprog(
        -sign * place[-1], rows, most, equal, target, bounds=[(-bounds.acceleration, bounds.acceleration)] * (n + 1)
    )
    return float(place[-1] @ answer.x) + start.velocity * time if answer.status == 0 else None


@st.composite
def tasks(draw: st.DrawFn) -> tuple[float, State, State, Bounds]:
    top = draw(st.floats(0.2, 5.0))
    bounds = Bounds(draw(st.sampled_from([0.0, -top])), top, draw(st.floats(0.3, 10.0)), draw(st.floats(0.2, 100.0)))
    states = [
        State(
            draw(st.floats(bounds.least_velocity, top)),
            draw(st.one_of(st.just(0.0), st.floats(-bounds.acceleration, bounds.acceleration))),
        )
        for _ in range(2)
    ]
    return draw(st.floats(0.3, 8.0)), states[0], states[1], bounds


def check_limits(transfer: Transfer, time: float, end: State, bounds: Bounds) -> None:
    """Integrate the corners, naively and finely."""
    times, accelerations = transfer.corners()
    assert times[-1] == pytest.approx(time, rel=1e-9)
    t = np.unique(np.concatenate([np.linspace(0.0, times[-1], 4_001), times]))
    a = np.interp(t, times, accelerations)
    v = transfer.start.velocity + np.concatenate([[0.0], np.cumsum(np.diff(t) * (a[1:] + a[:-1]) / 2)])
    s = np.concatenate([[0.0], np.cumsum(np.diff(t) * (v[:-1] + np.diff(t) * (a[:-1] / 3 + a[1:] / 6)))])
    speed = max(bounds.greatest_velocity, -bounds.least_velocity)
    assert s[-1] == pytest.approx(transfer.distance, abs=1e-8 * speed * time)
    assert v[-1] == pytest.approx(end.velocity, abs=1e-8 * (speed + bounds.acceleration * time))
    assert a[-1] == pytest.approx(end.acceleration, abs=1e-8 * bounds.acceleration)
    assert v.max() <= bounds.greatest_velocity + 1e-8 * speed
    assert v.min() >= bounds.least_velocity - 1e-8 * speed
    assert np.abs(a).max() <= bounds.acceleration * (1 + 1e-9)
    assert np.abs([j for _, j in transfer.phases]).max() <= bounds.jerk * (1 + 1e-12)
    # the least of the samples lies above the least of all, by less than the jerk does in a step
    missed = 0.5 * bounds.jerk * (times[-1] / 4_000) ** 2 + 1e-8 * (speed + bounds.acceleration * time)
    assert v.min() == pytest.approx(transfer.least_velocity(), abs=missed)


@settings(max_examples=60, deadline=None)
@given(tasks())
def test_no_motion_on_a_grid_goes_farther(task: tuple[float, State, State, Bounds]) -> None:
    """And where there is one on the grid there is a transfer; the grid comes close."""
    time, start, end, bounds = task
    for found, sign in ((farthest(*task), 1), (nearest(*task), -1)):
        twin = programme(time, start, end, bounds, sign)
        if found is None:
            assert twin is None
            continue
        check_limits(found, time, end, bounds)
        if twin is not None:
            scale = max(bounds.greatest_velocity, -bounds.least_velocity) * time
            assert -1e-7 * scale <= sign * (found.distance - twin) <= 0.1 * scale


@settings(max_examples=100, deadline=None)
@given(tasks())
def test_both_ends_of_the_interval_exist_or_neither(task: tuple[float, State, State, Bounds]) -> None:
    far, near = farthest(*task), nearest(*task)
    assert (far is None) == (near is None)
    if far is not None and near is not None:
        assert near.distance <= far.distance + 1e-9 * abs(far.distance)


@settings(max_examples=200, deadline=None)
@given(st.floats(0.1, 10.0), st.floats(0.1, 10.0), st.floats(0.1, 10.0), st.floats(0.1, 100.0))
def test_from_rest_to_rest_it_is_the_reach(time: float, speed: float, acceleration: float, jerk: float) -> None:
    rest = State(0.0, 0.0)
    found = farthest(time, rest, rest, Bounds(-speed, speed, acceleration, jerk))
    assert found is not None
    assert found.distance == pytest.approx(greatest_reach(time, speed, acceleration, jerk), rel=1e-9)


@settings(max_examples=100, deadline=None)
@given(tasks())
def test_the_nearest_is_the_farthest_of_the_mirror_image(task: tuple[float, State, State, Bounds]) -> None:
    time, start, end, bounds = task
    near = nearest(*task)
    assume(near is not None)
    assert near is not None
    mirrored = farthest(
        time,
        State(-start.velocity, -start.acceleration),
        State(-end.velocity, -end.acceleration),
        Bounds(-bounds.greatest_velocity, -bounds.least_velocity, bounds.acceleration, bounds.jerk),
    )
    assert mirrored is not None
    assert near.distance == -mirrored.distance
    assert near.mirrored().mirrored() == near


@pytest.mark.parametrize(
    ("start", "end", "time", "why"),
    [
        (State(3.0, 0.0), State(0.0, 0.0), 5.0, "faster than allowed at the start"),
        (State(0.0, 0.0), State(0.0, 6.0), 5.0, "more acceleration than allowed at the end"),
        (State(0.0, -5.0), State(0.0, 5.0), 0.5, "too little time to turn the acceleration round"),
        (State(1.9, 4.0), State(0.0, 0.0), 5.0, "cannot but exceed the speed limit"),
        (State(0.0, 0.0), State(2.0, 0.0), 0.5, "too little time to reach the speed"),
        (State(0.1, -4.0), State(1.0, 0.0), 5.0, "cannot but run backwards"),
    ],
)
def test_a_transfer_that_is_none(start: State, end: State, time: float, why: str) -> None:
    bounds = Bounds(0.0, 2.0, 5.0, 10.0)
    assert farthest(time, start, end, bounds) is None, why
    assert nearest(time, start, end, bounds) is None, why
