"""Weak duality of mean squares: below every motion that keeps the limits, and close to what another solver finds."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import cvxpy as cp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camwright import load_job
from camwright.design.optimise import solve
from camwright.profiles.cut import Cut
from camwright.profiles.errors import InfeasibleError
from camwright.profiles.limits import Limits
from camwright.profiles.machines import CrankSlider, LinearCarriage, RotaryKnife
from camwright.profiles.objective import OBJECTIVES
from camwright.profiles.task import Task
from camwright.validation.bounds.optimality import lower_bound
from camwright.validation.bounds.return_dual import DualTask, least_square_acceleration, least_square_jerk
from camwright.validation.motor import measure_motor

SEALER = RotaryKnife(0.376, blades=2, sync="horizontal", drum_inertia=0.02, drum_friction=1.0)
BAG = Cut(0.25, 0.6, 0.0409, 0.015, 0.0259, 2e-4)
CRANK = CrankSlider(0.15, 0.6, 0.0, 0.5, 20.0, sync_at=1.5)
SHEET = Cut(0.9, 0.5, 0.15, 0.04, 0.11, 2e-4)
SAW = LinearCarriage(0.9, mass=180.0)
TUBE = Cut(1.6, 0.6, 0.5, 0.2, 0.3, 2e-4)
EXAMPLES = Path(__file__).parents[3] / "examples"


def least_on_a_grid(task: DualTask, order: int, n: int = 240) -> float:
    """Half the integral's least with the jerk constant on each of n intervals: above the true one."""
    h = task.time / n
    j, a, v, q = cp.Variable(n), cp.Variable(n + 1), cp.Variable(n + 1), cp.Variable(n + 1)
    rows = [
        a[0] == task.start[1], v[0] == task.start[0], q[0] == 0, a[n] == task.end[2], q[n] == task.end[0],
        a[1:] == a[:-1] + h * j,
        v[1:] == v[:-1] + h * a[:-1] + h**2 / 2 * j,
        q[1:] == q[:-1] + h * v[:-1] + h**2 / 2 * a[:-1] + h**3 / 6 * j,
        cp.abs(j) <= task.jerk, cp.abs(a) <= task.acceleration, v >= task.velocities[0], v <= task.velocities[1],
    ]  # fmt: skip
    if task.end[1] is not None:
        rows.append(v[n] == task.end[1])
    if math.isfinite(task.positions[0]):
        rows += [q >= task.positions[0], q <= task.positions[1]]
    ends = cp.sum_squares(a[:-1]) + cp.sum_squares(a[1:]) + cp.sum_squares(a[:-1] + a[1:])
    square = cp.sum_squares(j) * h if order == 3 else h / 6 * ends
    problem = cp.Problem(cp.Minimize(square / 2), rows)
    problem.solve(solver=cp.CLARABEL)
    assert problem.status == "optimal"
    return float(problem.value)


FREE = DualTask(1.0, (1.0, 0.0), (1.4, 1.0, 0.0), (-9.0, 9.0), 50.0, 5e3)
TASKS = {
    "free": FREE,
    "bent": replace(FREE, start=(1.0, 2.0), end=(1.3, 1.1, -1.5)),
    "slow": replace(FREE, velocities=(0.0, 1.5)),
    "weak": replace(FREE, acceleration=2.2, jerk=60.0),
    "confined": replace(FREE, end=(-0.6, 1.0, 0.0), positions=(-0.75, 0.12), acceleration=60.0, jerk=2e3),
    "open": replace(FREE, end=(1.4, None, 0.0)),
}


@pytest.mark.parametrize("name", TASKS)
@pytest.mark.parametrize("order", [2, 3])
def test_another_solver_on_a_grid_finds_a_little_more(name: str, order: int) -> None:
    task = TASKS[name]
    grid = least_on_a_grid(task, order)
    nodes = np.linspace(0.0, task.time, 601)
    least = least_square_jerk if order == 3 else least_square_acceleration
    unit = math.sqrt(2 * grid) if order == 3 else math.sqrt(2 * grid) / task.time
    found = least(task, nodes, unit)
    assert found <= grid * (1 + 1e-6)
    assert found == pytest.approx(grid, rel=1.5e-2)


@pytest.mark.parametrize("acceleration", [1e2, 1e4, 1e6])
@pytest.mark.parametrize("jerk", [1e5, 1e7, 1e9])
def test_limits_far_beyond_the_motion_leave_the_cubic(acceleration: float, jerk: float) -> None:
    """Half of ``12 d² / T³`` for a way ``d`` more than the even one; from a start at zero the multipliers were not found in 60 steps."""
    task = replace(FREE, acceleration=acceleration, jerk=jerk, velocities=(-1e3, 1e3))
    found = least_square_acceleration(task, np.linspace(0.0, 1.0, 301), 1.0)
    assert found == pytest.approx(6 * 0.4**2, rel=2e-3)
    assert found <= 6 * 0.4**2 * (1 + 1e-9 + 30 / jerk)


@given(st.floats(0.2, 5.0), st.floats(0.05, 20.0), st.sampled_from(sorted(TASKS)), st.sampled_from([2, 3]))
@settings(max_examples=20)
def test_units_do_not_matter(time: float, unit: float, name: str, order: int) -> None:
    task = TASKS[name]
    place, pace, slope = task.end
    other = DualTask(
        time,
        (task.start[0] / time, task.start[1] / time**2),
        (place, None if pace is None else pace / time, slope / time**2),
        (task.velocities[0] / time, task.velocities[1] / time),
        task.acceleration / time**2,
        task.jerk / time**3,
        task.positions,
    )
    least = least_square_jerk if order == 3 else least_square_acceleration
    nodes = np.linspace(0.0, 1.0, 61)
    one, same = least(task, nodes, 10.0 * unit), least(other, time * nodes, 10.0 * unit / time**3)
    assert same * time ** (2 * order - 1) == pytest.approx(one, rel=1e-5, abs=1e-6)


@pytest.mark.parametrize("objective", ["rms_acceleration", "rms_jerk", "rms_torque"])
@pytest.mark.parametrize(
    ("machine", "cut", "limits"),
    [
        (SEALER, BAG, Limits(4.0, 90.0, 9000.0)),
        (SEALER, replace(BAG, length=0.12), Limits(2.0, 60.0, 9000.0)),
        (SEALER, replace(BAG, length=0.5), Limits(2.0, 60.0, 9000.0)),
        (SAW, TUBE, Limits(3.0, 6.0, 200.0)),
        (replace(SAW, stroke=0.62), TUBE, Limits(3.0, 9.0, 400.0)),
    ],
)
def test_designs_come_close(machine: RotaryKnife | LinearCarriage, cut: Cut, limits: Limits, objective: str) -> None:
    task = Task(machine, cut, limits)
    found = solve(task, objective)
    bound = lower_bound(found.profile, task, objective)
    value = measure_motor(found.profile, task).rms_torque if objective == "rms_torque" else found.minimised
    assert bound.value <= value * (1 + 1e-9)
    assert bound.value >= value * (1 - 5e-3)


@given(
    st.floats(0.7, 3.0), st.floats(0.3, 0.6), st.floats(1.36, 1.9), st.sampled_from(["rms_acceleration", "rms_jerk"])
)
@settings(max_examples=8)
def test_no_crank_goes_below(length: float, speed: float, place: float, objective: str) -> None:
    task = Task(
        replace(CRANK, sync_at=place), replace(SHEET, length=length, line_speed=speed), Limits(60.0, 400.0, 1e4)
    )
    try:
        rival = solve(task, "peak_jerk" if objective == "rms_jerk" else "peak_acceleration")
        found = solve(task, objective)
    except InfeasibleError:
        return
    order, start = OBJECTIVES[objective].order, task.cut.return_start
    for motion in (rival, found):
        bound = lower_bound(motion.profile, task, objective)
        square = motion.profile.mean_square(order, start, start + task.cut.return_zone)
        assert bound.value <= math.sqrt(square) * task.cut.line_speed**order * (1 + 1e-9)
    assert bound.value >= found.minimised * 0.99


def test_a_carriage_whose_stroke_binds_is_bounded_for_the_jerk() -> None:
    job = load_job(EXAMPLES / "flying-saw.toml")
    task = job.task.with_machine(replace(job.machine, stroke=0.8))
    found = solve(task, "rms_jerk")
    bound = lower_bound(found.profile, task, "rms_jerk")
    assert found.minimised * (1 - 5e-3) <= bound.value <= found.minimised * (1 + 1e-9)
