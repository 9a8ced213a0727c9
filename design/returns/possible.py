"""Whether some return keeps its limits, and one that does: closed forms, without a solver."""

from __future__ import annotations

import math

import numpy as np

from camwright.design.returns.problem import ReturnProblem
from camwright.design.returns.scaling import ScaledProblem, motion_scale, scale_problem
from camwright.profiles.closed_forms.overshoot import least_overshoot, shortest_stop
from camwright.profiles.closed_forms.reach import greatest_reach
from camwright.profiles.closed_forms.transfer import (
    Bounds,
    State,
    Transfer,
    farthest,
    nearest,
)
from camwright.profiles.objective import OBJECTIVES
from camwright.profiles.polynomial.profile import FloatArray

ROUNDING = 1e-12
"""A return short of its way by less than this share of it is possible: rounding, not physics."""


def is_possible(problem: ReturnProblem) -> bool:
    """Tell whether some motion makes a return within its limits.

    Where the slave must keep to a stroke, the two ends of the return must have the same ratio and no ratio slope, and the positions
    allowed must lie evenly about them: `camwright.profiles.closed_forms.overshoot`. Elsewhere the ways that motions from end to end
    can cover are an interval:
    `camwright.profiles.closed_forms.transfer`, and from rest to rest relative to a straight line `camwright.profiles.closed_forms.reach`.
    """
    if math.isfinite(problem.greatest_position):
        return _keeps_stroke(problem)
    length = problem.length
    if problem.start_ratio == problem.end_ratio and problem.start_slope == problem.end_slope == 0.0:
        distance = problem.height - problem.start_ratio * length
        room = (
            problem.start_ratio - problem.least_ratio if distance < 0 else problem.greatest_ratio - problem.start_ratio
        )
        if abs(distance) <= ROUNDING * length:
            return True
        if room <= 0:
            return False
        reach = greatest_reach(length, room, problem.greatest_slope, problem.greatest_jerk)
        return reach >= abs(distance) * (1 - ROUNDING)
    start, end = State(problem.start_ratio, problem.start_slope), State(problem.end_ratio, problem.end_slope)
    bounds = _bounds(problem)
    rounding = ROUNDING * max(abs(problem.height), problem.start_ratio * length)
    far = farthest(length, start, end, bounds)
    if far is None or far.distance < problem.height - rounding:
        return False
    near = nearest(length, start, end, bounds)
    return near is not None and near.distance <= problem.height + rounding


def _keeps_stroke(problem: ReturnProblem) -> bool:
    room, bounds = problem.greatest_position * (1 + ROUNDING), _bounds(problem)
    if shortest_stop(problem.start_ratio, bounds) > room:
        return False
    found = least_overshoot(problem.length, problem.start_ratio, -problem.height, bounds, room)
    return found is not None and found.distance <= room


def _bounds(problem: ReturnProblem) -> Bounds:
    return Bounds(problem.least_ratio, problem.greatest_ratio, problem.greatest_slope, problem.greatest_jerk)


def possible_motion(problem: ScaledProblem) -> tuple[FloatArray, FloatArray] | None:
    """Give a motion of the scaled problem that keeps its limits, to rounding; None if there is none.

    It is a mean of the motions that go farthest and least far, so it keeps every limit that both keep.

    Returns
    -------
    (nodes, accelerations)
        Places where the acceleration has its corners, from 0 to 1, and its values there; it is linear in between.
    """
    if problem.confined:
        return _within_stroke(problem)
    ends = _farthest_and_nearest(problem)
    if ends is None:
        return None
    far, near = ends
    share = _share(near.distance, far.distance, problem.height)
    return None if share is None else _mean(near.corners(), far.corners(), share)


def spare(problem: ScaledProblem) -> float:
    """How much farther than it must, and less far, a return without a stroke could go at least; minus infinity if none meets its ends."""
    ends = _farthest_and_nearest(problem)
    if ends is None:
        return -math.inf
    return min(ends[0].distance - problem.height, problem.height - ends[1].distance)


def _farthest_and_nearest(problem: ScaledProblem) -> tuple[Transfer, Transfer] | None:
    start, end = State(0.0, problem.start_slope), State(problem.end_ratio, problem.end_slope)
    bounds = Bounds(problem.least_ratio, problem.greatest_ratio, problem.greatest_slope, problem.greatest_jerk)
    far, near = farthest(1.0, start, end, bounds), nearest(1.0, start, end, bounds)
    return None if far is None or near is None else (far, near)


def possible_rms(problem: ReturnProblem) -> float:
    """Root mean square objective, over the master, of the motion that `possible_motion` gives; infinite if there is none."""
    scale = motion_scale(problem)
    found = possible_motion(scale_problem(problem, scale)) if scale else None
    if found is None:
        return math.inf
    nodes, values = found
    h, left, right = np.diff(nodes), values[:-1], values[1:]
    if OBJECTIVES[problem.objective].order == 2:
        return math.sqrt(float(h @ (left**2 + left * right + right**2)) / 3) * abs(scale) / problem.length**2
    return math.sqrt(float(((right - left) ** 2 / h).sum())) * abs(scale) / problem.length**3


def _within_stroke(problem: ScaledProblem) -> tuple[FloatArray, FloatArray] | None:
    way = math.copysign(1.0, problem.drift)  # the scaled slave may count the other way round
    ratios = sorted((way * (problem.least_ratio + problem.drift), way * (problem.greatest_ratio + problem.drift)))
    room = problem.greatest_position if way > 0 else -problem.least_position
    bounds = Bounds(ratios[0], ratios[1], problem.greatest_slope, problem.greatest_jerk)
    found = least_overshoot(1.0, abs(problem.drift), -way * (problem.height + problem.drift), bounds)
    if found is None or found.distance > room * (1 + ROUNDING):
        return None
    out, braked = found.braking.corners()
    between, slopes = _mean(found.back[1].corners(), found.back[0].corners(), found.share)
    nodes = np.concatenate([out, out[-1] + between[1:], 1.0 - out[-2::-1]])
    return nodes, way * np.concatenate([braked, slopes[1:], -braked[-2::-1]])


def _share(near: float, far: float, wanted: float) -> float | None:
    """Share of the farther of two ways in the mean that covers a wanted one; None if it lies beyond them."""
    span = far - near
    rounding = ROUNDING * max(abs(near), abs(far), abs(wanted))
    if not near - rounding <= wanted <= far + rounding:
        return None
    return min(max((wanted - near) / span, 0.0), 1.0) if span > 0 else 0.0


def _mean(
    first: tuple[FloatArray, FloatArray], second: tuple[FloatArray, FloatArray], share: float
) -> tuple[FloatArray, FloatArray]:
    """Mean of two broken lines over the same span, with a share of the second."""
    nodes = np.unique(np.concatenate([first[0], second[0]]))
    return nodes, (1.0 - share) * np.interp(nodes, *first) + share * np.interp(nodes, *second)
