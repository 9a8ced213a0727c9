"""What becomes of many random servo-aware jobs: a design that passes every check and whose error is the simulated one, or a refusal.

Machines, cuts and limits are those of ``random_machines.py``, the servo is drawn so slow that it matters, the command and the objective
from all there are. A design counts if every check passes (those of the axis' own limits only where the design says that it keeps them)
and if the sync error that it predicts is the one that the validation's simulation finds. A refusal counts if the job is infeasible and
every way out that it is shown then passes, or if its servo is unstable or too slow; so does a least sync error above the tolerance, which
a design of that objective says. Writes the counts
of each machine to ``results/random_servo_aware.csv`` and prints every job that ended otherwise; the exit code is 0 if there is none:

    python benchmarks/random_servo_aware.py [--jobs 60] [--seed 1] [--machine crank_slider]
"""

from __future__ import annotations

import argparse
import csv
import math
import sys
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from time import monotonic, process_time

import numpy as np
from random_machines import MACHINES, TO_SI, RandomJob, apply, random_job, spread

from camwright.design.optimise_axis import solve_axis
from camwright.design.servo_aware.command_basis import Command
from camwright.profiles.errors import CamwrightError, InfeasibleError, InputError, Suggestion
from camwright.profiles.objective import OBJECTIVES, ObjectiveName
from camwright.profiles.servo import Servo
from camwright.profiles.task import Task
from camwright.validation.report import judge

RESULTS = Path(__file__).parent / "results"
AGREEMENT = 1e-8
"""Greatest difference between predicted and simulated sync error, as a share of the sync zone: at its ends the simulation interpolates."""

GOOD = ("passed", "infeasible", "least error too large", "refused")
OF_THE_AXIS = {"axis_speed", "axis_acceleration", "axis_reversal"}


def draw_servo(rng: np.random.Generator, job: RandomJob) -> Servo:
    """Draw a servo that takes a good part of the sync zone to settle."""
    time = job.cut.sync_zone / job.cut.line_speed
    return Servo(
        spread(rng, 15.0, 150.0) / time,
        float(rng.uniform(0.5, 1.0)),
        spread(rng, 4.0, 30.0) / time,
        time / spread(rng, 20.0, 200.0),
        velocity_feedforward=1.0 if rng.integers(2) else float(rng.uniform(0.8, 1.0)),
    )


def ended(job: RandomJob, servo: Servo, command: Command, objective: ObjectiveName) -> tuple[str, str]:
    """Design a job; how it ended, and what there is to say about it."""
    try:
        return designed(job, servo, command, objective, suggest=True)
    except InfeasibleError as error:
        for suggestion in error.suggestions:
            named = f"{error.binding}: {suggestion.change} {suggestion.value!r} {suggestion.unit}"
            try:
                end, note = designed(followed(job, suggestion), servo, command, objective, suggest=False)
            except CamwrightError as other:
                return f"infeasible, then {type(other).__name__}", f"{named}: {other}"
            if end != "passed":
                return f"infeasible, then {end}", f"{named}: {note}"
        return "infeasible", f"{error.binding}: {len(error.suggestions)} ways out"
    except InputError as error:
        known = ("unstable", "remembers", "needs to know what the motor moves")
        return ("refused" if any(words in str(error) for words in known) else "InputError"), str(error)
    except CamwrightError as error:
        return type(error).__name__, str(error)


def followed(job: RandomJob, suggestion: Suggestion) -> RandomJob:
    """Follow a suggestion."""
    if suggestion.change == "sync_tolerance":
        return replace(job, cut=replace(job.cut, sync_tolerance=suggestion.value * TO_SI[suggestion.unit]))
    return apply(job, suggestion)


def designed(
    job: RandomJob, servo: Servo, command: Command, objective: ObjectiveName, *, suggest: bool
) -> tuple[str, str]:
    """Design a job and validate it."""
    cut = replace(job.cut, shaped=command == "shaped")
    solution = solve_axis(job.task.with_cut(cut), objective, command, (servo,), suggest=suggest)
    axis = solution.axis
    if axis is None:
        return "no axis", ""
    report = judge(solution.profile, Task(solution.machine, cut, job.limits), servo, servo_aware=True)
    if objective == "sync_error" and axis.error > cut.sync_tolerance:
        return "least error too large", ""
    failed = {check.name for check in report.checks if not check.passed} - (set() if axis.axis_limits else OF_THE_AXIS)
    if failed:
        return "check failed", ", ".join(sorted(failed))
    simulated = next(check.value for check in report.checks if check.name == "shear_zone_error")
    difference = abs(axis.errors[0] - float(simulated or 0.0)) / cut.sync_zone
    return ("passed", "") if difference <= AGREEMENT else ("differs", f"{difference:.1e} of the sync zone")


def counted(kind: str, seed: int, ends: Sequence[str], seconds: Sequence[float]) -> dict[str, object]:
    """Row of a machine."""
    counts = Counter(ends)
    return {
        "machine": kind,
        "seed": seed,
        "jobs": len(ends),
        "passed": counts["passed"],
        "infeasible": counts["infeasible"],
        "least_error_too_large": counts["least error too large"],
        "refused": counts["refused"],
        "other": len(ends) - sum(counts[name] for name in GOOD),
        "median_s": f"{np.median(seconds):.2f}",
        "longest_s": f"{max(seconds):.2f}",
    }


def main() -> int:
    """Draw, design, count; the machines take turns and the counts are written after each, so that a run may be ended early."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--jobs", type=int, default=60)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--machine", choices=list(MACHINES))
    parser.add_argument("--minutes", type=float, default=math.inf, help="begin no round of jobs after so many")
    parser.add_argument("--out", type=Path, default=RESULTS / "random_servo_aware.csv")
    options = parser.parse_args()
    objectives: tuple[ObjectiveName, ...] = tuple(OBJECTIVES)
    kinds = [options.machine] if options.machine else list(MACHINES)
    draws = {kind: np.random.default_rng([options.seed, list(MACHINES).index(kind), 77]) for kind in kinds}
    ends: dict[str, list[str]] = {kind: [] for kind in kinds}
    seconds: dict[str, list[float]] = {kind: [] for kind in kinds}
    rows: list[dict[str, object]] = []
    until = monotonic() + 60 * options.minutes
    for number in range(options.jobs):
        if monotonic() > until:
            break
        for kind, rng in draws.items():
            job = random_job(rng, kind)
            servo = draw_servo(rng, job)
            command: Command = ("in_sync", "shaped")[int(rng.integers(2))]  # type: ignore[assignment]
            objective = objectives[int(rng.integers(len(objectives)))]
            begun = process_time()
            end, note = ended(job, servo, command, objective)
            seconds[kind].append(process_time() - begun)
            ends[kind].append(end)
            if end not in GOOD:
                print(f"{kind} {number} {command} {objective}: {end}: {note}", file=sys.stderr, flush=True)
        rows = [counted(kind, options.seed, ends[kind], seconds[kind]) for kind in kinds]
        with options.out.open("w", newline="", encoding="utf-8") as file:
            table = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
            table.writeheader()
            table.writerows(rows)
    for row in rows:
        print(", ".join(f"{name} {value}" for name, value in row.items()), flush=True)
    return 1 if any(row["other"] for row in rows) else 0


if __name__ == "__main__":
    sys.exit(main())
