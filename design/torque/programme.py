"""The programme of returns whose torque counts: as the objective, or within what the motor gives at its speed.

The pieces, limits and boundary values are those of `camwright.design.returns.transcription`; torque and power are evaluated at
Gauss-Lobatto points of
every interval through the machine's own formulas. It is not convex where the inertia changes.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Literal

import casadi as ca
import numpy as np

from camwright.design.returns.ipopt import QUIET
from camwright.design.returns.problem import ReturnProblem
from camwright.design.returns.scaling import ScaledProblem
from camwright.design.returns.transcription import ScaledMotion
from camwright.profiles.cut import Cut
from camwright.profiles.machines import Machine
from camwright.profiles.motor import MotorCurve
from camwright.profiles.objective import MOTION_OBJECTIVES, CommandObjective
from camwright.profiles.polynomial.profile import CamProfile, FloatArray

# NumPy's functions on CasADi's symbols are meant: a machine is written once, for numbers and symbols alike.
ca.GlobalOptions.setNumpyMode(1)

Aim = CommandObjective | Literal["load"]
"""What is minimised; the load is the greatest share of the motor's torque at its speed that is used."""

INTERVALS = 80
# A peak, and the energy, also pay this share of the mean square, so that of all motions with that peak the smoothest is taken.
ROUNDING = 1e-4
DRAWN_IN = 3e-8
"""Share by which limits are drawn in here: the solver answers this programme to about 1e-8, the contract says 1e-9."""
CURVE_DRAWN_IN = 2e-3
"""The same for the motor's torque, which is looked at in Gauss-Lobatto points only."""

LOBATTO = (
    0.5 + 0.5 * np.array([-1.0, -math.sqrt(0.2), math.sqrt(0.2), 1.0]),
    np.array([1.0, 5.0, 5.0, 1.0]) / 12.0,
)
"""Gauss-Lobatto points on the unit interval, and their weights: exact to degree 5, and at the nodes, where a peak may stand."""

_WIDTHS: FloatArray = np.full(INTERVALS, 1.0 / INTERVALS)
_SHARES: FloatArray = np.tile(1.0 / INTERVALS * LOBATTO[1], INTERVALS)
"""Lengths of the intervals, and the shares of their Gauss-Lobatto points in a mean."""

_OPTIONS: dict[str, Any] = QUIET | {"ipopt.tol": 1e-8, "ipopt.max_iter": 500, "ipopt.mu_strategy": "adaptive"}


@dataclass(frozen=True, eq=False)
class TorqueTask:
    """What a programme is made for.

    Parameters
    ----------
    machine, cut
        The machine and its cycle.
    problem
        The return as numbers over the master; its own objective does not count.
    scale
        Slave travel that is 1 in the scaled problem (slave unit).
    start
        Slave coordinate at the start of the return (slave unit).
    aim
        What is minimised.
    curve
        What the motor can give; None where that is no limit.
    """

    machine: Machine
    cut: Cut
    problem: ReturnProblem
    scale: float
    start: float
    aim: Aim
    curve: MotorCurve | None


@dataclass(frozen=True, eq=False)
class TorqueAnswer:
    """One answer of the solver.

    Parameters
    ----------
    motion
        The scaled motion.
    value
        Its objective, as `TorqueProgramme.value` has it.
    residual
        Largest KKT residual (scaled).
    success
        Whether the solver converged.
    iterations
        Its iterations.
    """

    motion: ScaledMotion
    value: float
    residual: float
    success: bool
    iterations: int


class TorqueProgramme:
    """The programme of one task: accelerations at nodes, piecewise linear between, and the node states."""

    def __init__(self, task: TorqueTask) -> None:
        n = INTERVALS
        self._task = task
        h = 1.0 / n
        self._drawn = len(LOBATTO[0]) * n if task.aim == "energy" else 0
        x = ca.MX.sym("x", 3 * (n + 1) + 1 + self._drawn)
        a, v, q, t, drawn = ca.vertsplit(x, list(np.cumsum([0, n + 1, n + 1, n + 1, 1, self._drawn])))
        rise, jerk = a[1:] - a[:-1], (a[1:] - a[:-1]) / h
        equations = [
            v[:-1] + h * (a[:-1] + a[1:]) / 2 - v[1:],
            q[:-1] + h * v[:-1] + h * h * (a[:-1] / 3 + a[1:] / 6) - q[1:],
        ]
        between = v[:-1] + h * a[:-1] / 2
        interval = self._interval().map(n)
        torque, power, available = (
            ca.vec(part) for part in interval(a[:-1].T, rise.T, v[:-1].T, q[:-1].T, ca.DM(np.arange(n) * h).T)
        )
        self._measure = ca.Function("measure", [x], [torque, power, available])
        units = ca.MX.sym("u", 2)  # of the torque or motion, and of the power
        shares = ca.DM(_SHARES)
        mean_square = ca.dot(shares, (torque / units[0]) ** 2)
        peaks: list[Any] = []
        match task.aim:
            case "rms_torque":
                cost = mean_square
            case "energy":
                peaks = [drawn - power / units[1]]  # what is drawn is the power or, as its bound says, nothing
                cost = ca.dot(shares, drawn) + ROUNDING * mean_square
            case "rms_acceleration":
                cost = h * ca.sum1(a[:-1] ** 2 + a[:-1] * a[1:] + a[1:] ** 2) / 3 / units[0] ** 2
            case "rms_jerk":
                cost = h * ca.sumsqr(jerk / units[0])
            case _:
                values = {
                    "peak_torque": torque / units[0],
                    "load": torque / available,
                    "peak_acceleration": a / units[0],
                    "peak_jerk": jerk / units[0],
                }[task.aim]
                peaks = [t - values, t + values]
                cost = t + (ROUNDING * mean_square if task.aim in ("peak_torque", "load") else 0.0)
        if task.curve is not None and task.aim != "load":
            allowed, strongest = available * (1 - CURVE_DRAWN_IN), task.curve.points[0][1] * task.machine.motor_ratio
            peaks += [(allowed - torque) / strongest, (allowed + torque) / strongest]
        self._counts = (2 * n, sum(part.numel() for part in peaks), n, n)
        nlp = {"x": x, "p": units, "f": cost, "g": ca.vertcat(*equations, *peaks, between, jerk)}
        self._solver = ca.nlpsol("camwright_torque", "ipopt", nlp, _OPTIONS)

    def _interval(self) -> Any:
        """Make the function of one interval: torque or force and power at the slave, and what the motor gives, at its Gauss-Lobatto points.

        It takes the acceleration at the interval's start and its rise, ratio and position at the start, and where the interval begins.
        """
        task, machine, h = self._task, self._task.machine, 1.0 / INTERVALS
        drift = task.problem.start_ratio * task.problem.length / task.scale
        per_time = task.cut.line_speed * task.scale / task.problem.length
        a, rise, v, q, x = (ca.SX.sym(name) for name in ("a", "r", "v", "q", "x"))
        s = ca.DM(LOBATTO[0])
        pace = v + h * s * (a + rise * s / 2)
        y = task.start + task.scale * (q + h * s * (v + h * s * (a / 2 + rise * s / 6)) + drift * (x + s * h))
        velocity = per_time * (pace + drift)
        acceleration = per_time * task.cut.line_speed / task.problem.length * (a + rise * s)
        force = machine.inertia(y) * acceleration + machine.inertia_slope(y) * velocity**2 / 2
        # a slave that does not turn back has friction against it all the time
        force += machine.friction * (ca.tanh(velocity / (0.01 * task.cut.line_speed)) if machine.turns_back else 1.0)
        available: Any = ca.DM.inf(len(LOBATTO[0]))
        if task.curve is not None:
            speeds, torques = (ca.DM(list(column)) for column in zip(*task.curve.points, strict=True))
            speed = ca.vertsplit(ca.fabs(velocity) * machine.motor_ratio)
            available = ca.vertcat(*[ca.pw_lin(each, speeds, torques) for each in speed]) * machine.motor_ratio
        return ca.Function("interval", [a, rise, v, q, x], [force, force * velocity, available])

    def _state(self, guess: CamProfile, bound: float) -> FloatArray:
        x = np.clip(np.concatenate([[0.0], np.cumsum(_WIDTHS)]), guess.start, guess.end)
        return np.concatenate([guess(x, 2), guess(x, 1), guess(x), [bound], np.zeros(self._drawn)])

    def value(self, guess: CamProfile) -> float:
        """Objective of a scaled profile: at the slave for torques and power, over the scaled master for motions; the load as a share."""
        return self._value(self._state(guess, 0.0))

    def _value(self, state: FloatArray) -> float:
        torque, power, available = (np.asarray(part).ravel() for part in self._measure(state))
        n = INTERVALS
        a = state[: n + 1]
        jerk = np.diff(a) / _WIDTHS
        match self._task.aim:
            case "rms_torque":
                return math.sqrt(float(_SHARES @ torque**2))
            case "peak_torque":
                return float(np.abs(torque).max())
            case "energy":
                return float(_SHARES @ np.maximum(power, 0.0))
            case "load":
                return float(np.abs(torque / available).max())
            case "peak_acceleration":
                return float(np.abs(a).max())
            case "rms_acceleration":
                return math.sqrt(float(_WIDTHS @ (a[:-1] ** 2 + a[:-1] * a[1:] + a[1:] ** 2)) / 3)
            case "peak_jerk":
                return float(np.abs(jerk).max())
            case "rms_jerk":
                return math.sqrt(float(_WIDTHS @ jerk**2))

    def solve(self, problem: ScaledProblem, guess: CamProfile) -> TorqueAnswer:
        """Solve from a guess."""
        n = INTERVALS
        start = self._state(guess, 1.5)
        torque, power, _ = (np.asarray(part).ravel() for part in self._measure(start))
        motion = self._task.aim in MOTION_OBJECTIVES
        unit = self._value(start) if motion else float(np.sqrt(np.mean(torque**2)))
        units = [max(unit, 1e-300), max(float(np.abs(power).max()), 1e-300)]
        if self._drawn:
            start[-self._drawn :] = np.maximum(power / units[1], 0.0) + 0.1
        if self._task.aim == "load":
            start[3 * (n + 1)] = 1.1 * self._value(start)
        factor = 1.0 - DRAWN_IN
        low, high = problem.least_ratio * factor, problem.greatest_ratio * factor
        slope, jerk = problem.greatest_slope * factor, problem.greatest_jerk * factor
        place = problem.drift * np.concatenate([[0.0], np.cumsum(_WIDTHS)])
        lower = [np.full(n + 1, -slope), np.full(n + 1, low), problem.least_position - place, np.zeros(1 + self._drawn)]
        upper = [np.full(n + 1, slope), np.full(n + 1, high), problem.greatest_position - place]
        upper.append(np.full(1 + self._drawn, np.inf))
        ends = ((problem.start_slope, problem.end_slope), (0.0, problem.end_ratio), (0.0, problem.height))
        for part, (first, last) in enumerate(ends):
            lower[part][0] = upper[part][0] = first
            lower[part][-1] = upper[part][-1] = last
        equal, peaks, between, steps = self._counts
        answer = self._solver(
            x0=start,
            p=units,
            lbx=np.concatenate(lower),
            ubx=np.concatenate(upper),
            lbg=[0.0] * (equal + peaks) + [low] * between + [-jerk] * steps,
            ubg=[0.0] * equal + [np.inf] * peaks + [high] * between + [jerk] * steps,
        )
        statistics = self._solver.stats()
        flat: FloatArray = np.asarray(answer["x"], dtype=np.float64).ravel()
        history = statistics.get("iterations", {})
        residual = max(
            (float(history[name][-1]) for name in ("inf_pr", "inf_du") if history.get(name)), default=math.nan
        )
        value = self._value(flat)
        return TorqueAnswer(
            ScaledMotion(_WIDTHS, flat[: n + 1], value),
            value,
            residual,
            bool(statistics["success"]),
            int(statistics["iter_count"]),
        )
