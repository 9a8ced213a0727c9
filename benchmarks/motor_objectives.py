"""Least torque and energy beside a reference of this benchmark's own, on random jobs of every machine; and their lower bounds.

The reference is `motor_reference`: a plain nonlinear programme from many starts, from few where the bound already proves that none is
0.5 % better. It is kept in ``results/motor_references.csv``, so that a later run costs the designs and the bounds alone; delete that file
after a change of ``motor_reference``. Writes a row a job to ``results/motor_objectives.csv``, each as soon as it is known. Jobs go round
the machines and objectives, so that a run of a given time has about as many of each. A job that takes longer than its limit of processor
time is ended. The exit code is 0 if no job is more than 0.5 % above the reference, no bound above any motion, and none ended in an error:

    python benchmarks/motor_objectives.py [--jobs 100] [--starts 40] [--seed 1] [--machine crank_slider]
"""

from __future__ import annotations

import argparse
import csv
import hashlib
import json
import math
import resource
import sys
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import BrokenExecutor, ProcessPoolExecutor
from dataclasses import asdict, replace
from multiprocessing import get_context
from pathlib import Path
from time import monotonic, process_time
from typing import TypeVar, get_args

import numpy as np
from motor_reference import WITHIN, reference, value
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
KEY = ("seed", "machine", "objective", "number")
KEPT = (*KEY, "job", "starts", "reference", "seconds")
Key = tuple[int, str, str, int]
Kept = tuple[float, int, float]
Answer = TypeVar("Answer")


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


def designed(job: RandomJob, limit: int) -> dict[str, object]:
    """Design a job and bound it; its row as far as it goes. The process ends after so many seconds (s) of processor time."""
    limited(limit)
    begun = process_time()
    row: dict[str, object] = {}
    try:
        solution = solve(job.task, job.objective)
        there = job.task.with_machine(solution.machine)
        row |= {"value": value(solution.profile, there, job.objective), "seconds": round(process_time() - begun, 2)}
        begun = process_time()
        bound = lower_bound(solution.profile, there, job.objective)
        row |= {"bound": bound.value, "method": bound.method, "bound_seconds": round(process_time() - begun, 2)}
    except InfeasibleError as error:
        return row | {"end": "infeasible", "note": str(error)}
    except CamwrightError as error:
        return row | {"end": "error", "note": str(error)}
    except Exception as error:  # noqa: BLE001 - what nobody foresaw is looked for
        return row | {"end": "crash", "note": repr(error)}
    return row


def sought(job: RandomJob, seeds: Sequence[int], starts: int, limit: int) -> tuple[float, float]:
    """Value of the reference's motion, infinite if none was found, and the processor time that it took (s)."""
    limited(limit)
    begun = process_time()
    found = reference(job.task, job.objective, np.random.default_rng(seeds), starts)
    return math.inf if found is None else found.value, round(process_time() - begun, 2)


def limited(seconds: int) -> None:
    """End this process after so many seconds of processor time from now: a solver that hangs does not come back to Python."""
    resource.setrlimit(resource.RLIMIT_CPU, (math.ceil(process_time()) + seconds, resource.RLIM_INFINITY))


class Worker:
    """Process that jobs run in, another after each that was ended."""

    def __init__(self) -> None:
        self._pool: ProcessPoolExecutor | None = None

    def __call__(self, work: Callable[..., Answer], *given: object) -> Answer | None:
        """Answer of the work; none if it was ended, or fell over."""
        pool = self._pool = self._pool or ProcessPoolExecutor(1, get_context("spawn"))
        try:
            return pool.submit(work, *given).result()
        except BrokenExecutor:
            pool.shutdown()
            self._pool = None
            return None
        except RuntimeError as error:  # of the reference's solver: what a job throws is its row
            print(error, flush=True)
            return None


class References:
    """References that are kept, for they depend on the job, the seed and the number of starts alone."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._kept: dict[tuple[str, ...], dict[str, str]] = {}
        if path.exists():
            with path.open(newline="", encoding="utf-8") as file:
                self._kept = {tuple(row[name] for name in KEY): row for row in csv.DictReader(file)}

    def of(
        self, key: Key, job: RandomJob, starts: int, search: Callable[[], tuple[float, float] | None]
    ) -> Kept | None:
        """Value, starts and seconds (s) of a job's reference, sought where none of as many starts is kept; none if it was ended.

        Raises ``SystemExit`` if another job is kept under its name.
        """
        name, mark = tuple(map(str, key)), marked(job)
        row = self._kept.get(name)
        if row is not None and row["job"] != mark:
            raise SystemExit(f"{self._path}: {' '.join(name)} is the reference of another job; take its row out")
        if row is None or int(row["starts"]) < starts:
            answer = search()
            if answer is None:
                return None
            values = *name, mark, str(starts), *map(repr, answer)
            row = self._kept[name] = dict(zip(KEPT, values, strict=True))
            with self._path.open("w", newline="", encoding="utf-8") as file:
                writer = csv.DictWriter(file, KEPT, lineterminator="\n")
                writer.writeheader()
                writer.writerows(
                    self._kept[each] for each in sorted(self._kept, key=lambda each: (*each[:3], int(each[3])))
                )
        return float(row["reference"]), int(row["starts"]), float(row["seconds"])


def marked(job: RandomJob) -> str:
    """Hash of a job's fields, to the digits that every machine draws alike."""

    def plain(given: object) -> object:
        if isinstance(given, dict):
            return {name: plain(each) for name, each in given.items()}
        if isinstance(given, list | tuple):
            return [plain(each) for each in given]
        return f"{given:.10g}" if isinstance(given, float) else str(given)

    return hashlib.sha256(json.dumps([type(job.machine).__name__, plain(asdict(job))]).encode()).hexdigest()[:12]


def judged(
    job: RandomJob, key: Key, worker: Worker, kept: References, options: argparse.Namespace
) -> dict[str, object]:
    """Row of a job: designed, bounded, and held beside the reference."""
    row = worker(designed, job, options.limit)
    if row is None:
        return {"end": "hang", "note": f"no answer in {options.limit} s of processor time"}
    if "end" in row:
        return row
    reached, bound = float(row["value"]), float(row["bound"])  # type: ignore[arg-type]
    tried = FEW if bound >= reached * (1 - ALLOWED) else options.starts
    seeds = options.seed, key[-1]
    found = kept.of(key, job, tried, lambda: worker(sought, job, seeds, tried, 10 * options.limit))
    if found is None:
        return row | {"end": "no reference", "note": f"the reference gave none in {10 * options.limit} s"}
    other, tried, seconds = found
    row |= {"reference": other, "above": reached / other - 1.0 if other > 0 else 0.0}
    row |= {"starts": tried, "reference_seconds": seconds}
    lowest = reached if not job.machine.placed else min(reached, other)  # a bound is that of the place chosen
    wrong = bound > lowest * (1 + WITHIN)
    end = "bound above a motion" if wrong else "above the reference" if reached > other * (1 + ALLOWED) else "good"
    return row | {"end": end}


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
    parser.add_argument("--limit", type=int, default=60, help="end a job after so many seconds of processor time")
    parser.add_argument("--out", type=Path, default=RESULTS / "motor_objectives.csv")
    parser.add_argument("--references", type=Path, default=RESULTS / "motor_references.csv")
    options = parser.parse_args()
    kinds = [options.machine] if options.machine else list(MACHINES)
    objectives = [options.objective] if options.objective else get_args(MotorObjective)
    draws = {
        (kind, objective): jobs(np.random.default_rng(options.seed), kind, objective, options.jobs)
        for kind in kinds
        for objective in objectives
    }
    rows: list[dict[str, object]] = []
    worker, kept = Worker(), References(options.references)
    until = monotonic() + 60 * options.minutes
    with options.out.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        for number in range(options.jobs):
            for (kind, objective), drawn in draws.items():
                job = next(drawn)
                if options.only not in (None, number) or monotonic() > until:
                    continue
                key = options.seed, kind, objective, number
                row = judged(job, key, worker, kept, options)
                rows.append({"machine": kind, "objective": objective, "number": number} | row)
                writer.writerow(rows[-1])
                file.flush()
                if row["end"] not in ("good", "infeasible"):
                    print(rows[-1], job, flush=True)
    summary(rows)
    return 1 if any(row["end"] not in ("good", "infeasible") for row in rows) else 0


if __name__ == "__main__":
    sys.exit(main())
