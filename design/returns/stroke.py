"""The least peak of a slave that keeps to a stroke: the least limit within which there is still a motion, and that motion."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from camwright.design.returns.possible import possible_motion
from camwright.design.returns.scaling import ScaledProblem
from camwright.design.returns.structure import VANISHED
from camwright.design.returns.transcription import ScaledMotion
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
    """Give the motion of least peak acceleration, or jerk, of a slave that must keep to a stroke.

    Whether the limits leave any motion is known in closed form (`camwright.profiles.closed_forms.overshoot`), and a higher limit
    leaves more: the least limit
    of the acceleration that leaves one, with the others as they are, is the least peak that any motion has.

    Parameters
    ----------
    problem
        What is asked.
    narrow
        Share to which the least limit is found.

    Returns
    -------
    Motion or None
        ``None`` for other objectives, without a stroke, and where not even the given limits leave a motion.
    """
    if OBJECTIVES[problem.objective].form != "peak" or not problem.confined:
        return None
    slope = problem.objective == "peak_acceleration"

    def within(limit: float) -> tuple[FloatArray, FloatArray] | None:
        motion = possible_motion(
            replace(problem, greatest_slope=limit) if slope else replace(problem, greatest_jerk=limit)
        )
        return motion if motion is not None and _peak(*motion, slope=slope) <= limit * (1 + KEPT) else None

    high = problem.greatest_slope if slope else problem.greatest_jerk
    found = within(high)
    if found is None:
        return None
    low = STRIDE * high
    for _ in range(MOST_STRIDES):
        gentler = within(low)
        if gentler is None:
            break
        high, low, found = low, STRIDE * low, gentler
    while high - low > narrow * high:
        middle = 0.5 * (low + high)
        gentler = within(middle)
        if gentler is None:
            low = middle
        else:
            high, found = middle, gentler
    nodes, accelerations = found
    return ScaledMotion(np.diff(nodes), accelerations, math.nan)


def _peak(nodes: FloatArray, accelerations: FloatArray, *, slope: bool) -> float:
    """Greatest magnitude of a broken line or, if not that, of its slope; corners that have come together are none."""
    if slope:
        return float(np.abs(accelerations).max())
    apart = np.diff(nodes) > VANISHED
    return float(np.abs(np.diff(accelerations)[apart] / np.diff(nodes)[apart]).max(initial=0.0))
