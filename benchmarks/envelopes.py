"""Random envelopes against designs: what is drawn as possible must design, what lies a percent beyond must not.

``python benchmarks/envelopes.py [COUNT]``: paper-like knives and flying saws in turn, with random cuts, limits and servos (100 unless
said). For each, points 1 % inside and 1 % beyond both edges are designed: inside the perfect axis' edge
a motion exists, inside the other every check passes too.
"""

from __future__ import annotations

import math
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np

from camwright import load_job
from camwright.jobs.job import Job
from camwright.profiles.errors import CamwrightError
from camwright.profiles.machines import RotaryKnife
from camwright.studies.envelope import Edge, envelope_answer
from camwright.studies.reach import stand_in, verdict

RESULTS = Path(__file__).parent / "results" / "envelopes.csv"
SAW = Path(__file__).parents[1] / "examples" / "flying-saw.toml"

SEED, LENGTHS, TRIED = 7, 7, 12
"""Seed of the jobs, cut lengths of a map, and places tried on each edge."""

ASIDE = 0.01
"""Share of the line speed inside and beyond an edge."""


def drawn_knife(job: Job, random: np.random.Generator) -> Job:
    """Draw a job of a knife."""
    pitch = random.uniform(0.3, 0.8)
    cut = replace(
        job.cut,
        length=pitch * random.uniform(0.85, 2.0),
        line_speed=random.uniform(0.5, 1.2),
        sync_zone=0.4 * pitch,
        shear_zone=0.08 * pitch,
        shear_zone_at=0.32 * pitch,
        sync_tolerance=float(random.choice((1e-4, 3e-4, 1e-3))),
    )
    limits = replace(job.limits, acceleration=random.uniform(20.0, 80.0), jerk=random.uniform(2e3, 2e4))
    servo = replace(
        job.servo, position_gain=random.uniform(20.0, 45.0), sample_time=float(random.choice((1e-3, 2e-3, 4e-3)))
    )
    return replace(job, machine=RotaryKnife(pitch), cut=cut, limits=limits, servo=servo)


def drawn_saw(job: Job, random: np.random.Generator) -> Job:
    """Draw a job of a flying saw: stroke and sync zone are the example's."""
    cut = replace(
        job.cut,
        length=job.cut.length * random.uniform(0.7, 1.5),
        line_speed=job.cut.line_speed * random.uniform(0.6, 1.3),
        sync_tolerance=job.cut.sync_tolerance * float(random.choice((0.1, 0.3, 1.0))),
    )
    limits = replace(
        job.limits,
        acceleration=job.limits.acceleration * random.uniform(0.5, 3.0),
        jerk=job.limits.jerk * random.uniform(0.5, 3.0),
    )
    return replace(job, cut=cut, limits=limits, servo=replace(job.servo, position_gain=random.uniform(15.0, 45.0)))


def wrong(job: Job, edge: Edge, random: np.random.Generator, *, checked: bool) -> tuple[int, int]:
    """Count the places beside an edge that are drawn wrongly, and those that were tried."""
    found = tried = 0
    for _ in range(TRIED):
        at = int(random.integers(len(edge) - 1))
        (left, low), (right, high) = edge[at], edge[at + 1]
        if math.isnan(low + high) or left == right:  # where there is none, and where it jumps
            continue
        part = random.random()
        length, speed = left + part * (right - left), low + part * (high - low)
        for factor, possible in ((1 - ASIDE, True), (1 + ASIDE, False)):
            task = job.task.with_length(length).at_speed(factor * speed)
            failed, _ = verdict(job, task, stand_in(job))
            limit = failed in ("speed", "acceleration", "jerk", "reversal", "stroke", "sync_zone", "design")
            tried += 1
            if (not failed if checked else not limit) != possible:
                found += 1
                print(
                    f"wrong: {length!r} m at {factor!r} of {speed!r} m/s: {failed or 'passes'}; {job}", file=sys.stderr
                )
    return found, tried


def main() -> int:
    """Print what was tried and what was wrong; the rows are written after each envelope."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 100
    random = np.random.default_rng(SEED)
    drawers = ((drawn_knife, load_job()), (drawn_saw, load_job(SAW)))
    totals = {"perfect axis": [0, 0], "axis in tolerance": [0, 0]}
    began = time.process_time()
    for number in range(1, count + 1):
        draw, base = drawers[number % len(drawers)]
        job = draw(base, random)
        try:
            answer = envelope_answer(job, LENGTHS)
        except CamwrightError as error:
            print("skipped:", error)
            continue
        for name, edge, checked in (
            ("perfect axis", answer.perfect, False),
            ("axis in tolerance", answer.within, True),
        ):
            for total, more in enumerate(wrong(job, edge, random, checked=checked)):
                totals[name][total] += more
        written(totals, number, (time.process_time() - began) / number)
    for name, (bad, tried) in totals.items():
        print(f"{name}: {bad} of {tried} places wrong")
    return 1 if any(bad for bad, _ in totals.values()) else 0


def written(totals: dict[str, list[int]], envelopes: int, seconds: float) -> None:
    """Write what was found so far."""
    rows = [f"{name},{envelopes},{SEED},{tried},{bad},{seconds:.1f}" for name, (bad, tried) in totals.items()]
    RESULTS.write_text("\n".join(["edge,envelopes,seed,places,wrong,processor_s_an_envelope", *rows]) + "\n")


if __name__ == "__main__":
    sys.exit(main())
