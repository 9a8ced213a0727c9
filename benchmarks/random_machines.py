"""What becomes of many random jobs of every machine: a profile that passes every check, or a refusal whose every way out then works.

A job is drawn around what the quintic return needs: limits from below that to far above, with and without a motor's torque-speed curve. An
infeasible job is followed up: each of its suggestions is applied and must give a profile that passes every check, and the quintic must
not keep the limits. The servo is fast for the cut, so that its checks judge the profile and not the axis. Writes the counts of each
machine to ``results/random_machines.csv`` and prints every job that ended otherwise; the exit code is 0 if there is none:

    python benchmarks/random_machines.py [--jobs 300] [--seed 1] [--machine crank_slider]
"""

from __future__ import annotations

import argparse
import csv
import math
import sys
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from time import monotonic, process_time

import numpy as np

from camwright.design.feasible.feasibility import with_limit
from camwright.design.optimise import (
    solve,
)
from camwright.profiles.cut import Cut
from camwright.profiles.errors import CamwrightError, InfeasibleError, Suggestion
from camwright.profiles.limits import Limits
from camwright.profiles.machines import (
    CrankSlider,
    LinearCarriage,
    Machine,
    RotaryKnife,
)
from camwright.profiles.motor import MotorCurve
from camwright.profiles.objective import COMMAND_OBJECTIVES, MOTION_OBJECTIVES, CommandObjective
from camwright.profiles.returns import baseline
from camwright.profiles.servo import Servo
from camwright.profiles.task import Task
from camwright.validation.motion import measure_motion
from camwright.validation.motor import measure_motor
from camwright.validation.report import judge

FREE = Limits(math.inf, math.inf, math.inf)
"""Nothing here asks for limits."""

RESULTS = Path(__file__).parent / "results"

PASSED, WAY_OUT = "passed", "infeasible, every suggestion works"
TO_SI = {"m/min": 1 / 60, "mm": 1e-3, "rpm": math.pi / 30}


@dataclass(frozen=True)
class RandomJob:
    """A machine, its cut, limits and objective."""

    machine: Machine
    cut: Cut
    limits: Limits
    objective: CommandObjective

    @property
    def task(self) -> Task:
        """Machine, cut and limits together."""
        return Task(self.machine, self.cut, self.limits)


@dataclass(frozen=True)
class End:
    """How a job ended, what is to be said about it, and the processor time that it took (s)."""

    end: str
    note: str
    seconds: float


def spread(rng: np.random.Generator, low: float, high: float) -> float:
    """Draw from a logarithmic scale."""
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def servo_for(cut: Cut) -> Servo:
    """Servo that settles within a small part of the sync zone."""
    time = cut.sync_zone / cut.line_speed
    return Servo(200.0 / time, 0.8, 40.0 / time, time / 1000, velocity_feedforward=1.0)


def cut_of(rng: np.random.Generator, length: float, sync_zone: float, sync_ratio: float) -> Cut:
    """Cut with its shear zone at the end of the sync zone."""
    shear = 0.2 * sync_zone
    origin = ("return", "cut")[int(rng.integers(2))]
    speed = spread(rng, 0.1, 3.0)
    return Cut(length, speed, sync_zone, shear, sync_zone - shear, 0.02 * sync_zone, origin, sync_ratio)  # type: ignore[arg-type]


def draw_ratio(rng: np.random.Generator) -> float:
    """Draw a sync ratio: none in two of three jobs."""
    return float(rng.uniform(0.95, 1.1)) if rng.integers(3) == 0 else 1.0


def draw_knife(rng: np.random.Generator, horizontal: bool) -> tuple[Machine, Cut]:
    """Draw a rotary knife and its cut."""
    inertia = rng.integers(4) > 0
    machine = RotaryKnife(
        circumference=spread(rng, 0.2, 2.0),
        blades=int(rng.integers(1, 4)),
        gear_ratio=spread(rng, 1.0, 10.0),
        sync="horizontal" if horizontal else "tangential",
        drum_inertia=float(inertia) * spread(rng, 1e-3, 1.0),
        drum_friction=float(inertia) * float(rng.integers(2)) * spread(rng, 0.1, 10.0),
    )
    ratio = draw_ratio(rng)
    length = machine.pitch * spread(rng, 0.4, 3.0)
    longest = 0.8 * min(length, machine.pitch / ratio)
    if horizontal:
        angle = min(math.radians(80.0), 0.4 * machine.pitch / machine.radius)
        longest = min(0.8 * length, 2 * machine.radius * math.sin(angle) / ratio)
    return machine, cut_of(rng, length, longest * float(rng.uniform(0.1, 1.0)), ratio)


def draw_carriage(rng: np.random.Generator) -> tuple[Machine, Cut]:
    """Draw a linear carriage and its cut."""
    ratio = draw_ratio(rng)
    length = spread(rng, 0.2, 5.0)
    cut = cut_of(rng, length, length * float(rng.uniform(0.05, 0.7)), ratio)
    stroke = ratio * cut.sync_zone + length * spread(rng, 0.01, 1.0)
    mass = float(rng.integers(4) > 0) * spread(rng, 5.0, 200.0)
    return LinearCarriage(stroke, float(rng.uniform(-1.0, 1.0)), mass, spread(rng, 0.01, 0.2)), cut


def draw_crank(rng: np.random.Generator) -> tuple[Machine, Cut]:
    """Draw a crank-slider and its cut; the place of the sync zone is free in every other job."""
    crank, inertia = spread(rng, 0.05, 0.4), float(rng.integers(4) > 0)
    machine = CrankSlider(
        crank=crank,
        rod=crank * spread(rng, 2.0, 6.0),
        offset=float(rng.integers(2)) * crank * float(rng.uniform(-0.5, 0.5)),
        crank_inertia=inertia * spread(rng, 0.01, 2.0),
        carriage_mass=inertia * spread(rng, 2.0, 60.0),
        gear_ratio=spread(rng, 1.0, 10.0),
    )
    ratio = draw_ratio(rng)
    sync = machine.stroke / ratio * float(rng.uniform(0.1, 0.7))
    cut = cut_of(rng, max(1.2 * sync, machine.stroke * spread(rng, 0.8, 8.0)), sync, ratio)
    if rng.integers(2):
        return machine, cut
    least, greatest = machine.place_range(cut)
    return replace(machine, sync_at=least + (greatest - least) * float(rng.uniform(0.1, 0.9))), cut


MACHINES: dict[str, Callable[[np.random.Generator], tuple[Machine, Cut]]] = {
    "rotary_knife_tangential": lambda rng: draw_knife(rng, False),
    "rotary_knife_horizontal": lambda rng: draw_knife(rng, True),
    "linear_carriage": draw_carriage,
    "crank_slider": draw_crank,
}


def placed(machine: Machine, cut: Cut) -> Machine:
    """Put the sync zone of a crank that leaves it open into the middle of its range."""
    if isinstance(machine, CrankSlider) and math.isnan(machine.sync_at):
        return replace(machine, sync_at=0.5 * sum(machine.place_range(cut)))
    return machine


def random_job(rng: np.random.Generator, kind: str) -> RandomJob:
    """Draw a job, its limits around what the quintic return needs; one in three with little room, one in three with a motor."""
    machine, cut = MACHINES[kind](rng)
    there = placed(machine, cut)
    profile = baseline("poly_3_4_5", Task(there, cut, FREE))
    quintic, motor = measure_motion(profile, Task(there, cut, FREE)), measure_motor(profile, Task(there, cut, FREE))
    acceleration, jerk = quintic.peak_acceleration or 1.0, quintic.peak_jerk or 1.0
    if rng.integers(3) == 0:
        speed, bend, rise = rng.uniform(0.9, 1.1), rng.uniform(0.6, 1.1), rng.uniform(0.4, 1.2)
    else:
        speed, bend, rise = rng.uniform(0.7, 2.0), spread(rng, 0.5, 20.0), spread(rng, 0.3, 100.0)
    curve = None
    with_motor, strong, fast, weak = (
        rng.integers(3) == 0,
        spread(rng, 0.5, 5.0),
        rng.uniform(0.9, 2.5),
        rng.uniform(0.2, 1.0),
    )
    if with_motor and motor.peak_torque:
        torque, top = strong * motor.peak_torque, float(fast * motor.peak_speed)
        friction = machine.friction / machine.motor_ratio
        torque = max(torque, 1.5 * friction)
        curve = MotorCurve(((0.0, torque), (0.6 * top, torque), (top, friction + weak * (torque - friction))))
    limits = Limits(
        quintic.peak_speed * float(speed), acceleration * float(bend), jerk * float(rise), bool(rng.integers(2)), curve
    )
    names = COMMAND_OBJECTIVES if motor.peak_torque else MOTION_OBJECTIVES
    return RandomJob(machine, cut, limits, names[int(rng.integers(len(names)))])


def apply(job: RandomJob, suggestion: Suggestion) -> RandomJob:
    """Follow a suggestion."""
    value = suggestion.value * TO_SI.get(suggestion.unit, 1.0)
    match suggestion.change:
        case "reversal":
            return replace(job, limits=replace(job.limits, reversal=True))
        case "motor":
            points = job.limits.motor.points if job.limits.motor is not None else ()
            points = tuple((speed, torque * suggestion.value / 100) for speed, torque in points)
            return replace(job, limits=replace(job.limits, motor=MotorCurve(points)))
        case "line_speed":
            return replace(job, cut=replace(job.cut, line_speed=value))
        case "length":
            return replace(job, cut=replace(job.cut, length=value))
        case "stroke":
            return replace(job, machine=replace(job.machine, stroke=value))  # type: ignore[call-arg]
        case "speed" | "acceleration" | "jerk":
            return replace(job, limits=with_limit(job.limits, suggestion.change, value))
        case _:
            raise ValueError(f"unknown suggestion {suggestion!r}")


def outcome(job: RandomJob) -> tuple[str, str]:
    """Design a job and validate it; how it ended, and what failed with its numbers."""
    solution = solve(job.task, job.objective)
    report = judge(solution.profile, job.task.with_machine(solution.machine), servo_for(job.cut))
    failed = [check for check in report.checks if not check.passed]
    numbers = "; ".join(f"{check.name} {check.value!r} limit {check.limit!r} at {check.at!r}" for check in failed)
    return ("check failed" if failed else PASSED), numbers


def quintic_passes(job: RandomJob) -> bool:
    """Tell whether the quintic return passes every check of a job, a crank's sync zone in the middle of its range if it is free."""
    machine, cut, limits = placed(job.machine, job.cut), job.cut, job.limits
    profile = baseline("poly_3_4_5", Task(machine, cut, FREE))
    report = judge(profile, Task(machine, cut, limits), servo_for(cut))
    return report.passed


def measure(job: RandomJob) -> End:
    """Design one job, follow every suggestion if it is infeasible, and note the end."""
    start = process_time()
    try:
        end, note = outcome(job)
    except InfeasibleError as error:
        refused = process_time()
        end, note = follow(job, error)
        return End(end, note, refused - start)
    except CamwrightError as error:
        end, note = type(error).__name__, str(error)
    return End(end, note, process_time() - start)


def follow(job: RandomJob, error: InfeasibleError) -> tuple[str, str]:
    """Follow every suggestion of a refusal; how that ended."""
    if not error.suggestions:
        return "infeasible, no suggestion", str(error)
    if quintic_passes(job):
        return "infeasible, but the quintic is not", str(error)
    for suggestion in error.suggestions:
        named = f"{error.binding}: {suggestion.change} {suggestion.value!r} {suggestion.unit}"
        try:
            then, numbers = outcome(apply(job, suggestion))
        except CamwrightError as other:
            return f"infeasible, then {type(other).__name__}", f"{named}: {other}"
        if then != PASSED:
            return f"infeasible, then {then}", f"{named}: {numbers}"
    return WAY_OUT, f"{error.binding}: {', '.join(suggestion.change for suggestion in error.suggestions)}"


HEAD = (
    "machine",
    "seed",
    "jobs",
    "passed",
    "infeasible_suggestions_work",
    "other",
    "suggestions",
    "mean_s",
    "longest_s",
)


def counted(kind: str, seed: int, ends: Sequence[End]) -> tuple[object, ...]:
    """Row of a machine."""
    count = Counter(end.end for end in ends)
    offered = sum(end.note.count(",") + 1 for end in ends if end.end == WAY_OUT)
    seconds = [end.seconds for end in ends]
    other = len(ends) - count[PASSED] - count[WAY_OUT]
    times = f"{np.mean(seconds):.2f}", f"{max(seconds):.2f}"
    return kind, seed, len(ends), count[PASSED], count[WAY_OUT], other, offered, *times


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the jobs, write the counts, print all other ends; the exit code tells whether every job ended well.

    The machines take turns and the counts are written after each, so that a run that is ended early has as many jobs of each machine.
    """
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--jobs", type=int, default=300)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--machine", choices=tuple(MACHINES), action="append")
    parser.add_argument("--minutes", type=float, default=math.inf, help="begin no round of jobs after so many")
    parser.add_argument("--out", type=Path, default=RESULTS / "random_machines.csv")
    options = parser.parse_args(arguments)
    kinds = options.machine or list(MACHINES)
    draws = {kind: np.random.default_rng(options.seed) for kind in kinds}
    ends: dict[str, list[End]] = {kind: [] for kind in kinds}
    rows: list[tuple[object, ...]] = []
    until = monotonic() + 60 * options.minutes
    for number in range(options.jobs):
        if monotonic() > until:
            break
        for kind, rng in draws.items():
            job = random_job(rng, kind)
            end = measure(job)
            ends[kind].append(end)
            if end.end not in (PASSED, WAY_OUT):
                print(f"{kind} {number}: {end.end}: {end.note}\n  {job!r}", flush=True)
        rows = [counted(kind, options.seed, ends[kind]) for kind in kinds]
        with options.out.open("w", newline="", encoding="utf-8") as file:
            csv.writer(file, lineterminator="\n").writerows([HEAD, *rows])
    for row in rows:
        print(", ".join(f"{name} {value}" for name, value in zip(HEAD, row, strict=True)), flush=True)
    return 0 if all(end.end in (PASSED, WAY_OUT) for each in ends.values() for end in each) else 1


if __name__ == "__main__":
    sys.exit(main())
