"""What becomes of many random jobs: how they end, how well the limits are kept, and which roads the design had to take.

A job is drawn in terms of what its motion needs: limits from a little below what is possible to far above, cut lengths from a
third to three times the circumference, all objectives, with and without reversal. Writes one CSV row for each job and prints
the summary:

    python benchmarks/random_jobs.py [--jobs 500] [--seed 1]
"""

from __future__ import annotations

import argparse
import csv
import math
import statistics
import sys
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from time import process_time
from typing import get_args

import numpy as np

from camwright.design.optimise import Solution, solve
from camwright.design.returns import grids, polish, solver
from camwright.design.returns.problem import return_problem
from camwright.design.returns.scaling import motion_scale, scale_problem
from camwright.design.returns.structure import extreme_motion, from_extreme, tidy
from camwright.profiles.cut import Cut
from camwright.profiles.errors import InfeasibleError, SolverError
from camwright.profiles.limits import Limits
from camwright.profiles.machines import RotaryKnife
from camwright.profiles.objective import MotionObjective
from camwright.profiles.task import Task
from camwright.validation.bounds.optimality import lower_bound

RESULTS = Path(__file__).parent / "results"

ALLOWED_EXCESS = 1e-9
"""Share by which a design may exceed a limit."""

OBJECTIVES: tuple[MotionObjective, ...] = get_args(MotionObjective)
Job = tuple[RotaryKnife, Cut, Limits, MotionObjective]


def random_job(rng: np.random.Generator) -> Job:
    """Draw a job; about one in ten is infeasible."""
    circumference = float(np.exp(rng.uniform(np.log(0.1), np.log(2.0))))
    length = circumference * float(np.exp(rng.uniform(-np.log(3), np.log(3))))
    sync = min(length, circumference) * float(rng.uniform(0.02, 0.9))
    speed = float(np.exp(rng.uniform(np.log(0.05), np.log(5.0))))
    cut = Cut(length, speed, sync, 0.0, 0.0, 1e-4)
    time, distance = cut.return_zone / speed, abs(circumference - length)
    least = 2 * distance / time if length < circumference else 0.0
    limits = Limits(
        speed=speed + least * float(rng.uniform(0.5, 1.5)) + speed * float(rng.uniform(0.0, 0.5)),
        acceleration=4 * distance / time**2 * float(np.exp(rng.uniform(-0.3, np.log(100.0)))),
        jerk=32 * distance / time**3 * float(np.exp(rng.uniform(-0.6, np.log(1e4)))),
        reversal=bool(rng.integers(2)),
    )
    return RotaryKnife(circumference), cut, limits, OBJECTIVES[int(rng.integers(len(OBJECTIVES)))]


def worst_excess(result: Solution, job: Job) -> float:
    """Largest share by which the whole cycle exceeds a limit, over time, exactly."""
    machine, cut, limits, _ = job
    v = cut.line_speed
    (low, high), slope, jerk = (result.profile.extrema(1), result.profile.extrema(2), result.profile.extrema(3))
    return max(
        v * high.value / limits.speed - 1,
        (Task(machine, cut, limits).least_velocity - v * low.value) / limits.speed,
        v**2 * max(-slope[0].value, slope[1].value) / limits.acceleration - 1,
        v**3 * max(-jerk[0].value, jerk[1].value) / limits.jerk - 1,
    )


def is_extreme(result: Solution, job: Job) -> bool:
    """Whether the answer is the closed-form extreme motion and not a solver's."""
    machine, cut, limits, objective = job
    problem = return_problem(Task(machine, cut, limits), objective)
    scaled = scale_problem(problem, motion_scale(problem))
    extreme = extreme_motion(scaled)
    if extreme is None:
        return False
    breaks = tidy(from_extreme(extreme), scaled).profile().breaks * problem.length
    return len(breaks) == result.back.pieces + 1 and bool((np.abs(breaks - result.back.breaks) <= 1e-15).all())


@contextmanager
def recorded_grids() -> Iterator[list[str]]:
    """Note which grids a design looks at: uniform, widened, fine, or shared with other arcs."""
    seen: list[str] = []
    original = grids.on_grid

    def noting(problem, lengths, relax):  # type: ignore[no-untyped-def]
        uniform = bool(np.ptp(lengths) < 1e-12)
        fine = len(lengths) in grids.FINE.values() and grids.FINE[grids.degree_of(problem)] == len(lengths)
        seen.append("widened" if relax else "fine" if uniform and fine else "uniform" if uniform else "arcs")
        return original(problem, lengths, relax)

    polish.on_grid = solver.on_grid = noting
    try:
        yield seen
    finally:
        polish.on_grid = solver.on_grid = original


def measure(number: int, job: Job) -> dict[str, object]:
    """Design one job and judge it."""
    machine, cut, limits, objective = job
    row: dict[str, object] = {
        "job": number,
        "objective": objective,
        "circumference_m": machine.circumference,
        "length_m": cut.length,
        "line_speed_m_per_s": cut.line_speed,
        "sync_zone_m": cut.sync_zone,
        "speed_m_per_s": limits.speed,
        "acceleration_m_per_s2": limits.acceleration,
        "jerk_m_per_s3": limits.jerk,
        "reversal": limits.reversal,
    }
    start = process_time()
    with recorded_grids() as grids:
        try:
            result = solve(Task(machine, cut, limits), objective)
        except (InfeasibleError, SolverError) as error:
            row["status"] = type(error).__name__
            return row
    elapsed = process_time() - start
    bound = lower_bound(result.profile, Task(machine, cut, limits), objective)
    line = all(abs(e.value - 1) <= 1e-12 for e in result.profile.extrema(1))
    return row | {
        "status": result.status.value,
        "value": result.minimised,
        "gap": 0.0 if line else result.minimised / bound.value - 1 if bound.value > 0 else math.inf,
        "worst_excess": worst_excess(result, job),
        "pieces": result.profile.pieces,
        "iterations": result.iterations,
        "grids": "+".join(grids),
        "extreme": is_extreme(result, job),
        "ms": 1e3 * elapsed,
    }


def main() -> int:
    """Run the jobs, write the rows, print the summary; the exit code tells whether every job ended well."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--jobs", type=int, default=500)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    rng = np.random.default_rng(options.seed)
    rows = [measure(number, random_job(rng)) for number in range(options.jobs)]

    names = list(dict.fromkeys(name for row in rows for name in row))
    RESULTS.mkdir(exist_ok=True)
    with (RESULTS / "random_jobs.csv").open("w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, names, lineterminator="\n")
        table.writeheader()
        table.writerows(rows)

    solved = [row for row in rows if "value" in row]
    ends = Counter(str(row["status"]) for row in rows)
    excess = max(float(row["worst_excess"]) for row in solved)  # type: ignore[arg-type]
    figures: dict[str, float | str] = {
        **{f"jobs_{name}": f"{count}" for name, count in sorted(ends.items())},
        "worst_excess": f"{excess:.1e}",
        "iterations_median": f"{statistics.median(float(row['iterations']) for row in solved):g}",  # type: ignore[arg-type]
        "iterations_most": f"{max(int(row['iterations']) for row in solved)}",  # type: ignore[call-overload]
        "median_ms": f"{statistics.median(float(row['ms']) for row in solved):.1f}",  # type: ignore[arg-type]
        "answers_by_the_extreme_motion": f"{sum(bool(row['extreme']) for row in solved)}",
        "jobs_that_needed_a_second_grid": f"{sum(str(row['grids']).replace('uniform', '', 1) not in ('', '+arcs') for row in solved)}",
        "jobs_that_needed_the_fine_grid": f"{sum('fine' in str(row['grids']) for row in solved)}",
    }
    for objective in OBJECTIVES:
        gaps = [float(row["gap"]) for row in solved if row["objective"] == objective]  # type: ignore[arg-type]
        figures[f"gap_{objective}"] = f"median {statistics.median(gaps):.1e} worst {max(gaps):.1e}"
    print("measure,value")
    for name, value in figures.items():
        print(f"{name},{value}")
    return 0 if excess <= ALLOWED_EXCESS and not ends["SolverError"] and not ends["best_found"] else 1


if __name__ == "__main__":
    sys.exit(main())
