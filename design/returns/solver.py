"""The return between two sync zones: grid, structure, polish."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from camwright.design.returns.closed_starts import known_start
from camwright.design.returns.ipopt import SolveStatus, programme
from camwright.design.returns.least_peaks import NARROW, ROUGH, least_peak_motion
from camwright.design.returns.possible import possible_motion, spare
from camwright.design.returns.problem import ReturnProblem
from camwright.design.returns.scaling import (
    ScaledProblem,
    motion_scale,
    scale_problem,
    unscale_profile,
)
from camwright.design.returns.structure import (
    VANISHED,
    extreme_motion,
    from_extreme,
    read_cubic,
    readings_of,
    subdivide,
    tidy,
)
from camwright.design.returns.touching import touching_motions
from camwright.design.returns.transcription import (
    LIMIT_MARGIN,
    Arc,
    ScaledMotion,
    Shape,
)
from camwright.profiles.closed_forms.reach import greatest_reach
from camwright.profiles.errors import SolverError
from camwright.profiles.objective import OBJECTIVES, MotionObjective
from camwright.profiles.polynomial.profile import CamProfile, FloatArray

FREE: tuple[Arc, ...] = ("free",)
# Intervals of the first look and of the last, by the degree of the acceleration. The structure, not the grid, decides the answer: 40
# intervals tell apart arcs of 1/40 of the return; 160 are 0.2 % from the optimum.
COARSE = {1: 40, 3: 24}
MEDIUM = 40
FINE = {1: 160, 3: 80}
# Intervals where a stroke that is touched in points leaves no arcs to read: within 0.1 % of the least mean square of the acceleration.
FINER = 320
# Intervals of a draft, which stand closer at the ends: where the jerk limit binds it does so there, however little the slave moves between.
DRAFT = {1: 60, 3: 30}
# Intervals for each arc where a polished motion is looked at again.
EACH_ARC = 6
# Limits widened on the grid where a job leaves so little room that no motion on the grid keeps them.
WIDER = 0.1
# Where they leave less than this share, a few intervals of the same length have no motion that keeps them.
LITTLE_ROOM = 1e-2
# Where the limits leave less than this share of the way to spare, the extreme motion is the only one to within that share.
NO_ROOM = 1e-8
# Objectives that differ by less than this share are the same.
SAME = 1e-7
# By this share an answer may differ from a closed form that it confirms: the margin by which the programme draws limits in, enlarged
# where a job leaves little room.
CONFIRMED = 1e-6
# By this share a polished answer may be above its grid's, by the degree of the acceleration: on the grid the solver widens limits by
# 1e-8, which a mean square of the jerk shows enlarged.
GRID_ERROR = {1: SAME, 3: 1e-5}
# How often the arcs of a polished motion are looked at again.
READINGS = 4
# Largest share by which a limit may be exceeded by rounding; the contract says 1e-9.
ALLOWED_EXCESS = 5e-10
# Arcs of a polished motion shorter than this share of the return have vanished and get no grid of their own.
LEAST_ARC = 1e-5
# A deviation from the straight line below this share of the return's length is no motion at all.
NO_MOTION = 1e-13


def objective_value(back: CamProfile, objective: MotionObjective) -> float:
    """Objective of a return over the master: peak or root mean square of ``y''`` or ``y'''``, exactly."""
    of = OBJECTIVES[objective]
    if of.form == "rms":
        return math.sqrt(back.mean_square(of.order))
    least, greatest = back.extrema(of.order)
    return max(-least.value, greatest.value, 0.0)


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
    nodes = 0.5 - 0.5 * np.cos(np.linspace(0.0, math.pi, DRAFT[_degree(scaled)] + 1))
    motion, success, _ = _on_grid(scaled, np.diff(nodes), 0.0)
    profile = _kept(motion, scaled) if success else None
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
    if extreme is not None and _room(problem) < NO_ROOM:
        return tidy(from_extreme(extreme), problem).profile(), SolveStatus.OPTIMAL, 0
    known, iterations = _confirmed(problem)
    gentlest = known or _kept(least_peak_motion(problem), problem) or _touching(problem)
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
    for lengths, relax, every in _grids(problem, witness):
        grid, success, used = _on_grid(problem, lengths, relax)
        iterations += used
        if not success:
            continue
        if relax == 0.0:
            reached = min(reached, grid.objective)
        polished, finer, used = _polished(problem, grid, every)
        iterations += used
        reached = min(reached, finer)
        if polished is not None and polished.objective <= reached * (1 + GRID_ERROR[grid.degree]):
            profile = _kept(polished, problem)
            if profile is not None:
                return _better(profile, safe, problem), SolveStatus.OPTIMAL, iterations
        profile = _kept(grid, problem) if relax == 0.0 else None
        if profile is not None:
            safe = _better(profile, safe, problem)
            if problem.confined and not thorough:
                break
    if safe is None:
        raise SolverError(
            f"IPOPT ({iterations} iterations) found no return that keeps the limits on any grid, although the job is not known to be "
            f"infeasible; loosen the limit that is nearest to binding by 1 % and report this job"
        )
    return safe, SolveStatus.OPTIMAL if _extreme_is_optimal(problem) else SolveStatus.BEST_FOUND, iterations


def _polished(problem: ScaledProblem, grid: ScaledMotion, thorough: bool) -> tuple[ScaledMotion | None, float, int]:
    """Polish a grid's answer, None if that fails; with the least objective on grids of its own arcs, and the iterations."""
    polished, success, used = _polish(problem, grid, thorough)
    if not success:
        return None, math.inf, used
    if grid.degree == 1 or len(polished.lengths) == 1:
        return polished, math.inf, used
    again, finer, more = _read_again(problem, polished)
    return again, finer, used + more


def _kept(motion: ScaledMotion | None, problem: ScaledProblem) -> CamProfile | None:
    """Give the profile of a motion, None if there is no motion or it exceeds a limit."""
    if motion is None:
        return None
    profile = tidy(motion, problem).profile()
    return profile if excess(profile, problem) <= ALLOWED_EXCESS else None


def _touching(problem: ScaledProblem) -> CamProfile | None:
    """Give the motion of least mean square acceleration that touches its stroke, None if another limit binds too."""
    kept = (_kept(motion, problem) for motion in touching_motions(problem))
    return next((profile for profile in kept if profile is not None), None)


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
        return (_kept(start, problem) if _none_below(start.objective, problem) else None), 0
    shape = Shape(arcs, start.degree, True, problem.objective, at_nodes=start.degree > 1)
    motion, statistics = programme(shape, known=True).solve(problem, start)
    iterations = int(statistics["iter_count"])
    if statistics["success"] and abs(motion.objective - start.objective) <= CONFIRMED * start.objective:
        return _kept(motion, problem), iterations
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
        grid, success, used = _on_grid(problem, subdivide(arcs / arcs.sum(), EACH_ARC * len(arcs)), 0.0)
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


def _extreme_is_optimal(problem: ScaledProblem) -> bool:
    return OBJECTIVES[problem.objective].form == "peak" and problem.rest_to_rest and not problem.confined


def _better(profile: CamProfile, other: CamProfile | None, problem: ScaledProblem) -> CamProfile:
    """Choose the other profile if its objective is less by more than what counts as the same."""
    if other is None:
        return profile
    name = problem.objective
    return other if objective_value(other, name) < objective_value(profile, name) * (1 - SAME) else profile


def excess(profile: CamProfile, problem: ScaledProblem) -> float:
    """Largest share by which a scaled profile exceeds a limit or misses its end, exactly."""
    low, high, slope, jerk = _greatest(profile)
    room = max(problem.greatest_ratio, -problem.least_ratio)
    return max(
        (high - problem.greatest_ratio) / room,
        (problem.least_ratio - low)
        / max(-problem.least_ratio, 1e-300),  # a slave that may not reverse: of its speed in sync
        slope / problem.greatest_slope - 1.0,
        jerk / problem.greatest_jerk - 1.0,
        abs(float(profile(1.0)) - problem.height),
        _beyond(profile, problem),
        abs(float(profile(1.0, 1)) - problem.end_ratio),
        abs(float(profile(0.0, 2)) - problem.start_slope) / max(slope, 1.0),
        abs(float(profile(1.0, 2)) - problem.end_slope) / max(slope, 1.0),
    )


def _greatest(profile: CamProfile) -> tuple[float, float, float, float]:
    """Least and greatest ratio, and the greatest magnitudes of its slope and of that slope's slope, exactly."""
    if profile.degree > 3:
        low, high = profile.extrema(1)
        slope, jerk = (max(abs(extremum.value) for extremum in profile.extrema(order)) for order in (2, 3))
        return low.value, high.value, slope, jerk
    # pieces of cubics, all at once: the ratio is extreme at a node or where its slope, a straight line, is zero
    width = np.diff(profile.breaks)
    _, start, half, sixth = np.pad(profile.coefficients, ((0, 0), (0, 3 - profile.degree))).T
    slope_end = 2 * half + 6 * sixth * width
    turns = 2 * half * slope_end < 0
    ratios = np.concatenate(
        [start, start + width * (half * 2 + 3 * sixth * width), start[turns] - half[turns] ** 2 / (3 * sixth[turns])]
    )
    slopes = np.abs([2 * half, slope_end])
    return float(ratios.min()), float(ratios.max()), float(slopes.max()), float(6 * np.abs(sixth).max())


def _beyond(profile: CamProfile, problem: ScaledProblem) -> float:
    """How far the slave leaves the positions it may take (in units of the scaled height)."""
    if not problem.confined:
        return 0.0
    low, high = profile.add_line(problem.drift).extrema(0)
    return max(high.value - problem.greatest_position, problem.least_position - low.value)


def _room(problem: ScaledProblem) -> float:
    """Share by which the limits could move a slave further than its height; where it is not at rest at its ends, or less far."""
    if not problem.rest_to_rest:
        return spare(problem) / max(abs(problem.height), NO_MOTION)
    far = greatest_reach(1.0, problem.greatest_ratio, problem.greatest_slope, problem.greatest_jerk)
    return far / problem.height - 1.0


def grid_objective(problem: ReturnProblem) -> float:
    """Objective on the coarse grid alone, over the master: a few per cent above the optimum, smooth in the problem's numbers.

    Infinite if no motion on the grid keeps the limits; root mean squares as such.
    """
    scale = motion_scale(problem)
    if abs(scale) <= NO_MOTION * problem.length:
        return 0.0
    scaled = scale_problem(problem, scale)
    count = COARSE[_degree(scaled)]
    motion, success, _ = _on_grid(scaled, np.full(count, 1.0 / count), 0.0)
    if not success:
        return math.inf
    of = OBJECTIVES[problem.objective]
    value = motion.objective if of.form == "peak" else math.sqrt(max(0.0, motion.objective))
    return value * abs(scale) / problem.length**of.order


def _grids(problem: ScaledProblem, witness: ScaledMotion | None) -> Iterator[tuple[FloatArray, float, bool]]:
    """Grids to try in turn, each with the share by which the limits are widened on it and with how thoroughly to polish."""
    degree = _degree(problem)
    arcs = None if witness is None else witness.lengths[witness.lengths > VANISHED]
    arcs = None if arcs is None else arcs / arcs.sum()
    little = not problem.confined and _room(problem) <= LITTLE_ROOM
    coarse, fine = (np.full(count, 1.0 / count) for count in (COARSE[degree], FINE[degree]))
    if problem.confined and arcs is not None:
        if degree == 1:
            yield subdivide(arcs, FINE[degree]), 0.0, False
            yield subdivide(arcs, FINER), 0.0, False
        else:
            yield subdivide(arcs, MEDIUM), 0.0, False
            yield fine, 0.0, False
            yield subdivide(arcs, FINE[degree]), 0.0, False
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


def _degree(problem: ScaledProblem) -> int:
    """Degree of the acceleration that the optimum's pieces need: the least RMS jerk is a quintic, all else piecewise cubic."""
    return 3 if problem.objective == "rms_jerk" else 1


def _on_grid(problem: ScaledProblem, lengths: FloatArray, relax: float) -> tuple[ScaledMotion, bool, int]:
    """Solve with given lengths of the pieces, starting from the quintic through the boundary values."""
    degree = _degree(problem)
    shape = Shape(FREE * len(lengths), degree, False, problem.objective, problem.confined)
    nodes = np.concatenate([[0.0], np.cumsum(lengths)])
    x = np.interp(np.arange(len(lengths) * degree + 1) / degree, np.arange(len(lengths) + 1), nodes)
    bend = 60 * x - 180 * x**2 + 120 * x**3
    motion, statistics = programme(shape).solve(problem, ScaledMotion(lengths, problem.height * bend, 60.0), relax)
    return motion, bool(statistics["success"]), int(statistics["iter_count"])


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
