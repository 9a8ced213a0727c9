"""Returns within a motor's torque-speed curve where no single rectangle of the curve holds them: a programme of their own."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from camwright.design.feasible.feasibility import is_feasible
from camwright.design.returns.curve_limits import motor_speed_limits
from camwright.design.returns.problem import return_problem
from camwright.design.torque.parts import CURVE_DRAWN_IN
from camwright.design.torque.search import TorqueSolution, solve_torque
from camwright.design.torque.task import Aim, TorqueTask
from camwright.profiles.errors import SolverError
from camwright.profiles.motor import MotorCurve
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.returns import assemble
from camwright.profiles.task import Task

POINTS = 4001
"""Places of the cycle, besides its breaks, at which the torque is held against the curve."""
RAMP_SPEEDS = 10
"""Equal steps of the line speed down to standstill at which the torque of a ramp is looked at."""
ROUNDING = 1e-9
SAMPLED = 1e-6
"""Share of the torque that is kept free, for what happens between these places."""


def keeps_curve(profile: CamProfile, task: Task, curve: MotorCurve) -> bool:
    """Tell whether the motor reaches the speed of a cycle and gives the torque that it needs, at each of its speeds."""
    fastest = task.cut.line_speed * task.machine.motor_ratio * profile.peak(1)
    return fastest <= curve.top_speed * (1 + ROUNDING) and load(profile, task, curve) <= 1.0 - SAMPLED


def load(profile: CamProfile, task: Task, curve: MotorCurve) -> float:
    """Greatest share of the motor's torque at its speed that a cycle uses; beyond the motor's top speed, of that which it gives there."""
    machine = task.machine
    x = np.concatenate([np.linspace(profile.start, profile.end, POINTS), profile.breaks])
    worst = 0.0
    y, ratio = task.slave_at_start - float(profile(profile.start)) + profile(x), profile(x, 1)
    inertia, inertia_slope = machine.inertia(y), machine.inertia_slope(y)
    for v, ramp in _line_states(task):
        pace = v * ratio
        given = curve.torque(np.minimum(np.abs(pace) * machine.motor_ratio, curve.top_speed)) * machine.motor_ratio
        steady = inertia_slope * pace**2 / 2 + machine.friction * np.sign(ratio)
        for side in ("left", "right"):
            force = inertia * (v**2 * profile(x, 2, side=side) + ramp * ratio) + steady
            worst = max(worst, float((np.abs(force) / given).max()))
    return worst


def _line_states(task: Task) -> list[tuple[float, float]]:
    """Speeds (m/s) and accelerations (m/s²) of the line at which the torque is looked at: with ramps at lower speeds too."""
    v, line = task.cut.line_speed, task.line
    if not line.ramps:
        return [(v, 0.0)]
    return [(v * k / RAMP_SPEEDS, ramp) for k in range(RAMP_SPEEDS + 1) for ramp in (line.speeding, -line.braking)]


def least_load(task: Task) -> TorqueSolution | None:
    """Return that uses the least share of the motor's torque, that share being its value; None where the other limits are not enough.

    The share is not below 1 where the curve forbids the job, as far as the programme's starts tell.
    """
    curve, plain = task.limits.motor, motor_speed_limits(task.machine, task.limits)
    if curve is None or not is_feasible(task.with_limits(plain)):
        return None
    try:
        found = solve_torque(
            TorqueTask(task, return_problem(task.with_limits(plain), "peak_acceleration"), "load", curve)
        )
    except SolverError:
        return None
    return replace(found, value=load(assemble(found.back, task), task, curve) / (1 - 2 * CURVE_DRAWN_IN))


def solve_within_curve(task: Task, aim: Aim, starts: Sequence[CamProfile]) -> TorqueSolution | None:
    """Minimise an objective within the curve, from starts among others; None if no start led to a return that keeps it."""
    curve, plain = task.limits.motor, motor_speed_limits(task.machine, task.limits)
    if curve is None:
        return None

    def keeps(back: CamProfile) -> bool:
        return keeps_curve(assemble(back, task), task, curve)

    problem = return_problem(task.with_limits(plain), "peak_acceleration")
    try:
        return solve_torque(TorqueTask(task, problem, aim, curve), keeps, starts)
    except SolverError:
        return None
