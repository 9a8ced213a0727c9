"""Exact measures of a return: its objective, and by how much it exceeds a limit."""

from __future__ import annotations

import math

import numpy as np

from camwright.design.returns.bernstein import ScaledMotion
from camwright.design.returns.scaling import ScaledProblem
from camwright.design.returns.structure import tidy
from camwright.profiles.objective import OBJECTIVES, MotionObjective
from camwright.profiles.polynomial.profile import CamProfile

# Objectives that differ by less than this share are the same.
SAME = 1e-7
# Largest share by which a limit may be exceeded by rounding; the contract says 1e-9.
ALLOWED_EXCESS = 5e-10


def objective_value(back: CamProfile, objective: MotionObjective) -> float:
    """Objective of a return over the master: peak or root mean square of ``y''`` or ``y'''``, exactly."""
    of = OBJECTIVES[objective]
    if of.form == "rms":
        return math.sqrt(back.mean_square(of.order))
    return back.peak(of.order)


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
        slope, jerk = (profile.peak(order) for order in (2, 3))
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


def kept(motion: ScaledMotion | None, problem: ScaledProblem) -> CamProfile | None:
    """Give the profile of a motion, None if there is no motion or it exceeds a limit."""
    if motion is None:
        return None
    profile = tidy(motion, problem).profile()
    return profile if excess(profile, problem) <= ALLOWED_EXCESS else None


def better(profile: CamProfile, other: CamProfile | None, problem: ScaledProblem) -> CamProfile:
    """Choose the other profile if its objective is less by more than what counts as the same."""
    if other is None:
        return profile
    name = problem.objective
    return other if objective_value(other, name) < objective_value(profile, name) * (1 - SAME) else profile
