"""The bender's time table: fastest moves of feed and mould, the feed overlapping the mould's return where it is clear.

While the mould returns, its finger runs back along the flank that it has bent, at the radius ``r`` from the bending
point. With the finger at the angle ``phi``, a rule bent by ``gamma`` can be fed by

    x(phi) = r min(cos phi, sin(gamma - phi) / sin gamma)

before its flank (second term) or the straight rule behind the bend (first term) meets the finger; within the mould's
play around zero the rule passes freely. Before it touches the rule for the next bend, the mould turns through the
same play: that part may overlap the end of the feed.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from profiles.bender.motion import Moves, double_s_moves, trapezoid_moves
from profiles.limits import Limits
from profiles.polynomial import FloatArray

_POINTS = 65
"""Times at which the clearance is looked at, from the start of the return to the mould's play."""

_CHUNK = 2000
"""Bends handled at once, which bounds the memory."""


@dataclass(frozen=True)
class BenderDrive:
    """The two axes of a bender.

    Parameters
    ----------
    feed
        Limits of the feed axis (m/s, m/s², m/s³).
    mould
        Limits of the mould's axis (rad/s, rad/s², rad/s³).
    finger_radius
        Distance of the mould's finger from the bending point ``r`` (m).
    play
        Angle to either side of zero within which the mould does not touch the straight rule (rad).
    """

    feed: Limits
    mould: Limits
    finger_radius: float
    play: float


@dataclass(frozen=True)
class Dwell:
    """What an axis waits after its command has ended, so that it has really arrived.

    Parameters
    ----------
    feed, mould
        Times (s).
    """

    feed: float = 0.0
    mould: float = 0.0


@dataclass(frozen=True, eq=False)
class TimeTable:
    """When each move begins, from the start of the program (s).

    Parameters
    ----------
    feed_start
        Shape ``(m + 1,)``.
    bend_start, return_start
        Shape ``(m,)``.
    feeds, bends
        The moves; a return is the bend's move backwards.
    total
        End of the program (s).
    """

    feed_start: FloatArray
    bend_start: FloatArray
    return_start: FloatArray
    feeds: Moves
    bends: Moves
    total: float


def sequential_table(feeds: FloatArray, moulds: FloatArray, drive: BenderDrive, dwell: Dwell) -> TimeTable:
    """Time table of the paper: trapezoidal moves, one after the other.

    Parameters
    ----------
    feeds
        Shape ``(m + 1,)``: feeds (m).
    moulds
        Shape ``(m,)``: mould angles (rad), positive to the left.
    drive
        The axes; their jerk limits do not count here.
    dwell
        Waits after each feed and each bend.
    """
    feed, bend = trapezoid_moves(feeds, drive.feed), trapezoid_moves(np.abs(moulds), drive.mould)
    fed = feed.time + dwell.feed * (feeds > 0)
    cycle = fed[:-1] + 2 * (bend.time + dwell.mould)
    start = np.concatenate([[0.0], np.cumsum(cycle)])
    bends = start[:-1] + fed[:-1]
    return TimeTable(start, bends, bends + bend.time + dwell.mould, feed, bend, float(start[-1] + fed[-1]))


def overlapped_table(
    feeds: FloatArray, moulds: FloatArray, turns: FloatArray, drive: BenderDrive, dwell: Dwell
) -> TimeTable:
    """Time table with the fastest jerk-limited moves and with overlaps where the mould is clear of the rule.

    Parameters
    ----------
    feeds
        Shape ``(m + 1,)``: feeds (m).
    moulds, turns
        Shape ``(m,)``: mould angles and the workpiece angles they leave (rad), positive to the left.
    drive
        The axes.
    dwell
        Waits after each feed and each bend.
    """
    feed, bend = double_s_moves(feeds, drive.feed), double_s_moves(np.abs(moulds), drive.mould)
    fed = feed.time + dwell.feed * (feeds > 0)
    if not len(moulds):
        return TimeTable(np.zeros(1), np.zeros(0), np.zeros(0), feed, bend, float(fed[0]))
    parts = [slice(i, i + _CHUNK) for i in range(0, len(moulds), _CHUNK)]
    rows = np.arange(len(moulds))
    wait = np.concatenate(
        [feed_delay(feed.take(rows[p] + 1), bend.take(rows[p]), np.abs(turns[p]), drive) for p in parts]
    )
    approach = np.concatenate([_reaching(bend.take(rows[p]), np.full(len(rows[p]), drive.play)) for p in parts])
    # from one return's start to the next bend's start; the approach belongs to that next bend
    arrived = wait + fed[1:]
    back = bend.time + dwell.mould
    ready = np.maximum(back[:-1], arrived[:-1] - approach[1:])
    first = max(0.0, float(fed[0] - approach[0]))
    bend_start = first + np.concatenate([[0.0], np.cumsum(bend.time[:-1] + dwell.mould + ready)])
    return_start = bend_start + bend.time + dwell.mould
    feed_start = np.concatenate([[0.0], return_start + wait])
    total = float(return_start[-1] + max(back[-1], arrived[-1]))
    return TimeTable(feed_start, bend_start, return_start, feed, bend, total)


def feed_delay(feed: Moves, bend: Moves, turn: FloatArray, drive: BenderDrive) -> FloatArray:
    """Time from the start of each return to the earliest start of the feed after it (s), on the safe side.

    Parameters
    ----------
    feed, bend
        ``n`` moves each; the return is the bend backwards, which for these symmetric moves is the same move.
    turn
        Shape ``(n,)``: workpiece angles (rad), positive.
    drive
        The axes.
    """
    part = np.linspace(0.0, 1.0, _POINTS)
    bends, which = _different(bend)
    angle = bends.distance
    t = _reaching(bends, np.maximum(angle - drive.play, 0.0))[:, None] * part
    finger, t = (angle[:, None] - bends.position(t))[which], t[which]
    allowed = clearance(finger, turn[:, None], drive.finger_radius)
    # no further than at any later time: the feed never runs back
    allowed = np.minimum.accumulate(allowed[:, ::-1], axis=1)[:, ::-1]
    moment = feed.time[:, None] * part
    feeds, which = _different(feed)
    reached = feeds.position(feeds.time[:, None] * part)[which]
    index = _last_not_above(reached, allowed)
    free = allowed >= reached[:, -1:]  # the whole feed fits
    # at the end of each interval of time the feed may be where the start of that interval allows
    needed = np.where(free, 0.0, np.roll(t, -1, axis=1) - np.take_along_axis(moment, index, axis=1))
    needed[:, -1] = np.where(free[:, -1], 0.0, t[:, -1] - np.take_along_axis(moment, index[:, -1:], axis=1)[:, 0])
    return np.asarray(np.maximum(needed.max(axis=1), 0.0), dtype=np.float64)


def clearance(finger: FloatArray, turn: FloatArray, radius: float) -> FloatArray:
    """Greatest feed (m) that the finger at an angle (rad) leaves to a rule bent by ``turn`` (rad, in (0, pi))."""
    flank = np.sin(turn - finger) / np.sin(turn)
    return np.asarray(radius * np.maximum(np.minimum(np.cos(finger), flank), 0.0), dtype=np.float64)


def _different(moves: Moves) -> tuple[Moves, NDArray[np.int64]]:
    """Find the different moves of an axis, told apart by their durations, and which of them each move is."""
    _, first, which = np.unique(moves.time, return_index=True, return_inverse=True)
    return moves.take(first.astype(np.int64)), which.astype(np.int64)


def _reaching(moves: Moves, distance: FloatArray) -> FloatArray:
    """Time at which each move has covered a distance (s); its duration if it never does."""
    low, high = np.zeros(len(distance)), moves.time.copy()
    for _ in range(36):
        middle = 0.5 * (low + high)
        short = moves.position(middle[:, None])[:, 0] < distance
        low, high = np.where(short, middle, low), np.where(short, high, middle)
    return high


def _last_not_above(rising: FloatArray, value: FloatArray) -> NDArray[np.int64]:
    """Index of the last entry of each rising row that does not exceed a value; rows of `_POINTS` entries."""
    index = np.zeros(value.shape, dtype=np.int64)
    jump = (_POINTS - 1) // 2
    while jump:
        try_at = np.minimum(index + jump, _POINTS - 1)
        index = np.where(np.take_along_axis(rising, try_at, axis=1) <= value, try_at, index)
        jump //= 2
    return index
