"""The least peak of a return: the least limit within which there is still a motion, and that motion."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from camwright.design.returns.bernstein import ScaledMotion
from camwright.design.returns.possible import possible_motion, spare
from camwright.design.returns.scaling import ScaledProblem
from camwright.design.returns.structure import VANISHED
from camwright.profiles.halving import narrowed
from camwright.profiles.objective import OBJECTIVES
from camwright.profiles.polynomial.profile import FloatArray

# The least limit is found to this share, far below what counts as the same objective; and to this one where its arcs make a grid.
NARROW, ROUGH = 1e-12, 1e-6
# A first guess at a limit that is too low is this share of the given one, and lowered by it again.
STRIDE = 0.25
# A motion that is said to keep a limit does so but for this share of it.
KEPT = 1e-9
MOST_STRIDES = 40


def least_peak_motion(problem: ScaledProblem, narrow: float = NARROW) -> ScaledMotion | None:
    """Give the motion of least peak acceleration, or jerk, of a slave that must keep to a stroke or whose ends are no rests.

    Whether the limits leave any motion is known in closed form (`camwright.profiles.closed_forms.overshoot`, `transfer` without a
    stroke), and a higher limit leaves more: the least limit of the acceleration that leaves one, with the others as they are, is the
    least peak that any motion has. None is below what the return's ends ask for.

    Parameters
    ----------
    problem
        What is asked.
    narrow
        Share to which the least limit is found.

    Returns
    -------
    Motion or None
        ``None`` for other objectives, from rest to rest without a stroke, and where not even the given limits leave a motion.
    """
    if OBJECTIVES[problem.objective].form != "peak" or (problem.rest_to_rest and not problem.confined):
        return None
    slope = problem.objective == "peak_acceleration"

    def limited(limit: float) -> ScaledProblem:
        return replace(problem, greatest_slope=limit) if slope else replace(problem, greatest_jerk=limit)

    def within(limit: float) -> tuple[FloatArray, FloatArray] | None:
        motion = possible_motion(limited(limit))
        return motion if motion is not None and _peak(*motion, slope=slope) <= limit * (1 + KEPT) else None

    def missed(limit: float) -> float:
        if problem.confined:
            return math.inf if within(limit) is None else -math.inf
        return -spare(limited(limit))

    ends = problem.start_slope, problem.end_slope
    floor = max(map(abs, ends)) if slope else abs(ends[1] - ends[0])
    limit = problem.greatest_slope if slope else problem.greatest_jerk
    holds, fails = _strode(missed, limit, floor)
    if holds[0] > floor:
        holds = narrowed(missed, fails, holds, narrow)
    motion = within(holds[0])
    return None if motion is None else ScaledMotion(np.diff(motion[0]), motion[1], math.nan)


def _strode(
    missed: Callable[[float], float], limit: float, floor: float
) -> tuple[tuple[float, float], tuple[float, float]]:
    """Go down from a limit in strides, as far as a floor: the last that holds and the first that fails, each with what it misses."""
    holds = limit, missed(limit)
    for _ in range(MOST_STRIDES):
        if holds[1] > 0.0 or holds[0] == floor:
            break
        lower = max(STRIDE * holds[0], floor)
        found = lower, missed(lower)
        if found[1] > 0.0:
            return holds, found
        holds = found
    return holds, (0.0, math.inf)


def _peak(nodes: FloatArray, accelerations: FloatArray, *, slope: bool) -> float:
    """Greatest magnitude of a broken line or, if not that, of its slope; corners that have come together are none."""
    if slope:
        return float(np.abs(accelerations).max())
    apart = np.diff(nodes) > VANISHED
    return float(np.abs(np.diff(accelerations)[apart] / np.diff(nodes)[apart]).max(initial=0.0))
