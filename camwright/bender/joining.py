"""Loose pieces joined into paths: straight on at branches, closed frames kept closed.

Ends within the gap of each other meet at a node. Where two meet they are joined. Where more meet and all of them go
straight on, they do. Else the pieces that are part of some closed frame are joined among themselves first, the
straightest pair first, and then what is left. A path that comes back to a node that it has passed leaves a closed
frame there, and goes on without it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from camwright.bender.piece import Piece, chained
from camwright.profiles.bender.boxes import overlapping
from camwright.profiles.errors import InputError
from camwright.profiles.polynomial.profile import FloatArray

_STRAIGHT = math.radians(1.0)
"""Turn (rad) up to which a line goes straight on."""

_MOST_ENDS = 400
"""Ends that may meet at one node."""

End = tuple[int, int]
"""Number of a piece, and which of its ends: 0 or 1."""


def join(pieces: Sequence[Piece], gap: float) -> list[Piece]:
    """Join open pieces whose ends are within a gap of each other, and close those whose own ends are.

    Paths are in the order of their first pieces in the drawing, and run in the direction of that piece; a closed path
    begins with it. The end of a joined piece is moved onto the one before it.

    Parameters
    ----------
    pieces
        In the order of the drawing (m).
    gap
        Distance of ends that are joined (m).

    Raises
    ------
    InputError
        Too many ends meet at one place, or a piece vanishes in the gap.
    """
    graph = _graph(pieces, gap)
    mates = _mates(graph)
    found: list[tuple[int, Piece]] = [(i, piece) for i, piece in enumerate(pieces) if piece.closed]
    used = {i for i, _ in found}
    for i in range(len(pieces)):
        if i in used:
            continue
        path = _path(i, mates)
        used.update(piece for piece, _ in path)
        for part, closed in _frames(path, graph):
            found.append(_made(part, closed, pieces))
    return [piece for _, piece in sorted(found, key=lambda entry: entry[0])]


@dataclass(frozen=True, eq=False)
class _Graph:
    """Ends of open pieces and the nodes at which they meet.

    Parameters
    ----------
    meeting
        Ends at each node, in the order of the drawing.
    place, direction
        Where each end is, and which way its piece runs out there (rad).
    """

    node: dict[End, int]
    meeting: list[list[End]]
    place: dict[End, tuple[float, float]]
    direction: dict[End, float]


def _graph(pieces: Sequence[Piece], gap: float) -> _Graph:
    ends: list[End] = [(i, end) for i, piece in enumerate(pieces) if not piece.closed for end in (0, 1)]
    place = {(i, end): _tuple(pieces[i], end) for i, end in ends}
    at = np.array([place[end] for end in ends]).reshape(-1, 2)
    numbers: dict[int, int] = {}
    node = {end: numbers.setdefault(label, len(numbers)) for end, label in zip(ends, _together(at, gap), strict=True)}
    meeting: list[list[End]] = [[] for _ in numbers]
    for end in ends:
        meeting[node[end]].append(end)
    return _Graph(node, meeting, place, {(i, end): _outward(pieces[i], end) for i, end in ends})


def _tuple(piece: Piece, end: int) -> tuple[float, float]:
    x, y = piece.points[-end]
    return float(x), float(y)


def _together(at: FloatArray, gap: float) -> list[int]:
    """Label places of shape ``(n, 2)`` so that those within the gap of each other, one by one, have one label."""
    places, which = np.unique(at, axis=0, return_inverse=True)
    first, second = overlapping(places - 0.5 * gap, places + 0.5 * gap)
    near = np.hypot(*(places[first] - places[second]).T) <= gap
    first, second = first[near], second[near]
    label = np.arange(len(places))
    while True:
        least = label.copy()
        np.minimum.at(least, first, label[second])
        np.minimum.at(least, second, label[first])
        least = least[least]
        if (least == label).all():
            return [int(k) for k in label[which.reshape(-1)]]
        label = least


def _outward(piece: Piece, end: int) -> float:
    """Direction in which a piece runs out of one of its ends (rad)."""
    if end == 0:
        (x0, y0), (x1, y1), half = piece.points[1], piece.points[0], 2 * math.atan(piece.bulges[0])
    else:
        (x0, y0), (x1, y1), half = piece.points[-2], piece.points[-1], -2 * math.atan(piece.bulges[-1])
    return math.atan2(y1 - y0, x1 - x0) - half


def _mates(graph: _Graph) -> dict[End, End]:
    """Which end goes on with which."""
    mates: dict[End, End] = {}
    cyclic: set[int] | None = None
    for ends in graph.meeting:
        own = [i for (i, a), (j, _) in pairwise(ends) if i == j and a == 0]
        free = [end for end in ends if end[0] not in own]  # a piece whose own ends meet is a frame by itself
        for i in own:
            mates[i, 0], mates[i, 1] = (i, 1), (i, 0)
        if len(free) > _MOST_ENDS:
            x, y = graph.place[free[0]]
            raise InputError(
                f"{len(free)} ends meet at ({1e3 * x:.3f}, {1e3 * y:.3f}) mm, more than {_MOST_ENDS}; purge what is "
                "no die line"
            )
        if len(free) <= 2:
            pairs = [(free[0], free[1])] if len(free) == 2 else []
        else:
            pairs = _straightest(free, graph, _STRAIGHT)
            if 2 * len(pairs) < len(free):
                cyclic = _in_frames(graph) if cyclic is None else cyclic
                pairs = _straightest([end for end in free if end[0] in cyclic], graph, math.pi)
                paired = {end for pair in pairs for end in pair}
                pairs += _straightest([end for end in free if end not in paired], graph, math.pi)
        for a, b in pairs:
            mates[a], mates[b] = b, a
    return mates


def _straightest(ends: list[End], graph: _Graph, most: float) -> list[tuple[End, End]]:
    """Pair ends at a node: the least turn first, then the nearest, then in the order of the drawing."""
    if len(ends) < 2:
        return []
    way = np.array([graph.direction[end] for end in ends])
    at = np.array([graph.place[end] for end in ends])
    a, b = np.triu_indices(len(ends), 1)
    turn = np.abs((way[a] - way[b]) % (2 * np.pi) - np.pi)
    away = np.hypot(*(at[a] - at[b]).T)
    pairs, used = [], set()
    for k in np.lexsort((b, a, away, np.round(turn, 3))).tolist():
        i, j = int(a[k]), int(b[k])
        if turn[k] <= most and i not in used and j not in used:
            used |= {i, j}
            pairs.append((ends[i], ends[j]))
    return pairs


def _in_frames(graph: _Graph) -> set[int]:
    """Pieces that are part of some closed frame: all but those whose removal parts the drawing (Tarjan's bridges)."""
    order: dict[int, int] = {}
    low: dict[int, int] = {}
    found = {i for i, _ in graph.node}
    for root in range(len(graph.meeting)):
        if root in order:
            continue
        order[root] = low[root] = len(order)
        stack = [(root, -1, iter(graph.meeting[root]))]
        while stack:
            node, came, ends = stack[-1]
            for i, end in ends:
                if i == came:
                    continue
                other = graph.node[i, 1 - end]
                if other in order:
                    low[node] = min(low[node], order[other])
                    continue
                order[other] = low[other] = len(order)
                stack.append((other, i, iter(graph.meeting[other])))
                break
            else:
                stack.pop()
                if stack:
                    before = stack[-1][0]
                    low[before] = min(low[before], low[node])
                    if low[node] > order[before]:
                        found.discard(came)
    return found


def _path(i: int, mates: dict[End, End]) -> list[End]:
    """Pieces that go on into each other around piece ``i``, each with the end at which it begins."""
    back: list[End] = []
    step = mates.get((i, 0))
    while step is not None and step[0] != i:
        back.append((step[0], 1 - step[1]))
        step = mates.get((step[0], 1 - step[1]))
    path = [*reversed(back), (i, 0)]
    if step is not None:  # it came round
        return [(i, 0), *reversed(back)]
    step = mates.get((i, 1))
    while step is not None:
        path.append(step)
        step = mates.get((step[0], 1 - step[1]))
    return path


def _frames(path: list[End], graph: _Graph) -> list[tuple[list[End], bool]]:
    """Part a path at the nodes that it passes twice: closed frames, and what is left of it."""
    found: list[tuple[list[End], bool]] = []
    nodes = [graph.node[path[0]]]
    passed = {nodes[0]: 0}
    left: list[End] = []
    for i, end in path:
        left.append((i, end))
        node = graph.node[i, 1 - end]
        if node in passed:
            at = passed[node]
            found.append((left[at:], True))
            for gone in nodes[at + 1 :]:
                del passed[gone]
            del left[at:], nodes[at + 1 :]
        else:
            passed[node] = len(left)
            nodes.append(node)
    return [*found, (left, False)] if left else found


def _made(part: list[End], closed: bool, pieces: Sequence[Piece]) -> tuple[int, Piece]:
    """Make the piece of a path: along the first of its pieces in the drawing, and its number."""
    first = min(i for i, _ in part)
    at = next(k for k, (i, _) in enumerate(part) if i == first)
    if part[at][1] == 1:
        part = [(i, 1 - end) for i, end in reversed(part)]
        at = len(part) - 1 - at
    if closed:
        part = part[at:] + part[:at]
    chain = [pieces[i] if end == 0 else pieces[i].reverse() for i, end in part]
    # a single segment whose ends meet by way of others between them stays open
    return first, chained(chain, pieces[first].name, closed=closed and sum(len(piece.bulges) for piece in chain) > 1)
