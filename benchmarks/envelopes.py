"""Random envelopes against designs: what is drawn as possible must design, what lies a percent beyond must not.

``python benchmarks/envelopes.py [COUNT [KIND]]``: envelopes of all machines in turn, or of one kind, with random cuts, limits and servos
(100 unless said): knives in tangential and in horizontal sync, saws, punches whose zones last a time, cranks whose place is given and
cranks that leave it open, servo-aware knives, and knives whose line ramps. An open place is where the line can run fastest, as the
envelope says. For each, points 1 % inside and 1 % beyond both edges are designed: inside the perfect axis' edge a motion exists, inside
the other every check passes too. Rows are written where all kinds are tried.
"""

from __future__ import annotations

import math
import sys
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from camwright import load_job
from camwright.design.feasible.extremes import placed_fastest
from camwright.jobs.job import Job
from camwright.profiles.errors import CamwrightError
from camwright.profiles.line import STEADY
from camwright.profiles.machines import CrankSlider, RotaryKnife
from camwright.studies.envelope import Edge, EnvelopeAnswer, envelope_answer
from camwright.studies.reach import named, stand_in, verdict

RESULTS = Path(__file__).parent / "results" / "envelopes.csv"
EXAMPLES = Path(__file__).parents[1] / "examples"

SEED, LENGTHS, TRIED = 7, 7, 12
"""Seed of the jobs, cut lengths of a map, and places tried on each edge."""

TRIED_SERVO_AWARE = 3
"""Places tried on an edge of a servo-aware job, whose every one is a design of a second."""

ASIDE = 0.01
"""Share of the line speed inside and beyond an edge."""

ROUNDS = 3
"""Rounds of the quick kinds to one of the slow ones."""

SLOW = ("free crank", "servo-aware knife", "ramping knife")
"""Kinds whose envelope takes ten seconds and more."""

LIMITS = ("speed", "acceleration", "jerk", "reversal", "stroke", "sync_zone", "design")
"""What fails beyond the perfect axis' edge."""


def bent(job: Job, random: np.random.Generator, low: float, high: float) -> Job:
    """Draw what every job has anew: line speed, tolerance, limits and the servo's gain, between shares of its own."""
    cut = replace(
        job.cut,
        line_speed=job.cut.line_speed * random.uniform(0.6, 1.3),
        sync_tolerance=job.cut.sync_tolerance * float(random.choice((0.3, 1.0, 3.0))),
    )
    limits = replace(
        job.limits,
        acceleration=job.limits.acceleration * random.uniform(low, high),
        jerk=job.limits.jerk * random.uniform(low, high),
    )
    servo = replace(job.servo, position_gain=job.servo.position_gain * random.uniform(0.5, 1.2))
    return replace(job, cut=cut, limits=limits, servo=servo)


def lengthened(job: Job, random: np.random.Generator, low: float, high: float) -> Job:
    """Draw the cut length between shares of the job's."""
    return replace(job, cut=replace(job.cut, length=job.cut.length * random.uniform(low, high)))


def knife(job: Job, random: np.random.Generator) -> Job:
    """Draw a knife in tangential sync, its cut in the middle of the sync zone or at its end."""
    pitch = random.uniform(0.3, 0.8)
    cut = replace(
        job.cut,
        length=pitch * random.uniform(0.85, 2.0),
        line_speed=random.uniform(0.5, 1.2),
        sync_zone=0.4 * pitch,
        shear_zone=0.08 * pitch,
        shear_zone_at=float(random.choice((0.16, 0.32))) * pitch,
        sync_tolerance=float(random.choice((1e-4, 3e-4, 1e-3))),
    )
    limits = replace(job.limits, acceleration=random.uniform(20.0, 80.0), jerk=random.uniform(2e3, 2e4))
    servo = replace(
        job.servo, position_gain=random.uniform(20.0, 45.0), sample_time=float(random.choice((1e-3, 2e-3, 4e-3)))
    )
    return replace(job, machine=RotaryKnife(pitch), cut=cut, limits=limits, servo=servo)


def horizontal(job: Job, random: np.random.Generator) -> Job:
    """Draw a knife in horizontal sync: thick product or cross sealer, of other circumference."""
    assert isinstance(job.machine, RotaryKnife)  # noqa: S101 - the examples are
    wider = random.uniform(1.0, 1.5)
    machine = replace(job.machine, circumference=job.machine.circumference * wider)
    return replace(lengthened(bent(job, random, 0.5, 2.0), random, 0.9, 1.6), machine=machine)


def carriage(job: Job, random: np.random.Generator) -> Job:
    """Draw a job of a saw or a punch: stroke and zones are the example's."""
    return lengthened(bent(job, random, 0.5, 3.0), random, 0.7, 1.5)


def crank(job: Job, random: np.random.Generator) -> Job:
    """Draw a chasing shear whose place of the sync zone is given."""
    drawn = free_crank(job, random)
    assert isinstance(drawn.machine, CrankSlider)  # noqa: S101 - the example is
    least, greatest = drawn.machine.place_range(drawn.cut)
    at = least + (greatest - least) * random.uniform(0.25, 0.75)
    return replace(drawn, machine=replace(drawn.machine, sync_at=float(at)))


def free_crank(job: Job, random: np.random.Generator) -> Job:
    """Draw a chasing shear that leaves the place open."""
    drawn = lengthened(bent(job, random, 0.5, 2.0), random, 0.8, 1.4)
    return replace(drawn, objective=("peak_acceleration", "rms_acceleration")[int(random.integers(2))])


def servo_aware(job: Job, random: np.random.Generator) -> Job:
    """Draw a servo-aware knife for one line speed and one servo."""
    drawn = lengthened(bent(job, random, 0.7, 1.5), random, 0.9, 1.2)
    return replace(drawn, slowest=1.0, servo_tolerance=None)


def ramping(job: Job, random: np.random.Generator) -> Job:
    """Draw a knife whose line ramps up and down, and stops harder."""
    drawn = lengthened(bent(job, random, 0.7, 2.5), random, 0.8, 1.5)
    up = random.uniform(0.3, 2.0)
    return replace(drawn, line=replace(job.line, acceleration=up, stop=up * random.uniform(1.0, 4.0)))


def drawers() -> dict[str, tuple[Callable[[Job, np.random.Generator], Job], tuple[Job, ...]]]:
    """Give what draws each kind of machine, and from which examples in turn."""

    def jobs(*names: str) -> tuple[Job, ...]:
        return tuple(load_job(EXAMPLES / f"{name}.toml") for name in names)

    return {
        "knife": (knife, jobs("paper-600")),
        "horizontal knife": (horizontal, jobs("thick-product", "cross-sealer")),
        "saw": (carriage, jobs("flying-saw")),
        "punch": (carriage, jobs("flying-punch")),
        "crank": (crank, jobs("chasing-shear")),
        "free crank": (free_crank, jobs("chasing-shear")),
        "servo-aware knife": (servo_aware, jobs("short-cut")),
        "ramping knife": (ramping, jobs("ramping-line")),
    }


def blind(job: Job) -> Job:
    """Give the job of the perfect axis: nothing is asked of the servo, and the line keeps its speed."""
    return replace(job, servo_aware=False, line=STEADY, cut=replace(job.cut, shaped=False))


def wrong(job: Job, edge: Edge, random: np.random.Generator, *, checked: bool) -> Counter[str]:
    """Count the places beside an edge that are drawn wrongly, and those that were tried."""
    counts: Counter[str] = Counter()
    judged = job if checked else blind(job)
    for _ in range(TRIED_SERVO_AWARE if checked and job.servo_aware else TRIED):
        at = int(random.integers(len(edge) - 1))
        (left, low), (right, high) = edge[at], edge[at + 1]
        if math.isnan(low + high) or left == right:  # where there is none, and where it jumps
            continue
        # of an open place the lengths of the map are the only nodes
        part = 0.0 if checked and not job.machine.placed else random.random()
        length, speed = left + part * (right - left), low + part * (high - low)
        for factor, possible in ((1 - ASIDE, True), (1 + ASIDE, False)):
            task = placed_fastest(judged.task.with_length(length)).designed_at(factor * speed)
            failed, missed = verdict(judged, task, stand_in(judged))
            counts["places"] += 1
            if (not failed if checked else named(failed) not in LIMITS) != possible:
                counts["wrong"] += 1
                print(
                    f"wrong: {length!r} m at {factor!r} of {speed!r} m/s: {named(failed) or 'passes'} {missed}; {job}",
                    file=sys.stderr,
                    flush=True,
                )
    return counts


def main() -> int:
    """Print what was tried and what was wrong; the rows are written after each envelope."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 100
    kinds = drawers()
    randoms = {kind: np.random.default_rng((SEED, number)) for number, kind in enumerate(kinds)}
    totals = {(kind, sense): Counter[str]() for kind in kinds for sense in ("perfect axis", "axis in tolerance")}
    turns: Counter[str] = Counter()
    only = sys.argv[2:3]
    order = only or [kind for kind in kinds if kind not in SLOW] * ROUNDS + list(SLOW)
    for number in range(count):
        kind = order[number % len(order)]
        draw, bases = kinds[kind]
        turn, random = turns[kind], randoms[kind]
        turns[kind] += 1
        job = draw(bases[turn % len(bases)], random)
        began = time.process_time()
        try:
            answer = envelope_answer(job, LENGTHS)
        except CamwrightError as error:
            print(f"{kind} {turn} skipped: {error}", flush=True)
            continue
        spent = time.process_time() - began
        for sense, edge in edges(answer).items():
            found = totals[kind, sense]
            found += wrong(job, edge, random, checked=sense == "axis in tolerance")
            found += Counter(envelopes=1)
            found["milliseconds"] += round(1e3 * spent)
        if not only:
            written(totals)
    for (kind, sense), found in totals.items():
        print(f"{kind}, {sense}: {found['wrong']} of {found['places']} places of {found['envelopes']} envelopes wrong")
    return 1 if any(found["wrong"] for found in totals.values()) else 0


def edges(answer: EnvelopeAnswer) -> dict[str, Edge]:
    """Give the edges of both senses."""
    return {"perfect axis": answer.perfect, "axis in tolerance": answer.within}


def written(totals: dict[tuple[str, str], Counter[str]]) -> None:
    """Write what was found so far."""
    rows = [
        f"{found['wrong'] == 0:d},{kind},{sense},{found['envelopes']},{SEED},{found['places']},{found['wrong']},"
        f"{found['milliseconds'] / 1e3 / max(found['envelopes'], 1):.1f}"
        for (kind, sense), found in totals.items()
        if found["envelopes"]
    ]
    head = "valid,machine,edge,envelopes,seed,places,wrong,processor_s_an_envelope"
    RESULTS.write_text("\n".join([head, *rows]) + "\n")


if __name__ == "__main__":
    sys.exit(main())
