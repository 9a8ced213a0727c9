"""What becomes of many random jobs of every machine: a profile that passes its checks, or a way out that then works.

A job is drawn around what the quintic return needs: limits from below that to far above. An infeasible job is followed up: its first
suggestion is applied and must give a profile. Writes one CSV row for each job and prints the ends; the exit code is 0 if none is
another one:

    python benchmarks/random_machines.py [--jobs 300] [--seed 1] [--machine crank_slider]
"""

from __future__ import annotations

import argparse
import csv
import math
import sys
from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from time import perf_counter

import numpy as np

from design.optimise import OBJECTIVES, Objective, solve
from profiles.cycle import Cut
from profiles.errors import CamwrightError, InfeasibleError, Suggestion
from profiles.limits import Limits
from profiles.machines import CrankSlider, LinearCarriage, Machine, RotaryKnife
from profiles.returns import baseline
from profiles.servo import Servo
from validation import measure_motion, validate

RESULTS = Path(__file__).parent / "results"

SERVO = Servo(bandwidth=1000.0, damping=0.8, position_gain=120.0, sample_time=0.0005, velocity_feedforward=1.0)
SERVO_CHECKS = {"following_error", "crossing", "settling", "shear_zone_error", "servo_stability", "minimum_cut_length"}
"""Checks on what the axis makes of the profile: the design does not know the axis, so they are counted apart."""

TO_SI = {"m/min": 1 / 60, "mm": 1e-3, "rpm": math.pi / 30}
Job = tuple[Machine, Cut, Limits, Objective]


def spread(rng: np.random.Generator, low: float, high: float) -> float:
    """Draw from a logarithmic scale."""
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def cut_of(rng: np.random.Generator, length: float, sync_zone: float, sync_ratio: float) -> Cut:
    """Cut with its shear zone at the end of the sync zone."""
    shear = 0.2 * sync_zone
    origin = ("return", "cut")[int(rng.integers(2))]
    return Cut(length, spread(rng, 0.1, 3.0), sync_zone, shear, sync_zone - shear, 5e-4, origin, sync_ratio)  # type: ignore[arg-type]


def draw_ratio(rng: np.random.Generator) -> float:
    """Draw a sync ratio: none in two of three jobs."""
    return float(rng.uniform(0.95, 1.1)) if rng.integers(3) == 0 else 1.0


def draw_knife(rng: np.random.Generator, horizontal: bool) -> tuple[Machine, Cut]:
    """Draw a rotary knife and its cut."""
    machine = RotaryKnife(
        circumference=spread(rng, 0.2, 2.0),
        blades=int(rng.integers(1, 4)),
        gear_ratio=spread(rng, 1.0, 10.0),
        sync="horizontal" if horizontal else "tangential",
        drum_inertia=spread(rng, 1e-3, 1.0),
        drum_friction=float(rng.integers(2)) * spread(rng, 0.1, 10.0),
    )
    ratio = draw_ratio(rng)
    length = machine.pitch * spread(rng, 0.4, 3.0)
    longest = min(
        0.8 * length, 0.8 * machine.pitch / ratio, machine.greatest_sync_zone(ratio) * 0.95 if horizontal else math.inf
    )
    return machine, cut_of(rng, length, longest * float(rng.uniform(0.1, 1.0)), ratio)


def draw_carriage(rng: np.random.Generator) -> tuple[Machine, Cut]:
    """Draw a linear carriage and its cut."""
    ratio = draw_ratio(rng)
    length = spread(rng, 0.2, 5.0)
    cut = cut_of(rng, length, length * float(rng.uniform(0.05, 0.7)), ratio)
    stroke = ratio * cut.sync_zone + length * spread(rng, 0.01, 1.0)
    return LinearCarriage(stroke, float(rng.uniform(-1.0, 1.0)), spread(rng, 5.0, 200.0), spread(rng, 0.01, 0.2)), cut


def draw_crank(rng: np.random.Generator) -> tuple[Machine, Cut]:
    """Draw a crank-slider and its cut; the place of the sync zone is free in every other job."""
    crank = spread(rng, 0.05, 0.4)
    machine = CrankSlider(
        crank=crank,
        rod=crank * spread(rng, 2.0, 6.0),
        offset=float(rng.integers(2)) * crank * float(rng.uniform(-0.5, 0.5)),
        crank_inertia=spread(rng, 0.01, 2.0),
        carriage_mass=spread(rng, 2.0, 60.0),
        gear_ratio=spread(rng, 1.0, 10.0),
    )
    ratio = draw_ratio(rng)
    sync = machine.stroke / ratio * float(rng.uniform(0.1, 0.7))
    cut = cut_of(rng, max(1.2 * sync, machine.stroke * spread(rng, 0.8, 8.0)), sync, ratio)
    if rng.integers(2):
        return machine, cut
    least, greatest = machine.sync_range(cut)
    return replace(machine, sync_at=least + (greatest - least) * float(rng.uniform(0.1, 0.9))), cut


MACHINES: dict[str, Callable[[np.random.Generator], tuple[Machine, Cut]]] = {
    "rotary_knife_tangential": lambda rng: draw_knife(rng, False),
    "rotary_knife_horizontal": lambda rng: draw_knife(rng, True),
    "linear_carriage": draw_carriage,
    "crank_slider": draw_crank,
}


def random_job(rng: np.random.Generator, kind: str) -> Job:
    """Draw a job, its limits around what the quintic return needs."""
    machine, cut = MACHINES[kind](rng)
    placed = machine
    if isinstance(machine, CrankSlider) and math.isnan(machine.sync_at):
        placed = replace(machine, sync_at=0.5 * sum(machine.sync_range(cut)))
    quintic = measure_motion(baseline("poly_3_4_5", placed, cut), placed, cut)
    limits = Limits(
        speed=quintic.peak_speed * float(rng.uniform(0.7, 2.0)),
        acceleration=(quintic.peak_acceleration or 1.0) * spread(rng, 0.5, 20.0),
        jerk=(quintic.peak_jerk or 1.0) * spread(rng, 0.3, 100.0),
        reversal=bool(rng.integers(2)),
    )
    return machine, cut, limits, OBJECTIVES[int(rng.integers(len(OBJECTIVES)))]


def apply(job: Job, suggestion: Suggestion) -> Job:
    """Follow a suggestion."""
    machine, cut, limits, objective = job
    value = suggestion.value * TO_SI.get(suggestion.unit, 1.0)
    if suggestion.change == "reversal":
        return machine, cut, replace(limits, reversal=True), objective
    if suggestion.change == "line_speed":
        return machine, replace(cut, line_speed=value), limits, objective
    if suggestion.change == "length":
        return machine, replace(cut, length=value), limits, objective
    speed, acceleration, jerk = (
        value if suggestion.change == name else getattr(limits, name) for name in ("speed", "acceleration", "jerk")
    )
    return machine, cut, replace(limits, speed=speed, acceleration=acceleration, jerk=jerk), objective


def judge(job: Job) -> tuple[str, str]:
    """Design a job and validate it; how it ended, and what failed with its numbers."""
    machine, cut, limits, objective = job
    solution = solve(machine, cut, limits, objective)
    report = validate(solution.profile, solution.machine, cut, limits, SERVO)
    failed = [check for check in report.checks if not check.passed]
    numbers = "; ".join(f"{check.name} {check.value!r} limit {check.limit!r} at {check.at!r}" for check in failed)
    if not failed:
        return "passed", ""
    return ("passed but for the servo" if {check.name for check in failed} <= SERVO_CHECKS else "check failed"), numbers


def measure(number: int, kind: str, job: Job) -> dict[str, object]:
    """Design one job, follow its first suggestion if it is infeasible, and note the end."""
    machine, cut, limits, objective = job
    start = perf_counter()
    suggestion = ""
    try:
        end, numbers = judge(job)
    except InfeasibleError as error:
        end, numbers = "infeasible, no suggestion", str(error)
        if error.suggestions:
            first = error.suggestions[0]
            suggestion = f"{error.binding}: {first.change} {first.value!r} {first.unit}"
            try:
                then, numbers = judge(apply(job, first))
                end = "infeasible, suggestion works" if then.startswith("passed") else f"infeasible, then {then}"
            except CamwrightError as other:
                end, numbers = f"infeasible, then {type(other).__name__}", str(other)
    except CamwrightError as error:
        end, numbers = type(error).__name__, str(error)
    seconds = perf_counter() - start
    return {
        "machine": kind,
        "job": number,
        "objective": objective,
        "end": end,
        "suggestion": suggestion,
        "numbers": numbers,
        "seconds": f"{seconds:.2f}",
        "data": f"{machine!r} {cut!r} {limits!r}",
    }


GOOD_ENDS = ("passed", "passed but for the servo", "infeasible, suggestion works")


def main() -> int:
    """Run the jobs, write the rows, print the ends; the exit code tells whether every job ended well."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--jobs", type=int, default=300)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--machine", choices=tuple(MACHINES), action="append")
    options = parser.parse_args()
    RESULTS.mkdir(exist_ok=True)
    others = 0
    print("machine,end,jobs")
    for kind in options.machine or MACHINES:
        rng = np.random.default_rng(options.seed)
        rows = []
        with (RESULTS / f"random_{kind}.csv").open("w", newline="", encoding="utf-8") as file:
            table = csv.writer(file, lineterminator="\n")
            for number in range(options.jobs):
                rows.append(measure(number, kind, random_job(rng, kind)))
                table.writerows([list(rows[0])] * (number == 0) + [list(rows[-1].values())])
                file.flush()
        for end, count in sorted(Counter(str(row["end"]) for row in rows).items()):
            print(f"{kind},{end},{count}", flush=True)
        for row in rows:
            if row["end"] not in GOOD_ENDS:
                others += 1
                print(
                    f"  {kind} {row['job']} {row['objective']}: {row['end']}: {row['suggestion']} {row['numbers']} [{row['data']}]",
                    flush=True,
                )
    return 0 if others == 0 else 1


if __name__ == "__main__":
    sys.exit(main())
