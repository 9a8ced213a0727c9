"""How much faster the lifted servo simulation is than a plain Python loop over its samples.

All simulate the paper's servo on a quintic return, every sampling phase, with the same memory and the same points
between the samples; before anything is timed they must agree. Two loops do the whole job, sampling of the command
included:

- the model as its equations stand, a 3 by 3 matrix and a vector for each step; the promised ratio is that to this loop;
- the same written out by hand in floats, the fastest that plain Python can do; its ratio is printed beside it.

Prints one CSV row below its heading:

    python benchmarks/servo_simulation.py
"""

from __future__ import annotations

import sys
from bisect import bisect_right
from collections.abc import Callable
from math import floor
from time import perf_counter

import numpy as np

from profiles.cycle import Cut
from profiles.machines import RotaryKnife
from profiles.polynomial import CamProfile
from profiles.returns import baseline
from profiles.servo import Servo, sample_plant
from validation.simulation import SUBSTEPS, ServoRun, memory, simulate

AGREEMENT = 1e-11
"""Greatest difference of the axis (m) with which the two count as the same."""

LEAST_RATIO = 50.0
"""Ratio that the project promises."""

ROUNDS = 7

MACHINE = RotaryKnife(0.4)
CUT = Cut(0.6, 80 / 60, 0.2, 0.04, 0.16, 1e-4)
SERVO = Servo(120.0, 0.7, 35.0, 0.004, 1.0)


def sampled_commands(profile: CamProfile, run: ServoRun) -> list[list[float]]:
    """Commands at the samples of every phase, memory first, by a plain loop over the samples."""
    breaks, rows = profile.breaks.tolist(), profile.coefficients.tolist()
    step, past, advance = CUT.line_speed * SERVO.sample_time, memory(SERVO), profile.advance
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


def loop_of_matrices(commands: list[list[float]]) -> list[list[float]]:
    """Axis at the substeps of the last cycle of every phase: the equations of the model, sample by sample."""
    past, gain, lead = memory(SERVO), SERVO.position_gain, SERVO.velocity_feedforward / SERVO.sample_time
    plants = [sample_plant(SERVO, SERVO.sample_time * s / SUBSTEPS) for s in range(SUBSTEPS)]
    whole = sample_plant(SERVO, SERVO.sample_time)
    axes = []
    for row in commands:
        state, before, axis = np.array([0.0, 0.0, row[0]]), row[0], []
        for k, command in enumerate(row):
            held = gain * (command - state[2]) + lead * (command - before)
            before = command
            if k >= past:
                for plant in plants:
                    inner = plant.transition @ state + plant.input * held
                    axis.append(float(inner[2]))
            state = whole.transition @ state + whole.input * held
        axes.append(axis)
    return axes


def loop_of_floats(commands: list[list[float]]) -> list[list[float]]:
    """Do the same written out in plain Python floats; axis and velocity, as the lifted simulation gives both."""
    past, gain, lead = memory(SERVO), SERVO.position_gain, SERVO.velocity_feedforward / SERVO.sample_time
    plants = [sample_plant(SERVO, SERVO.sample_time * s / SUBSTEPS) for s in range(SUBSTEPS)]
    between = [(*plant.transition[2].tolist(), float(plant.input[2])) for plant in plants]
    speed = [(*plant.transition[1].tolist(), float(plant.input[1])) for plant in plants]
    whole = sample_plant(SERVO, SERVO.sample_time)
    (a, b, _), (c, d, _), (e, f, _) = whole.transition.tolist()
    p, q, r = whole.input.tolist()
    axes = []
    for row in commands:
        acceleration, velocity, position, before = 0.0, 0.0, row[0], row[0]
        axis, rate = [], []
        for k, command in enumerate(row):
            held = gain * (command - position) + lead * (command - before)
            before = command
            if k >= past:
                for (i, j, g, h), (ii, jj, _, hh) in zip(between, speed, strict=True):
                    axis.append(i * acceleration + j * velocity + g * position + h * held)
                    rate.append(ii * acceleration + jj * velocity + hh * held)
            acceleration, velocity, position = (
                a * acceleration + b * velocity + p * held,
                c * acceleration + d * velocity + q * held,
                e * acceleration + f * velocity + position + r * held,
            )
        axes.append(axis)
    return axes


def least_time(work: Callable[[], object]) -> float:
    """Shortest of `ROUNDS` runs (s)."""
    times = []
    for _ in range(ROUNDS):
        start = perf_counter()
        work()
        times.append(perf_counter() - start)
    return min(times)


def main() -> int:
    """Check, measure, print; the exit code tells whether the promise is kept."""
    profile = baseline("poly_3_4_5", MACHINE, CUT)
    run = simulate(profile, CUT, SERVO)
    commands = sampled_commands(profile, run)
    difference = max(
        float(np.abs(np.array(loop(commands)) - run.axis).max()) for loop in (loop_of_matrices, loop_of_floats)
    )
    if not difference <= AGREEMENT:
        print(f"the simulations differ by {difference:.3g} m, more than {AGREEMENT:g} m", file=sys.stderr)
        return 1
    fast = least_time(lambda: [simulate(profile, CUT, SERVO) for _ in range(20)]) / 20
    matrices = least_time(lambda: loop_of_matrices(sampled_commands(profile, run)))
    floats = least_time(lambda: loop_of_floats(sampled_commands(profile, run)))
    print(
        "benchmark,phases,samples,difference_m,lifted_ms,matrix_loop_ms,float_loop_ms,ratio,ratio_float_loop,promised"
    )
    print(
        f"servo_simulation,{run.phases},{len(commands[0])},{difference:.1e},{1e3 * fast:.3f},{1e3 * matrices:.1f},"
        f"{1e3 * floats:.1f},{matrices / fast:.1f},{floats / fast:.1f},{LEAST_RATIO:g}"
    )
    return 0 if matrices / fast >= LEAST_RATIO else 1


if __name__ == "__main__":
    sys.exit(main())
