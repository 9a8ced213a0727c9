"""Cut lists and shifts: how long they take, and whether their words are true on random machines.

- ``plan``: random lists against a dense dynamic programme over their joints: how much slower the plan is, at most;
- ``list``: 1000 pieces of 50 lengths planned, designed, written and run through their seams (processor time);
- ``shift``: 10 000 pieces run by the servo, with optimised cams and linear returns (processor time);
- ``seams``: random pairs of cams: cranks at places of their own and cams in sync. What steps by design must be told, what meets must meet
  in the tables, of a target in float64 and of one in float32;
- ``meetings``: every ordered pair of shaped cams, of cranks at places of their own, and of knives in sync: whether they are said to meet,
  against differences of their positions about the seam.

Prints one CSV row for each below a heading, and ends with 1 if a promise is missed:

    python benchmarks/cutlist.py [--pairs 12] [--cams 9]
"""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from time import process_time

import numpy as np

from camwright.design.production.line_plan import fastest_plan
from camwright.jobs.job import Job, load_job
from camwright.production.cams import highest_for_gap, list_cam
from camwright.production.changes import find_changes
from camwright.production.cut_list import line_of, study_list
from camwright.production.simulation import Disturbances, simulate_shift
from camwright.profiles.cut_list import CutList, ListRow
from camwright.profiles.errors import InfeasibleError
from camwright.profiles.line import STEADY
from camwright.profiles.polynomial.profile import FloatArray
from camwright.studies.reach import stand_in

EXAMPLES = Path(__file__).parents[1] / "examples"
SECONDS = 10.0
SLOWER = 1e-3
STEP = 1e-6
"""Steps of a velocity (m/s) from which two cams do not meet."""
LEAST_RATIO = 1e-4
"""Step of the ratio from which differences of positions tell that two cams do not meet."""
EXACT, ROUNDED = 1e-9, 1e-4
"""Steps of a velocity (m/s) that tables of cams which meet may have in float64 and in float32."""


def dense(lengths: FloatArray, highest: FloatArray, ramp: float, levels: int = 1200) -> float:
    """Least time by dynamic programming over the joints, on a grid of squared speeds."""
    grid = np.unique(np.concatenate([np.linspace(0.0, float(highest.max()) ** 2, levels)[1:], highest**2]))
    cost = np.where(grid <= highest[0] ** 2 * (1 + 1e-12), 0.0, math.inf)
    first, last = grid[:, None], grid[None, :]
    for length, speed in zip(lengths.tolist(), highest.tolist(), strict=True):
        peak = np.minimum(speed**2, 0.5 * (first + last) + ramp * length)
        way = length - (2 * peak - first - last) / (2 * ramp)
        time = (2 * np.sqrt(peak) - np.sqrt(first) - np.sqrt(last)) / ramp + way / np.sqrt(peak)
        kept = (np.abs(first - last) <= 2 * ramp * length) & (np.maximum(first, last) <= speed**2 * (1 + 1e-12))
        cost = np.where(kept, cost[:, None] + time, math.inf).min(axis=0)
    return float(cost.min())


def plans(draw: np.random.Generator) -> tuple[float, bool]:
    """Greatest share by which a plan is slower than the dynamic programme."""
    worst = -math.inf
    for _ in range(20):
        count = int(draw.integers(2, 15))
        lengths, highest = draw.uniform(0.2, 1.5, count), draw.uniform(0.2, 2.5, count)
        ramp = float(draw.uniform(0.1, 5.0))
        worst = max(worst, fastest_plan(lengths, highest, ramp).time / dense(lengths, highest, ramp) - 1.0)
    return worst, worst <= SLOWER


def lists(draw: np.random.Generator) -> tuple[float, bool]:
    """Processor time of a list (s)."""
    lengths = np.round(np.linspace(0.3, 1.2, 50), 4)
    asked = CutList(tuple(ListRow(float(draw.choice(lengths))) for _ in range(1000)))
    begun = process_time()
    study = study_list(line_of(load_job(), 1.0), asked, ["csv"])
    time = process_time() - begun
    return time, time <= SECONDS and study.passed


def shifts() -> tuple[float, bool]:
    """Processor time of a shift (s)."""
    asked = CutList((ListRow(0.6, 6000), ListRow(0.3, 2000), ListRow(0.45, 2000)))
    begun = process_time()
    study = simulate_shift(line_of(load_job(), 0.2), asked, None, Disturbances(2e-6, 2e-4, 3e-4))
    time = process_time() - begun
    return time, time <= SECONDS and len(study.lengths) == 10_000


def jobs(draw: np.random.Generator, pairs: int) -> Iterator[tuple[Job, CutList]]:
    """Random machines with two lengths: every other one a crank whose place is free."""
    knife = load_job()
    crank = replace(load_job(EXAMPLES / "chasing-shear.toml"), objective="peak_acceleration")
    for number in range(pairs):
        job = crank if number % 2 else knife
        scale = float(draw.uniform(0.7, 1.3))
        limits = replace(job.limits, acceleration=job.limits.acceleration * scale, jerk=job.limits.jerk * scale)
        lengths = draw.uniform(1.0, 3.0, 2) * (0.5 if number % 2 else 0.33)
        first, other = (ListRow(round(float(length), 4), 2) for length in lengths)
        asked = CutList((first, other, replace(first, quantity=1)))
        yield replace(job, limits=limits), asked


def seams(draw: np.random.Generator, pairs: int) -> tuple[int, bool]:
    """Pairs whose seams were told wrong."""
    wrong = 0
    for job, asked in jobs(draw, pairs):
        try:
            study = study_list(line_of(job, 0.2), asked, ["csv", "logix"])
        except InfeasibleError:
            continue
        for change in study.planned.changes.values():
            steps = change.jump.velocity > STEP or change.jump.position > STEP
            wrong += steps != (change.how in ("transition", "stop"))
        csv, logix = study.tables
        wrong += csv.jump.velocity > EXACT or logix.jump.velocity > ROUNDED
    return wrong, wrong == 0


def meetings(draw: np.random.Generator, count: int) -> tuple[int, bool]:
    """Ordered pairs that are said to meet, and do not."""
    shaped = load_job(EXAMPLES / "short-cut.toml")
    shaped = replace(shaped, servo_tolerance=None)  # the nominal servo is enough, and ten times as quick
    crank = replace(load_job(EXAMPLES / "chasing-shear.toml"), objective="peak_acceleration")
    missed = 0
    for job, least, most in ((shaped, 0.28, 0.39), (crank, 0.4, 1.6), (load_job(), 0.3, 1.2)):
        lengths = np.unique(np.round(draw.uniform(least, most, count), 4)).tolist()
        cams = [
            list_cam(number, job, length, top, min(top, job.cut.line_speed), STEADY)
            for number, (length, top) in enumerate(((each, highest_for_gap(job, each)) for each in lengths), start=1)
        ]
        for (one, other), change in find_changes(cams, np.zeros(1, dtype=np.intp), stand_in(job)).items():
            before, after = cams[one - 1].running, cams[other - 1].running
            end = before.profile.end - 1e-6 * np.arange(3)  # m of material
            left, right = before.profile(end), after.profile(1e-6 * np.arange(3))
            place = before.zero + left[0] - job.machine.pitch - after.zero - right[0]
            ratio = (np.array([3.0, -4.0, 1.0]) @ left + np.array([3.0, -4.0, 1.0]) @ right) / 2e-6
            steps = abs(place) > STEP or abs(ratio) > LEAST_RATIO
            missed += steps and change.how in ("direct", "slow_down")
    return missed, missed == 0


def main() -> int:
    """Run all and print what was found."""
    parser = argparse.ArgumentParser(description="Cut lists and shifts.")
    parser.add_argument("--pairs", type=int, default=12, help="random machines of two cams")
    parser.add_argument("--cams", type=int, default=9, help="cams of each kind, all pairs of which are looked at")
    asked = parser.parse_args()
    pairs, cams = asked.pairs, asked.cams
    draw = np.random.default_rng(18)
    print("what,value,unit,kept", flush=True)
    kept = True
    for what, unit, (value, good) in (
        ("plan slower than a dynamic programme", "share", plans(draw)),
        ("list of 1000 pieces of 50 lengths", "s", lists(draw)),
        ("shift of 10000 pieces", "s", shifts()),
        (f"wrong among {pairs} random lists", "seams", seams(draw, pairs)),
        (
            f"missed among {3 * cams * (cams - 1)} pairs of shaped cams, cranks and knives",
            "pairs",
            meetings(draw, cams),
        ),
    ):
        print(f"{what},{value:.4g},{unit},{'yes' if good else 'NO'}", flush=True)
        kept = kept and good
    return 0 if kept else 1


if __name__ == "__main__":
    sys.exit(main())
