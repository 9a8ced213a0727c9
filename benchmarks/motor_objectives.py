"""Least torque and energy beside a reference of this benchmark's own, on random jobs of every machine; and their lower bounds.

The reference is `motor_reference`: a plain nonlinear programme from many starts, from few where the bound already proves that none is
0.5 % better. Writes a row a job to ``results/motor_objectives.csv``, each as soon as it is known. Jobs go round the machines and
objectives, so that a run of a given time has about as many of each. The exit code is 0 if no job is more than 0.5 % above the
reference, no bound above any motion, and none ended in an error:

    python benchmarks/motor_objectives.py [--jobs 100] [--starts 40] [--seed 1] [--machine crank_slider]
"""

from __future__ import annotations

import argparse
import csv
import math
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from time import monotonic, process_time
from typing import get_args

import numpy as np
from motor_reference import WITHIN, Found, reference, value
from random_machines import MACHINES, RandomJob, placed, random_job, spread

from camwright.design.feasible.feasibility import is_feasible
from camwright.design.optimise import solve
from camwright.profiles.errors import CamwrightError, InfeasibleError
from camwright.profiles.objective import MotorObjective
from camwright.validation.bounds.optimality import lower_bound

RESULTS = Path(__file__).parent / "results"
ALLOWED = 5e-3
"""Share by which a job may be above the reference."""
FEW = 4
"""Starts of the reference where the bound proves that no motion is as much better."""
COLUMNS = (
    "machine",
    "objective",
    "number",
    "end",
    "value",
    "reference",
    "above",
    "bound",
    "method",
    "starts",
    "seconds",
    "bound_seconds",
    "reference_seconds",
    "note",
)


def jobs(rng: np.random.Generator, kind: str, objective: MotorObjective, count: int) -> Iterator[RandomJob]:
    """Draw jobs whose machine moves something, and which some motion can do; cuts of half a pitch to twenty."""
    while count:
        job = random_job(rng, kind)
        if not job.machine.moves_something:
            continue
        travel = job.machine.pitch or 2 * job.cut.sync_zone
        length = max(1.2 * job.cut.sync_zone, abs(travel) * spread(rng, 0.5, 20.0))
        if job.machine.slave_unit == "rad":
            length = max(1.2 * job.cut.sync_zone, job.cut.length * spread(rng, 0.5, 10.0))
        job = replace(job, objective=objective, cut=replace(job.cut, length=length))
        if is_feasible(job.task.with_machine(placed(job.machine, job.cut))):
            yield job
            count -= 1


def judged(job: RandomJob, rng: np.random.Generator, starts: int) -> tuple[dict[str, object], Found | None]:
    """Design a job, bound it, and hold it beside the reference; its row, and the reference's motion."""
    begun = process_time()
    row: dict[str, object] = {}
    try:
        solution = solve(job.task, job.objective)
        there = job.task.with_machine(solution.machine)
        reached = value(solution.profile, there, job.objective)
        row |= {"value": reached, "seconds": round(process_time() - begun, 2)}
        begun = process_time()
        bound = lower_bound(solution.profile, there, job.objective)
        row |= {"bound": bound.value, "method": bound.method, "bound_seconds": round(process_time() - begun, 2)}
    except InfeasibleError as error:
        return row | {"end": "infeasible", "note": str(error)}, None
    except CamwrightError as error:
        return row | {"end": "error", "note": str(error)}, None
    except Exception as error:  # noqa: BLE001 - what nobody foresaw is looked for
        return row | {"end": "crash", "note": repr(error)}, None
    begun = process_time()
    tried = FEW if bound.value >= reached * (1 - ALLOWED) else starts
    found = reference(job.task, job.objective, rng, tried)
    other = found.value if found is not None else math.inf
    row |= {"reference": other, "above": reached / other - 1.0 if other > 0 else 0.0}
    row["starts"] = tried
    row["reference_seconds"] = round(process_time() - begun, 2)
    lowest = reached if not job.machine.placed else min(reached, other)  # a bound is that of the place chosen
    wrong = bound.value > lowest * (1 + WITHIN)
    end = "bound above a motion" if wrong else "above the reference" if reached > other * (1 + ALLOWED) else "good"
    return row | {"end": end}, found


def summary(rows: list[dict[str, object]]) -> None:
    """Print what the rows say."""
    done = [row for row in rows if "reference" in row]
    beside = [row for row in done if row["reference"] != math.inf]
    gaps = [1 - row["bound"] / row["value"] for row in done if row["bound"] == row["bound"] and row["value"]]  # type: ignore[operator]
    bad = [row for row in rows if row["end"] not in ("good", "infeasible")]
    print(f"{len(rows)} jobs, {len(done)} designed, {len(beside)} beside a reference, {len(bad)} not as they should be")
    if beside:
        print(
            f"above the reference: at most {max(row['above'] for row in beside):.2%}, at least {min(row['above'] for row in beside):.2%}"
        )  # type: ignore[type-var]
    if gaps:
        print(
            f"gaps: median {np.median(gaps):.2%}, nine in ten below {np.quantile(gaps, 0.9):.2%}, greatest {max(gaps):.2%}, "
            f"{len(done) - len(gaps)} without a bound"
        )


def main() -> int:
    """Run the jobs."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--jobs", type=int, default=100)
    parser.add_argument("--starts", type=int, default=40)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--machine", choices=list(MACHINES))
    parser.add_argument("--objective", choices=get_args(MotorObjective))
    parser.add_argument("--minutes", type=float, default=math.inf, help="begin no job after so many")
    parser.add_argument("--only", type=int, help="number of the one job to run")
    parser.add_argument("--out", type=Path, default=RESULTS / "motor_objectives.csv")
    options = parser.parse_args()
    kinds = [options.machine] if options.machine else list(MACHINES)
    objectives = [options.objective] if options.objective else get_args(MotorObjective)
    draws = {
        (kind, objective): jobs(np.random.default_rng(options.seed), kind, objective, options.jobs)
        for kind in kinds
        for objective in objectives
    }
    rows: list[dict[str, object]] = []
    until = monotonic() + 60 * options.minutes
    with options.out.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        for number in range(options.jobs):
            for (kind, objective), drawn in draws.items():
                job = next(drawn)
                if options.only not in (None, number) or monotonic() > until:
                    continue
                row, found = judged(job, np.random.default_rng([options.seed, number]), options.starts)
                rows.append({"machine": kind, "objective": objective, "number": number} | row)
                writer.writerow(rows[-1])
                file.flush()
                if row["end"] not in ("good", "infeasible"):
                    print(rows[-1], job, "reference at", found and found.task.machine.place, flush=True)
    summary(rows)
    return 1 if any(row["end"] not in ("good", "infeasible") for row in rows) else 0


if __name__ == "__main__":
    sys.exit(main())
