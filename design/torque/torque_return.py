"""Returns of least torque or energy at the motor, or of least load within its curve, from several starts."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from camwright.design.returns.problem import ReturnProblem
from camwright.design.returns.scaling import motion_scale, scale_problem, unscale_profile
from camwright.design.returns.solver import ALLOWED_EXCESS, excess, solve_return
from camwright.design.returns.structure import tidy
from camwright.design.torque.programme import Aim, TorqueProgramme, TorqueTask
from camwright.profiles.errors import SolverError
from camwright.profiles.motor import MotorCurve
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.returns import quintic_between
from camwright.profiles.task import Task

AGREEMENT = 1e-4
"""Starts whose objectives differ by less than this share have found the same optimum."""


@dataclass(frozen=True, eq=False)
class TorqueSolution:
    """Best of several starts.

    Parameters
    ----------
    back
        The return over ``[0, length]`` from slave zero.
    value
        Its objective at the slave: root mean square or peak (N or N·m), or mean power drawn (W), over the return.
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
    value: float
    spread: float
    starts: int
    agreeing: int
    residual: float
    iterations: int


def solve_torque(
    task: Task,
    problem: ReturnProblem,
    aim: Aim,
    curve: MotorCurve | None = None,
    keeps: Callable[[CamProfile], bool] | None = None,
    starts: Sequence[CamProfile] = (),
) -> TorqueSolution:
    """Find the return of least torque or energy, of least load, or the least of another objective within the motor's curve.

    Parameters
    ----------
    task
        The machine and its cycle.
    problem
        The return as numbers over the master; its own objective does not count.
    aim
        What is minimised: ``"rms_torque"``, ``"peak_torque"``, ``"energy"`` (drawn, nothing fed back), ``"load"`` or an objective of the
        motion.
    curve
        What the motor can give, for the load and as a limit for all else.
    keeps
        What a return must fulfil besides its limits.
    starts
        Returns to start from, beside the quintic; if there are none, the optima of the motion alone.

    Raises
    ------
    SolverError
        No start converged to a motion that keeps the limits.
    """
    scale = motion_scale(problem)
    scaled = scale_problem(problem, scale)
    programme = TorqueProgramme(TorqueTask(task.machine, task.cut, problem, scale, task.slave_at_sync_end, aim, curve))
    accepted = keeps or (lambda _: True)
    found: list[tuple[float, CamProfile, float]] = []
    iterations = 0
    guesses = _guesses(task, problem, scale, starts)
    for guess in guesses:
        answer = programme.solve(scaled, guess)
        iterations += answer.iterations
        if not answer.success:
            continue
        profile = tidy(answer.motion, scaled).profile()
        back = unscale_profile(profile, problem, scale)
        if excess(profile, scaled) <= ALLOWED_EXCESS and accepted(back):
            found.append((answer.value, back, answer.residual))
    converged = len(found)
    # the starts keep the limits themselves: the answer is at least as good as the best of them
    kept = [
        (guess, unscale_profile(guess, problem, scale)) for guess in guesses if excess(guess, scaled) <= ALLOWED_EXCESS
    ]
    found += [(programme.value(guess), back, math.nan) for guess, back in kept if accepted(back)]
    if not found:
        raise SolverError(
            f"IPOPT found no return of least {aim} from any start, although the limits can be kept; minimise peak_acceleration or "
            f"rms_acceleration instead"
        )
    best = min(found, key=lambda entry: entry[0])
    found = found[:converged] or [best]
    agreeing = sum(value <= best[0] * (1 + AGREEMENT) for value, _, _ in found)
    spread = max(value for value, _, _ in found) / best[0] - 1.0 if best[0] > 0 else 0.0
    return TorqueSolution(best[1], best[0], spread, converged, agreeing, best[2], iterations)


def _guesses(task: Task, problem: ReturnProblem, scale: float, starts: Sequence[CamProfile]) -> list[CamProfile]:
    """Scaled first guesses: the quintic, and the given starts or the optima of the motion alone."""
    profiles = list(starts) or [
        solve_return(replace(problem, objective=name))[0] for name in ("peak_acceleration", "rms_acceleration")
    ]
    profiles.append(quintic_between(task.sync, problem.length, problem.height))
    return [
        profile.add_line(-problem.start_ratio).scale(master=1.0 / problem.length, slave=1.0 / scale).over(0.0, 1.0)
        for profile in profiles
    ]
