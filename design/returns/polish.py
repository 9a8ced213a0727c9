"""Polish: few pieces of unknown length, from the structure of an answer on a grid."""

from __future__ import annotations

import math

from camwright.design.returns.bernstein import ScaledMotion
from camwright.design.returns.grids import on_grid
from camwright.design.returns.ipopt import programme
from camwright.design.returns.measures import ALLOWED_EXCESS, SAME, excess
from camwright.design.returns.scaling import ScaledProblem
from camwright.design.returns.structure import read_cubic, readings_of, subdivide, tidy
from camwright.design.returns.transcription import Arc, Shape

# Intervals for each arc where a polished motion is looked at again.
EACH_ARC = 6
# By this share a polished answer may be above its grid's, by the degree of the acceleration: on the grid the solver widens limits by
# 1e-8, which a mean square of the jerk shows enlarged.
GRID_ERROR = {1: SAME, 3: 1e-5}
# How often the arcs of a polished motion are looked at again.
READINGS = 4
# Arcs of a polished motion shorter than this share of the return have vanished and get no grid of their own.
LEAST_ARC = 1e-5


def polished_grid(problem: ScaledProblem, grid: ScaledMotion, thorough: bool) -> tuple[ScaledMotion | None, float, int]:
    """Polish a grid's answer, None if that fails; with the least objective on grids of its own arcs, and the iterations."""
    polished, success, used = _polish(problem, grid, thorough)
    if not success:
        return None, math.inf, used
    if grid.degree == 1 or len(polished.lengths) == 1:
        return polished, math.inf, used
    again, finer, more = _read_again(problem, polished)
    return again, finer, used + more


def _read_again(problem: ScaledProblem, polished: ScaledMotion) -> tuple[ScaledMotion, float, int]:
    """Look at the arcs of a polished motion on grids of their own, until nothing new shows: arcs shorter than an interval come to light.

    Returns
    -------
    (motion, reached, iterations)
        The best polished motion, and the least objective on any of these grids.
    """
    iterations, reached = 0, math.inf
    for _ in range(READINGS):
        arcs = polished.lengths[polished.lengths > LEAST_ARC]
        if len(arcs) < 2:
            break
        grid, success, used = on_grid(problem, subdivide(arcs / arcs.sum(), EACH_ARC * len(arcs)), 0.0)
        iterations += used
        if not success:
            break
        reached = min(reached, grid.objective)
        if grid.objective >= polished.objective * (1 - SAME):
            break
        again, success, used = _polish(problem, grid, thorough=True)
        iterations += used
        if not success or again.objective >= polished.objective * (1 - SAME):
            break
        polished = again
    return polished, reached, iterations


def _polish(problem: ScaledProblem, grid: ScaledMotion, thorough: bool) -> tuple[ScaledMotion, bool, int]:
    """Solve for few pieces of unknown length, starting from the structure of a grid solution.

    A quintic grid can be read in several ways. They are tried in turn, with limits at the nodes alone and then, if ``thorough``, with
    limits everywhere, until one ends with something as good as the grid. A stroke that is touched in points shows in no arc, so there is
    nothing to read.
    """
    if problem.confined:
        return grid, False, 0
    if grid.degree == 1:
        return _polish_arcs(problem, *read_cubic(grid, problem))
    enough = grid.objective * (1 + GRID_ERROR[grid.degree])
    best, success, iterations = grid, False, 0
    readings = readings_of(grid, problem)
    for at_nodes in (True, False):
        if not (at_nodes or thorough):
            continue
        for start, arcs in readings if at_nodes else readings[-2:]:
            motion, also, used = _polish_arcs(problem, start, arcs, at_nodes)
            iterations += used
            if also and (not success or motion.objective < best.objective):
                best, success = motion, True
            if success and best.objective <= enough:
                return best, True, iterations
    return best, success, iterations


def _polish_arcs(
    problem: ScaledProblem, start: ScaledMotion, arcs: tuple[Arc, ...], at_nodes: bool = False
) -> tuple[ScaledMotion, bool, int]:
    """Solve for arcs of unknown length; with limits at the nodes alone it is a success only if they are kept between, too."""
    shape = Shape(arcs, start.degree, True, problem.objective, problem.confined, at_nodes)
    if shape.overdetermined:
        return start, False, 0
    motion, statistics = programme(shape).solve(problem, start)
    success = bool(statistics["success"])
    if success and at_nodes:
        success = excess(tidy(motion, problem).profile(), problem) <= ALLOWED_EXCESS
    return motion, success, int(statistics["iter_count"])
