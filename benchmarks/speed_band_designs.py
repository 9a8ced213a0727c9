"""Whether designs for a band of line speeds hold what they state: random jobs of all machines, each simulated anew at many line speeds.

Machines, cuts, limits and servos are those of ``random_servo_aware.py``; each job has a band from 10 to 60 % up to its line speed, a third
of the commands are in sync, two thirds shaped, a third make the sync error least. What a design predicts of its nominal servo is compared
with the validation's simulation at 40 of the line speeds that it looked at, and at 40 others drawn from the band the error must keep what
is stated: the tolerance, or the least error found, to 1 %. Writes a row for each job to ``results/speed_band_designs.csv`` as it ends, the
machines in turn; the exit code is 0 if every prediction holds to 1e-8 m and nothing is outside:

    python benchmarks/speed_band_designs.py [--jobs 200] [--seed 1] [--minutes 60]

With ``--issue`` it prints instead what the published knife and servo reach: the table of cut lengths, the cost beside designs for one line
speed, of the programmes alone and of `camwright.optimise` with all that it proves, and ranges of the servo with the corner that binds. The
independent linear programme is in ``tests/design/servo_aware/test_line_speeds_referee.py``.
"""

from __future__ import annotations

import argparse
import csv
import math
import sys
from collections import Counter
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from time import monotonic, process_time

import numpy as np
from random_machines import MACHINES, random_job
from random_servo_aware import draw_servo

from camwright import load_job, optimise
from camwright.design.optimise import Solution
from camwright.design.optimise_axis import solve_axis
from camwright.profiles.cut import Cut
from camwright.profiles.errors import CamwrightError
from camwright.profiles.limits import Limits
from camwright.profiles.machines import RotaryKnife
from camwright.profiles.objective import ObjectiveName, of_motion
from camwright.profiles.servo import Servo
from camwright.profiles.servo_tolerance import ServoTolerance
from camwright.profiles.task import Task
from camwright.studies.axis_study import shares_of
from camwright.validation.servo.line_speeds import line_speed_errors

RESULTS = Path(__file__).parent / "results"
SPEEDS, ATTEMPTS = 40, 12
EXACT, STATED = 1e-8, 1.01
"""What a prediction may be wrong by (m), and the factor on what is stated that a line speed between may reach."""

PAPER = Servo(120.0, 0.7, 35.0, 0.004, 1.0)
RANGES = ServoTolerance((108.0, 132.0), (0.63, 0.77), (33.25, 36.75), (0.004, 0.004), (0.0, 0.0))
CUT = Cut(0.3, 80 / 60, 0.12, 0.04, 0.08, 1e-4, shaped=True)
LIMITS = Limits(200 / 60, 100.0, 20_000.0)

ROW = (
    "seed",
    "number",
    "machine",
    "command",
    "objective",
    "slowest",
    "wrong_by_m",
    "of_stated",
    "design_s",
    "held",
    "cpu_s",
)

OBJECTIVES: tuple[ObjectiveName, ...] = ("sync_error", "peak_acceleration", "rms_acceleration", "peak_jerk", "rms_jerk")
JOB = """
name = "band"
[machine]
kind = "rotary_knife"
circumference = "400 mm"
[cut]
length = "300 mm"
line_speed = "80 m/min"
sync_zone = "120 mm"
shear_zone = "40 mm"
sync_tolerance = "0.1 mm"
[limits]
speed = "200 m/min"
acceleration = "100 m/s^2"
jerk = "20000 m/s^3"
[servo]
bandwidth = "120 rad/s"
damping = 0.7
position_gain = "35 1/s"
sample_time = "4 ms"
velocity_feedforward = 1.0
[objective]
servo_aware = true
command = "shaped"
minimise = "{objective}"
line_speeds = {line_speeds}
"""


@dataclass(frozen=True, eq=False)
class Designed:
    """A cam for a band, its task, servo and objective, and the processor time that it took (s)."""

    solution: Solution
    task: Task
    servo: Servo
    objective: ObjectiveName
    slowest: float
    seconds: float


def designed(rng: np.random.Generator, kind: str, number: int) -> Designed | None:
    """Draw a job with a band and design it; None if that cannot be."""
    job = random_job(rng, kind)
    servo, slowest = draw_servo(rng, job), float(rng.uniform(0.1, 0.6))
    objective: ObjectiveName = "sync_error" if number % 3 == 0 else of_motion(job.objective)
    shaped = number % 3 != 1
    task = job.task.with_cut(replace(job.cut, shaped=shaped))
    begun = process_time()
    try:
        command = "shaped" if shaped else "in_sync"
        solution = solve_axis(task, objective, command, (servo,), shares=shares_of(slowest), suggest=False)
    except CamwrightError:
        return None
    spent = process_time() - begun
    return Designed(solution, task.with_machine(solution.machine), servo, objective, slowest, spent)


def judged(rng: np.random.Generator, found: Designed) -> tuple[float, float]:
    """By how much predictions are wrong at most (m), and the worst error in the band over what is stated."""
    axis, v = found.solution.axis, found.task.cut.line_speed
    if axis is None:
        raise TypeError("a servo-aware design has an axis")
    shares = list(axis.by_speed)
    chosen = [shares[i] for i in np.unique(np.linspace(0, len(shares) - 1, SPEEDS).round().astype(int))]

    def simulated(at: list[float]) -> np.ndarray:
        return line_speed_errors(found.solution.profile, found.task, [found.servo], np.array(at) * v, axis.phases)[0]

    wrong = float(np.abs(simulated(chosen) - [axis.by_speed[share] for share in chosen]).max())
    stated = axis.errors[0] if found.objective == "sync_error" else found.task.cut.sync_tolerance
    drawn = rng.uniform(found.slowest, 1.0, SPEEDS).tolist()
    return wrong, float(simulated(drawn).max()) / max(stated, 1e-9)


def one_job(seed: int, number: int) -> dict[str, object]:
    """Draw, design and simulate a job of the machine whose turn it is; its numbers depend on seed and number alone."""
    kind = list(MACHINES)[number % len(MACHINES)]
    rng = np.random.default_rng([seed, number, 15])
    begun, found = process_time(), None
    for _ in range(ATTEMPTS):
        found = found or designed(rng, kind, number // len(MACHINES))
    row: dict[str, object] = {"seed": seed, "number": number, "machine": kind}
    if found is None:
        return row | dict.fromkeys(ROW[3:-2], "") | {"held": "", "cpu_s": f"{process_time() - begun:.1f}"}
    wrong, share = judged(rng, found)
    command = "shaped" if found.task.cut.shaped else "in_sync"
    row |= {"command": command, "objective": found.objective, "slowest": f"{found.slowest:.3f}"}
    row |= {"wrong_by_m": f"{wrong:.1e}", "of_stated": f"{share:.4f}", "design_s": f"{found.seconds:.2f}"}
    return row | {"held": int(wrong <= EXACT and share <= STATED), "cpu_s": f"{process_time() - begun:.1f}"}


def random_jobs(jobs: int, seed: int, minutes: float, out: Path) -> int:
    """Write a row for each job as it ends, the machines in turn, so that a run that must be stopped has all of them."""
    counts: dict[str, Counter[str]] = {kind: Counter() for kind in MACHINES}
    until = monotonic() + 60.0 * minutes
    with out.open("w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, ROW, lineterminator="\n")
        table.writeheader()
        for number in range(jobs):
            if monotonic() > until:
                break
            row = one_job(seed, number)
            table.writerow(row)
            file.flush()
            end = "none" if row["held"] == "" else "held" if row["held"] else "failed"
            counts[str(row["machine"])][end] += 1
            if end == "failed":
                print(", ".join(f"{name} {value}" for name, value in row.items()), file=sys.stderr, flush=True)
    for kind, count in counts.items():
        print(f"{kind}: {count['held']} held, {count['failed']} failed, {count['none']} without a cam", flush=True)
    return 1 if any(count["failed"] for count in counts.values()) else 0


def optimised(folder: str, objective: str, line_speeds: str) -> float:
    """Design the published job as a user does, from its file to the proved cam; the processor time (s)."""
    path = Path(folder) / "job.toml"
    path.write_text(JOB.format(objective=objective, line_speeds=line_speeds), encoding="utf-8")
    begun = process_time()
    optimise(load_job(path))
    return process_time() - begun


def issue() -> int:
    """Print what the published knife and servo reach over 8 to 80 m/min."""
    band, many = shares_of(0.1), np.linspace(8.0, 80.0, 200) / 60

    def of(length: float, objective: ObjectiveName, shares: tuple[float, ...]) -> tuple[Task, Solution, float]:
        task = Task(RotaryKnife(0.4), replace(CUT, length=length), LIMITS)
        begun = process_time()
        found = solve_axis(task, objective, "shaped", (PAPER,), shares=shares, suggest=False)
        return task, found, process_time() - begun

    of(0.5, "rms_jerk", (1.0,))  # libraries are loaded
    for length in (0.3, 0.29, 0.28, 0.272, 0.266):
        task, found, seconds = of(length, "sync_error", band)
        worst = line_speed_errors(found.profile, task, [PAPER], many, 64).max()
        within = found.axis is not None and found.axis.axis_limits
        print(
            f"{length * 1e3:.0f} mm: {worst * 1e3:.4f} mm, axis within its limits: {within}, {seconds:.2f} s",
            flush=True,
        )
    for objective in OBJECTIVES:
        one, many_speeds = of(0.3, objective, (1.0,))[2], of(0.3, objective, band)[2]
        print(
            f"least {objective} at 300 mm: {many_speeds:.2f} s over the band, {one:.3f} s at one line speed, {many_speeds / one:.1f} times"
        )
    with TemporaryDirectory() as folder:
        for objective in OBJECTIVES:
            one, many_speeds = (optimised(folder, objective, speeds) for speeds in ('"100 %"', '["10 %", "100 %"]'))
            print(
                f"optimise, least {objective} at 300 mm: {many_speeds:.2f} s over the band, {one:.2f} s at one line speed, "
                f"{many_speeds / one:.1f} times",
                flush=True,
            )
    servos, between = (PAPER, *RANGES.vertices(PAPER)), RANGES.between(PAPER)
    for length in (0.3, 0.29):
        task = Task(RotaryKnife(0.4), replace(CUT, length=length), LIMITS)
        begun = process_time()
        found = solve_axis(task, "sync_error", "shaped", servos, between, band, suggest=False)
        seconds = process_time() - begun
        errors = line_speed_errors(found.profile, task, servos, many)
        servo, column = np.unravel_index(int(errors.argmax()), errors.shape)
        bound = servos[int(servo)]
        print(
            f"{length * 1e3:.0f} mm with ranges: {errors.max() * 1e3:.4f} mm at omega {bound.bandwidth:g} rad/s, zeta {bound.damping:g}, "
            f"K {bound.position_gain:g} 1/s and {many[int(column)] * 60:.1f} m/min, {seconds:.2f} s",
            flush=True,
        )
    return 0


def main() -> int:
    """Do what is asked."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--jobs", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--minutes", type=float, default=math.inf, help="begin no job after so many")
    parser.add_argument("--issue", action="store_true")
    parser.add_argument("--out", type=Path, default=RESULTS / "speed_band_designs.csv")
    options = parser.parse_args()
    return issue() if options.issue else random_jobs(options.jobs, options.seed, options.minutes, options.out)


if __name__ == "__main__":
    sys.exit(main())
