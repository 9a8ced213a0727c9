"""Polynomials in rows, all at once: values, derivatives, integrals, products, and what they are about other origins.

A table has the shape ``(n, m)``: one polynomial a row, ascending powers of the distance from the row's own origin.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Rows = NDArray[np.float64]


def ascending(numbers: Rows) -> Rows:
    """Sort numbers, each once, as `numpy.unique` does, which takes twice as long for few and loads masked arrays."""
    found = np.sort(numbers, axis=None)
    return np.asarray(found[np.concatenate([[True], found[1:] != found[:-1]])] if len(found) else found)


def values(table: Rows, row: NDArray[np.intp], local: Rows) -> Rows:
    """Evaluate polynomials at distances from their origins, by Horner's rule.

    Parameters
    ----------
    table
        Shape ``(n, m)``.
    row
        Which polynomial answers, of a shape that broadcasts to that of ``local``.
    local
        Distances from the origin of that row, any shape.
    """
    found = np.zeros(local.shape)
    for coefficient in table.T[::-1]:
        found *= local
        found += coefficient[row]
    return found


def at_ends(table: Rows, width: Rows) -> Rows:
    """Value of each polynomial at its own width, shape ``(n,)``."""
    found = np.zeros(len(table))
    for coefficient in table.T[::-1]:
        found *= width
        found += coefficient
    return found


def differentiated(table: Rows) -> Rows:
    """Take the derivative, shape ``(n, max(1, m - 1))``."""
    if table.shape[1] == 1:
        return np.zeros_like(table)
    return np.asarray(table[:, 1:] * np.arange(1, table.shape[1]))


def integrated(table: Rows, width: Rows) -> Rows:
    """Antiderivative, shape ``(n, m + 1)``: zero at the first origin, each row going on where the one before ends."""
    powers = np.arange(1, table.shape[1] + 1)
    found = np.concatenate([np.zeros((len(table), 1)), table / powers], axis=1)
    rise = np.sum(found * width[:, None] ** np.arange(found.shape[1]), axis=1)
    found[1:, 0] = np.cumsum(rise)[:-1]
    return found


def added(left: Rows, right: Rows) -> Rows:
    """Sum, row by row; the tables may differ in their degree."""
    found = np.zeros((len(left), max(left.shape[1], right.shape[1])))
    found[:, : left.shape[1]] = left
    found[:, : right.shape[1]] += right
    return found


def multiplied(left: Rows, right: Rows) -> Rows:
    """Product, row by row."""
    found = np.zeros((len(left), left.shape[1] + right.shape[1] - 1))
    for power in range(left.shape[1]):
        found[:, power : power + right.shape[1]] += left[:, power, None] * right
    return found


def recentred(table: Rows, offset: Rows) -> Rows:
    """Taylor shift: coefficients about a new origin that lies ``offset`` to the right.

    Parameters
    ----------
    table
        Shape ``(n, m)``.
    offset
        Shape ``(n,)``.

    Returns
    -------
    ndarray
        Shape ``(n, m)``.
    """
    moved = np.array(table, dtype=np.float64)
    rows = np.nonzero(offset)[0]
    if len(rows):
        part, by = moved[rows], offset[rows]
        for k in range(part.shape[1] - 1):  # synthetic division, once for each power
            for p in range(part.shape[1] - 2, k - 1, -1):
                part[:, p] += by * part[:, p + 1]
        moved[rows] = part
    return moved
