"""Returns of least torque or energy at the motor, for machines whose inertia depends on where the slave is.

The pieces, limits and boundary values are those of `design.transcription`; the objective is evaluated at Gauss points of every interval
through the machine's own formulas. It is not convex where the inertia changes, so it is solved from several starts.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Literal

import casadi as ca
import numpy as np

from design.ipopt import QUIET
from design.problem import ReturnProblem
from design.scaling import ScaledProblem, motion_scale, scale_problem, unscale_profile
from design.solver import ALLOWED_EXCESS, excess, solve_return
from design.structure import tidy
from design.transcription import Motion, dynamics
from profiles.cycle import Cut
from profiles.errors import SolverError
from profiles.machines import Machine
from profiles.polynomial import CamProfile, FloatArray
from profiles.returns import quintic_between

# NumPy's functions on CasADi's symbols are meant: a machine is written once, for numbers and symbols alike.
ca.GlobalOptions.setNumpyMode(1)

TorqueObjective = Literal["rms_torque", "peak_torque", "energy"]

INTERVALS = 80
GAUSS_POINTS = 3
# A step in the power's sign is rounded over this share of the largest power; a peak also pays this share of the mean square, so that of
# all motions with that peak the smoothest is taken.
ROUNDING = 1e-4
DRAWN_IN = 3e-8
"""Share by which limits are drawn in here: the solver answers this programme to about 1e-8, the contract says 1e-9."""
AGREEMENT = 1e-4
"""Starts whose objectives differ by less than this share have found the same optimum."""

_OPTIONS: dict[str, Any] = QUIET | {"ipopt.tol": 1e-8, "ipopt.max_iter": 500, "ipopt.mu_strategy": "adaptive"}


@dataclass(frozen=True, eq=False)
class TorqueSolution:
    """Best of several starts.

    Parameters
    ----------
    back
        The return over ``[0, length]`` from slave zero.
    spread
        Greatest objective over least, less one, of the starts that converged.
    starts, agreeing
        How many starts converged, and how many of them to the best objective.
    residual
        Largest KKT residual of the best (scaled).
    iterations
        Iterations of IPOPT, all starts together.
    """

    back: CamProfile
    spread: float
    starts: int
    agreeing: int
    residual: float
    iterations: int


def solve_torque(
    machine: Machine, cut: Cut, problem: ReturnProblem, start: float, objective: TorqueObjective
) -> TorqueSolution:
    """Find the return of least torque or energy.

    Parameters
    ----------
    machine, cut
        The machine and its cycle.
    problem
        The return as numbers over the master; its own objective does not count.
    start
        Slave coordinate at the start of the return (slave unit).
    objective
        ``"rms_torque"``, ``"peak_torque"`` or ``"energy"`` (drawn, nothing fed back).

    Raises
    ------
    SolverError
        No start converged to a motion that keeps the limits.
    """
    scale = motion_scale(problem)
    scaled = scale_problem(problem, scale)
    programme = _TorqueProgramme(machine, cut, problem, scale, start, objective)
    found: list[tuple[float, CamProfile, float]] = []
    iterations = 0
    guesses = _starts(machine, cut, problem, scale)
    for guess in guesses:
        motion, value, residual, success, used = programme.solve(scaled, guess)
        iterations += used
        if not success:
            continue
        profile = tidy(motion, scaled).profile()
        if excess(profile, scaled) <= ALLOWED_EXCESS:
            found.append((value, unscale_profile(profile, problem, scale), residual))
    converged = len(found)
    # the starts keep the limits themselves: the answer is at least as good as the best of them
    kept = [guess for guess in guesses if excess(guess, scaled) <= ALLOWED_EXCESS]
    found += [(programme.value(guess), unscale_profile(guess, problem, scale), math.nan) for guess in kept]
    if not found:
        raise SolverError(
            f"IPOPT found no return of least {objective} from any start, although the limits can be kept; minimise peak_acceleration or "
            f"rms_acceleration instead"
        )
    best = min(found, key=lambda entry: entry[0])
    found = found[:converged] or [best]
    agreeing = sum(value <= best[0] * (1 + AGREEMENT) for value, _, _ in found)
    spread = max(value for value, _, _ in found) / best[0] - 1.0 if best[0] > 0 else 0.0
    return TorqueSolution(best[1], spread, converged, agreeing, best[2], iterations)


def _starts(machine: Machine, cut: Cut, problem: ReturnProblem, scale: float) -> list[CamProfile]:
    """Scaled first guesses: the optima of the motion alone, and the quintic."""
    from dataclasses import replace

    profiles = [solve_return(replace(problem, objective=name))[0] for name in ("peak_acceleration", "rms_acceleration")]
    profiles.append(quintic_between(machine.sync_profile(cut), problem.length, problem.height))
    return [
        profile.add_line(-problem.start_ratio).scale(master=1.0 / problem.length, slave=1.0 / scale)
        for profile in profiles
    ]


class _TorqueProgramme:
    """The programme of one machine and job: accelerations at nodes, piecewise linear between, and the node states."""

    def __init__(
        self, machine: Machine, cut: Cut, problem: ReturnProblem, scale: float, start: float, objective: TorqueObjective
    ) -> None:
        n = INTERVALS
        self._h = np.full(n, 1.0 / n)
        a, v, q, t = ca.SX.sym("a", n + 1), ca.SX.sym("v", n + 1), ca.SX.sym("q", n + 1), ca.SX.sym("t")
        equations, between = dynamics({"a": a, "v": v, "q": q}, ca.DM(self._h), 1)
        drift = problem.start_ratio * problem.length / scale
        node, weight = np.polynomial.legendre.leggauss(GAUSS_POINTS)
        node, weight = 0.5 * (node + 1), 0.5 * weight
        torques, powers, shares = [], [], []
        per_time = cut.line_speed * scale / problem.length
        for i in range(n):
            h, rise = float(self._h[i]), a[i + 1] - a[i]
            for s, w in zip(node, weight, strict=True):
                pace = v[i] + h * s * (a[i] + rise * s / 2)
                place = q[i] + h * s * (v[i] + h * s * (a[i] / 2 + rise * s / 6))
                y = start + scale * (place + drift * (i + s) * h)
                velocity = per_time * (pace + drift)
                acceleration = per_time * cut.line_speed / problem.length * (a[i] + rise * s)
                force = machine.inertia(y) * acceleration + machine.inertia_slope(y) * velocity**2 / 2
                force += machine.friction * (ca.tanh(velocity / (0.01 * cut.line_speed)) if machine.turns_back else 1.0)
                torques.append(force)
                powers.append(force * velocity)
                shares.append(h * w)
        self._shares, self._objective = np.array(shares), objective
        unknown = ca.vertcat(a, v, q, t)
        self._measure = ca.Function("measure", [unknown], [ca.vertcat(*torques), ca.vertcat(*powers)])
        force_unit, power_unit = ca.SX.sym("F"), ca.SX.sym("P")
        scaled = ca.vertcat(*torques) / force_unit
        mean_square = ca.dot(ca.DM(shares), scaled**2)
        jerk = ca.vertcat(*[(a[i + 1] - a[i]) / self._h[i] for i in range(n)])
        peaks: list[Any] = []
        if objective == "rms_torque":
            cost = mean_square
        elif objective == "peak_torque":
            cost = t + ROUNDING * mean_square
            peaks = [t - scaled, t + scaled]
        else:
            power = ca.vertcat(*powers) / power_unit
            cost = ca.dot(ca.DM(shares), (power + ca.sqrt(power**2 + ROUNDING**2)) / 2) + ROUNDING * mean_square
        self._counts = (2 * n, 2 * len(torques) if peaks else 0, len(between), n)
        nlp = {
            "x": unknown,
            "p": ca.vertcat(force_unit, power_unit),
            "f": cost,
            "g": ca.vertcat(*equations, *peaks, *between, jerk),
        }
        self._solver = ca.nlpsol("camwright_torque", "ipopt", nlp, _OPTIONS)

    def _value(self, torque: FloatArray, power: FloatArray) -> float:
        """Objective at the slave: root mean square or peak (N or N·m), or mean power drawn (W), over the return."""
        if self._objective == "rms_torque":
            return math.sqrt(float(self._shares @ torque**2))
        return (
            float(np.abs(torque).max())
            if self._objective == "peak_torque"
            else float(self._shares @ np.maximum(power, 0.0))
        )

    def value(self, guess: CamProfile) -> float:
        """Objective of a scaled profile, as `_value`."""
        x = np.clip(np.concatenate([[0.0], np.cumsum(self._h)]), guess.start, guess.end)
        torque, power = self._measure(np.concatenate([guess(x, 2), guess(x, 1), guess(x), np.zeros(1)]))
        return self._value(np.asarray(torque).ravel(), np.asarray(power).ravel())

    def solve(self, problem: ScaledProblem, guess: CamProfile) -> tuple[Motion, float, float, bool, int]:
        """Solve from a guess; returns motion, objective, KKT residual, success, iterations."""
        n = INTERVALS
        x = np.clip(np.concatenate([[0.0], np.cumsum(self._h)]), guess.start, guess.end)
        start = np.concatenate([guess(x, 2), guess(x, 1), guess(x), [1.5]])
        torque, power = (np.asarray(part).ravel() for part in self._measure(start))
        units = [max(float(np.sqrt(np.mean(torque**2))), 1e-300), max(float(np.abs(power).max()), 1e-300)]
        factor = 1.0 - DRAWN_IN
        low, high = problem.least_ratio * factor, problem.greatest_ratio * factor
        slope, jerk = problem.greatest_slope * factor, problem.greatest_jerk * factor
        place = np.clip(problem.drift * x, -np.inf, np.inf)
        lower = [np.full(n + 1, -slope), np.full(n + 1, low), problem.least_position - place, np.zeros(1)]
        upper = [np.full(n + 1, slope), np.full(n + 1, high), problem.greatest_position - place, np.full(1, np.inf)]
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
        torque, power = (np.asarray(part).ravel() for part in self._measure(flat))
        value = self._value(torque, power)
        return (
            Motion(self._h, flat[: n + 1], value),
            value,
            residual,
            bool(statistics["success"]),
            int(statistics["iter_count"]),
        )
