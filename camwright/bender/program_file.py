"""From outline to program: the machine's limits kept, the program written, read back and proved."""

from __future__ import annotations

import hashlib
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from camwright.bender.job import BenderJob
from camwright.bender.machine_run import MachineRun, machine_run
from camwright.profiles.bender.bridges import Bridge, BridgeMark, marked_places, place_bridges, with_cuts
from camwright.profiles.bender.compensation import compensate
from camwright.profiles.bender.division import EqualSides
from camwright.profiles.bender.nc_code import read_program, write_program
from camwright.profiles.bender.nearby import crossings
from camwright.profiles.bender.outline import Outline
from camwright.profiles.bender.plan import BendPlan, plan_bends
from camwright.profiles.bender.program import NcProgram
from camwright.profiles.errors import InputError
from camwright.profiles.polynomial.profile import FloatArray
from camwright.validation.bender.bridges import BridgeProof, prove_bridges
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
_ALIKE = 12
"""Digits after the point (m, rad) to which the bends of outlines agree that are run alike."""

_ALIKE_PLACE = 1e-9
"""Distance (m) to which the places of outlines agree that are bent alike."""

_NEAR = 1e-6
"""Part of the mould's range within which a bend's mould angle is computed to tell whether it exceeds the range."""


@dataclass(frozen=True, eq=False)
class BentOutline:
    """One outline's program and what is known of it.

    Parameters
    ----------
    program
        The program as read back from its text.
    text
        What is written to the file.
    proof
        The virtual bender's result.
    run
        What the machine does in it.
    bridges, bridge_proof
        Breaks of the rule, and what the program makes of them; ``None`` if there are none.
    bridge_gap
        Least distance of a bridge's edge from bends, ends and other bridges (m).
    paper
        The bends by the paper's rule, 25 sides to a circle.
    """

    plan: BendPlan
    program: NcProgram
    text: str
    proof: BendingProof
    run: MachineRun
    bridges: tuple[Bridge, ...]
    bridge_proof: BridgeProof | None
    bridge_gap: float
    paper: BendPlan

    def moved_to(self, plan: BendPlan, name: str) -> BentOutline:
        """Give the same for an outline of the same shape elsewhere, under a name of its own."""
        shift = plan.vertices[0] - self.plan.vertices[0]
        proof = replace(self.proof, points=self.proof.points + shift, worst=self.proof.worst + shift)
        text = self.text.replace(self.program.name, name, 1)  # it stands in the head
        return replace(self, plan=plan, program=replace(self.program, name=name), text=text, proof=proof)

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
            ("feed_overshoot", self.run.feed_overshoot, "m"),
            ("mould_overshoot", self.run.mould_overshoot, "rad"),
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
        hits = float(len(self.run.collisions))
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
    shapes = [_shape(outline) for outline in outlines]
    plans = _plans(outlines, shapes, job)
    places = marked_places(plans, marks, job.bridges.width)
    keys = [(shape, tuple(place) if marks else ()) for shape, place in zip(shapes, places, strict=True)]
    written: dict[_Key, tuple[NcProgram, tuple[Bridge, ...]]] = {}
    faults: list[str] = []
    for i, plan in enumerate(plans):
        if keys[i] in written:
            continue
        program = compensate(plan, job.springback, program_name(stem, i, len(plans)))
        try:
            bridges = place_bridges(plan, replace(job.bridges, at=places[i]) if marks else job.bridges)
            program = with_cuts(program, bridges, job.bridges)
        except InputError as error:
            faults += error.faults
            continue
        found = _range_faults(program, plan, job)
        faults += found
        if not found:
            written[keys[i]] = program, bridges
    if faults:
        raise InputError(*faults[:_MOST_FAULTS])
    known: dict[tuple[bytes, ...], MachineRun] = {}
    first: dict[_Key, BentOutline] = {}
    bent = []
    for i, (plan, key) in enumerate(zip(plans, keys, strict=True)):
        if key in first:
            bent.append(first[key].moved_to(plan, program_name(stem, i, len(plans))))
        else:
            first[key] = _finished(plan, *written[key], job, known)
            bent.append(first[key])
    return tuple(bent)


_Key = tuple[bytes, tuple[float, ...]]
"""Shape of an outline, and where its marks are: outlines that agree in both are bent alike."""


def _plans(outlines: Sequence[Outline], shapes: Sequence[bytes], job: BenderJob) -> list[BendPlan]:
    """Plan the bends of all outlines, those of one shape once.

    Raises
    ------
    InputError
        What the bender cannot do.
    """
    plans: list[BendPlan] = []
    faults: list[str] = []
    known: dict[bytes, BendPlan] = {}
    for outline, shape in zip(outlines, shapes, strict=True):
        if shape in known:
            plans.append(known[shape].moved_to(outline))
            continue
        plan, found = _planned(outline, job)
        faults += found
        if len(faults) >= _MOST_FAULTS:
            break
        if not found:
            known[shape] = plan
        plans.append(plan)
    if job.bridges.at and len(outlines) > 1:
        faults.append(
            f"[bridges] at names places along one rule, and the drawing has {len(outlines)}; write spacing instead, or choose one "
            "with --style"
        )
    if faults:
        raise InputError(*faults[:_MOST_FAULTS])
    return plans


def _shape(outline: Outline) -> bytes:
    """Tell what an outline is wherever it lies, to a nanometre, a thousandth of what a program can say."""
    places = np.rint((outline.points - outline.points[0]) / _ALIKE_PLACE).astype(np.int64)
    return bytes(places.tobytes() + outline.bulges.tobytes() + repr(outline.flattening).encode())


def program_name(stem: str, index: int, count: int) -> str:
    """Name a program after its drawing: letters, digits, dashes, at most 20; numbered when there are several."""
    plain = re.sub(r"[^A-Z0-9]+", "-", stem.upper()).strip("-") or "RULE"
    number = "" if count == 1 else f"-{index + 1}"
    return plain[: min(18, _LONGEST_NAME - len(number))] + number


def _planned(outline: Outline, job: BenderJob) -> tuple[BendPlan, list[str]]:
    """Plan the bends; what the rule and the table do not allow, and where the outline crosses itself."""
    faults = [
        f"{outline.name}: segment {i + 1}: radius {1e3 * outline.radii[i]:.3f} mm is less than the rule's least radius "
        f"{1e3 * job.rule.least_radius:.3f} mm; draw a larger radius or a corner"
        for i in np.flatnonzero(outline.radii < job.rule.least_radius * (1 - 1e-9))[:_MOST_FAULTS]
    ]
    plan = plan_bends(outline, job.divide, job.mould.least_turn)
    if not faults:
        faults += job.springback.faults(plan)
    places = crossings(plan.vertices, plan.chord_error + job.drawing.gap)[2]
    faults += [
        f"{outline.name}: the outline crosses or touches itself at ({1e3 * x:.3f}, {1e3 * y:.3f}) mm; a rule cannot pass through "
        "itself: split it into several outlines"
        for x, y in places[:3]
    ]
    if not faults:
        factors = job.springback.by_radius(plan.radii)
        # the mould angle rises with the workpiece angle: few bends come near to the greatest
        greatest = job.springback.workpiece_angle(job.mould.greatest_angle)
        reach = (1 - _NEAR) * np.where(np.isnan(factors), greatest, job.mould.greatest_angle / factors)
        for i in np.flatnonzero(np.abs(plan.turns) > reach).tolist():
            turn = float(plan.turns[i])
            mould = abs(job.springback.mould_angle(turn, float(factors[i])))
            if mould > job.mould.greatest_angle:
                x, y = 1e3 * plan.vertices[i + 1]
                faults.append(
                    f"{outline.name}: bend {i + 1} at ({x:.3f}, {y:.3f}) mm: workpiece angle "
                    f"{math.degrees(abs(turn)):.3f}° needs a "
                    f"mould angle of {math.degrees(mould):.3f}°, beyond the mould's range of "
                    f"{math.degrees(job.mould.greatest_angle):.3f}°; "
                    "split the outline there"
                )
    return plan, faults


def _range_faults(program: NcProgram, plan: BendPlan, job: BenderJob) -> list[str]:
    """List feeds below the machine's least step."""
    least = job.feed.least_step * 1e6
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
            f"shorter than the machine's least step of {1e3 * job.feed.least_step:.3f} mm; {advice}"
        )
    return faults


def _finished(
    plan: BendPlan,
    program: NcProgram,
    bridges: tuple[Bridge, ...],
    job: BenderJob,
    known: dict[tuple[bytes, ...], MachineRun],
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
        known[key] = machine_run(read, plan, proof, job)
    paper = plan_bends(plan.outline, EqualSides(), job.mould.least_turn) if plan.outline.arcs.any() else plan
    return BentOutline(
        plan,
        read,
        text,
        proof,
        known[key],
        bridges,
        prove_bridges(read, bridges, job.bridges),
        job.bridges.clearance,
        paper,
    )
