"""Motions from rest to rest whose optimum is known in closed form: starts for the programme, and what its answer must come to."""

from __future__ import annotations

import math

import numpy as np

from camwright.design.returns.bernstein import ScaledMotion
from camwright.design.returns.scaling import ScaledProblem
from camwright.design.returns.structure import VANISHED, extreme_motion
from camwright.design.returns.transcription import Arc
from camwright.profiles.closed_forms.smoothest import smoothest
from camwright.profiles.closed_forms.softest import softest
from camwright.profiles.objective import OBJECTIVES


def known_start(problem: ScaledProblem) -> tuple[ScaledMotion, tuple[Arc, ...]] | None:
    """Optimum in closed form, with the arcs that it has and their objective; None where no closed form is known.

    That is so for all but motions from rest to rest, and for a least RMS jerk that reaches none of its limits or several. Limits of the
    position are left out of account.
    """
    if not problem.rest_to_rest:
        return None
    if problem.objective == "rms_jerk":
        return _smoothest_start(problem)
    if OBJECTIVES[problem.objective].form == "peak":
        extreme = extreme_motion(problem)
        if extreme is None:
            return None
        rise = fall = extreme.ramp
        hold, cruise, level = extreme.hold, extreme.cruise, extreme.acceleration
        objective = level if problem.objective == "peak_acceleration" else extreme.jerk
    else:
        limits = problem.greatest_ratio, problem.greatest_slope, problem.greatest_jerk
        softest_motion = softest(problem.height, 1.0, *limits)
        if softest_motion is None:
            return None
        rise, hold, fall = softest_motion.rise, softest_motion.hold, softest_motion.fall
        cruise, level, objective = softest_motion.cruise, softest_motion.acceleration, softest_motion.mean_square
    if not (min(rise, level) > 0 and math.isfinite(objective)):
        return None
    arcs: list[tuple[Arc, float, float]] = [("free", rise, level), ("hold", hold, level)]
    if cruise > VANISHED:
        arcs += [("free", fall, 0.0), ("cruise", cruise, 0.0)]
    else:
        arcs += [("fall", fall, 0.0)]
    arcs += [("free", fall, -level), ("hold", hold, -level), ("free", rise, 0.0)]
    arcs = [arc for arc in arcs if arc[1] > VANISHED]
    lengths, ends = np.array([arc[1] for arc in arcs]), [arc[2] for arc in arcs]
    return ScaledMotion(lengths, np.array([0.0, *ends]), objective), tuple(arc[0] for arc in arcs)


def _smoothest_start(problem: ScaledProblem) -> tuple[ScaledMotion, tuple[Arc, ...]] | None:
    motion = smoothest(problem.height, problem.greatest_ratio, problem.greatest_slope, problem.greatest_jerk)
    if motion is None or min(motion.lengths) <= VANISHED:
        return None
    arcs: list[Arc] = [_ARC_OF[held] for held in motion.held]
    if len(arcs) == 2:  # the speed is touched where they meet
        arcs[0] = "fall"
    return ScaledMotion(np.array(motion.lengths), np.array(motion.accelerations), motion.mean_square), tuple(arcs)


_ARC_OF: dict[str, Arc] = {"": "free", "speed": "cruise", "acceleration": "hold", "jerk": "ramp"}
