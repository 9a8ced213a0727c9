"""A tree of boxes over the sides of a polyline, to find which sides meet without comparing each with each.

Neighbouring sides lie near each other, so the tree follows the order of the polyline: a box holds two boxes of the
level below. Searches go down level by level with whole arrays of candidates at a time.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from camwright.profiles.polynomial.profile import FloatArray

Indices = NDArray[np.int64]

_CHUNK = 400_000
"""Candidate pairs looked at in one step, which bounds the memory."""

_SLACK = 1e-9
"""Part of a side by which it is drawn out, so that a line through a vertex of another is not missed by rounding."""


@dataclass(frozen=True, eq=False)
class BoxTree:
    """Boxes of the sides (level 0), of pairs of them, and so on up to one box.

    Parameters
    ----------
    low, high
        Corners of the boxes, each level of shape ``(n, 2)`` (m). Empty boxes have ``low > high``.
    """

    low: tuple[FloatArray, ...]
    high: tuple[FloatArray, ...]

    @classmethod
    def over(cls, points: FloatArray) -> BoxTree:
        """Build the tree over the sides of a polyline of shape ``(n + 1, 2)``."""
        lows, highs = [np.minimum(points[:-1], points[1:])], [np.maximum(points[:-1], points[1:])]
        while len(lows[-1]) > 1:
            low, high = lows[-1], highs[-1]
            if len(low) % 2:
                low, high = np.vstack([low, [[np.inf, np.inf]]]), np.vstack([high, [[-np.inf, -np.inf]]])
                lows[-1], highs[-1] = low, high
            lows.append(np.minimum(low[::2], low[1::2]))
            highs.append(np.maximum(high[::2], high[1::2]))
        return cls(tuple(lows), tuple(highs))

    def meeting_pairs(self) -> tuple[Indices, Indices]:
        """Pairs of sides ``i < j``, not neighbours, whose boxes overlap."""
        top = len(self.low) - 1
        todo = [(top, np.zeros(1, dtype=np.int64), np.zeros(1, dtype=np.int64))]
        first, second = [], []
        while todo:
            level, a, b = todo.pop()
            low, high = self.low[level], self.high[level]
            keep = (low[a] <= high[b]).all(axis=1) & (low[b] <= high[a]).all(axis=1)
            a, b = a[keep], b[keep]
            if level == 0:
                apart = b - a > 1
                first.append(a[apart])
                second.append(b[apart])
                continue
            same = a == b
            child_a = np.concatenate([2 * a, 2 * a, 2 * a + 1, 2 * a[~same] + 1])
            child_b = np.concatenate([2 * b, 2 * b + 1, 2 * b + 1, 2 * b[~same]])
            todo += [
                (level - 1, child_a[i : i + _CHUNK], child_b[i : i + _CHUNK]) for i in range(0, len(child_a), _CHUNK)
            ]
        return np.concatenate(first), np.concatenate(second)

    def inside(self, normals: FloatArray, offsets: FloatArray, before: Indices) -> tuple[Indices, Indices]:
        """Sides whose boxes reach into convex regions.

        Parameters
        ----------
        normals, offsets
            Shapes ``(q, h, 2)`` and ``(q, h)``: region ``q`` is where ``normals @ p <= offsets`` in all ``h`` rows.
        before
            Shape ``(q,)``: only sides with a lower number than this count for region ``q``.

        Returns
        -------
        (region, side)
            Candidates; their boxes, not necessarily the sides, reach into the region.
        """
        top = len(self.low) - 1
        todo = [
            (top, np.arange(i, min(i + _CHUNK, len(before))), np.zeros(min(_CHUNK, len(before) - i), dtype=np.int64))
            for i in range(0, len(before), _CHUNK)
        ]
        regions, sides = [np.zeros(0, dtype=np.int64)], [np.zeros(0, dtype=np.int64)]
        while todo:
            level, q, node = todo.pop()
            keep = (node << level) < before[q]
            keep &= self.low[level][node, 0] <= self.high[level][node, 0]
            q, node = q[keep], node[keep]
            low, high = self.low[level], self.high[level]
            for h in range(offsets.shape[1]):
                nx, ny = normals[q, h, 0], normals[q, h, 1]
                nearest = nx * np.where(nx > 0, low[node, 0], high[node, 0])
                nearest += ny * np.where(ny > 0, low[node, 1], high[node, 1])
                reaching = nearest <= offsets[q, h]
                q, node = q[reaching], node[reaching]
            if level == 0:
                regions.append(q)
                sides.append(node)
                continue
            q, node = np.repeat(q, 2), np.repeat(2 * node, 2)
            node[1::2] += 1
            todo += [(level - 1, q[i : i + _CHUNK], node[i : i + _CHUNK]) for i in range(0, len(q), _CHUNK)]
        return np.concatenate(regions), np.concatenate(sides)


def crossings(points: FloatArray, tolerance: float) -> tuple[Indices, Indices, FloatArray]:
    """Find where a polyline crosses or touches itself.

    A crossing within the tolerance of either end of the polyline is a contact: a rule may end on its own flank, and a
    closed one does.

    Returns
    -------
    (first, second, place)
        Numbers of the sides that cross, in the order of the polyline, and the places (m), shape ``(k, 2)``.
    """
    i, j = BoxTree.over(points).meeting_pairs()
    p, r = points[i], points[i + 1] - points[i]
    q, s = points[j], points[j + 1] - points[j]
    cross = r[:, 0] * s[:, 1] - r[:, 1] * s[:, 0]
    gap = q - p
    with np.errstate(divide="ignore", invalid="ignore"):
        t = (gap[:, 0] * s[:, 1] - gap[:, 1] * s[:, 0]) / cross
        u = (gap[:, 0] * r[:, 1] - gap[:, 1] * r[:, 0]) / cross
        found = (t >= -_SLACK) & (t <= 1 + _SLACK) & (u >= -_SLACK) & (u <= 1 + _SLACK)
    i, j, place = i[found], j[found], (p + t[:, None] * r)[found]
    ends = np.minimum(np.hypot(*(place - points[0]).T), np.hypot(*(place - points[-1]).T))
    away = ends > tolerance
    order = np.lexsort((j[away], i[away]))
    return i[away][order], j[away][order], place[away][order]
