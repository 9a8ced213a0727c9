"""Which of many boxes overlap: a sweep along the axis that leaves the fewest pairs to look at."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from camwright.profiles.errors import InputError
from camwright.profiles.polynomial.profile import FloatArray

Indices = NDArray[np.int64]

MOST_PAIRS = 50_000_000
"""Pairs above which a sweep is refused: it would take longer than a user waits."""

_CHUNK = 1_000_000


def overlapping(low: FloatArray, high: FloatArray) -> tuple[Indices, Indices]:
    """Find the pairs ``i < j`` of boxes that overlap or touch.

    Parameters
    ----------
    low, high
        Corners of the boxes, shape ``(n, k)``.

    Raises
    ------
    InputError
        More than `MOST_PAIRS` pairs are left to look at by the best sweep.
    """
    if len(low) < 2:
        return np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64)
    sweeps = [_swept(low[:, axis], high[:, axis]) for axis in range(low.shape[1])]
    order, counts = min(sweeps, key=lambda sweep: int(sweep[1].sum()))
    if int(counts.sum()) > MOST_PAIRS:
        raise InputError(f"more than {MOST_PAIRS} pairs of lines lie beside each other; purge what is no die line")
    first, second = [np.zeros(0, dtype=np.int64)], [np.zeros(0, dtype=np.int64)]
    for rows in _portions(counts):
        count = counts[rows]
        a = np.repeat(np.arange(rows.start, rows.stop), count)
        b = a + 1 + np.arange(len(a)) - np.repeat(np.cumsum(count) - count, count)
        a, b = order[a], order[b]
        meet = (low[a] <= high[b]).all(axis=1) & (low[b] <= high[a]).all(axis=1)
        first.append(np.minimum(a[meet], b[meet]))
        second.append(np.maximum(a[meet], b[meet]))
    return np.concatenate(first), np.concatenate(second)


def _swept(low: FloatArray, high: FloatArray) -> tuple[Indices, Indices]:
    """Order of the boxes along an axis, and how many of those that follow begin before each ends."""
    order = np.argsort(low, kind="stable").astype(np.int64)
    until = np.searchsorted(low[order], high[order], side="right")
    return order, np.maximum(until - np.arange(1, len(low) + 1), 0).astype(np.int64)


def _portions(counts: Indices) -> Iterator[slice]:
    """Rows of the sweep in portions of about `_CHUNK` pairs, which bounds the memory."""
    until = np.cumsum(counts)
    start = 0
    while start < len(counts):
        before = until[start - 1] if start else 0
        stop = max(start + 1, int(np.searchsorted(until, before + _CHUNK, side="right")))
        yield slice(start, stop)
        start = stop
