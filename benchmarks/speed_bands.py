"""Whether the line speeds for which a cam is released are right: random jobs, judged anew inside and outside the stated band.

Machines, cuts, limits and servos are those of ``random_servo_aware.py``; a third of the jobs are designed without the servo, a third
with a command in sync, a third with a shaped one. At 25 line speeds inside each band and 25 outside every check is made anew: the
report's, and the sync error once more at 64 sampling phases by the road of many servos, each as the servo that it is at that speed. A
verdict is wrong if it is not the band's and no end of the band lies within 0.2 %. Writes the counts of each machine to
``results/speed_bands.csv`` and prints each wrong verdict; the exit code is 0 if there is none:

    python benchmarks/speed_bands.py [--jobs 200] [--seed 1]
"""

from __future__ import annotations

import argparse
import csv
import sys
from collections import Counter
from dataclasses import dataclass, replace
from pathlib import Path
from time import process_time

import numpy as np
from random_machines import MACHINES, random_job
from random_servo_aware import draw_servo

from camwright.design.optimise import solve
from camwright.design.optimise_axis import solve_axis
from camwright.profiles.errors import CamwrightError, InputError
from camwright.profiles.objective import of_motion
from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.profiles.servo import Servo
from camwright.profiles.task import Task
from camwright.studies.speed_band import SpeedBand, speed_band
from camwright.validation.report import judge
from camwright.validation.servo.monte_carlo import shear_zone_errors

RESULTS = Path(__file__).parent / "results"
ASIDE = 2e-3
"""What an end of a band may be wrong by, relative to it."""

SPEEDS, PHASES = 25, 64
SLOWEST = 0.02
"""Share of the highest speed below which nothing is judged anew: it takes for ever."""


@dataclass(frozen=True, eq=False)
class Cam:
    """A cam, what it is for, and the band that is stated of it."""

    profile: CamProfile
    task: Task
    servo: Servo
    servo_aware: bool
    band: SpeedBand
    seconds: float


def designed(rng: np.random.Generator, kind: str, way: int) -> Cam | None:
    """Draw a job and design it: without its servo, with a command in sync, or shaped; None if that cannot be."""
    job = random_job(rng, kind)
    servo, objective = draw_servo(rng, job), of_motion(job.objective)
    cut = replace(job.cut, shaped=way == 2)
    task = job.task.with_cut(cut)
    try:
        if way == 0:
            solution = solve(task, objective, suggest=False)
        else:
            solution = solve_axis(task, objective, "shaped" if way == 2 else "in_sync", (servo,), suggest=False)
        task = task.with_machine(solution.machine)
        report = judge(solution.profile, task, servo, servo_aware=way > 0)
        begun = process_time()
        band = speed_band(solution.profile, task, (servo,), report, servo_aware=way > 0)
    except CamwrightError:
        return None
    return Cam(solution.profile, task, servo, way > 0, band, process_time() - begun)


def passes(cam: Cam, line_speed: float) -> bool:
    """Judge a cam anew at a line speed, the sync error at 64 phases."""
    task = cam.task.at_speed(line_speed)
    report = judge(cam.profile, task, cam.servo, servo_aware=cam.servo_aware)
    share = line_speed / cam.task.cut.line_speed
    error = shear_zone_errors(cam.profile, cam.task, [cam.servo.at_speed(share)], PHASES)[0]
    return report.passed and bool(error <= task.cut.sync_tolerance)


def drawn(rng: np.random.Generator, cam: Cam) -> list[float]:
    """Draw line speeds inside the band and outside it."""
    parts = cam.band.parts
    top = 1.3 * (parts[-1][1] if parts else cam.task.cut.line_speed)
    low = SLOWEST * top

    def spread(ends: list[tuple[float, float]]) -> list[float]:
        wide = [(max(a, low) * (1 + ASIDE), b * (1 - ASIDE)) for a, b in ends]
        wide = [(a, b) for a, b in wide if a < b]
        sizes: FloatArray = np.array([np.log(b / a) for a, b in wide])
        if not len(sizes):
            return []
        chosen = rng.choice(len(wide), SPEEDS, p=sizes / sizes.sum())
        return [float(wide[i][0] * (wide[i][1] / wide[i][0]) ** rng.uniform()) for i in chosen]

    ends = [0.0, *(end for part in parts for end in part), top]
    outside = [(a, b) for a, b in zip(ends[::2], ends[1::2], strict=True) if a < b]
    return spread(list(parts)) + spread(outside)


def wrong_speeds(rng: np.random.Generator, cam: Cam) -> tuple[int, list[float]]:
    """Judge a cam anew in and out of its band; how many verdicts, and the line speeds at which one is wrong."""
    wrong, judged = [], 0
    for speed in drawn(rng, cam):
        try:
            found = passes(cam, speed)
        except InputError:  # too slow to be simulated as a whole
            continue
        judged += 1
        if found is not cam.band.holds(speed):
            wrong.append(speed)
    return judged, wrong


def main() -> int:
    """Draw, design, judge anew, write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--jobs", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, default=RESULTS / "speed_bands.csv")
    options = parser.parse_args()
    rows, any_wrong = [], 0
    kinds = list(MACHINES)
    for index, kind in enumerate(kinds):
        rng = np.random.default_rng([options.seed, index, 14])
        counts: Counter[str] = Counter()
        seconds = []
        wanted = options.jobs // len(kinds) + (index < options.jobs % len(kinds))
        for number in range(wanted):
            way = number % 3
            cam = None
            for _ in range(20):  # until one can be designed
                cam = cam or designed(rng, kind, way)
            if cam is None:
                continue
            judged, wrong = wrong_speeds(rng, cam)
            counts.update(
                jobs=1, gaps=len(cam.band.parts) > 1, creeps=cam.band.holds(0.0), none=not cam.band.parts, judged=judged
            )
            counts["wrong"] += len(wrong)
            seconds.append(cam.seconds)
            if wrong:
                any_wrong += 1
                print(f"{kind} {number} way {way}: {cam.band} wrong at {wrong}", file=sys.stderr, flush=True)
        names = ("jobs", "creeps", "gaps", "none", "judged", "wrong")
        row = {"machine": kind, "seed": options.seed, **{name: counts[name] for name in names}}
        row |= {"median_s": f"{np.median(seconds):.3f}", "longest_s": f"{max(seconds):.3f}"}
        rows.append(row)
        print(", ".join(f"{name} {value}" for name, value in row.items()), flush=True)
    with options.out.open("w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
        table.writeheader()
        table.writerows(rows)
    return 1 if any_wrong else 0


if __name__ == "__main__":
    sys.exit(main())
