"""Where the bent part of the rule meets the mould, or the rule still to come: a simple envelope in the plane.

Seen from the bent part, the machine walks along the outline: at each bend the mould and the rule behind it stand on
the line of the rule to come, and turn with it by the mould angle. The mould is a convex shape, the same to both sides
of the rule; the rule to come is a strip of its thickness. The height of the rule, its elasticity and lifting the part
over the mould are not in it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from camwright.profiles.bender.nearby import BoxTree, Indices
from camwright.profiles.errors import InputError
from camwright.profiles.polynomial.profile import FloatArray

_STEP = math.radians(15.0)
"""Angle between the poses of the mould that are looked at while it turns."""

MOST_REPORTED = 100
"""Bends with a collision after which the search ends."""

_BLOCK = 500
"""Bends looked at in one step."""

_TOUCH = 1e-6
"""Length of rule (m) inside the envelope from which on it counts."""


@dataclass(frozen=True, eq=False)
class MouldEnvelope:
    """The mould seen from above, behind the bending point.

    Parameters
    ----------
    distance, half_width
        Shape ``(n,)``: half widths (m) at distances behind the bending point (m), from distance 0 on; convex.
    thickness
        Thickness of the rule (m).
    """

    distance: FloatArray
    half_width: FloatArray
    thickness: float

    def __post_init__(self) -> None:
        d, w = self.distance, self.half_width
        if len(d) < 2 or len(d) != len(w) or d[0] != 0 or (np.diff(d) <= 0).any() or (w < 0).any():
            raise InputError(
                "the mould's envelope needs rows of increasing distance, the first 0, and half widths not below 0"
            )
        slopes = np.diff(w) / np.diff(d)
        if (np.diff(slopes) > 1e-12).any():
            i = int(np.argmax(np.diff(slopes) > 1e-12)) + 2
            raise InputError(
                f"the mould's envelope must be convex; row {i} lies inside the line between its neighbours"
            )

    @property
    def depth(self) -> float:
        """How far the mould reaches behind the bending point (m)."""
        return float(self.distance[-1])


@dataclass(frozen=True)
class Collision:
    """The bent part meets something while a bend is made or the rule is fed on after it.

    Parameters
    ----------
    bend
        Number of the bend, from 0.
    side
        Side of the rule that is hit, from 0: the one before bend ``side``.
    """

    bend: int
    side: int
    what: Literal["mould", "rule"]


def collisions(points: FloatArray, moulds: FloatArray, envelope: MouldEnvelope) -> tuple[Collision, ...]:
    """Find the bends at which the part bent so far meets the mould or the rule to come; the first hit of each.

    Parameters
    ----------
    points
        Shape ``(m + 2, 2)``: the bent rule (m).
    moulds
        Shape ``(m,)``: mould angles (rad), positive to the left.
    """
    count = len(moulds)
    if count < 2:
        return ()
    steps = np.diff(points, axis=0)
    heading = np.arctan2(steps[:, 1], steps[:, 0])
    feeds = np.hypot(*steps.T)
    remaining = np.cumsum(feeds[::-1])[::-1]
    tree = BoxTree.over(points)
    found: list[Collision] = []
    for start in range(0, count, _BLOCK):
        bends = np.arange(start, min(start + _BLOCK, count))
        found += _collisions_of(bends, tree, points, moulds, envelope, heading, feeds, remaining)
        if len(found) >= MOST_REPORTED:
            break
    return tuple(found[:MOST_REPORTED])


def _collisions_of(
    bends: Indices,
    tree: BoxTree,
    points: FloatArray,
    moulds: FloatArray,
    envelope: MouldEnvelope,
    heading: FloatArray,
    feeds: FloatArray,
    remaining: FloatArray,
) -> list[Collision]:
    """First collision of each of some bends; heading, feed and remaining length belong to the sides of the rule."""
    # poses of the mould: before the bend, while it turns; then, with the rule sprung back, along the feed that follows
    poses = 1 + np.ceil(np.abs(moulds[bends]) / _STEP).astype(np.int64)
    bend = np.repeat(bends, poses)
    inner = np.arange(len(bend)) - np.repeat(np.cumsum(poses) - poses, poses)
    turn = heading[bend] + moulds[bend] * inner / np.repeat(poses - 1, poses)
    following = heading[bends + 1]
    last = bends == len(moulds) - 1  # the last feed only pushes the cut rule out
    depth = envelope.depth + np.concatenate([np.zeros(len(bend)), np.where(last, 0.0, feeds[bends + 1])])
    found: dict[int, Collision] = {}
    normals, offsets = _mould_region(envelope, depth)
    both, direction = np.concatenate([bend, bends]), np.concatenate([turn, following])
    for i, side in _hits(tree, points, both, direction, normals, offsets):
        found.setdefault(i, Collision(i, side, "mould"))
    # the rule to come, behind the mould; its last bit may meet the start, as in a closed outline
    half, end = envelope.thickness / 2, remaining[bends + 1] - 2 * envelope.thickness
    long = end > envelope.depth
    count = int(long.sum())
    normals = np.tile(np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]]), (count, 1, 1))
    offsets = np.stack([end[long], np.full(count, -envelope.depth), *[np.full(count, half)] * 2], axis=1)
    for i, side in _hits(tree, points, bends[long], following[long], normals, offsets):
        found.setdefault(i, Collision(i, side, "rule"))
    return [found[i] for i in sorted(found)]


def _mould_region(envelope: MouldEnvelope, depth: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Half planes of the mould, its depth drawn out by the feed: along the rule, and to the left of it."""
    d, w = envelope.distance, envelope.half_width
    run, rise = np.diff(d), np.diff(w)
    size = np.hypot(run, rise)
    outward = np.stack([-rise / size, run / size], axis=1)  # of the left flank
    offset = outward[:, 0] * d[:-1] + outward[:, 1] * w[:-1]
    mirrored = outward * [1.0, -1.0]
    # the half planes that leave most boxes out come first: behind the bend, within the depth, within the width
    widest = float(w.max())
    flat = np.vstack([[[-1.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.0, -1.0]], outward, mirrored])
    limits = np.concatenate([[0.0, 0.0, widest, widest], offset, offset])
    normals = np.tile(flat, (len(depth), 1, 1))
    offsets = np.tile(limits, (len(depth), 1))
    offsets[:, 1] = depth
    if rise[-1] < 0:  # a flank that closes in again would cut the drawn-out part: it keeps its greatest width there
        closing = np.flatnonzero(rise < 0)
        both = 4 + np.concatenate([closing, closing + len(run)])
        normals[:, both], offsets[:, both] = 0.0, 1.0
    return normals, offsets


def _hits(
    tree: BoxTree, points: FloatArray, bend: Indices, direction: FloatArray, normals: FloatArray, offsets: FloatArray
) -> list[tuple[int, int]]:
    """Bends and the sides of the part that reach into the regions given in the frame of the rule to come."""
    cos, sin = np.cos(direction)[:, None], np.sin(direction)[:, None]
    turned = np.stack(
        [cos * normals[..., 0] - sin * normals[..., 1], sin * normals[..., 0] + cos * normals[..., 1]], axis=2
    )
    shifted = offsets + (turned * points[bend + 1][:, None, :]).sum(axis=2)
    # side `bend` ends at the bending point and belongs to the bend itself
    region, side = tree.inside(turned, shifted, bend)
    first, last = np.zeros(len(region)), np.ones(len(region))
    start, along = points[side], points[side + 1] - points[side]
    with np.errstate(divide="ignore", invalid="ignore"):
        for h in range(offsets.shape[1]):
            n = turned[region, h]
            slope, room = (n * along).sum(axis=1), shifted[region, h] - (n * start).sum(axis=1)
            at = room / slope
            last = np.where(slope > 0, np.minimum(last, at), last)
            first = np.where(slope < 0, np.maximum(first, at), first)
            last = np.where((slope == 0) & (room < 0), -1.0, last)
    inside = (last - first) * np.hypot(*along.T) > _TOUCH
    pairs = zip(bend[region[inside]].tolist(), side[inside].tolist(), strict=True)
    return sorted(set(pairs))
