"""The virtual bender: an NC program read back, bent with the springback inverted, and compared with the drawing."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from camwright.profiles.bender.plan import BendPlan
from camwright.profiles.bender.program import NcProgram
from camwright.profiles.bender.springback import Springback
from camwright.profiles.errors import InputError
from camwright.profiles.polynomial.profile import FloatArray


@dataclass(frozen=True, eq=False)
class BendingProof:
    """What a program makes of the rule.

    Parameters
    ----------
    points
        Shape ``(m + 2, 2)``: the bent rule: start, bends, end (m), laid with its start on the start of the outline.
    deviation
        Largest distance between the bent rule and the drawing (m).
    worst
        Where on the bent rule that is (m), shape ``(2,)``.
    closing_error
        Distance between the rule's ends (m); ``None`` for an open outline.
    rule_length
        Length of rule used (m).
    """

    points: FloatArray
    deviation: float
    worst: FloatArray
    closing_error: float | None
    rule_length: float


def bend(program: NcProgram, plan: BendPlan, springback: Springback) -> FloatArray:
    """Bend a rule as the program says.

    Only feeds and mould angles come from the program; from the plan come the place and direction of the rule's start,
    and which bend belongs to which radius, which is what the steel answers to.

    Returns
    -------
    ndarray
        Shape ``(m + 2, 2)``: start, bends and end of the rule (m).

    Raises
    ------
    InputError
        The program has another number of bends than the plan.
    """
    if len(program.bends) != plan.bends:
        raise InputError(f"program {program.name} has {len(program.bends)} bends, its outline needs {plan.bends}")
    factors = springback.by_radius(plan.radii)
    turns = [
        springback.workpiece_angle(math.radians(mould / 1e3), factor)
        for mould, factor in zip(program.bends.tolist(), factors.tolist(), strict=True)
    ]
    heading = plan.heading + np.concatenate([[0.0], np.cumsum(turns)])
    steps = (program.feeds * 1e-6)[:, None] * np.stack([np.cos(heading), np.sin(heading)], axis=1)
    return np.asarray(plan.vertices[0] + np.vstack([[0.0, 0.0], np.cumsum(steps, axis=0)]), dtype=np.float64)


def prove(program: NcProgram, plan: BendPlan, springback: Springback) -> BendingProof:
    """Bend a rule as the program says and compare it with the drawing."""
    points = bend(program, plan, springback)
    deviation, worst = greatest_distance(points, plan)
    closing = float(np.hypot(*(points[-1] - points[0]))) if plan.outline.closed else None
    return BendingProof(points, deviation, worst, closing, program.rule_length)


def greatest_distance(points: FloatArray, plan: BendPlan) -> tuple[float, FloatArray]:
    """Find the largest distance between a bent rule and its outline, each part with its own counterpart.

    Corners and ends are compared point with point; that bounds the distance of the straight lines between them. Arcs
    are compared by radius: at their bends, and where a side of the rule comes nearest to the arc's centre. Joints
    that are not bent are compared with the side that passes them. Where the outline's lines stand for curves, their
    distance from these is added to that of corners, ends and joints.

    Parameters
    ----------
    points
        Shape ``(m + 2, 2)`` (m).
    plan
        Says which bend belongs to which corner or arc.

    Returns
    -------
    (deviation, place)
        Distance (m) and place on the bent rule (m).
    """
    outline = plan.outline
    corner = np.isinf(plan.radii)
    parts = [(np.hypot(*(points[-1:] - outline.points[-1:]).T) + outline.flattening, points[-1:])]
    at = points[1:-1][corner]
    parts.append((np.hypot(*(at - outline.points[plan.segments[corner]]).T) + outline.flattening, at))
    arc = np.flatnonzero(~corner)
    if len(arc):
        centre, radius = outline.centres[plan.segments[arc]], plan.radii[arc]
        for start, end in ((points[arc], points[arc + 1]), (points[arc + 1], points[arc + 2])):
            foot = _nearest(centre, start, end)
            parts.append((np.abs(np.hypot(*(foot - centre).T) - radius), foot))
        at = points[arc + 1]
        parts.append((np.abs(np.hypot(*(at - centre).T) - radius), at))
    joint = np.setdiff1d(np.arange(1, len(outline.bulges)), plan.segments[corner])
    if len(joint):
        side = np.searchsorted(plan.segments, joint, side="left")
        foot = _nearest(outline.points[joint], points[side], points[side + 1])
        parts.append((np.hypot(*(foot - outline.points[joint]).T) + outline.flattening, foot))
    distance = np.concatenate([part[0] for part in parts])
    place = np.vstack([part[1] for part in parts])
    i = int(np.argmax(distance))
    return float(distance[i]), place[i]


def _nearest(point: FloatArray, start: FloatArray, end: FloatArray) -> FloatArray:
    """Points of the sides from start to end that lie nearest to other points; all of shape ``(n, 2)``."""
    along = end - start
    square = np.maximum((along**2).sum(axis=1), 1e-300)
    t = np.clip(((point - start) * along).sum(axis=1) / square, 0.0, 1.0)
    return np.asarray(start + t[:, None] * along, dtype=np.float64)
