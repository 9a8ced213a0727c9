"""Rows of a servo-aware programme that hold the command to its limits while the line ramps."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from camwright.design.line.forms import ramp_forms
from camwright.design.servo_aware.axis_problem import AxisProblem
from camwright.profiles.polynomial.profile import FloatArray

BESIDE = 1
"""Intervals on either side of a row that is broken which get it too: what is pressed down there rises beside."""


class RampRows:
    """What the line's ramps ask of a command (`camwright.design.line.forms`), by Bernstein coefficients on the intervals of its spline.

    Most of it never matters: a row stands from the first answer on that breaks it.
    """

    def __init__(self, problem: AxisProblem, beside: RampRows | None = None) -> None:
        self._problem = problem
        self._asked: NDArray[np.bool_] = np.zeros(0, dtype=bool) if beside is None else beside._asked.copy()

    @cached_property
    def _all(self) -> tuple[FloatArray, FloatArray]:
        """All rows as ``matrix @ z + constant <= 1``: form by form, coefficient by coefficient, interval by interval."""
        basis = self._problem.basis
        (slope, slope_0), (jerk, jerk_0) = basis.differences[2], basis.differences[3]
        ratio, ratio_0 = basis.ratios
        width = np.diff(basis.nodes)
        middle = ratio[:-1] + 0.5 * width[:, None] * slope[:-1], ratio_0[:-1] + 0.5 * width * slope_0[:-1]
        half = 0.5 * (slope[1:] + slope[:-1]), 0.5 * (slope_0[1:] + slope_0[:-1])
        places = (
            ((ratio[:-1], ratio_0[:-1]), (slope[:-1], slope_0[:-1])),
            (middle, half),
            ((ratio[1:], ratio_0[1:]), (slope[1:], slope_0[1:])),
        )
        matrices, constants = [], []
        for form in ramp_forms(self._problem.task):
            for (fast, fast_0), (bent, bent_0) in places:
                matrices.append(form.ratio * fast + form.slope * bent + form.jerk * jerk)
                constants.append(form.ratio * fast_0 + form.slope * bent_0 + form.jerk * jerk_0)
        return np.vstack(matrices) * self._problem.scale, np.concatenate(constants)

    def rows(self) -> tuple[FloatArray, FloatArray]:
        """Give the rows that stand, as ``matrix @ z + constant <= 1``."""
        if not self._asked.any():
            return np.zeros((0, self._problem.basis.matrix.shape[1])), np.zeros(0)
        matrix, constant = self._all
        return matrix[self._asked], constant[self._asked]

    @property
    def numbers(self) -> NDArray[np.intp]:
        """Numbers of the rows that stand."""
        return np.nonzero(self._asked)[0]

    def tighten(self, unknowns: FloatArray, room: float) -> bool:
        """Let those rows stand from now on that an answer breaks by more than there is room for below 1; whether there are new ones."""
        if not self._problem.task.line.ramps:
            return False
        matrix, constant = self._all
        if not len(self._asked):
            self._asked = np.zeros(len(constant), dtype=bool)
        broken = self._spread(matrix @ unknowns + constant > 1.0 - 0.5 * room)
        new = broken & ~self._asked
        self._asked |= new
        return bool(new.any())

    def _spread(self, broken: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Mark the intervals beside too."""
        by_interval = broken.reshape(-1, len(self._problem.basis.nodes) - 1)
        wide = by_interval.copy()
        for step in range(1, BESIDE + 1):
            wide[:, step:] |= by_interval[:, :-step]
            wide[:, :-step] |= by_interval[:, step:]
        return wide.ravel()
