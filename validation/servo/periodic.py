"""A repeated profile about its mean straight line: what is left is periodic in the cut length."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np

from camwright.profiles.polynomial.profile import CamProfile, FloatArray


def periodic_part(profile: CamProfile, master: FloatArray) -> FloatArray:
    """Repeated profile minus the straight line through its start, which is periodic in the cut length.

    As the master only rises, the points of a piece follow one another: the breaks are looked up among the points, not
    the points among the breaks, and every coefficient is repeated for the points of its piece.

    Parameters
    ----------
    master
        Master positions (m), any number of cycles, ascending along the last axis; shape ``(points,)`` or ``(rows, points)``.
    """
    table = straightened(profile)
    rows = master.reshape(-1, master.shape[-1])
    least, greatest = (rows[0, 0], rows[0, -1]) if len(rows) == 1 else (rows[:, 0].min(), rows[:, -1].max())
    first, last = (math.floor((float(x) - profile.start) / profile.length) for x in (least, greatest))
    table = np.concatenate([table] * (last + 1 - first), axis=1)
    table[-1] += (np.arange(first, last + 1) * profile.length).repeat(profile.pieces)
    bounds = np.zeros((len(rows), table.shape[1] + 1), dtype=np.intp)
    for row, bound in zip(rows, bounds, strict=True):
        bound[1:-1] = row.searchsorted(table[-1, 1:])
    bounds[:, -1] = rows.shape[1]
    counts = (bounds[:, 1:] - bounds[:, :-1]).ravel()
    if len(rows) > 1:
        table = np.tile(table, len(rows))
    local = master.ravel() - table[-1].repeat(counts)
    found: FloatArray = table[-2].repeat(counts)
    for coefficient in table[-3::-1]:  # Horner, one coefficient spread at a time: less memory is faster
        found *= local
        found += coefficient.repeat(counts)
    return found.reshape(master.shape)


@lru_cache(maxsize=8)
def straightened(profile: CamProfile) -> FloatArray:
    """Coefficients of the profile minus the straight line, ascending powers, and last the start of each piece; a row each."""
    slope, start, table = -profile.mean_ratio, profile.breaks[:-1], profile.coefficients.T
    found = np.zeros((max(len(table), 2) + 1, profile.pieces))
    found[: len(table)], found[-1] = table, start
    found[0] -= table[0, 0]
    found[0] += slope * (start - start[0])
    found[1] += slope
    return found
