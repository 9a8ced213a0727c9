"""The cam as CSV text, rows of master and slave position and derivatives over the master; and rows as a profile."""

from __future__ import annotations

import heapq
from collections.abc import Sequence

import numpy as np

from camwright.profiles.errors import InputError
from camwright.profiles.machines.machine import SlaveUnit
from camwright.profiles.message import Message
from camwright.profiles.polynomial.profile import CamProfile, FloatArray

_HEADERS: dict[SlaveUnit, tuple[str, ...]] = {
    "m": ("x [mm]", "y [mm]", "dy/dx [1]", "d2y/dx2 [1/m]", "d3y/dx3 [1/m^2]"),
    "rad": ("x [mm]", "y [rad]", "dy/dx [rad/m]", "d2y/dx2 [rad/m^2]", "d3y/dx3 [rad/m^3]"),
}
_WIDEST = 2.0 + 1e-9
"""Widest step, in equal ones, where each break moves its own nearest position by half a step at most."""
_ROUNDING = 8 * np.finfo(np.float64).eps
"""Residuals below this part of the values that they come from are rounding."""


def table_positions(profile: CamProfile, points: int) -> FloatArray:
    """Choose master positions for a table: equidistant, but with the nearest one moved onto each break of the profile.

    So pieces begin and end at rows, and the table holds the profile and not only samples of it. Where two breaks have
    the same nearest position, one of them gets the next free one. Where so many lie together that they would take the
    positions of another stretch, the steps between breaks are divided instead, the widest first.

    Parameters
    ----------
    points
        Number of positions, both ends of the cycle included.

    Returns
    -------
    ndarray
        Shape ``(points,)``, increasing (m).

    Raises
    ------
    InputError
        There are more breaks than points.
    """
    breaks = profile.breaks
    if points < len(breaks):
        raise InputError(
            Message(
                f"{{@points}} = {points}: too few to hold the {len(breaks)} ends of the profile's pieces; "
                f"write points = {len(breaks)} or more"
            )
        )
    x = np.linspace(profile.start, profile.end, points)
    nearest = np.rint((breaks - profile.start) * ((points - 1) / profile.length))
    rank = np.arange(len(breaks))
    # Each break a position of its own, in order: first push up past the one before, then down from the last position.
    taken = np.maximum.accumulate(nearest - rank) + rank
    down = points - 1 - (len(breaks) - 1 - rank)
    taken = np.minimum(taken, down)
    x[taken.astype(np.int64)] = breaks
    if np.diff(x).max() <= _WIDEST * (profile.length / (points - 1)):
        return x
    gaps = np.diff(breaks)
    widest = [(-gap, number, 1) for number, gap in enumerate(gaps.tolist())]
    heapq.heapify(widest)
    for _ in range(points - len(breaks)):
        _, number, parts = widest[0]
        heapq.heapreplace(widest, (-float(gaps[number]) / (parts + 1), number, parts + 1))
    divided = [
        np.linspace(breaks[number], breaks[number + 1], parts, endpoint=False)
        for _, number, parts in sorted(widest, key=lambda each: each[1])
    ]
    return np.concatenate([*divided, breaks[-1:]])


def write_cam_csv(profile: CamProfile, points: int, comments: Sequence[str], slave_unit: SlaveUnit = "m") -> str:
    """Write a profile as a table: comment lines, a header with units, one row a position.

    Parameters
    ----------
    points
        Number of rows.
    comments
        Texts that are put before the header, one a line.
    slave_unit
        Unit of the profile's slave: m is written in mm, rad as it is.

    Returns
    -------
    str
        Numbers have as many digits as they need to be read back bit by bit. At a break the derivatives are those of the
        piece that begins there.

    Raises
    ------
    InputError
        There are more breaks than points.
    """
    x = table_positions(profile, points)
    scale = 1e3 if slave_unit == "m" else 1.0
    columns = [x * 1e3, profile(x) * scale, profile(x, 1), profile(x, 2), profile(x, 3)]
    lines = ["# " + " ".join(comment.splitlines()) for comment in comments]
    lines.append(",".join(_HEADERS[slave_unit]))
    lines.extend(",".join(map(repr, row)) for row in zip(*((column + 0.0).tolist() for column in columns), strict=True))
    return "\n".join(lines) + "\n"


def rebuild(x: FloatArray, y: FloatArray, dy: FloatArray, d2y: FloatArray) -> CamProfile:
    """Make the profile that a table stands for: on each interval the quintic through both ends' values.

    It is made as the cubic of linear acceleration plus a correction by what that cubic misses at the right end,

        ``y = y0 + d0 s + a0 s²/2 + (a1 - a0)/(6 h) s³ + r0 P(s/h) + r1 h Q(s/h)``,
        ``P = 10 u³ - 15 u⁴ + 6 u⁵``, ``Q = -4 u³ + 7 u⁴ - 3 u⁵``,

    with the residuals ``r1`` of the ratio and ``r0`` of the position. Residuals at rounding level count as zero: a
    table of cubic pieces gives those cubics, without the noise that differences of positions would put on the jerk.

    Parameters
    ----------
    x, y
        Master and slave positions (m), shape ``(n,)``; ``x`` increases.
    dy, d2y
        Ratio, and ratio slope (1/m).
    """
    h = np.diff(x)
    y0, y1, d0, d1, a0, a1 = y[:-1], y[1:], dy[:-1], dy[1:], d2y[:-1], d2y[1:]
    third = (a1 - a0) / (6 * h)
    r1 = d1 - (d0 + 0.5 * h * (a0 + a1))
    r0 = y1 - (y0 + d0 * h + h * h * (2 * a0 + a1) / 6)
    # What rounding of the table's own numbers can do: h is a difference of x, so x's last digit counts with the slope.
    reach = np.abs(x[:-1]) + np.abs(x[1:])
    bend, slope = np.abs(a0) + np.abs(a1), np.abs(d0) + np.abs(d1)
    r1 = np.where(np.abs(r1) <= _ROUNDING * (slope + bend * reach), 0.0, r1)
    r0 = np.where(np.abs(r0) <= _ROUNDING * (np.abs(y0) + np.abs(y1) + slope * reach + bend * h * reach), 0.0, r0)
    r1 = r1 * h
    table = np.stack(
        [
            y0,
            d0,
            0.5 * a0,
            third + (10 * r0 - 4 * r1) / h**3,
            (-15 * r0 + 7 * r1) / h**4,
            (6 * r0 - 3 * r1) / h**5,
        ],
        axis=1,
    )
    return CamProfile(x.copy(), table)
