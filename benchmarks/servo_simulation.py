"""How much faster the lifted servo simulation is than a plain Python loop over its samples.

The loop is the model written out by hand in plain Python floats, sampling of the command included, with the same
sampling phases, the same memory and the same points between the samples. Before anything is timed the two must agree
in the axis and its velocity. Two sizes, a quintic return in both:

- ``paper_servo``: the one servo of the paper;
- ``validate``: the 18 simulations that one validation runs, the job's servo and the 17 of the published ranges.

The promised ratio is that of ``validate``, with the matrices of each servo at hand, as they are from its second profile
on; ``first_ratio`` is the ratio when they have to be made first. The times are the shortest processor times of several rounds, in which
loop and lifted simulation take turns. Prints one CSV row for each size below a heading:

    python benchmarks/servo_simulation.py
"""

from __future__ import annotations

import math
import sys
from bisect import bisect_right
from math import floor, inf
from time import process_time

import numpy as np

from camwright.profiles.cut import Cut
from camwright.profiles.limits import Limits
from camwright.profiles.machines import RotaryKnife
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.returns import baseline
from camwright.profiles.servo import Servo, sample_plant
from camwright.profiles.task import Task
from camwright.validation.servo.axis_run import ServoRun
from camwright.validation.servo.lifting import SUBSTEPS, lift
from camwright.validation.servo.simulation import lifted_cycle, memory, simulate
from camwright.validation.servo.sweep import sweep_servos

FREE = Limits(math.inf, math.inf, math.inf)
"""Nothing here asks for limits."""

AGREEMENT = 1e-14
"""Greatest difference of the axis (m) with which the two count as the same."""

VELOCITY_AGREEMENT = 1e-11
"""Greatest difference of the velocity (m/s): the position's, over the time between two points."""

LEAST_RATIO = 50.0
"""Ratio that the project promises."""

ROUNDS = 7
RUNS = 20
"""Lifted simulations in a round, each timed by itself."""

MACHINE = RotaryKnife(0.4)
CUT = Cut(0.6, 80 / 60, 0.2, 0.04, 0.16, 1e-4)
SERVO = Servo(120.0, 0.7, 35.0, 0.004, 1.0)


def sampled_commands(profile: CamProfile, servo: Servo, run: ServoRun) -> list[list[float]]:
    """Commands at the samples of every phase, memory first, by a plain loop over the samples."""
    breaks, rows = profile.breaks.tolist(), profile.coefficients.tolist()
    step, past, advance = CUT.line_speed * servo.sample_time, memory(servo), profile.advance
    samples = run.master.shape[1] // SUBSTEPS
    found = []
    for first in run.master[:, 0].tolist():
        commands = []
        for k in range(-past, samples):
            x = first + k * step
            turns = floor(x / CUT.length)
            x -= turns * CUT.length
            i = bisect_right(breaks, x, 1, len(rows)) - 1
            local, value = x - breaks[i], 0.0
            for c in reversed(rows[i]):
                value = value * local + c
            commands.append(value + turns * advance)
        found.append(commands)
    return found


def plain_loop(profile: CamProfile, servo: Servo, run: ServoRun) -> tuple[list[list[float]], list[list[float]]]:
    """Axis and velocity at the substeps of the last cycle of every phase, sample by sample."""
    past, gain, lead = memory(servo), servo.position_gain, servo.velocity_feedforward / servo.sample_time
    plants = [sample_plant(servo, servo.sample_time * s / SUBSTEPS) for s in range(SUBSTEPS)]
    between = [
        (
            *plant.transition[2, :2].tolist(),
            float(plant.input[2]),
            *plant.transition[1, :2].tolist(),
            float(plant.input[1]),
        )
        for plant in plants
    ]
    whole = sample_plant(servo, servo.sample_time)
    (a, b, _), (c, d, _), (e, f, _) = whole.transition.tolist()
    p, q, r = whole.input.tolist()
    axes, rates = [], []
    for row in sampled_commands(profile, servo, run):
        acceleration, velocity, position, before = 0.0, 0.0, row[0], row[0]
        axis, rate = [], []
        for k, command in enumerate(row):
            held = gain * (command - position) + lead * (command - before)
            before = command
            if k >= past:
                for g, h, i, gg, hh, ii in between:
                    axis.append(g * acceleration + h * velocity + position + i * held)
                    rate.append(gg * acceleration + hh * velocity + ii * held)
            acceleration, velocity, position = (
                a * acceleration + b * velocity + p * held,
                c * acceleration + d * velocity + q * held,
                e * acceleration + f * velocity + position + r * held,
            )
        axes.append(axis)
        rates.append(rate)
    return axes, rates


def compare(profile: CamProfile, servo: Servo) -> tuple[float, float]:
    """Greatest difference of axis (m) and velocity (m/s) between the two."""
    run = simulate(profile, CUT, servo)
    axis, rate = plain_loop(profile, servo, run)
    return (
        float(np.abs(np.array(axis) - run.axis).max()),
        float(np.abs(np.array(rate) - CUT.line_speed * run.axis_ratio).max()),
    )


def times(profile: CamProfile, servo: Servo) -> tuple[float, float, float]:
    """Shortest times of the lifted simulation, of its first run with a servo, and of the loop (s)."""
    run = simulate(profile, CUT, servo)
    lifted = first = loop = inf
    for _ in range(ROUNDS):
        start = process_time()
        plain_loop(profile, servo, run)
        loop = min(loop, process_time() - start)
        for _ in range(RUNS):
            start = process_time()
            simulate(profile, CUT, servo)
            lifted = min(lifted, process_time() - start)
        for _ in range(RUNS):
            memory.cache_clear()
            lift.cache_clear()
            lifted_cycle.cache_clear()
            start = process_time()
            simulate(profile, CUT, servo)
            first = min(first, process_time() - start)
    return lifted, first, loop


def main() -> int:
    """Check, measure, print; the exit code tells whether the promise is kept."""
    profile = baseline("poly_3_4_5", Task(MACHINE, CUT, FREE))
    sizes = {"paper_servo": (SERVO,), "validate": (SERVO, *sweep_servos(SERVO))}
    print(
        "benchmark,size,simulations,commands,points,difference_m,lifted_ms,first_ms,plain_loop_ms,ratio,first_ratio,promised"
    )
    ratio = 0.0
    for size, servos in sizes.items():
        differences = [compare(profile, servo) for servo in servos]
        axis, velocity = (max(column) for column in zip(*differences, strict=True))
        if not (axis <= AGREEMENT and velocity <= VELOCITY_AGREEMENT):
            print(
                f"{size}: axis differs by {axis:.3g} m, velocity by {velocity:.3g} m/s, more than rounding",
                file=sys.stderr,
            )
            return 1
        shapes = [simulate(profile, CUT, servo).master.shape for servo in servos]
        points = sum(rows * columns for rows, columns in shapes)
        commands = sum(
            rows * (memory(servo) + columns // SUBSTEPS) for servo, (rows, columns) in zip(servos, shapes, strict=True)
        )
        lifted, first, loop = (sum(column) for column in zip(*(times(profile, servo) for servo in servos), strict=True))
        ratio = loop / lifted
        print(
            f"servo_simulation,{size},{len(servos)},{commands},{points},{axis:.1e},{1e3 * lifted:.3f},"
            f"{1e3 * first:.3f},{1e3 * loop:.1f},{ratio:.1f},{loop / first:.1f},{LEAST_RATIO:g}"
        )
    return 0 if ratio >= LEAST_RATIO else 1


if __name__ == "__main__":
    sys.exit(main())
