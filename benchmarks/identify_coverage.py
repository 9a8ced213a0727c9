"""How often the 95 % intervals of ``identify`` hold the truth, over simulated recordings.

Servos are drawn from the published ranges, with a dead time of up to 5 ms. Each follows a cam (the bundled job's cut with one of several
returns) or a sweep; it is simulated by a plain loop over its samples, its clock anywhere, recorded at 1 kHz for 2 s. The noise is
normal, the rounding of counts, or both. The velocity feed-forward is given, but to every fifth. A recording that is refused has no
interval and is counted.

Prints one CSV row for each recording and parameter, and at the end how many intervals hold the truth:

    python benchmarks/identify_coverage.py --traces 300 --jobs 2
"""

from __future__ import annotations

import argparse
import csv
import math
import sys
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from camwright.profiles.cut import Cut
from camwright.profiles.errors import InputError
from camwright.profiles.limits import Limits
from camwright.profiles.machines import RotaryKnife
from camwright.profiles.returns import baseline
from camwright.profiles.servo import PAPER_RANGES, Servo, sample_plant
from camwright.profiles.task import Task
from camwright.profiles.trace import Trace
from camwright.validation.identify.identification import identify

FREE = Limits(math.inf, math.inf, math.inf)
"""Nothing here asks for limits."""

CUT = Cut(0.6, 80 / 60, 0.2, 0.04, 0.16, 1e-4)
LAWS = ("poly_3_4_5", "linear_return", "modified_sine", "cycloid")
STEP, ROWS = 1e-3, 2000
PROMISED = (0.94, 0.97)
"""Share of the intervals that hold the truth."""

RESULTS = Path(__file__).parent / "results" / "identify_coverage.csv"
HEADING = (
    "seed",
    "motion",
    "noise_um",
    "count_um",
    "given",
    "parameter",
    "truth",
    "value",
    "low",
    "high",
    "held",
    "refused",
)
Command = Callable[[np.ndarray], np.ndarray]


@dataclass(frozen=True)
class Recording:
    """A recording to be made: the servo, its motion by name, its noise (rms) and the count to which positions are rounded (m)."""

    seed: int
    servo: Servo
    motion: str
    noise: float
    count: float
    given: bool


def recordings(number: int) -> Iterator[Recording]:
    """Draw the recordings, each by a seed of its own: cams, and every fourth a sweep."""
    for seed in range(number):
        random = np.random.default_rng(seed)
        loop = {name: float(random.uniform(*span)) for name, span in PAPER_RANGES.items()}
        servo = Servo(**loop, velocity_feedforward=1.0, dead_time=float(random.uniform(0.0, 5e-3)))
        motion = "sweep" if seed % 4 == 3 else LAWS[seed // 4 % len(LAWS)]
        noise = float(10 ** random.uniform(-5.5, -4.0))
        count = float(random.choice([0.0, 1e-6, 1e-5]))
        yield Recording(seed, servo, motion, noise if random.random() < 0.8 or not count else 0.0, count, seed % 5 != 2)


def command_of(motion: str, last: float, begun: float) -> Command:
    """Give the command over time (s): a cam of the bundled job's cut, its cycle begun before, or a sine up to a last frequency in 2 s."""
    if motion == "sweep":
        return lambda time: np.where(time > 0, 0.02 * np.sin(2 * np.pi * (0.5 + (last - 0.5) * time / 4.0) * time), 0.0)
    cycle = baseline(motion, Task(RotaryKnife(0.4), CUT, FREE))
    return lambda time: np.asarray(cycle((time + begun) * CUT.line_speed, outside="repeat"))


def recorded(what: Recording) -> Trace:
    """Run the servo by a plain loop over its samples, from a second before the recording."""
    servo, random = what.servo, np.random.default_rng(100_000 + what.seed)
    last, begun, zero = random.uniform(8.0, 20.0), random.uniform(0.0, CUT.length / CUT.line_speed), random.random()
    command = command_of(what.motion, last, begun)
    clock = -1.0 - servo.sample_time * random.random()
    whole = sample_plant(servo, servo.sample_time)
    times = STEP * np.arange(ROWS)
    starts = clock + servo.sample_time * np.arange(math.ceil((times[-1] - clock) / servo.sample_time) + 1)
    seen = command(np.concatenate([starts[:1], starts]) - servo.delay)
    state, row, actual = np.array([0.0, 0.0, seen[0]]), 0, np.empty(ROWS)
    for k, start in enumerate(starts.tolist()):
        now, before = seen[k + 1], seen[k]
        held = servo.position_gain * (now - state[2]) + servo.velocity_feedforward * (now - before) / servo.sample_time
        while row < ROWS and times[row] < start + servo.sample_time:
            plant = sample_plant(servo, times[row] - start)
            actual[row] = plant.transition[2] @ state + plant.input[2] * held
            row += 1
        state = whole.transition @ state + whole.input * held
    actual = actual + random.normal(0.0, what.noise, ROWS) if what.noise else actual
    given = command(times)
    if what.count:
        actual, given = (np.round(signal / what.count + zero) * what.count for signal in (actual, given))
    return Trace(0.0, STEP, given, actual, "m")


def rows_of(what: Recording) -> list[tuple[object, ...]]:
    """Identify one recording."""
    head = (what.seed, what.motion, f"{what.noise * 1e6:.3g}", f"{what.count * 1e6:g}", int(what.given))
    try:
        found = identify(recorded(what), "trace", 1.0 if what.given else None)
    except InputError as error:
        return [(*head, "", "", "", "", "", "", str(error).splitlines()[0][:160])]
    rows: list[tuple[object, ...]] = []
    for name, (low, high) in found.confidence.items():
        truth, value = getattr(what.servo, name), getattr(found.servo, name)
        rows.append(
            (*head, name, *(f"{each:.7g}" for each in (truth, value, low, high)), int(low <= truth <= high), "")
        )
    return rows


def main() -> int:
    """Identify all, print; the exit code tells whether the promise is kept."""
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("--traces", type=int, default=300)
    options.add_argument("--jobs", type=int, default=1)
    options.add_argument("--write", action="store_true", help=f"write the rows to {RESULTS.name}")
    asked = options.parse_args()
    todo = list(recordings(asked.traces))
    table = csv.writer(sys.stdout, lineterminator="\n")
    table.writerow(HEADING)
    rows: list[tuple[object, ...]] = []
    with ProcessPoolExecutor(asked.jobs) as pool:
        for each in pool.map(rows_of, todo):
            rows += each
            table.writerows(each)
            sys.stdout.flush()
    if asked.write:
        with RESULTS.open("w", encoding="utf-8", newline="") as file:
            csv.writer(file, lineterminator="\n").writerows([HEADING, *rows])
    held = [(row[5], row[1] == "sweep", bool(row[10])) for row in rows if row[5]]
    for kind, sweep in (("cams", False), ("sweeps", True)):
        for name in dict.fromkeys(each[0] for each in held):
            of = [each[2] for each in held if each[0] == name and each[1] == sweep]
            if of:
                print(f"{kind}: {name} {sum(of)}/{len(of)} = {sum(of) / len(of):.3f}", file=sys.stderr)
    share = sum(each[2] for each in held) / len(held)
    refused = sum(1 for row in rows if not row[5])
    print(f"all: {share:.4f} of {len(held)} intervals, {refused} of {len(todo)} refused", file=sys.stderr)
    return 0 if PROMISED[0] <= share <= PROMISED[1] else 1


if __name__ == "__main__":
    sys.exit(main())
