"""Motions by the Bernstein coefficients of their accelerations, and the matrices that such coefficients need."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from camwright.profiles.polynomial.profile import CamProfile, FloatArray


@dataclass(frozen=True, eq=False)
class ScaledMotion:
    """A motion of the scaled problem in the programme's own coordinates.

    Parameters
    ----------
    lengths
        Lengths of the pieces, shape ``(M,)``.
    accelerations
        Bernstein coefficients of ``q''``, neighbours sharing one: shape ``(M p + 1,)``.
    objective
        Value of the objective; for root-mean-square objectives the mean square.
    """

    lengths: FloatArray
    accelerations: FloatArray
    objective: float

    @property
    def degree(self) -> int:
        """Degree of the acceleration on a piece."""
        return (len(self.accelerations) - 1) // len(self.lengths)

    def nodes(self) -> tuple[FloatArray, FloatArray]:
        """Position and ratio at the ``M + 1`` nodes, integrated from rest at zero."""
        p, h = self.degree, self.lengths
        rows = piece_coefficients(self.accelerations, p)
        v = np.concatenate([[0.0], np.cumsum(h * rows.sum(axis=1) / (p + 1))])
        bent = h * h * (rows @ np.arange(p + 1, 0, -1)) / ((p + 1) * (p + 2))
        return np.concatenate([[0.0], np.cumsum(h * v[:-1] + bent)]), v

    def profile(self) -> CamProfile:
        """Return the motion as a profile over ``[0, 1]``; pieces of no length are left out."""
        p = self.degree
        q, v = self.nodes()
        x = np.concatenate([[0.0], np.cumsum(self.lengths)])
        there = np.diff(x) > 0
        h = self.lengths[there]
        k = np.arange(p + 1)
        power = piece_coefficients(self.accelerations, p)[there] @ power_basis(p).T
        rows = np.column_stack([q[:-1][there], v[:-1][there], power / h[:, None] ** k / ((k + 1) * (k + 2))])
        breaks = np.append(x[:-1][there], 1.0)
        return CamProfile(breaks, rows)


def piece_coefficients(accelerations: FloatArray, degree: int) -> FloatArray:
    """Rows of Bernstein coefficients of the single pieces, shape ``(M, p + 1)``."""
    count = (len(accelerations) - 1) // degree
    return np.asarray(accelerations[np.arange(count)[:, None] * degree + np.arange(degree + 1)])


@lru_cache
def power_basis(degree: int) -> FloatArray:
    """Matrix from Bernstein coefficients on the unit interval to ascending powers."""
    matrix = np.zeros((degree + 1, degree + 1))
    for k in range(degree + 1):
        for i in range(k, degree + 1):
            matrix[i, k] = (-1) ** (i - k) * math.comb(degree, i) * math.comb(i, k)
    return matrix


def gram(degree: int) -> FloatArray:
    """Integrals of products of Bernstein polynomials over the unit interval."""
    c, n = math.comb, degree
    table = [[c(n, k) * c(n, m) / (c(2 * n, k + m) * (2 * n + 1)) for m in range(n + 1)] for k in range(n + 1)]
    return np.array(table)


@lru_cache
def subdivision(degree: int, parts: int) -> FloatArray:
    """Matrix from Bernstein coefficients on the unit interval to those on equal parts of it, shape ``(parts (d + 1), d + 1)``.

    The coefficient ``k`` on ``[s, t]`` is the polar form at ``d - k`` times ``s`` and ``k`` times ``t`` (de Casteljau).
    """
    rows = []
    for part in range(parts):
        s, t = part / parts, (part + 1) / parts
        for k in range(degree + 1):
            table = np.eye(degree + 1)
            for u in [s] * (degree - k) + [t] * k:
                table = (1 - u) * table[:-1] + u * table[1:]
            rows.append(table[0])
    return np.array(rows)


@lru_cache
def inner(degree: int, parts: int) -> FloatArray:
    """`subdivision` with each coefficient once: where two parts meet they share one."""
    keep = np.arange(parts * (degree + 1)) % (degree + 1) > 0
    keep[0] = True
    return subdivision(degree, parts)[keep]
