"""How long a warm design takes, beside the same problem in rockit with IPOPT and in cvxpy with Clarabel.

Random rotary-knife jobs, all four objectives. All roads solve the same normalised return (unit length, unit height), and before
anything is timed each must come within its stated error of the exact optimum: a closed form, or for `rms_jerk` where a limit binds
(jobs whose optimum is a quintic are not drawn, they need no solver) the design itself, which an independent lower bound confirms:

- camwright: `camwright.design.optimise.solve`, from the job to the polished profile, the feasibility check among it, every programme
it needs
  built before;
- rockit: the problem stated, transcribed by multiple shooting and solved by IPOPT;
- cvxpy: the problem stated, compiled and solved by Clarabel, and, as `cvxpy_warm`, solved again by the compiled one with its
  numbers as parameters.

The last three hold the jerk constant on N equal intervals, which they integrate exactly, so that they have the same optimum. N is the
smallest of `COUNTS` whose objective is within `ACCURACY` of the exact one: a number that only those know who know the answer. Who does
not must double N until the objective stays; `cvxpy_found` is the time of one such run at N and one at 2 N, the confirmation, both
compiled. Promised are ratios to rockit, to plain `cvxpy` and to `cvxpy_warm`. rockit, which would take tens of seconds at such N, gets
no more than `MOST_ROCKIT` intervals and its error is stated.

Writes one CSV row for each job and prints the medians:

    pip install '.[bench]'
    python benchmarks/design_speed.py [--jobs 20] [--seed 1]
"""

from __future__ import annotations

import argparse
import contextlib
import csv
import io
import math
import statistics
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from time import process_time

import cvxpy as cp
import numpy as np
import rockit
from random_jobs import Job, random_job

from camwright.design.feasible.feasibility import is_feasible
from camwright.design.optimise import solve
from camwright.design.returns.closed_starts import known_start
from camwright.design.returns.problem import return_problem
from camwright.design.returns.scaling import ScaledProblem, motion_scale, scale_problem
from camwright.profiles.objective import MotionObjective
from camwright.profiles.task import Task
from camwright.validation.bounds.optimality import QUINTIC, lower_bound

RESULTS = Path(__file__).parent / "results"

ACCURACY = 1e-4
"""Share by which the objective of a road may be off."""

COUNTS = (20, 30, 40, 60, 80, 120, 160, 240, 320, 480, 640)

MOST_ROCKIT = 160
"""Most intervals for rockit."""

OWN_ACCURACY = 1e-6
"""Share by which a design may be off; the contract."""

CONFIRMED = 1e-4
"""Largest gap to an independent lower bound where the design itself serves as the exact optimum."""

OBJECTIVES: tuple[MotionObjective, ...] = ("peak_acceleration", "rms_acceleration", "peak_jerk", "rms_jerk")

PROMISED = {"rockit": 10.0, "cvxpy": 1.0, "cvxpy_warm": 2.0}
"""Least ratios of the medians."""

REPEATS = 5

OTHERS = ("rockit", "cvxpy", "cvxpy_warm", "cvxpy_found")


@dataclass(frozen=True, eq=False)
class Convex:
    """The problem on a grid as cvxpy states it, its limits as parameters."""

    problem: cp.Problem
    limits: dict[str, cp.Parameter]

    def solve(self, job: ScaledProblem) -> float:
        """Objective for the limits of a job."""
        self.limits["high"].value = job.greatest_ratio
        self.limits["low"].value = job.least_ratio
        self.limits["slope"].value = job.greatest_slope
        self.limits["jerk"].value = job.greatest_jerk
        try:
            self.problem.solve(solver=cp.CLARABEL)
        except cp.error.SolverError:
            return math.inf
        return float(self.problem.value) if self.problem.status == cp.OPTIMAL else math.inf


def convex(objective: str, count: int) -> Convex:
    """State the problem: accelerations, ratios and positions at the nodes; the objective is a peak or a mean square."""
    h = 1.0 / count
    a, v, q, bound = cp.Variable(count + 1), cp.Variable(count + 1), cp.Variable(count + 1), cp.Variable()
    limits = {name: cp.Parameter() for name in ("high", "low", "slope", "jerk")}
    steps = cp.diff(a)
    rules = [
        a[0] == 0,
        a[-1] == 0,
        v[0] == 0,
        v[-1] == 0,
        q[0] == 0,
        q[-1] == 1,
        cp.diff(v) == h / 2 * (a[:-1] + a[1:]),
        cp.diff(q) == h * v[:-1] + h**2 / 6 * (2 * a[:-1] + a[1:]),
        v <= limits["high"],
        v >= limits["low"],
        cp.abs(a) <= (bound if objective == "peak_acceleration" else limits["slope"]),
        cp.abs(steps) <= h * (bound if objective == "peak_jerk" else limits["jerk"]),
    ]
    if objective.startswith("peak"):
        rules.append(bound <= (limits["slope"] if objective == "peak_acceleration" else limits["jerk"]))
        return Convex(cp.Problem(cp.Minimize(bound), rules), limits)
    if objective == "rms_acceleration":  # Simpson's rule, exact for the square of straight lines
        cost = h / 6 * (cp.sum_squares(a[:-1]) + cp.sum_squares(a[:-1] + a[1:]) + cp.sum_squares(a[1:]))
    else:
        cost = cp.sum_squares(steps) / h
    return Convex(cp.Problem(cp.Minimize(cost), rules), limits)


def by_rockit(objective: str, job: ScaledProblem, count: int) -> float:
    """State, transcribe and solve the problem by rockit and IPOPT."""
    ocp = rockit.Ocp(T=1.0)
    q, v, a = ocp.state(), ocp.state(), ocp.state()
    j, bound = ocp.control(), ocp.variable()
    ocp.set_der(q, v)
    ocp.set_der(v, a)
    ocp.set_der(a, j)
    for state in (q, v, a):
        ocp.subject_to(ocp.at_t0(state) == 0)
    ocp.subject_to(ocp.at_tf(q) == 1)
    ocp.subject_to(ocp.at_tf(v) == 0)
    ocp.subject_to(ocp.at_tf(a) == 0)
    ocp.subject_to(job.least_ratio <= (v <= job.greatest_ratio))
    slope = bound if objective == "peak_acceleration" else job.greatest_slope
    jerk = bound if objective == "peak_jerk" else job.greatest_jerk
    ocp.subject_to(-slope <= (a <= slope))
    ocp.subject_to(-jerk <= (j <= jerk), include_last=False)
    if objective.startswith("peak"):
        ocp.subject_to(bound <= (job.greatest_slope if objective == "peak_acceleration" else job.greatest_jerk))
        ocp.add_objective(bound)
    else:
        ocp.subject_to(bound == 0)
        square = ocp.integral((a if objective == "rms_acceleration" else j) ** 2)
        ocp.add_objective(square)
    ocp.solver("ipopt", {"ipopt.print_level": 0, "print_time": False, "ipopt.sb": "yes", "expand": True})
    ocp.method(rockit.MultipleShooting(N=count, M=1, intg="rk"))
    ocp.set_initial(bound, {"peak_acceleration": 8.0, "peak_jerk": 60.0}.get(objective, 0.0))
    with contextlib.redirect_stdout(io.StringIO()):
        try:
            solution = ocp.solve()
        except RuntimeError:  # what CasADi raises where IPOPT does not succeed
            return math.inf
    return float(solution.value(bound if objective.startswith("peak") else square))


def timed(work: Callable[[], object], repeats: int) -> float:
    """Median processor time of a piece of work (s): other programs on the machine do not count."""
    times = []
    for _ in range(repeats):
        start = process_time()
        work()
        times.append(process_time() - start)
    return statistics.median(times)


def drawn(rng: np.random.Generator, wanted: MotionObjective) -> tuple[Job, ScaledProblem, float]:
    """Draw a feasible job, its normalised return and the least objective of that (of a mean square the square)."""
    while True:
        machine, cut, limits, _ = random_job(rng)
        task = Task(machine, cut, limits)
        job = machine, cut, limits, wanted
        if not is_feasible(task):
            continue
        problem = return_problem(task, wanted)
        scale = motion_scale(problem)
        scaled = scale_problem(problem, scale)
        known = known_start(scaled)
        if known is not None:
            return job, scaled, known[0].objective
        own = solve(task, wanted)
        bound = lower_bound(own.profile, Task(machine, cut, limits), wanted)
        if bound.method != QUINTIC and bound.value > own.minimised * (1 - CONFIRMED):
            return job, scaled, normalised(own.minimised, job, scale) ** 2


def normalised(value: float, job: Job, scale: float) -> float:
    """Objective over time of a job, as that of its normalised return."""
    _, cut, _, objective = job
    order = 2 if objective.endswith("acceleration") else 3
    return value / (abs(scale) / cut.return_zone**order * cut.line_speed**order)


def measure(job: Job, scaled: ScaledProblem, exact: float) -> dict[str, object] | None:
    """Check and time the roads on one job; None if no grid of `COUNTS` is accurate enough."""
    machine, cut, limits, objective = job
    task = Task(machine, cut, limits)
    own = normalised(solve(task, objective).minimised, job, motion_scale(return_problem(task, objective)))
    own_error = (own if objective.startswith("peak") else own**2) / exact - 1
    if abs(own_error) > OWN_ACCURACY:
        raise AssertionError(f"camwright is {own_error:.1e} off the exact optimum: {job}")
    for count in COUNTS:
        programme = convex(objective, count)
        error = accuracy(programme.solve(scaled), objective, exact)
        if abs(error) <= ACCURACY:
            break
    else:
        return None
    few = min(count, MOST_ROCKIT)
    start = process_time()  # once only: it takes seconds
    rockit_error = accuracy(by_rockit(objective, scaled, few), objective, exact)
    rockit_time = process_time() - start
    times = {
        "camwright": timed(lambda: solve(task, objective), REPEATS),
        "rockit": rockit_time,
        "cvxpy": timed(lambda: convex(objective, count).solve(scaled), 3),
        "cvxpy_warm": timed(lambda: programme.solve(scaled), 3),
    }
    times["cvxpy_found"] = times["cvxpy"] + timed(lambda: convex(objective, 2 * count).solve(scaled), 3)
    return {
        "objective": objective,
        "speed": scaled.greatest_ratio,
        "acceleration": scaled.greatest_slope,
        "jerk": scaled.greatest_jerk,
        "intervals": count,
        "rockit_intervals": few,
        "camwright_error": own_error,
        "rockit_error": rockit_error,
        "cvxpy_error": error,
        **{f"{name}_ms": 1e3 * value for name, value in times.items()},
        **{f"{name}_ratio": times[name] / times["camwright"] for name in OTHERS},
    }


def accuracy(value: float, objective: str, exact: float) -> float:
    """Share by which an objective is off; mean squares count as roots."""
    return value / exact - 1 if objective.startswith("peak") else math.sqrt(max(0.0, value) / exact) - 1


def main() -> int:
    """Check, measure, write, print; the exit code tells whether the promises are kept."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--jobs", type=int, default=20)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    rng = np.random.default_rng(options.seed)
    rows: list[dict[str, object]] = []
    beyond = 0
    for objective in OBJECTIVES:
        wanted = len(rows) + (options.jobs if objective == "peak_acceleration" else max(1, options.jobs // 2))
        while len(rows) < wanted:
            row = measure(*drawn(rng, objective))
            if row is None:
                beyond += 1
            else:
                rows.append(row)
    RESULTS.mkdir(exist_ok=True)
    with (RESULTS / "design_speed.csv").open("w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
        table.writeheader()
        table.writerows(rows)

    print("measure,value")
    print(f"jobs_beyond_{COUNTS[-1]}_intervals,{beyond}")
    kept = True
    for objective in OBJECTIVES:
        own = [row for row in rows if row["objective"] == objective]
        middle = {name: statistics.median(float(row[name]) for row in own) for name in own[0] if name != "objective"}  # type: ignore[arg-type]
        print(f"{objective}_jobs,{len(own)}")
        for name in ("intervals", "rockit_intervals"):
            print(f"{objective}_{name},{middle[name]:g}")
        for name in ("camwright", "rockit", "cvxpy"):
            worst = max(abs(float(row[f"{name}_error"])) for row in own)  # type: ignore[arg-type]
            print(f"{objective}_{name}_error,median {middle[f'{name}_error']:.1e} worst {worst:.1e}")
        for name in ("camwright", *OTHERS):
            print(f"{objective}_{name}_ms,{middle[f'{name}_ms']:.1f}")
        for name in OTHERS:
            print(f"{objective}_{name}_ratio,{middle[f'{name}_ratio']:.1f}")
        kept &= all(middle[f"{name}_ratio"] >= least for name, least in PROMISED.items())
    return 0 if kept else 1


if __name__ == "__main__":
    sys.exit(main())
