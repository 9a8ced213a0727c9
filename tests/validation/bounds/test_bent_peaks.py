"""Least peaks of returns that leave the sync zone while the ratio changes, against a linear programme and against designs."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import linprog

from camwright.design.optimise import solve
from camwright.profiles.cut import Cut
from camwright.profiles.limits import Limits
from camwright.profiles.machines import CrankSlider, Machine, RotaryKnife
from camwright.profiles.task import Task
from camwright.validation.bounds.bent_peaks import least_bent_acceleration, least_bent_jerk
from camwright.validation.bounds.optimality import lower_bound

SEALER = RotaryKnife(0.376, blades=2, sync="horizontal")
BAG = Cut(0.25, 0.6, 0.0409, 0.015, 0.0259, 2e-4)
CRANK = CrankSlider(0.15, 0.6, 0.0, 0.5, 20.0, sync_at=1.5)
SHEET = Cut(0.9, 0.5, 0.15, 0.04, 0.11, 2e-4)


def least_by_programme(task: Task, order: int, intervals: int = 600) -> float:
    """Least peak by a linear programme with the jerk constant on each interval: above the true one, closely."""
    v, time = task.cut.line_speed, task.cut.return_zone / task.cut.line_speed
    h, n = time / intervals, intervals
    sync = task.sync
    (v0, a0), (v1, a1) = ((float(sync(at, 1)) * v, float(sync(at, 2)) * v**2) for at in (sync.end, sync.start))
    ahead = np.tril(np.ones((n, n)))
    rank = np.arange(1, n + 1)
    acceleration = h * ahead
    back = rank[:, None] - rank[None, :]
    velocity = np.where(back >= 0, h**2 * (back + 0.5), 0.0)
    last = h**3 * ((n - rank) ** 2 / 2 + (n - rank) / 2 + 1 / 6)
    ones, none = np.ones((n, 1)), np.zeros((n, 1))
    limits, t = task.limits, h * rank
    peak = (ones, none) if order == 2 else (none, ones)
    rows = [np.hstack([s * acceleration, -peak[0]]) for s in (1, -1)] + [
        np.hstack([s * np.eye(n), -peak[1]]) for s in (1, -1)
    ]
    top = [np.full(n, -s * a0 + (0.0 if order == 2 else limits.acceleration)) for s in (1, -1)] + [
        np.full(n, limits.jerk if order == 2 else 0.0) for _ in (1, -1)
    ]
    rows += [np.hstack([s * velocity, none]) for s in (1, -1)]
    top += [limits.speed - v0 - a0 * t, -task.least_velocity + v0 + a0 * t]
    ends = np.vstack([acceleration[-1], velocity[-1], last])
    wanted = [a1 - a0, v1 - v0 - a0 * time, task.height - v0 * time - a0 * time**2 / 2]
    found = linprog(
        np.append(np.zeros(n), 1.0), A_ub=np.vstack(rows), b_ub=np.concatenate(top),
        A_eq=np.hstack([ends, np.zeros((3, 1))]), b_eq=wanted, bounds=[(None, None)] * n + [(0, None)],
    )  # fmt: skip
    assert found.status == 0
    return float(found.fun)


@pytest.mark.parametrize("speed", [1.0, 4.0])
@pytest.mark.parametrize("jerk", [900.0, 9000.0])
def test_a_linear_programme_finds_the_same_least_acceleration(speed: float, jerk: float) -> None:
    task = Task(SEALER, BAG, Limits(speed, 90.0, jerk))
    assert least_by_programme(task, 2) == pytest.approx(least_bent_acceleration(task), rel=2e-3)
    assert least_bent_acceleration(task) <= least_by_programme(task, 2) * (1 + 1e-6)


@pytest.mark.parametrize(("machine", "cut", "limits"), [
    (SEALER, BAG, Limits(4.0, 90.0, 9000.0)),
    (SEALER, BAG, Limits(1.0, 4.0, 9000.0)),
    (CRANK, SHEET, Limits(40.0, 200.0, 1e5)),
])  # fmt: skip
def test_a_linear_programme_finds_the_same_least_jerk(machine: Machine, cut: Cut, limits: Limits) -> None:
    task = Task(machine, cut, limits)
    assert least_by_programme(task, 3) == pytest.approx(least_bent_jerk(task), rel=1e-2)
    assert least_bent_jerk(task) <= least_by_programme(task, 3) * (1 + 1e-6)


@pytest.mark.parametrize("objective", ["peak_acceleration", "peak_jerk"])
@pytest.mark.parametrize("length", [0.12, 0.19, 0.25, 0.4])
def test_designs_of_a_cross_sealer_reach_the_bound(objective: str, length: float) -> None:
    task = Task(SEALER, replace(BAG, length=length), Limits(4.0, 90.0, 9000.0))
    found = solve(task, objective)
    bound = lower_bound(found.profile, task, objective)
    assert bound.value <= found.minimised * (1 + 1e-9)
    assert found.minimised == pytest.approx(bound.value, rel=1e-5)


def test_what_is_impossible_has_no_least_peak() -> None:
    task = Task(SEALER, replace(BAG, length=0.06), Limits(0.7, 5.0, 100.0))
    assert math.isinf(least_bent_acceleration(task))
    assert math.isinf(least_bent_jerk(task))
