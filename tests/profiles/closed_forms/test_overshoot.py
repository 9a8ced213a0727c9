"""The least overshoot of a carriage, against a linear programme on half the return."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import linprog

from camwright.profiles.closed_forms.overshoot import Overshoot, least_overshoot
from camwright.profiles.closed_forms.reach import greatest_reach
from camwright.profiles.closed_forms.transfer import Bounds, State, nearest


def motion(found: Overshoot) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Integrate the whole return from its corners: times, positions and velocities."""
    out, braked = found.braking.corners()
    (near_t, near_a), (far_t, far_a) = (part.corners() for part in found.back)
    t = np.unique(np.concatenate([near_t, far_t]))
    between = found.share * np.interp(t, near_t, near_a) + (1 - found.share) * np.interp(t, far_t, far_a)
    times = np.concatenate([out, out[-1] + t[1:], 2 * out[-1] + t[-1] - out[-2::-1]])
    accelerations = np.concatenate([braked, between[1:], -braked[-2::-1]])
    x = np.unique(np.concatenate([np.linspace(0.0, times[-1], 10_001), times]))
    a = np.interp(x, times, accelerations)
    v = found.braking.start.velocity + np.concatenate([[0.0], np.cumsum(np.diff(x) * (a[1:] + a[:-1]) / 2)])
    s = np.concatenate([[0.0], np.cumsum(np.diff(x) * (v[:-1] + np.diff(x) * (a[:-1] / 3 + a[1:] / 6)))])
    return x, s, v


def programme(time: float, velocity: float, way: float, bounds: Bounds, nodes: np.ndarray) -> float | None:
    """Naive twin: least overshoot on a grid of half the return, the acceleration linear between its nodes."""
    h, n = np.diff(nodes), len(nodes) - 1
    pace, place = np.zeros((n + 1, n + 1)), np.zeros((n + 1, n + 1))
    for i in range(n):
        pace[i + 1] = pace[i]
        pace[i + 1, i : i + 2] += h[i] / 2
        place[i + 1] = place[i] + h[i] * pace[i]
        place[i + 1, i : i + 2] += [h[i] ** 2 / 3, h[i] ** 2 / 6]
    jerk, none = np.diff(np.eye(n + 1), axis=0) / h[:, None], np.zeros((n + 1, 1))
    flat = np.zeros((n, 1))
    rows = np.vstack(
        [
            np.hstack([jerk, flat]),
            np.hstack([-jerk, flat]),
            np.hstack([pace, none]),
            np.hstack([-pace, none]),
            np.hstack([place, none - 1.0]),
        ]
    )
    most = np.concatenate(
        [
            np.full(2 * n, bounds.jerk),
            np.full(n + 1, bounds.greatest_velocity - velocity),
            np.full(n + 1, velocity - bounds.least_velocity),
            -velocity * nodes,
        ]
    )
    equal = np.vstack([np.eye(1, n + 2), np.eye(1, n + 2, n), np.hstack([place[-1:], [[0.0]]])])
    target = [0.0, 0.0, -0.5 * way - velocity * nodes[-1]]
    limits = [(-bounds.acceleration, bounds.acceleration)] * (n + 1) + [(0.0, None)]
    answer = linprog([0.0] * (n + 1) + [1.0], rows, most, equal, target, bounds=limits)
    return float(answer.x[-1]) if answer.status == 0 else None


@settings(max_examples=40, deadline=None)
@given(st.floats(0.6, 6.0), st.floats(0.02, 3.0), st.floats(1.05, 4.0), st.floats(1.0, 20.0), st.floats(5.0, 500.0))
def test_no_motion_on_a_grid_overshoots_less(
    time: float, way: float, top: float, acceleration: float, jerk: float
) -> None:
    """Positions are looked at on the nodes alone, so the grid's overshoot can be a little less."""
    bounds = Bounds(-top, top, acceleration, jerk)
    found = least_overshoot(time, 1.0, way, bounds)
    reach = greatest_reach(time, 1.0 + top, acceleration, jerk)
    if found is None:
        assert reach <= (time + way) * (1 + 1e-9)
        return
    x, s, v = motion(found)
    assert x[-1] == pytest.approx(time, rel=1e-9)
    assert s[-1] == pytest.approx(-way, abs=1e-7 * time)
    assert v[-1] == pytest.approx(1.0, abs=1e-7 * top)
    assert np.abs(v).max() <= top * (1 + 1e-7)
    assert s.max() == pytest.approx(found.distance, abs=1e-6 * time)
    assert s.min() == pytest.approx(-way - found.distance, abs=1e-6 * time)
    corners = found.braking.corners()[0]
    nodes = np.unique(np.concatenate([np.linspace(0.0, time / 2, 41), corners[corners < time / 2]]))
    nodes = nodes[np.concatenate([[True], np.diff(nodes) > 1e-9 * time])]
    twin = programme(time, 1.0, way, bounds, nodes)
    if twin is not None:
        assert twin >= found.distance - 2e-3 * time


def test_the_hardest_stop_is_the_least_of_all() -> None:
    """With time to spare the carriage brakes as hard as it may: ``v²/2a + v a/2j`` with the acceleration held."""
    found = least_overshoot(4.0, 1.0, 1.0, Bounds(-2.0, 2.0, 5.0, 100.0))
    assert found is not None
    ramp = 5.0 / 100.0
    after_ramp = 1.0 - 0.5 * 100.0 * ramp**2
    assert found.distance == pytest.approx(ramp - 100.0 * ramp**3 / 6 + after_ramp**2 / (2 * 5.0), rel=1e-12)


def test_there_is_none_where_the_limits_do_not_bring_it_back() -> None:
    assert least_overshoot(0.5, 1.0, 1.0, Bounds(-2.0, 2.0, 5.0, 100.0)) is None


@settings(deadline=None, max_examples=200)
@given(
    time=st.floats(0.1, 10.0),
    backwards=st.floats(0.1, 3.0),
    acceleration=st.floats(0.0, 2.0).map(lambda power: 10.0**power),
    jerk=st.floats(0.5, 4.0).map(lambda power: 10.0**power),
    short=st.floats(-12.0, -1.0).map(lambda power: 10.0**power),
)
def test_there_is_one_up_to_the_farthest_way_that_any_motion_covers(
    time: float, backwards: float, acceleration: float, jerk: float, short: float
) -> None:
    """However few turns are left: near the farthest way they lie within a millionth of each other."""
    bounds, ends = Bounds(-backwards, 2.0, acceleration, jerk), State(1.0, 0.0)
    quickest = nearest(time, ends, ends, bounds)
    if quickest is None or quickest.distance >= -1e-3:
        return
    way = -quickest.distance * (1.0 - short)
    found = least_overshoot(time, 1.0, way, bounds)
    assert found is not None
    braking, (near, far) = found.braking, found.back
    back = found.share * near.distance + (1.0 - found.share) * far.distance
    assert 2.0 * braking.distance + back == pytest.approx(-way, rel=1e-9)
    assert least_overshoot(time, 1.0, -quickest.distance * (1.0 + 1e-6), bounds) is None
