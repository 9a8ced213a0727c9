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

from camwright.profiles.bender.motion import Moves, double_s_moves, trapezoid_moves
from camwright.profiles.limits import Limits
from camwright.profiles.polynomial.profile import FloatArray

_POINTS = 65
"""Times at which the clearance is looked at, from the start of the return to the mould's play."""

_CHUNK = 500
"""Bends handled at once, which bounds the memory."""

_TURN_DIGITS = 11
"""Decimals of workpiece angles (rad) that tell bends apart: beyond them stands the rounding of the drawing's numbers."""


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
    bends, which = _different(bend)
    approach = bends.reaching(np.full(len(bends.time), drive.play))[which]
    # bends alike in mould angle, workpiece angle and following feed wait alike
    turn = np.asarray(np.round(np.abs(turns), _TURN_DIGITS), dtype=np.float64)
    rows, alike = _first_of_each(which, feed.time[1:], turn)
    parts = [rows[i : i + _CHUNK] for i in range(0, len(rows), _CHUNK)]
    wait = np.concatenate([feed_delay(feed.take(p + 1), bend.take(p), turn[p], drive) for p in parts])[alike]
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
    t = bends.reaching(np.maximum(angle - drive.play, 0.0))[:, None] * part
    finger = angle[:, None] - bends.position(t)
    t = t[which]
    allowed = clearance(np.cos(finger)[which], np.sin(finger)[which], turn[:, None], drive.finger_radius)
    # no further than at any later time: the feed never runs back
    allowed = np.minimum.accumulate(allowed[:, ::-1], axis=1)[:, ::-1]
    feeds, which = _different(feed)
    reached = feeds.position(feeds.time[:, None] * part)
    moment = _last_not_above(reached, which, allowed) * (feed.time / (_POINTS - 1))[:, None]
    # at the end of each interval of time the feed may be where the start of that interval allows
    needed = np.hstack([t[:, 1:], t[:, -1:]]) - moment
    free = allowed >= reached[which, -1:]  # the whole feed fits
    return np.asarray(np.where(free, 0.0, needed).max(axis=1, initial=0.0), dtype=np.float64)


def clearance(cos: FloatArray, sin: FloatArray, turn: FloatArray, radius: float) -> FloatArray:
    """Greatest feed (m) that the finger leaves to a rule bent by ``turn`` (rad, in (0, pi)), from the cosine and sine of its angle.

    ``sin(turn - phi) / sin(turn) = cos(phi) - sin(phi) / tan(turn)``.
    """
    flank = cos - sin / np.tan(turn)
    return np.asarray(radius * np.maximum(np.minimum(cos, flank), 0.0), dtype=np.float64)


def _different(moves: Moves) -> tuple[Moves, NDArray[np.int64]]:
    """Find the different moves of an axis, told apart by their durations, and which of them each move is."""
    first, which = _first_of_each(moves.time)
    return moves.take(first), which


def _first_of_each(*keys: NDArray[np.generic]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Find the different rows of some columns: the first of each, and for each row which of them it is."""
    order = np.lexsort(keys)
    fresh = np.zeros(len(order), dtype=np.bool_)
    fresh[:1] = True
    for key in keys:
        fresh[1:] |= key[order[1:]] != key[order[:-1]]
    which = np.empty(len(order), dtype=np.int64)
    which[order] = np.cumsum(fresh) - 1
    return order[fresh], which


def _last_not_above(rising: FloatArray, rows: NDArray[np.int64], value: FloatArray) -> NDArray[np.int64]:
    """Index of the last but one entry, or one before it, of a rising row that does not exceed a value.

    Parameters
    ----------
    rising
        Shape ``(k, _POINTS)``.
    rows
        Shape ``(n,)``: which of these rows each row of values is looked up in.
    value
        Shape ``(n, m)``.
    """
    flat = rising.ravel()
    first = rows[:, None] * _POINTS
    index = np.zeros(value.shape, dtype=np.int64)
    jump = (_POINTS - 1) // 2
    while jump:
        index += jump * (flat[first + index + jump] <= value)
        jump //= 2
    return index
