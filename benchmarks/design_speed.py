"""How long a warm design takes, beside the same problem in rockit with IPOPT and in cvxpy with Clarabel.

Random rotary-knife jobs with the objectives that have a closed form. All roads solve the same normalised return (unit length, unit
height), and before anything is timed each must come within its stated error of the closed form:

- camwright: `design.optimise.solve`, from the job to the polished profile, every programme it needs built before;
- rockit: the problem stated, transcribed by multiple shooting and solved by IPOPT;
- cvxpy: the problem stated, compiled and solved by Clarabel, and, as `cvxpy_warm`, solved again by the compiled one with its
  numbers as parameters.

The last three hold the jerk constant on N equal intervals, which they integrate exactly, so that they have the same optimum. N is the
smallest of `COUNTS` whose objective is within `ACCURACY`; rockit, which would take tens of seconds there, gets no more than `MOST_ROCKIT`
intervals and its error is stated. The promises hold for the default objective ``peak_acceleration``. With ``peak_jerk`` and no other
limit active all switching points lie on the nodes of a coarse grid: there a convex solver needs no more than 20 intervals.

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

from design.optimise import solve
from design.problem import return_problem
from design.scaling import ScaledProblem, motion_scale, scale_problem
from profiles.reach import least_acceleration, least_jerk

RESULTS = Path(__file__).parent / "results"

ACCURACY = 1e-4
"""Share by which the objective of a road may be off."""

COUNTS = (20, 30, 40, 60, 80, 120, 160, 240, 320, 480, 640)

MOST_ROCKIT = 160
"""Most intervals for rockit."""

OWN_ACCURACY = 1e-6
"""Share by which a design may be off; the contract."""

PROMISED = {"rockit": 10.0, "cvxpy": 1.0}
"""Least ratios of the medians."""

REPEATS = 5


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
    """State the problem: accelerations, ratios and positions at the nodes."""
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
        bound <= (limits["slope"] if objective == "peak_acceleration" else limits["jerk"]),
    ]
    return Convex(cp.Problem(cp.Minimize(bound), rules), limits)


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
    ocp.subject_to(bound <= (job.greatest_slope if objective == "peak_acceleration" else job.greatest_jerk))
    ocp.add_objective(bound)
    ocp.solver("ipopt", {"ipopt.print_level": 0, "print_time": False, "ipopt.sb": "yes", "expand": True})
    ocp.method(rockit.MultipleShooting(N=count, M=1, intg="rk"))
    ocp.set_initial(bound, 8.0 if objective == "peak_acceleration" else 60.0)
    with contextlib.redirect_stdout(io.StringIO()):
        try:
            solution = ocp.solve()
        except RuntimeError:  # what CasADi raises where IPOPT does not succeed
            return math.inf
    return float(solution.value(bound))


def timed(work: Callable[[], object], repeats: int) -> float:
    """Median processor time of a piece of work (s): other programs on the machine do not count."""
    times = []
    for _ in range(repeats):
        start = process_time()
        work()
        times.append(process_time() - start)
    return statistics.median(times)


def drawn(rng: np.random.Generator, wanted: str) -> tuple[Job, ScaledProblem, float]:
    """Draw a feasible job with a closed form, its normalised return and the least objective of that."""
    while True:
        machine, cut, limits, objective = random_job(rng)
        if objective != wanted:
            continue
        job = machine, cut, limits, objective
        problem = return_problem(*job)
        scaled = scale_problem(problem, motion_scale(problem))
        if objective == "peak_acceleration":
            exact = least_acceleration(1.0, 1.0, scaled.greatest_ratio, scaled.greatest_jerk)
            room = scaled.greatest_slope
        else:
            exact = least_jerk(1.0, 1.0, scaled.greatest_ratio, scaled.greatest_slope)
            room = scaled.greatest_jerk
        if exact < room:
            return job, scaled, exact


def measure(job: Job, scaled: ScaledProblem, exact: float) -> dict[str, object] | None:
    """Check and time the roads on one job; None if no grid of `COUNTS` is accurate enough."""
    machine, cut, limits, objective = job
    own = solve(machine, cut, limits, objective)
    order = 2 if objective == "peak_acceleration" else 3
    problem = return_problem(*job)
    unit = abs(motion_scale(problem)) / cut.return_zone**order * cut.line_speed**order
    own_error = own.objective / unit / exact - 1
    if abs(own_error) > OWN_ACCURACY:
        raise AssertionError(f"camwright is {own_error:.1e} off the closed form: {job}")
    for count in COUNTS:
        programme = convex(objective, count)
        error = programme.solve(scaled) / exact - 1
        if abs(error) <= ACCURACY:
            break
    else:
        return None
    few = min(count, MOST_ROCKIT)
    start = process_time()  # once only: it takes seconds
    rockit_error = by_rockit(objective, scaled, few) / exact - 1
    rockit_time = process_time() - start
    times = {
        "camwright": timed(lambda: solve(machine, cut, limits, objective), REPEATS),
        "rockit": rockit_time,
        "cvxpy": timed(lambda: convex(objective, count).solve(scaled), 3),
        "cvxpy_warm": timed(lambda: programme.solve(scaled), 3),
    }
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
        **{f"{name}_ratio": times[name] / times["camwright"] for name in ("rockit", "cvxpy", "cvxpy_warm")},
    }


def main() -> int:
    """Check, measure, write, print; the exit code tells whether the promises are kept."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--jobs", type=int, default=20)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    rng = np.random.default_rng(options.seed)
    rows: list[dict[str, object]] = []
    beyond = 0
    for objective, count in (("peak_acceleration", options.jobs), ("peak_jerk", max(1, options.jobs // 4))):
        wanted = len(rows) + count
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
    for objective in ("peak_acceleration", "peak_jerk"):
        own = [row for row in rows if row["objective"] == objective]
        middle = {name: statistics.median(float(row[name]) for row in own) for name in own[0] if name != "objective"}  # type: ignore[arg-type]
        print(f"{objective}_jobs,{len(own)}")
        for name in ("intervals", "rockit_intervals"):
            print(f"{objective}_{name},{middle[name]:g}")
        for name in ("camwright", "rockit", "cvxpy"):
            worst = max(abs(float(row[f"{name}_error"])) for row in own)  # type: ignore[arg-type]
            print(f"{objective}_{name}_error,median {middle[f'{name}_error']:.1e} worst {worst:.1e}")
        for name in ("camwright", "rockit", "cvxpy", "cvxpy_warm"):
            print(f"{objective}_{name}_ms,{middle[f'{name}_ms']:.1f}")
        for name in ("rockit", "cvxpy", "cvxpy_warm"):
            print(f"{objective}_{name}_ratio,{middle[f'{name}_ratio']:.1f}")
        if objective == "peak_acceleration":
            kept = all(middle[f"{name}_ratio"] >= least for name, least in PROMISED.items())
    return 0 if kept else 1


if __name__ == "__main__":
    sys.exit(main())
