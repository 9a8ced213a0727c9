"""How long the servo simulation of 10 000 servos takes.

Servos are drawn from ranges about the paper's servo; every one is simulated at all sampling phases and between the samples, and its
greatest sync error in the shear zone kept. Before anything is timed the errors of the first servos must be those of the simulation of
each by itself. Two ranges, a quintic return in both:

- ``loop``: velocity loop and position gain; all servos sample alike, so one set of command values serves all;
- ``all``: sample time and dead time too.

The time is the shortest processor time of several rounds, in one process. Prints one CSV row for each below a heading:

    python benchmarks/monte_carlo.py
"""

from __future__ import annotations

import math
import sys
from time import process_time

import numpy as np

from camwright.profiles.cut import Cut
from camwright.profiles.limits import Limits
from camwright.profiles.machines import RotaryKnife
from camwright.profiles.returns import baseline
from camwright.profiles.servo import Servo
from camwright.profiles.servo_tolerance import ServoTolerance
from camwright.profiles.task import Task
from camwright.validation.servo.monte_carlo import shear_zone_errors
from camwright.validation.servo.response import servo_response

FREE = Limits(math.inf, math.inf, math.inf)
"""Nothing here asks for limits."""

DRAWS = 10_000
ALONE = 20
"""Servos that are simulated by themselves too."""

AGREEMENT = 1e-9
"""Greatest difference of the errors (m) with which the two count as the same."""

MOST = 5.0
"""Time that the project promises to stay below (s)."""

ROUNDS = 3
MACHINE = RotaryKnife(0.4)
CUT = Cut(0.6, 80 / 60, 0.2, 0.04, 0.16, 1e-4)
SERVO = Servo(120.0, 0.7, 35.0, 0.004, 1.0)
LOOP = ServoTolerance((108.0, 132.0), (0.63, 0.77), (33.25, 36.75), (0.004, 0.004), (0.0, 0.0))
RANGES = {
    "loop": LOOP,
    "all": ServoTolerance(LOOP.bandwidth, LOOP.damping, LOOP.position_gain, (0.0038, 0.0042), (0.0, 0.002)),
}


def main() -> int:
    """Check, measure, print; the exit code tells whether the promise is kept."""
    profile = baseline("poly_3_4_5", Task(MACHINE, CUT, FREE))
    print("benchmark,ranges,draws,difference_m,worst_mm,seconds,promised")
    kept = True
    for name, ranges in RANGES.items():
        servos = ranges.draw(SERVO, DRAWS, seed=1)
        found = shear_zone_errors(profile, Task(MACHINE, CUT, FREE), servos[:ALONE])
        alone = [servo_response(profile, Task(MACHINE, CUT, FREE), servo).shear_zone_error for servo in servos[:ALONE]]
        difference = float(np.abs(found - alone).max())
        if not difference <= AGREEMENT:
            print(f"{name}: the errors differ by {difference:.3g} m", file=sys.stderr)
            return 1
        times = []
        for _ in range(ROUNDS):
            start = process_time()
            worst = float(shear_zone_errors(profile, Task(MACHINE, CUT, FREE), servos).max())
            times.append(process_time() - start)
        kept = kept and min(times) < MOST
        print(f"monte_carlo,{name},{DRAWS},{difference:.1e},{1e3 * worst:.4f},{min(times):.2f},{MOST:g}")
    return 0 if kept else 1


if __name__ == "__main__":
    sys.exit(main())
