"""The return between two sync zones: closed forms, then grids in turn, their structure and its polish."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from camwright.design.returns.bernstein import ScaledMotion
from camwright.design.returns.closed_starts import known_start
from camwright.design.returns.grids import NO_MOTION, degree_of, grids, on_grid, room
from camwright.design.returns.ipopt import SolveStatus, programme
from camwright.design.returns.least_peaks import NARROW, ROUGH, least_peak_motion
from camwright.design.returns.measures import ALLOWED_EXCESS, better, excess, kept
from camwright.design.returns.polish import GRID_ERROR, polished_grid
from camwright.design.returns.possible import possible_motion
from camwright.design.returns.problem import ReturnProblem
from camwright.design.returns.scaling import ScaledProblem, motion_scale, scale_problem, unscale_profile
from camwright.design.returns.structure import extreme_motion, from_extreme, tidy
from camwright.design.returns.touching import touching_motions
from camwright.design.returns.transcription import LIMIT_MARGIN, Shape
from camwright.profiles.closed_forms.reach import greatest_reach
from camwright.profiles.errors import SolverError
from camwright.profiles.objective import OBJECTIVES
from camwright.profiles.polynomial.profile import CamProfile

# Intervals of a draft, which stand closer at the ends: where the jerk limit binds it does so there, however little the slave moves between.
DRAFT = {1: 60, 3: 30}
# Where the limits leave less than this share of the way to spare, the extreme motion is the only one to within that share.
NO_ROOM = 1e-8
# By this share an answer may differ from a closed form that it confirms: the margin by which the programme draws limits in, enlarged
# where a job leaves little room.
CONFIRMED = 1e-6


def solve_return(problem: ReturnProblem, *, thorough: bool = True) -> tuple[CamProfile, SolveStatus, int]:
    """Solve the return between two sync zones.

    Parameters
    ----------
    problem
        What is asked.
    thorough
        Whether a stroke that is touched is looked at on more than the first grid that serves: it takes three times as long and
        gains 0.1 % at most.

    Returns
    -------
    (profile, status, iterations)
        The return over ``[0, length]`` from slave zero.

    Raises
    ------
    SolverError
        No grid gave an answer.
    """
    scale = motion_scale(problem)
    if abs(scale) <= NO_MOTION * problem.length:
        # The straight line is the answer: nothing is faster than its own mean, and it has no acceleration.
        line = CamProfile.from_arrays([0.0, problem.length], [[0.0, problem.height / problem.length]])
        return line, SolveStatus.OPTIMAL, 0
    scaled = scale_problem(problem, scale)
    profile, status, iterations = _solve_scaled(scaled, thorough)
    return unscale_profile(profile, problem, scale), status, iterations


def draft_return(problem: ReturnProblem) -> tuple[CamProfile, bool]:
    """Draw the return at once: the closed form where there is one, else the answer on one grid.

    Returns
    -------
    (profile, exact)
        The return over ``[0, length]`` from slave zero, which keeps the limits; whether it is the optimum. On the grid it lies above,
        by 1.4 % at most on the examples and their objectives.

    Raises
    ------
    SolverError
        Neither that nor the whole search gave an answer.
    """
    scale = motion_scale(problem)
    if abs(scale) <= NO_MOTION * problem.length:
        return solve_return(problem)[0], True
    scaled = scale_problem(problem, scale)
    known = _confirmed(scaled)[0]
    if known is not None:
        return unscale_profile(known, problem, scale), True
    nodes = 0.5 - 0.5 * np.cos(np.linspace(0.0, math.pi, DRAFT[degree_of(scaled)] + 1))
    motion, success, _ = on_grid(scaled, np.diff(nodes), 0.0)
    profile = kept(motion, scaled) if success else None
    if profile is not None:
        return unscale_profile(profile, problem, scale), False
    back, status, _ = solve_return(problem)
    return back, status is SolveStatus.OPTIMAL


def _solve_scaled(problem: ScaledProblem, thorough: bool = True) -> tuple[CamProfile, SolveStatus, int]:
    """Grid, structure, polish; the grids are tried in turn until a polished answer is at least as good as its grid's.

    A closed form tells a motion that keeps the limits, from rest to rest the extreme one. It is the answer where the limits leave no room,
    and where the solver ends with something worse, at the edge of what double precision resolves. Its corners make a grid on which
    there is a motion, however little room there is.
    """
    free = _unlimited(problem)
    if free is not None:
        return free
    extreme = extreme_motion(problem)
    if extreme is not None and room(problem) < NO_ROOM:
        return tidy(from_extreme(extreme), problem).profile(), SolveStatus.OPTIMAL, 0
    known, iterations = _confirmed(problem)
    gentlest = known or kept(least_peak_motion(problem), problem) or _touching(problem)
    if gentlest is not None:
        return gentlest, SolveStatus.OPTIMAL, iterations
    witness = from_extreme(extreme) if extreme is not None else _possible(problem)
    if problem.confined:
        # the optimum of a mean square turns about where the gentlest motion does, not where the fastest does
        gentlest_way = replace(problem, objective="peak_acceleration")
        witness = least_peak_motion(gentlest_way, NARROW if thorough else ROUGH) or witness
    safe: CamProfile | None = None
    if witness is not None:
        profile = tidy(witness, problem).profile()
        safe = profile if excess(profile, problem) <= ALLOWED_EXCESS or extreme is not None else None
    return _first_as_good(problem, witness, safe, iterations, thorough)


def _unlimited(problem: ScaledProblem) -> tuple[CamProfile, SolveStatus, int] | None:
    """Solve without the limits, or without those of the position, where the answer keeps them; None where it does not."""
    if problem.objective != "rms_jerk":
        return None
    free = _quintic(problem)
    if excess(free, problem) <= ALLOWED_EXCESS:
        return free, SolveStatus.OPTIMAL, 0
    if not problem.confined:
        return None
    found = _solve_scaled(_unconfined(problem))
    return found if excess(found[0], problem) <= ALLOWED_EXCESS else None


def _first_as_good(
    problem: ScaledProblem, witness: ScaledMotion | None, safe: CamProfile | None, iterations: int, thorough: bool
) -> tuple[CamProfile, SolveStatus, int]:
    """Try the grids in turn until a polished answer is at least as good as any grid's; else give the best that keeps the limits."""
    reached = math.inf  # the least objective on any grid
    for lengths, relax, every in grids(problem, witness):
        grid, success, used = on_grid(problem, lengths, relax)
        iterations += used
        if not success:
            continue
        if relax == 0.0:
            reached = min(reached, grid.objective)
        polished, finer, used = polished_grid(problem, grid, every)
        iterations += used
        reached = min(reached, finer)
        if polished is not None and polished.objective <= reached * (1 + GRID_ERROR[grid.degree]):
            profile = kept(polished, problem)
            if profile is not None:
                return better(profile, safe, problem), SolveStatus.OPTIMAL, iterations
        profile = kept(grid, problem) if relax == 0.0 else None
        if profile is not None:
            safe = better(profile, safe, problem)
            if problem.confined and not thorough:
                break
    if safe is None:
        raise SolverError(
            f"IPOPT ({iterations} iterations) found no return that keeps the limits on any grid, although the job is not known to be "
            f"infeasible; loosen the limit that is nearest to binding by 1 % and report this job"
        )
    return safe, SolveStatus.OPTIMAL if _extreme_is_optimal(problem) else SolveStatus.BEST_FOUND, iterations


def _touching(problem: ScaledProblem) -> CamProfile | None:
    """Give the motion of least mean square acceleration that touches its stroke, None if another limit binds too."""
    found = (kept(motion, problem) for motion in touching_motions(problem))
    return next((profile for profile in found if profile is not None), None)


def _unconfined(problem: ScaledProblem) -> ScaledProblem:
    return replace(problem, least_position=-math.inf, greatest_position=math.inf)


def _possible(problem: ScaledProblem) -> ScaledMotion | None:
    """Give a motion that keeps the limits, from a closed form; None if there is none."""
    found = possible_motion(problem)
    return None if found is None else ScaledMotion(np.diff(found[0]), found[1], math.nan)


def _confirmed(problem: ScaledProblem) -> tuple[CamProfile | None, int]:
    """Polish the optimum that a closed form tells; None if there is none, or if it is not confirmed.

    A slave that keeps to a stroke of its own accord needs no limits of the position. Of quintics the limits are put at the nodes alone:
    where they are not kept between, the motion is none. A least peak needs no programme: it is one if any lesser leaves no motion.
    """
    peak = OBJECTIVES[problem.objective].form == "peak"
    known = known_start(_unconfined(_drawn_in(problem) if peak else problem))
    if known is None:
        return None, 0
    start, arcs = known
    if peak:
        return (kept(start, problem) if _none_below(start.objective, problem) else None), 0
    shape = Shape(arcs, start.degree, True, problem.objective, at_nodes=start.degree > 1)
    motion, statistics = programme(shape, known=True).solve(problem, start)
    iterations = int(statistics["iter_count"])
    if statistics["success"] and abs(motion.objective - start.objective) <= CONFIRMED * start.objective:
        return kept(motion, problem), iterations
    return None, iterations


def _drawn_in(problem: ScaledProblem) -> ScaledProblem:
    """Draw the limits in as the programme does."""
    less = 1.0 - LIMIT_MARGIN
    ratio, slope, jerk = problem.greatest_ratio * less, problem.greatest_slope * less, problem.greatest_jerk * less
    return replace(problem, greatest_ratio=ratio, greatest_slope=slope, greatest_jerk=jerk)


def _none_below(peak: float, problem: ScaledProblem) -> bool:
    """Whether a peak lower by `CONFIRMED` would leave a rest-to-rest slave no motion that comes as far as it must."""
    less = peak * (1 - CONFIRMED)
    of_jerk = OBJECTIVES[problem.objective].order == 3
    slope, jerk = (problem.greatest_slope, less) if of_jerk else (less, problem.greatest_jerk)
    return greatest_reach(1.0, problem.greatest_ratio, slope, jerk) < problem.height


def _quintic(problem: ScaledProblem) -> CamProfile:
    """Return the quintic through the boundary values: of all motions the one with the least RMS jerk, if the limits allow it."""
    v, a, b = problem.end_ratio, problem.start_slope, problem.end_slope
    d, e, f = problem.height - a / 2, v - a, b - a  # what the cubic and higher powers make up for at the end
    row = [0.0, 0.0, a / 2, 10 * d - 4 * e + f / 2, -15 * d + 7 * e - f, 6 * d - 3 * e + f / 2]
    return CamProfile.from_arrays([0.0, 1.0], [row])


def _extreme_is_optimal(problem: ScaledProblem) -> bool:
    return OBJECTIVES[problem.objective].form == "peak" and problem.rest_to_rest and not problem.confined
