"""Whether cams that bear the ramps of their line are the best: random jobs of every machine beside a linear programme on a fine grid.

Machines and cuts are those of ``random_machines.py``, the sync zone of a crank placed; limits are drawn from what the gentlest return of
a line that keeps its speed needs, ramps from what the limits leave. The programme is written in cvxpy from the chain rule alone, with the
jerk constant on even intervals and the limits asked at their nodes and middles. Asked of every job: the design is within 1e-3 of the
programme or better, its lower bound is not above the programme's answer by more than the grid's own error, and 200 phases and 20 line
speeds run in time with the line's greatest acceleration and jerk exceed no limit by more than 1e-6. Writes one row a job to
``results/line_ramps.csv``, as many as give fifty designs; the exit code is 0 if all is so:

    python benchmarks/line_ramps.py [--designs 50] [--seed 1]
"""

from __future__ import annotations

import argparse
import csv
import math
import sys
from pathlib import Path
from time import process_time

import cvxpy
import numpy as np
from random_machines import MACHINES, spread

from camwright.design.optimise import solve
from camwright.profiles.errors import CamwrightError, InfeasibleError, InputError
from camwright.profiles.limits import Limits
from camwright.profiles.line import Line
from camwright.profiles.objective import MOTION_OBJECTIVES, OBJECTIVES, of_motion
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.task import Task
from camwright.validation.bounds.optimality import lower_bound
from camwright.validation.motion import measure_motion

RESULTS = Path(__file__).parent / "results"
GRID = 600
"""Intervals of the linear programme."""

WITHIN, TOUCHED = 1e-3, 1e-6
"""What a design may be above the programme, and what the simulation may exceed a limit by."""

PHASES, SPEEDS = 200, 20


def draw(rng: np.random.Generator, kind: str) -> tuple[Task, str] | None:
    """Draw a job that can be done on a line that keeps its speed, and a ramp; None if there is none."""
    machine, cut = MACHINES[kind](rng)
    try:
        task = Task(machine, cut, Limits(1e6, 1e9, 1e12, reversal=bool(rng.integers(2))))
        task = task if machine.placed else task.placed_midway()
        gentle = solve(task, "rms_jerk", suggest=False)
    except (CamwrightError, InputError):
        return None
    measures = measure_motion(gentle.profile, task.with_machine(gentle.machine))
    if measures.peak_acceleration is None or measures.peak_jerk is None:
        return None
    limits = Limits(
        measures.peak_speed * spread(rng, 1.02, 2.0),
        measures.peak_acceleration * spread(rng, 0.9, 2.0) + 1e-6,
        measures.peak_jerk * spread(rng, 0.9, 4.0) + 1e-6,
        task.limits.reversal,
    )
    fastest = measures.peak_speed / cut.line_speed
    ramp = spread(rng, 0.01, 0.3) * limits.acceleration / fastest
    jerk = spread(rng, 0.01, 0.2) * limits.jerk / fastest if rng.integers(2) else None
    stop = ramp * spread(rng, 1.0, 3.0) if rng.integers(2) else None
    objective = MOTION_OBJECTIVES[int(rng.integers(len(MOTION_OBJECTIVES)))]
    return Task(task.machine, cut, limits, Line(ramp, stop, jerk)), objective


def programme(task: Task, objective: str) -> float:
    """Least value of an objective by cvxpy on even intervals; infinite where it finds none, not a number where it fails."""
    if exceeded(task.sync, task) > TOUCHED:
        return math.inf  # no return makes up for what the sync zone asks
    cut, limits, line, v = task.cut, task.limits, task.line, task.cut.line_speed
    sync, time = task.sync, cut.return_zone / cut.line_speed
    h = 1.0 / GRID
    size = max(abs(task.height), 1e-9)
    to_speed, to_acceleration, to_jerk = (
        size / time,
        size / time**2,
        size / time**3,
    )  # in units of the return's travel and time
    u, a, p, q = cvxpy.Variable(GRID), cvxpy.Variable(GRID + 1), cvxpy.Variable(GRID + 1), cvxpy.Variable(GRID + 1)
    ends = [
        (float(sync(sync.end, order, side="left")) * v**order, float(sync(sync.start, order)) * v**order)
        for order in (1, 2)
    ]
    rows = [
        a[1:] - a[:-1] == h * u,
        p[1:] - p[:-1] == h * (a[1:] + a[:-1]) / 2,
        q[1:] - q[:-1] == h * p[:-1] + h**2 * (2 * a[:-1] + a[1:]) / 6,
        p[0] == ends[0][0] / to_speed,
        p[GRID] == ends[0][1] / to_speed,
        a[0] == ends[1][0] / to_acceleration,
        a[GRID] == ends[1][1] / to_acceleration,
        q[0] == 0,
        q[GRID] == task.height / size,
    ]
    middle_p, middle_a = p[:-1] + h * (3 * a[:-1] + a[1:]) / 8, (a[1:] + a[:-1]) / 2
    for pace, bend in ((p[:-1], a[:-1]), (middle_p, middle_a), (p[1:], a[1:])):
        # velocity, acceleration and jerk over time at the line speed; the ratio is the velocity over it
        velocity, acceleration, jerk = to_speed * pace, to_acceleration * bend, to_jerk * u
        rows += [velocity <= limits.speed, velocity >= task.least_velocity]
        for way in (line.speeding, -line.braking):
            for share in (1.0, 0.0):
                rows.append(cvxpy.abs(share**2 * acceleration + velocity / v * way) <= limits.acceleration)
            rows.append(
                cvxpy.abs(jerk + 3 * acceleration / v * way) + cvxpy.abs(velocity) / v * line.known_jerk <= limits.jerk
            )
            rows.append(
                cvxpy.abs(3 * acceleration / v * way) + cvxpy.abs(velocity) / v * line.known_jerk <= limits.jerk
            )
        rows.append(cvxpy.abs(jerk) <= limits.jerk)
    if task.machine.guide is not None:
        low, high = ((each - task.slave_at_sync_end) / size for each in task.machine.guide)
        rows += [q >= low, q <= high]
    of = OBJECTIVES[of_motion(objective)]  # type: ignore[arg-type]
    measured, unit = (a, to_acceleration) if of.order == 2 else (u, to_jerk)
    if of.form == "peak":
        goal = cvxpy.norm_inf(measured)
    elif of.order == 2:
        goal = cvxpy.sum_squares((a[1:] + a[:-1]) / 2) * h + cvxpy.sum_squares(a[1:] - a[:-1]) * h / 12
    else:
        goal = cvxpy.sum_squares(u) * h
    problem = cvxpy.Problem(cvxpy.Minimize(goal), rows)
    try:
        problem.solve(solver=cvxpy.CLARABEL)
    except cvxpy.SolverError:
        return math.nan
    if problem.status in ("infeasible", "infeasible_inaccurate"):
        return math.inf
    if problem.status != "optimal":
        return math.nan
    value = float(problem.value) if of.form == "peak" else math.sqrt(max(0.0, float(problem.value)))
    zone = sync.peak(of.order) * v**of.order if of.form == "peak" else 0.0
    return max(value * unit, zone)


def exceeded(profile: CamProfile, task: Task) -> float:
    """Share by which the slave exceeds a limit while the line ramps: every phase, speed, direction and sign of the line's jerk."""
    line, limits = task.line, task.limits
    x = profile.start + np.arange(PHASES * 20) / (PHASES * 20) * profile.length
    ratio, bend, third = (profile(x, order) for order in (1, 2, 3))
    worst = 0.0
    for v in task.cut.line_speed * np.arange(1, SPEEDS + 1) / SPEEDS:
        for a in (line.speeding, -line.braking):
            acceleration = np.abs(bend * v**2 + ratio * a)
            jerk = np.abs(third * v**3 + 3 * bend * v * a) + np.abs(ratio) * line.known_jerk
            worst = max(worst, acceleration.max() / limits.acceleration, jerk.max() / limits.jerk)
    return worst - 1.0


def judged(task: Task, objective: str) -> dict[str, object]:
    """Design a job, and hold it against the programme."""
    began = process_time()
    row: dict[str, object] = {
        "machine": task.machine.kind,
        "objective": objective,
        "ramp": task.line.hardest,
        "fault": "",
    }
    name = of_motion(objective)  # type: ignore[arg-type]
    try:
        found = solve(task, name, suggest=False)
    except InfeasibleError as error:
        if not error.binding.startswith("line."):
            raise
        reached = programme(task, objective)
        row |= {"end": "infeasible", "cvxpy": reached, "seconds": process_time() - began}
        if math.isfinite(reached):
            row["fault"] = "refused, but cvxpy finds a motion"
        return row
    seconds = process_time() - began
    bound = lower_bound(found.profile, task, name).value
    reached = programme(task, objective)
    over = exceeded(found.profile, task)
    gap = 1.0 - bound / found.minimised
    row |= {"end": "designed", "value": found.minimised, "bound": bound, "gap": gap, "cvxpy": reached, "over": over}
    row |= {"seconds": seconds, "pieces": found.profile.pieces}
    if over > TOUCHED:
        row["fault"] = f"a limit is exceeded by {over:.2g}"
    elif math.isfinite(reached) and found.minimised > reached * (1 + WITHIN):
        row["fault"] = f"{found.minimised / reached - 1:.2g} above the programme"
    elif math.isfinite(reached) and bound > reached * (1 + WITHIN):
        row["fault"] = "the bound is above the programme"
    return row


def main() -> int:
    """Judge random jobs."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--designs", type=int, default=50)
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    rng = np.random.default_rng(arguments.seed)
    rows: list[dict[str, object]] = []
    while sum(row["end"] == "designed" for row in rows) < arguments.designs:
        kind = list(MACHINES)[len(rows) % len(MACHINES)]
        drawn = draw(rng, kind)
        if drawn is None:
            continue
        try:
            row = judged(*drawn)
        except InfeasibleError:
            continue
        rows.append({"job": len(rows) + 1, **row})
        print(
            ", ".join(
                f"{key} {value:.6g}" if isinstance(value, float) else f"{key} {value}"
                for key, value in rows[-1].items()
            ),
            flush=True,
        )
    RESULTS.mkdir(exist_ok=True)
    columns = [
        "job",
        "machine",
        "objective",
        "ramp",
        "end",
        "value",
        "bound",
        "gap",
        "cvxpy",
        "over",
        "pieces",
        "seconds",
        "fault",
    ]
    with (RESULTS / "line_ramps.csv").open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, columns, extrasaction="ignore", lineterminator="\n")
        writer.writeheader()
        writer.writerows(
            {key: f"{value:.6g}" if isinstance(value, float) else value for key, value in row.items()} for row in rows
        )
    gaps = [float(str(row["gap"])) for row in rows if row["end"] == "designed"]
    faults = sum(bool(row["fault"]) for row in rows)
    print(
        f"{len(gaps)} of {len(rows)} designed; greatest gap {max(gaps):.2g}, median {np.median(gaps):.2g}; {faults} faults"
    )
    return int(faults > 0)


if __name__ == "__main__":
    sys.exit(main())
