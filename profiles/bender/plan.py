"""`BendPlan`: where an outline is bent, and by how much: the polygon that the bender makes of it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from camwright.profiles.bender.division import Division, DivisionRule
from camwright.profiles.bender.outline import Outline, wrapped
from camwright.profiles.polynomial.profile import FloatArray

_ONE_CIRCLE = 1e-6
"""Difference of radius and of centre (m) up to which neighbouring arcs are parts of one circle."""


@dataclass(frozen=True, eq=False)
class BendPlan:
    """The bends of one outline, before springback and rounding.

    Parameters
    ----------
    outline
        The die line.
    vertices
        Shape ``(m + 2, 2)``: start of the rule, the ``m`` bends, end of the rule (m).
    turns
        Shape ``(m,)``: workpiece angles (rad), positive to the left.
    radii
        Shape ``(m,)``: radius of the arc that the bend is a part of (m), infinite at a corner.
    segments
        Shape ``(m,)``: the arc's segment, or the number of the segment that begins at the corner, from 0.
    chord_error
        Largest distance between the polygon and the drawing's arcs and curves (m).
    """

    outline: Outline
    vertices: FloatArray
    turns: FloatArray
    radii: FloatArray
    segments: NDArray[np.int64]
    chord_error: float

    def moved_to(self, outline: Outline) -> BendPlan:
        """Give the plan of an outline of the same shape that lies elsewhere."""
        return replace(self, outline=outline, vertices=self.vertices + (outline.points[0] - self.outline.points[0]))

    @property
    def bends(self) -> int:
        """Number of bends."""
        return len(self.turns)

    @property
    def feeds(self) -> FloatArray:
        """Distances (m) from start to first bend, from bend to bend, from last bend to end, shape ``(m + 1,)``."""
        return np.asarray(np.hypot(*np.diff(self.vertices, axis=0).T), dtype=np.float64)

    @property
    def heading(self) -> float:
        """Direction of the rule at its start (rad)."""
        return float(self.outline.headings[0][0])


def plan_bends(outline: Outline, divide: DivisionRule, least_turn: float) -> BendPlan:
    """Find the bends of an outline: at its corners, and of its arcs by a division rule.

    Parameters
    ----------
    outline
        The die line.
    divide
        How arcs become bends.
    least_turn
        Workpiece angle below which a joint is smooth and not bent (rad).
    """
    corners = 1 + np.flatnonzero(np.abs(outline.turns) >= least_turn)
    first_arc, last_arc = _runs(outline, corners)
    reach = np.concatenate([[0.0], np.cumsum(np.abs(outline.included))])  # angle turned in arcs before each segment
    if len(first_arc):
        division = divide(outline.radii[first_arc], reach[last_arc + 1] - reach[first_arc])
        error = float(division.error(outline.radii[first_arc]).max())
    else:
        division, error = Division(np.zeros(0, dtype=np.int64), np.zeros(0), np.zeros(0)), 0.0
    # one entry a bend: the run it belongs to, its number in the run, the angles at the centre
    run = np.repeat(np.arange(len(first_arc)), division.bends)
    inner = np.arange(len(run)) - np.repeat(np.cumsum(division.bends) - division.bends, division.bends)
    first, step, bends, arc = division.first[run], division.step[run], division.bends[run], first_arc[run]
    sign = np.sign(outline.bulges[arc])
    left = np.where(inner == 0, first, step / 2)
    right = np.where(inner == bends - 1, first, step / 2)
    swing = first + inner * step
    out = outline.points[arc] - outline.centres[arc]
    cos, sin = np.cos(swing) / np.cos(first), sign * np.sin(swing) / np.cos(first)
    place = outline.centres[arc] + np.stack(
        [cos * out[:, 0] - sin * out[:, 1], sin * out[:, 0] + cos * out[:, 1]], axis=1
    )
    # which segment of the run the bend lies in
    owner = np.clip(np.searchsorted(reach, reach[arc] + swing, side="right") - 1, arc, last_arc[run])
    # a corner comes before the bends of the arc that begins there
    key = np.concatenate([2 * corners, 2 * owner + 1])
    order = np.argsort(key, kind="stable")
    vertices = np.vstack([outline.points[corners], place])[order]
    turns = np.concatenate([outline.turns[corners - 1], sign * (left + right)])[order]
    radii = np.concatenate([np.full(len(corners), np.inf), outline.radii[arc]])[order]
    segments = np.concatenate([corners, owner])[order].astype(np.int64)
    ends = np.vstack([outline.points[:1], vertices, outline.points[-1:]])
    return BendPlan(outline, ends, wrapped(turns), radii, segments, max(error, outline.flattening))


def _runs(outline: Outline, corners: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """First and last segments of the arcs; neighbours on one circle, such as two halves of a full one, are one arc."""
    arcs = np.flatnonzero(outline.arcs)
    if not len(arcs):
        return arcs, arcs
    before, after = arcs[:-1], arcs[1:]
    alike = (after == before + 1) & ~np.isin(after, corners)
    alike &= np.sign(outline.bulges[after]) == np.sign(outline.bulges[before])
    alike &= np.abs(outline.radii[after] - outline.radii[before]) <= _ONE_CIRCLE
    alike &= np.hypot(*(outline.centres[after] - outline.centres[before]).T) <= _ONE_CIRCLE
    begins = np.concatenate([[True], ~alike])
    return arcs[begins], arcs[np.roll(begins, -1)]
