"""From outline to program: the machine's limits kept, the program written, read back and proved."""

from __future__ import annotations

import hashlib
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from camwright.bender.job import BenderJob
from camwright.design.bender.moves import (
    Dwell,
    TimeTable,
    overlapped_table,
    sequential_table,
)
from camwright.profiles.bender.bridges import Bridge, BridgeMark, marked_places, place_bridges, with_cuts
from camwright.profiles.bender.compensation import compensate
from camwright.profiles.bender.division import EqualSides
from camwright.profiles.bender.motion import Moves, double_s_moves, trapezoid_moves
from camwright.profiles.bender.nc_code import read_program, write_program
from camwright.profiles.bender.nearby import crossings
from camwright.profiles.bender.outline import Outline
from camwright.profiles.bender.plan import BendPlan, plan_bends
from camwright.profiles.bender.program import NcProgram
from camwright.profiles.errors import InputError
from camwright.profiles.polynomial.profile import FloatArray
from camwright.validation.bender.arrival import arrivals
from camwright.validation.bender.bridges import BridgeProof, prove_bridges
from camwright.validation.bender.collision import Collision, collisions
from camwright.validation.bender.virtual_bender import BendingProof, prove
from camwright.validation.check import Check

ROUNDING = 5e-6
"""What the bent rule may be off the outline beyond the chord error (m)."""

CLOSING = 10e-6
"""Greatest distance between the ends of a closed outline's rule (m)."""

COLLISIONS = "collisions"
"""Name of the check that the user may accept to fail."""

_LONGEST_NAME = 20
"""Characters of a program's name: Fagor's header takes no more."""

_MOST_FAULTS = 20
_SETTLED = 200
_ALIKE = 12
"""Digits after the point (m, rad) to which the bends of outlines agree that are run alike."""

_NEAR = 1e-6
"""Part of the mould's range within which a bend's mould angle is computed to tell whether it exceeds the range."""


@dataclass(frozen=True, eq=False)
class BentOutline:
    """One outline's program and what is known of it.

    Parameters
    ----------
    plan
        Its bends.
    program
        The program as read back from its text.
    text
        What is written to the file.
    proof
        The virtual bender's result.
    collisions
        Where the bent part meets the mould or the rule to come.
    times, paper_times
        Optimised moves with overlaps, and sequential trapezoidal moves.
    dwell, paper_dwell
        What the axes wait for their servos in these.
    feed_overshoot, mould_overshoot
        Greatest overshoot of either axis in the discrete servo, and what is allowed (m, rad).
    bridges, bridge_proof
        Breaks of the rule, and what the program makes of them; ``None`` if there are none.
    bridge_gap
        Least distance of a bridge's edge from bends, ends and other bridges (m).
    paper_bends, paper_error
        Number of bends and chord error (m) by the paper's rule, 25 sides to a circle.
    """

    plan: BendPlan
    program: NcProgram
    text: str
    proof: BendingProof
    collisions: tuple[Collision, ...]
    times: TimeTable
    paper_times: TimeTable
    dwell: Dwell
    paper_dwell: Dwell
    feed_overshoot: tuple[float, float]
    mould_overshoot: tuple[float, float]
    bridges: tuple[Bridge, ...]
    bridge_proof: BridgeProof | None
    bridge_gap: float
    paper_bends: int
    paper_error: float

    @property
    def sha256(self) -> str:
        """SHA-256 of the program's text, in hexadecimal."""
        return hashlib.sha256(self.text.encode("ascii")).hexdigest()

    @property
    def moulds(self) -> FloatArray:
        """Mould angles of the program (rad), positive to the left."""
        return np.asarray(np.radians(self.program.bends / 1e3), dtype=np.float64)

    @property
    def checks(self) -> tuple[Check, ...]:
        """What the program must fulfil."""
        limit = self.plan.chord_error + ROUNDING
        found = [
            Check("deviation", self.proof.deviation <= limit, self.proof.deviation, limit, "m", None,
                  "virtual bending: chord error and rounding"),
        ]  # fmt: skip
        for name, (value, allowed), unit in (
            ("feed_overshoot", self.feed_overshoot, "m"),
            ("mould_overshoot", self.mould_overshoot, "rad"),
        ):
            found.append(Check(name, value <= allowed, value, allowed, unit, None, "discrete servo (S1): window"))
        closing = self.proof.closing_error
        if closing is not None:
            found.append(
                Check(
                    "closing_error",
                    closing <= CLOSING,
                    closing,
                    CLOSING,
                    "m",
                    None,
                    "virtual bending: the rule's ends meet",
                )
            )
        if self.bridge_proof is not None:
            missing = max(0.0, self.bridge_gap - self.bridge_proof.gap)
            found += [
                Check("bridge_clearance", missing <= ROUNDING, missing, ROUNDING, "m", None,
                      "program: what bridges lack in distance from bends, ends and each other"),
                Check("bridge_place", self.bridge_proof.shift <= ROUNDING, self.bridge_proof.shift, ROUNDING, "m", None,
                      "program: bridges where they are asked for"),
            ]  # fmt: skip
        hits = float(len(self.collisions))
        found.append(
            Check(
                COLLISIONS,
                not hits,
                hits,
                0.0,
                "1",
                None,
                "plane envelope of the mould: bends at which the part is hit",
            )
        )
        return tuple(found)


def bend_outlines(
    outlines: Sequence[Outline], job: BenderJob, stem: str, marks: Sequence[BridgeMark] = ()
) -> tuple[BentOutline, ...]:
    """Write and prove the program of each outline; the drawing's marks say where bridges are.

    Raises
    ------
    InputError
        What the bender cannot do, of all outlines.
    """
    plans, faults = [], []
    for outline in outlines:
        plan, found = _planned(outline, job)
        faults += found
        plans.append(plan)
    if job.bridges.at and len(plans) > 1:
        faults.append(
            f"[bridges] at names places along one rule, and the drawing has {len(plans)}; write spacing instead, or choose one "
            "with --style"
        )
    if faults:
        raise InputError(*faults[:_MOST_FAULTS])
    places = marked_places(plans, marks, job.bridges.width)
    programs = []
    for i, plan in enumerate(plans):
        program = compensate(plan, job.springback, program_name(stem, i, len(plans)))
        try:
            bridges = place_bridges(plan, replace(job.bridges, at=places[i]) if marks else job.bridges)
            program = with_cuts(program, bridges, job.bridges)
        except InputError as error:
            faults += error.faults
            continue
        faults += _range_faults(program, plan, job)
        programs.append((plan, program, bridges))
    if faults:
        raise InputError(*faults[:_MOST_FAULTS])
    known: dict[tuple[bytes, ...], _Run] = {}
    return tuple(_finished(plan, program, bridges, job, known) for plan, program, bridges in programs)


def program_name(stem: str, index: int, count: int) -> str:
    """Name a program after its drawing: letters, digits, dashes, at most 20; numbered when there are several."""
    plain = re.sub(r"[^A-Z0-9]+", "-", stem.upper()).strip("-") or "RULE"
    number = "" if count == 1 else f"-{index + 1}"
    return plain[: min(18, _LONGEST_NAME - len(number))] + number


def _planned(outline: Outline, job: BenderJob) -> tuple[BendPlan, list[str]]:
    """Plan the bends; what the rule and the table do not allow, and where the outline crosses itself."""
    faults = [
        f"{outline.name}: segment {i + 1}: radius {1e3 * outline.radii[i]:.3f} mm is less than the rule's least radius "
        f"{1e3 * job.least_radius:.3f} mm; draw a larger radius or a corner"
        for i in np.flatnonzero(outline.radii < job.least_radius * (1 - 1e-9))[:_MOST_FAULTS]
    ]
    plan = plan_bends(outline, job.divide, job.least_turn)
    if not faults:
        faults += job.springback.faults(plan)
    places = crossings(plan.vertices, plan.chord_error + job.gap)[2]
    faults += [
        f"{outline.name}: the outline crosses or touches itself at ({1e3 * x:.3f}, {1e3 * y:.3f}) mm; a rule cannot pass through "
        "itself: split it into several outlines"
        for x, y in places[:3]
    ]
    if not faults:
        factors = job.springback.by_radius(plan.radii)
        # the mould angle rises with the workpiece angle: few bends come near to the greatest
        greatest = job.springback.workpiece_angle(job.greatest_angle)
        reach = (1 - _NEAR) * np.where(np.isnan(factors), greatest, job.greatest_angle / factors)
        for i in np.flatnonzero(np.abs(plan.turns) > reach).tolist():
            turn = float(plan.turns[i])
            mould = abs(job.springback.mould_angle(turn, float(factors[i])))
            if mould > job.greatest_angle:
                x, y = 1e3 * plan.vertices[i + 1]
                faults.append(
                    f"{outline.name}: bend {i + 1} at ({x:.3f}, {y:.3f}) mm: workpiece angle "
                    f"{math.degrees(abs(turn)):.3f}° needs a "
                    f"mould angle of {math.degrees(mould):.3f}°, beyond the mould's range of "
                    f"{math.degrees(job.greatest_angle):.3f}°; "
                    "split the outline there"
                )
    return plan, faults


def _range_faults(program: NcProgram, plan: BendPlan, job: BenderJob) -> list[str]:
    """List feeds below the machine's least step."""
    least = job.least_step * 1e6
    faults = []
    for i in np.flatnonzero(program.feeds < least - 0.5)[:_MOST_FAULTS]:
        x, y = 1e3 * plan.vertices[i]
        segment = int(plan.segments[min(i, plan.bends - 1)]) if plan.bends else 0
        advice = (
            "allow a greater chord error or a longer step" if plan.outline.arcs[segment] else "remove the short segment"
        )
        faults.append(
            f"{plan.outline.name}: segment {segment + 1} at ({x:.3f}, {y:.3f}) mm: a feed of "
            f"{program.feeds[i] / 1e3:.3f} mm is "
            f"shorter than the machine's least step of {1e3 * job.least_step:.3f} mm; {advice}"
        )
    return faults


@dataclass(frozen=True, eq=False)
class _Run:
    """What the machine does in a program, wherever its outline lies: collisions, time tables, dwells, and how both axes arrive.

    ``feed`` and ``mould`` are the greatest overshoots (m, rad).
    """

    collisions: tuple[Collision, ...]
    times: TimeTable
    paper_times: TimeTable
    dwell: Dwell
    paper_dwell: Dwell
    feed: float
    mould: float


def _finished(
    plan: BendPlan,
    program: NcProgram,
    bridges: tuple[Bridge, ...],
    job: BenderJob,
    known: dict[tuple[bytes, ...], _Run],
) -> BentOutline:
    """Write a program and prove it; ``known`` keeps what the machine does, as outlines are often repeated in a drawing."""
    drive = job.drive
    speed = min(drive.feed.speed * 6e4, math.degrees(drive.mould.speed) * 60)
    command = job.bridges.command
    text = write_program(program, job.flavour, job.numbering, speed, command or "")
    read = read_program(text, program.name, command)
    proof = prove(read, plan, job.springback)
    alike = read.feeds, read.bends, np.round(plan.radii, _ALIKE), np.round(plan.turns, _ALIKE)
    key = tuple(part.tobytes() for part in alike)
    if key not in known:
        known[key] = _run(read, plan, proof, job)
    run = known[key]
    paper = plan_bends(plan.outline, EqualSides(), job.least_turn) if plan.outline.arcs.any() else plan
    return BentOutline(
        plan,
        read,
        text,
        proof,
        run.collisions,
        run.times,
        run.paper_times,
        run.dwell,
        run.paper_dwell,
        (run.feed, job.feed_window),
        (run.mould, job.mould_window),
        bridges,
        prove_bridges(read, bridges, job.bridges),
        job.bridges.clearance,
        paper.bends,
        paper.chord_error,
    )


def _run(read: NcProgram, plan: BendPlan, proof: BendingProof, job: BenderJob) -> _Run:
    """Run a program in the machine."""
    drive = job.drive
    feeds = np.asarray(read.feeds * 1e-6, dtype=np.float64)
    moulds = np.asarray(np.radians(read.bends / 1e3), dtype=np.float64)
    feed = _worst(double_s_moves(_spread(feeds), drive.feed), job, job.feed_window)
    mould = _worst(double_s_moves(_spread(np.abs(moulds)), drive.mould), job, job.mould_window)
    paper_feed = _worst(trapezoid_moves(_spread(feeds), drive.feed), job, job.feed_window)
    paper_mould = _worst(trapezoid_moves(_spread(np.abs(moulds)), drive.mould), job, job.mould_window)
    dwell, paper_dwell = Dwell(feed[0], mould[0]), Dwell(paper_feed[0], paper_mould[0])
    return _Run(
        collisions(proof.points, moulds, job.envelope),
        overlapped_table(feeds, moulds, plan.turns, drive, dwell),
        sequential_table(feeds, moulds, drive, paper_dwell),
        dwell,
        paper_dwell,
        feed[1],
        mould[1],
    )


def _spread(distances: FloatArray) -> FloatArray:
    """Different distances of moves, from the least to the greatest; some of them if there are many."""
    unique = np.unique(distances)
    return (
        unique[np.unique(np.linspace(0, len(unique) - 1, min(len(unique), _SETTLED)).astype(int))]
        if len(unique)
        else unique
    )


def _worst(moves: Moves, job: BenderJob, window: float) -> tuple[float, float]:
    """Longest settling time (s) and greatest overshoot (m or rad) of an axis among its moves."""
    if not len(moves.time):
        return 0.0, 0.0
    found = arrivals(moves, job.servo, window)
    return float(found.settling.max()), float(found.overshoot.max())
