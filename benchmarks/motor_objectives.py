"""Least torque and energy beside a reference of this benchmark's own, on random jobs of every machine; and their lower bounds.

The reference is a plain nonlinear programme: even pieces of constant jerk, finer towards the ends, torque by the trapezium of its nodes and
middles, friction smoothed, IPOPT from the quintic bent by random waves, for an open place on the crank from random places. What it
finds counts with its torque measured exactly, and only where it keeps the limits. Writes a row a job to ``results/motor_objectives.csv``;
the exit code is 0 if no job is more than 0.5 % above the reference, no bound above any motion, and none ended in an error:

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
from time import process_time
from typing import Any, get_args

import casadi as ca
import numpy as np
from random_machines import MACHINES, RandomJob, placed, random_job, spread

from camwright.design.feasible.feasibility import is_feasible
from camwright.design.optimise import solve
from camwright.profiles.errors import CamwrightError, InfeasibleError
from camwright.profiles.objective import MotorObjective
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.returns import assemble, quintic_between
from camwright.profiles.task import Task
from camwright.validation.bounds.optimality import lower_bound
from camwright.validation.motor import greatest_load, measure_motor

RESULTS = Path(__file__).parent / "results"
ALLOWED = 5e-3
NODES = 100
WITHIN = 1e-6


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


def reference(task: Task, objective: MotorObjective, rng: np.random.Generator, starts: int) -> float:
    """Least value of the programme's answers that keep all limits, at the motor; infinite if none does."""
    best = math.inf
    for number in range(starts):
        there = task
        if not task.machine.placed:
            low, high = task.machine.place_range(task.cut)
            there = task.placed_at(low + (high - low) * float(rng.uniform(0.02, 0.98)))
        cycle = one_start(there, objective, rng, number)
        if cycle is not None and keeps(cycle, there):
            best = min(best, float(getattr(measure_motor(cycle, there), objective)))
    return best


def one_start(task: Task, objective: MotorObjective, rng: np.random.Generator, number: int) -> CamProfile | None:
    """Solve from one start; the cycle."""
    machine, cut, v = task.machine, task.cut, task.cut.line_speed
    length = cut.return_zone
    x = 0.5 * length * (1 - np.cos(np.pi * np.linspace(0, 1, NODES + 1))) * 0.9 + 0.1 * length * np.linspace(
        0, 1, NODES + 1
    )
    x[-1] = length
    h = np.diff(x)
    quintic = quintic_between(task.sync, length, task.height)
    size = max(abs(task.height), 0.1 * quintic.extrema(0)[1].value)
    wave = sum((rng.normal(0, 0.15 * size / k) * np.sin(k * np.pi * x / length) for k in range(1, 5)), np.zeros(len(x)))
    y0 = quintic(x) + (wave if number else 0.0)
    v0 = np.gradient(y0, x)
    a0 = np.gradient(v0, x)
    unit = [max(abs(y0).max(), 1e-12), max(abs(v0).max(), 1e-12), max(abs(a0).max(), 1e-12)]
    y, u, a = (ca.MX.sym(name, NODES + 1) for name in "yua")
    t, drawn = ca.MX.sym("t"), ca.MX.sym("d", 2 * NODES + 1 if objective == "energy" else 0)
    yy, uu, aa = y * unit[0], u * unit[1], a * unit[2]
    step = ca.DM(h)
    rules = [
        (uu[:-1] + step * (aa[:-1] + aa[1:]) / 2 - uu[1:]) / unit[1],
        (yy[:-1] + step * uu[:-1] + step**2 * (aa[:-1] / 3 + aa[1:] / 6) - yy[1:]) / unit[0],
    ]
    jerk = (aa[1:] - aa[:-1]) / step / task.greatest_jerk
    half_u = uu[:-1] + step / 2 * (0.75 * aa[:-1] + 0.25 * aa[1:])
    half_y = yy[:-1] + step / 2 * uu[:-1] + (step / 2) ** 2 * (aa[:-1] * 5 / 12 + aa[1:] / 12)
    at = ca.vertcat(yy, half_y), ca.vertcat(uu, half_u), ca.vertcat(aa, (aa[:-1] + aa[1:]) / 2)
    weight = np.concatenate([np.append(h, 0) / 6 + np.append(0, h) / 6, h * 2 / 3])
    one, two, three = (ca.SX.sym(name) for name in "abc")
    force = machine.inertia(one) * v**2 * three + machine.inertia_slope(one) * (v * two) ** 2 / 2
    if machine.friction:
        force += machine.friction * ca.tanh(two / (0.01 * unit[1]))
    torque = (
        ca.Function("f", [one, two, three], [force])
        .map(2 * NODES + 1)((at[0] + task.slave_at_sync_end).T, at[1].T, at[2].T)
        .T
    )
    scale = float(machine.inertia(task.slave_at_sync_end)) * v**2 * unit[2] + machine.friction
    extra: list[Any] = []
    if objective == "rms_torque":
        cost = ca.dot(ca.DM(weight), (torque / scale) ** 2) / length
    elif objective == "peak_torque":
        cost, extra = t, [t - torque / scale, t + torque / scale]
    else:
        cost, extra = ca.dot(ca.DM(weight), drawn) / length, [drawn - torque * at[1] / (scale * unit[1])]
    w = ca.vertcat(y, u, a, t, drawn)
    g = ca.vertcat(*rules, jerk, *extra)
    solver = ca.nlpsol(
        "reference",
        "ipopt",
        {"x": w, "f": cost, "g": g},
        {"print_time": False, "ipopt.print_level": 0, "ipopt.sb": "yes", "ipopt.max_iter": 300},
    )
    low = [np.full(NODES + 1, -np.inf), np.full(NODES + 1, task.least_ratio), np.full(NODES + 1, -task.greatest_slope)]
    high = [
        np.full(NODES + 1, np.inf),
        np.full(NODES + 1, task.greatest_ratio),
        np.full(NODES + 1, task.greatest_slope),
    ]
    if machine.guide is not None:
        low[0][:] = machine.guide[0] - task.slave_at_sync_end
        high[0][:] = machine.guide[1] - task.slave_at_sync_end
    for part, order in ((0, 0), (1, 1), (2, 2)):
        low[part][0] = high[part][0] = float(quintic(0.0, order))
        low[part][-1] = high[part][-1] = float(quintic(length, order))
    tail = w.numel() - 3 * (NODES + 1)
    count = sum(each.numel() for each in extra)
    lower = np.concatenate(
        [
            *(part / each for part, each in zip(low, unit, strict=True)),
            np.zeros(tail),
        ]
    )
    upper = np.concatenate([*(part / each for part, each in zip(high, unit, strict=True)), np.full(tail, np.inf)])
    try:
        answer = solver(
            x0=np.concatenate([y0 / unit[0], v0 / unit[1], a0 / unit[2], np.ones(tail)]),
            lbx=lower,
            ubx=upper,
            lbg=np.concatenate([np.zeros(2 * NODES), np.full(NODES, -1.0), np.zeros(count)]),
            ubg=np.concatenate([np.zeros(2 * NODES), np.full(NODES, 1.0), np.full(count, np.inf)]),
        )
    except RuntimeError:
        return None
    if not solver.stats()["success"]:
        return None
    found = np.asarray(answer["x"]).ravel()
    a = found[2 * (NODES + 1) : 3 * (NODES + 1)] * unit[2]
    rows, place, pace = [], 0.0, float(quintic(0.0, 1))
    for width, first, last in zip(h, a[:-1], a[1:], strict=True):
        rows.append([place, pace, first / 2, (last - first) / (6 * width)])
        place += width * (pace + width * (first / 3 + last / 6))
        pace += width * (first + last) / 2
    return assemble(CamProfile.from_arrays(np.append(x[:-1], length), rows), task)


def keeps(cycle: CamProfile, task: Task) -> bool:
    """Whether a cycle keeps its limits, to `WITHIN`."""
    least, greatest = cycle.extrema(1)
    inside = (
        greatest.value <= task.greatest_ratio * (1 + WITHIN)
        and least.value >= task.least_ratio - WITHIN * task.greatest_ratio
    )
    for order, limit in ((2, task.greatest_slope), (3, task.greatest_jerk)):
        inside &= max(abs(each.value) for each in cycle.extrema(order)) <= limit * (1 + WITHIN)
    if task.machine.guide is not None:
        low, high = (each.value + task.slave_at_start for each in cycle.extrema(0))
        inside &= low >= task.machine.guide[0] - WITHIN and high <= task.machine.guide[1] + WITHIN
    if task.limits.motor is not None:
        torque, available = greatest_load(cycle, task, task.limits.motor)
        inside &= torque.value <= available * (1 + WITHIN)
    return bool(inside)


def judged(job: RandomJob, rng: np.random.Generator, starts: int) -> dict[str, object]:
    """Design a job, bound it, and hold it beside the reference."""
    begun = process_time()
    row: dict[str, object] = {"objective": job.objective}
    try:
        solution = solve(job.task, job.objective)
        there = job.task.with_machine(solution.machine)
        value = float(getattr(measure_motor(solution.profile, there), job.objective))
        row |= {"value": value, "seconds": round(process_time() - begun, 2)}
        begun = process_time()
        bound = lower_bound(solution.profile, there, job.objective)
        row |= {"bound": bound.value, "method": bound.method, "bound_seconds": round(process_time() - begun, 2)}
    except InfeasibleError:
        return row | {"end": "infeasible"}
    except CamwrightError as error:
        return row | {"end": f"error: {error}"}
    other = reference(job.task, job.objective, rng, starts)
    row |= {"reference": other, "above": value / other - 1.0 if other > 0 else 0.0}
    lowest = value if not job.machine.placed else min(value, other)  # a bound is that of the place chosen
    wrong = bound.value > lowest * (1 + WITHIN)
    return row | {
        "end": "bound above a motion" if wrong else "above the reference" if value > other * (1 + ALLOWED) else "good"
    }


def main() -> int:
    """Run the jobs."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--jobs", type=int, default=100)
    parser.add_argument("--starts", type=int, default=40)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--machine", choices=list(MACHINES))
    options = parser.parse_args()
    rows: list[dict[str, object]] = []
    for kind in [options.machine] if options.machine else list(MACHINES):
        for objective in get_args(MotorObjective):
            rng = np.random.default_rng(options.seed)
            for number, job in enumerate(jobs(rng, kind, objective, options.jobs)):
                rows.append({"machine": kind, "number": number} | judged(job, rng, options.starts))
                if rows[-1]["end"] not in ("good", "infeasible"):
                    print(kind, number, rows[-1], placed(job.machine, job.cut), job.cut, job.limits, flush=True)
    names = list(dict.fromkeys(name for row in rows for name in row))
    with (RESULTS / "motor_objectives.csv").open("w", newline="") as file:
        writer = csv.DictWriter(file, names)
        writer.writeheader()
        writer.writerows(rows)
    done = [row for row in rows if "above" in row]
    gaps = [
        1 - float(str(row["bound"])) / float(str(row["value"]))
        for row in done
        if row["bound"] == row["bound"] and row["value"]
    ]
    bad = [row for row in rows if row["end"] not in ("good", "infeasible")]
    print(f"{len(rows)} jobs, {len(done)} designed, {len(bad)} not as they should be")
    if gaps:
        print(
            f"gaps: median {np.median(gaps):.2%}, nine in ten below {np.quantile(gaps, 0.9):.2%}, {len(done) - len(gaps)} without a bound"
        )
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
