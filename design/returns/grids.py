"""The grids on which a return is looked for, and the answer on one of them."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from camwright.design.returns.bernstein import ScaledMotion
from camwright.design.returns.ipopt import programme
from camwright.design.returns.possible import spare
from camwright.design.returns.problem import ReturnProblem
from camwright.design.returns.scaling import ScaledProblem, motion_scale, scale_problem
from camwright.design.returns.structure import VANISHED, subdivide
from camwright.design.returns.transcription import Arc, Shape
from camwright.profiles.closed_forms.reach import greatest_reach
from camwright.profiles.objective import OBJECTIVES
from camwright.profiles.polynomial.profile import FloatArray

FREE: tuple[Arc, ...] = ("free",)
# Intervals of the first look and of the last, by the degree of the acceleration. The structure, not the grid, decides the answer: 40
# intervals tell apart arcs of 1/40 of the return; 160 are 0.2 % from the optimum.
COARSE = {1: 40, 3: 24}
MEDIUM = 40
FINE = {1: 160, 3: 80}
# Intervals where a stroke that is touched in points leaves no arcs to read: within 0.1 % of the least mean square of the acceleration.
FINER = 320
# Limits widened on the grid where a job leaves so little room that no motion on the grid keeps them.
WIDER = 0.1
# Where they leave less than this share, a few intervals of the same length have no motion that keeps them.
LITTLE_ROOM = 1e-2
# A deviation from the straight line below this share of the return's length is no motion at all.
NO_MOTION = 1e-13


def degree_of(problem: ScaledProblem) -> int:
    """Degree of the acceleration that the optimum's pieces need: the least RMS jerk is a quintic, all else piecewise cubic."""
    return 3 if problem.objective == "rms_jerk" else 1


def room(problem: ScaledProblem) -> float:
    """Share by which the limits could move a slave further than its height; where it is not at rest at its ends, or less far."""
    if not problem.rest_to_rest:
        return spare(problem) / max(abs(problem.height), NO_MOTION)
    far = greatest_reach(1.0, problem.greatest_ratio, problem.greatest_slope, problem.greatest_jerk)
    return far / problem.height - 1.0


def grids(problem: ScaledProblem, witness: ScaledMotion | None) -> Iterator[tuple[FloatArray, float, bool]]:
    """Grids to try in turn, each with the share by which the limits are widened on it and with how thoroughly to polish."""
    degree = degree_of(problem)
    arcs = None if witness is None else (lasting := witness.lengths[witness.lengths > VANISHED]) / lasting.sum()
    little = not problem.confined and room(problem) <= LITTLE_ROOM
    coarse, fine = (np.full(count, 1.0 / count) for count in (COARSE[degree], FINE[degree]))
    if problem.confined and arcs is not None:
        yield from _confined(arcs, degree)
        return
    if degree == 1:
        if arcs is None or not little:
            yield coarse, 0.0, True
        if arcs is not None:
            yield subdivide(arcs, COARSE[degree]), 0.0, True
        yield coarse, WIDER, True
        yield fine, 0.0, True
        return
    medium = np.full(MEDIUM, 1.0 / MEDIUM)
    if arcs is None or not little:
        yield coarse, 0.0, False
        yield medium, 0.0, False
    if arcs is not None:
        yield subdivide(arcs, MEDIUM), 0.0, False
    yield fine, 0.0, True
    if arcs is not None:
        yield subdivide(arcs, FINE[degree]), 0.0, True
    yield medium, WIDER, True


def _confined(arcs: FloatArray, degree: int) -> Iterator[tuple[FloatArray, float, bool]]:
    """Grids of a slave that must keep to its stroke: on the arcs of a motion that does, finer and finer."""
    for count in (FINE[degree], FINER) if degree == 1 else (MEDIUM, None, FINE[degree]):
        yield np.full(FINE[degree], 1.0 / FINE[degree]) if count is None else subdivide(arcs, count), 0.0, False


def on_grid(problem: ScaledProblem, lengths: FloatArray, relax: float) -> tuple[ScaledMotion, bool, int]:
    """Solve with given lengths of the pieces, starting from the quintic through the boundary values."""
    degree = degree_of(problem)
    shape = Shape(FREE * len(lengths), degree, False, problem.objective, problem.confined)
    nodes = np.concatenate([[0.0], np.cumsum(lengths)])
    x = np.interp(np.arange(len(lengths) * degree + 1) / degree, np.arange(len(lengths) + 1), nodes)
    bend = 60 * x - 180 * x**2 + 120 * x**3
    motion, statistics = programme(shape).solve(problem, ScaledMotion(lengths, problem.height * bend, 60.0), relax)
    return motion, bool(statistics["success"]), int(statistics["iter_count"])


def grid_objective(problem: ReturnProblem) -> float:
    """Objective on the coarse grid alone, over the master: a few per cent above the optimum, smooth in the problem's numbers.

    Infinite if no motion on the grid keeps the limits; root mean squares as such.
    """
    scale = motion_scale(problem)
    if abs(scale) <= NO_MOTION * problem.length:
        return 0.0
    scaled = scale_problem(problem, scale)
    count = COARSE[degree_of(scaled)]
    motion, success, _ = on_grid(scaled, np.full(count, 1.0 / count), 0.0)
    if not success:
        return math.inf
    of = OBJECTIVES[problem.objective]
    value = motion.objective if of.form == "peak" else math.sqrt(max(0.0, motion.objective))
    return value * abs(scale) / problem.length**of.order
