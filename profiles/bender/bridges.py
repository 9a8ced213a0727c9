"""Bridges: short breaks cut out of a rule, so that what it stands in stays in one piece."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from camwright.profiles.bender.plan import BendPlan
from camwright.profiles.bender.program import IntArray, NcProgram
from camwright.profiles.errors import InputError
from camwright.profiles.polynomial.profile import FloatArray

_MOST_FAULTS = 20
_SLACK = 1e-9
"""Distance (m) by which rounding may take a place out of its range."""

MOST_BRIDGES = 10_000
"""Bridges of one rule; more are a spacing in the wrong unit."""


@dataclass(frozen=True)
class BridgeRule:
    """Which bridges a rule gets, and what their tool needs.

    Parameters
    ----------
    width
        Length of rule that is cut out (m).
    spacing
        Distance of the bridges along the rule (m), the first half a spacing from its start; ``None`` for places.
    at
        Places of their middles along the rule, from its start (m); empty for a spacing.
    clearance
        Least distance of a bridge's edge from a bend, an end of the rule or another bridge (m).
    command
        The machine's cut command; ``None`` cuts by hand.
    tool_distance
        How far before the bending place the machine's cutting tool stands (m).
    layer
        The drawing's layer whose marks say where bridges are; ``None`` for a spacing or places.
    """

    width: float = 0.0
    spacing: float | None = None
    at: tuple[float, ...] = ()
    clearance: float = 2e-3
    command: str | None = None
    tool_distance: float = 0.0
    layer: str | None = None

    @property
    def asked(self) -> bool:
        """Whether there are bridges at all."""
        return self.spacing is not None or bool(self.at)

    @property
    def first(self) -> float:
        """Least place along the rule that the tool reaches (m): the rule begins at the bending place."""
        return self.tool_distance if self.command is not None else 0.0


@dataclass(frozen=True)
class Bridge:
    """One break of the rule.

    Parameters
    ----------
    middle
        Its middle along the rule, from its start (m).
    width
        Length that is cut out (m).
    side
        Number of the side that it lies on, from 0: the one before bend ``side``.
    from_bend
        Distance of its middle from the bend before it, or from the start of the rule (m).
    moved
        How far it lies from where the spacing would have it (m), positive away from the start.
    """

    middle: float
    width: float
    side: int
    from_bend: float
    moved: float = 0.0


def place_bridges(plan: BendPlan, rule: BridgeRule) -> tuple[Bridge, ...]:
    """Place the bridges of a rule on the straight stretches between its bends.

    A place that is named stays or is refused. One of a spacing moves to the nearest place that is free, by at most half
    a spacing.

    Raises
    ------
    InputError
        A bridge lies on a bend, or nearer to a bend, an end or another bridge than the tool allows; each with where
        it may go.
    """
    if not rule.asked:
        return ()
    room = _Room.of(plan, rule)
    bridges: list[Bridge] = []
    faults: list[str] = []
    for number, wanted in enumerate(_wanted(room, rule), start=1):
        least = bridges[-1].middle + rule.width + rule.clearance if bridges else -math.inf
        found = room.nearest(wanted, least)
        reach = _SLACK if rule.spacing is None else rule.spacing / 2
        if found is None or abs(found - wanted) > reach:
            faults.append(f"{plan.outline.name}: bridge {number} {room.refusal(wanted, least)}")
            continue
        side = int(np.clip(np.searchsorted(room.ends, found), 0, len(room.ends) - 1))
        start = float(room.ends[side - 1]) if side else 0.0
        bridges.append(Bridge(found, rule.width, side, found - start, found - wanted))
    if faults:
        raise InputError(*faults[:_MOST_FAULTS])
    return tuple(bridges)


def _wanted(room: _Room, rule: BridgeRule) -> list[float]:
    """Places along the rule where bridges are asked for (m), in order.

    Raises
    ------
    InputError
        There are too many.
    """
    if rule.spacing is None:
        return sorted(rule.at)
    count = math.floor(room.length / rule.spacing + 0.5)
    if count > MOST_BRIDGES:
        raise InputError(
            f"{room.plan.outline.name}: a spacing of {1e3 * rule.spacing:g} mm makes {count} bridges along "
            f"{1e3 * room.length:.3f} mm of rule, more than {MOST_BRIDGES}; lengthen the spacing"
        )
    return [(i + 0.5) * rule.spacing for i in range(count)]


@dataclass(frozen=True, eq=False)
class _Room:
    """Where the middle of a bridge may lie along a rule.

    Parameters
    ----------
    ends
        Shape ``(m + 1,)``: where each side ends along the rule (m).
    low, high
        Ranges of free places (m), in order.
    """

    plan: BendPlan
    rule: BridgeRule
    ends: FloatArray
    low: FloatArray
    high: FloatArray

    @classmethod
    def of(cls, plan: BendPlan, rule: BridgeRule) -> _Room:
        feeds = plan.feeds
        ends = np.cumsum(feeds)
        need = rule.width / 2 + rule.clearance
        low, high = np.maximum(ends - feeds + need, rule.first), ends - need
        free = high >= low - _SLACK
        return cls(plan, rule, ends, low[free], np.maximum(high[free], low[free]))

    @property
    def length(self) -> float:
        """Length of the rule (m)."""
        return float(self.ends[-1])

    def nearest(self, wanted: float, least: float) -> float | None:
        """Find the free place nearest to another, not before ``least``; of two as near the one nearer the start."""
        low = np.maximum(self.low, least)
        open_ = low <= self.high + _SLACK
        if not open_.any():
            return None
        places = np.clip(wanted, low[open_], np.maximum(self.high[open_], low[open_]))
        return float(places[int(np.argmin(np.abs(places - wanted)))])

    def refusal(self, wanted: float, least: float) -> str:
        """Say why a bridge cannot lie at a place, and where it may go."""
        width, need = 1e3 * self.rule.width, 1e3 * self.rule.clearance
        where = f"of {width:g} mm at {1e3 * wanted:.3f} mm along the rule"
        return f"{where}: {self._reason(wanted, least, need)}; {self._way_out(wanted, least)}"

    def _reason(self, wanted: float, least: float, need: float) -> str:
        if not 0 <= wanted <= self.length:
            return f"the rule is {1e3 * self.length:.3f} mm long"
        if wanted < least:
            return f"it is nearer than {need:g} mm to the bridge before it"
        if wanted < self.rule.first:
            return (
                f"the cutting tool stands {1e3 * self.rule.tool_distance:g} mm before the bending place, where the rule "
                "begins"
            )
        marks = np.concatenate([[0.0], self.ends])
        k = int(np.argmin(np.abs(marks - wanted)))
        x, y = 1e3 * self.plan.vertices[k]
        last = len(marks) - 1
        what = "the start" if k == 0 else "the end" if k == last else f"bend {k}"
        gap = 1e3 * (abs(float(marks[k]) - wanted) - self.rule.width / 2)
        far = f"it lies on {what}" if gap < 0 else f"its edge is {gap:.3f} mm from {what}"
        return f"{far} at ({x:.3f}, {y:.3f}) mm, and the tool needs {need:g} mm"

    def _way_out(self, wanted: float, least: float) -> str:
        low = np.maximum(self.low, least)
        open_ = low <= self.high
        low, high = low[open_], self.high[open_]
        before = high[high < wanted]
        after = low[low > wanted]
        # rounded into the free range
        places = [f"{math.floor(1e6 * float(before[-1]) + 1e-3) / 1e3:.3f} mm"] if len(before) else []
        places += [f"{math.ceil(1e6 * float(after[0]) - 1e-3) / 1e3:.3f} mm"] if len(after) else []
        if places:
            return f"it may go to {' or '.join(places)}"
        return "no place of this rule is free for it; make bridges narrower or fewer"


@dataclass(frozen=True)
class BridgeMark:
    """A mark of a drawing that says where a bridge is.

    Parameters
    ----------
    name
        Kind, handle and layer of the mark.
    place
        Its middle (m).
    """

    name: str
    place: tuple[float, float]


def marked_places(plans: Sequence[BendPlan], marks: Sequence[BridgeMark], width: float) -> list[tuple[float, ...]]:
    """Find where along each rule the marks lie (m): each on the rule that passes nearest to it.

    Raises
    ------
    InputError
        No rule passes within half a bridge's width of a mark.
    """
    start = np.vstack([plan.vertices[:-1] for plan in plans])
    way = np.vstack([np.diff(plan.vertices, axis=0) for plan in plans])
    owner = np.repeat(np.arange(len(plans)), [len(plan.vertices) - 1 for plan in plans])
    before = np.concatenate([np.cumsum(plan.feeds) - plan.feeds for plan in plans])
    square = np.maximum((way**2).sum(axis=1), 1e-300)
    found: list[list[float]] = [[] for _ in plans]
    faults = []
    for mark in marks:
        off = np.array(mark.place) - start
        part = np.clip((off * way).sum(axis=1) / square, 0.0, 1.0)
        away = np.hypot(*(off - part[:, None] * way).T)
        k = int(np.argmin(away))
        x, y = 1e3 * np.array(mark.place)
        if away[k] > width / 2:
            to_x, to_y = 1e3 * (start[k] + part[k] * way[k])
            faults.append(
                f"{mark.name} at ({x:.3f}, {y:.3f}) mm marks a bridge, but no rule passes within {500 * width:g} mm of it; the "
                f"nearest does at ({to_x:.3f}, {to_y:.3f}) mm: move the mark there"
            )
        else:
            found[owner[k]].append(float(before[k] + part[k] * math.sqrt(square[k])))
    if faults:
        raise InputError(*faults[:_MOST_FAULTS])
    return [tuple(places) for places in found]


def with_cuts(program: NcProgram, bridges: tuple[Bridge, ...], rule: BridgeRule) -> NcProgram:
    """Put the machine's cuts into a program: each where the middle of its bridge stands at the cutting tool."""
    if not bridges or rule.command is None:
        return program
    return NcProgram(
        program.name, program.feeds, program.bends, bridge_places(program, bridges) - _um(rule.tool_distance)
    )


def bridge_places(program: NcProgram, bridges: tuple[Bridge, ...]) -> IntArray:
    """Middles of bridges along the rule that a program feeds (µm), shape ``(k,)``: from the bend before each."""
    begins = np.concatenate([[0], np.cumsum(program.feeds)])
    return np.array([int(begins[bridge.side]) + _um(bridge.from_bend) for bridge in bridges], dtype=np.int64)


def _um(length: float) -> int:
    return round(1e6 * length)
