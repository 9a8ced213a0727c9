"""Tables of several cuts: where blades do not divide the counts of a turn, a table closes on whole counts after several cuts only."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from camwright.profiles.polynomial.profile import FloatArray
from camwright.profiles.tables.cam_table import CamTable
from camwright.profiles.tables.count_grid import grain_of
from camwright.validation.servo.axis_run import hermite

_MOST = 64
"""Most cuts that are looked for in a table."""

_COUNTS = 4.0
"""By how many counts the same place of two cuts may differ: values and the cut's travel are rounded, and between points lies a chord."""

_STRAIGHT = 8.0
"""A table that is nearer to a straight line than this many times that holds no cuts that could be told apart."""


def cuts_of(table: CamTable) -> int:
    """Count the cuts in a table of counts: the parts into which it falls that are all alike, to its rounding."""
    allowed = _COUNTS * grain_of(table.y)
    if not (table.travel_known and allowed > 0.0):
        return 1
    x, y = table.x - table.x[0], table.y - table.y[0]
    if float(np.abs(y - table.advance / table.period * x).max()) <= _STRAIGHT * allowed:
        return 1
    for cuts in range(_MOST, 1, -1):
        if _alike(x, y, table, cuts, allowed):
            return cuts
    return 1


def _alike(x: FloatArray, y: FloatArray, table: CamTable, cuts: int, allowed: float) -> bool:
    """Whether each part of a table is the next one."""
    at = x[x <= x[-1] * (1.0 - 1.0 / cuts)]
    later = _between(at + table.period / cuts, x, y)
    return float(np.abs(later - y[: len(at)] - table.advance / cuts).max()) <= allowed


def _between(at: FloatArray, x: FloatArray, y: FloatArray) -> FloatArray:
    """Positions between points, by cubics through points and the slopes there."""
    slope = np.gradient(y, x)
    left = (x.searchsorted(at, side="right") - 1).clip(0, len(x) - 2)
    step = x[left + 1] - x[left]
    value, slopes = (y[left], y[left + 1]), (slope[left], slope[left + 1])
    return np.asarray(hermite((at - x[left]) / step, step, value, slopes)[0])


def first_cut(table: CamTable, cuts: int) -> CamTable:
    """Take the first cut of a table, its end where the cuts end on average."""
    end = table.x[0] + table.period / cuts
    inside = table.x < end - 1e-9 * table.period
    count = int(inside.sum())
    return replace(
        table,
        x=np.append(table.x[:count], end),
        y=np.append(table.y[:count], table.y[0] + table.advance / cuts),
        ratio=np.append(table.ratio[:count], table.ratio[0]),
        ratio_slope=np.append(table.ratio_slope[:count], table.ratio_slope[0]),
        laws=table.laws[:count],
    )
