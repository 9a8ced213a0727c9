"""The return that bears the ramps of its line: a mesh that is refined where the jerk changes, and what its solution is."""

from __future__ import annotations

import numpy as np

from camwright.design.line.forms import Form, greatest_form, ramp_forms
from camwright.design.line.programme import MeshAnswer, least_ramp_share, solve_on_mesh
from camwright.design.returns.bernstein import ScaledMotion
from camwright.design.returns.measures import ALLOWED_EXCESS, excess
from camwright.design.returns.problem import ReturnProblem
from camwright.design.returns.scaling import ScaledProblem, motion_scale, scale_problem, unscale_profile
from camwright.design.returns.structure import subdivide, tidy
from camwright.profiles.objective import OBJECTIVES
from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.profiles.task import Task

FIRST = 64
"""Intervals of the first mesh, shared out over the arcs of a return that does not know of the ramps."""

MOST = 400
"""Intervals of the last mesh at most."""

ROUNDS = 8
"""How often the mesh is refined."""

STEP = 0.005
"""Part of the greatest jerk by which neighbours differ where a mesh is refined: there an arc ends."""

COST = 1e-6
"""Part of the objective that an interval may cost by what the mesh asks too much of it, or a mean square of the jerk by its steps."""

SHORTEST = 1e-6
"""No interval is made shorter than this part of the return."""

SAME_JERK = 2e-8
"""Part of the greatest jerk by which neighbours of the same jerk may differ."""

NO_MOTION = 1e-13
"""A deviation from the straight line below this part of the return's length is no motion at all."""

KEPT_PEAK = 1e-6
"""Share of a peak that its smoothest motion may give away."""


def ramped_return(
    task: Task, problem: ReturnProblem, start: CamProfile | None, zone: float = 0.0, *, thorough: bool = True
) -> CamProfile | None:
    """Solve a return on which the line may ramp.

    Parameters
    ----------
    task
        Limits, cut and line.
    problem
        The return and its objective.
    start
        A return whose arcs the first mesh takes, the optimum of a line that keeps its speed; None for an even mesh.
    zone
        Peak of the objective in the sync zone, below which no peak of the return counts.
    thorough
        Whether the mesh is refined; the first one is finer where it is not.

    Returns
    -------
    CamProfile or None
        The return over ``[0, length]`` from slave zero; ``None`` where no mesh has one that keeps the limits to rounding.
    """
    scale = motion_scale(problem)
    if abs(scale) <= NO_MOTION * problem.length:
        return CamProfile.from_arrays([0.0, problem.length], [[0.0, problem.height / problem.length]])
    scaled = scale_problem(problem, scale)
    forms = tuple(_scaled(form, problem.length, scale) for form in ramp_forms(task))
    peak = 0.0 if start is None else start.peak(2)
    unit = peak * problem.length**2 / abs(scale) or 1.0
    if thorough:
        motion = _refined(scaled, forms, _first_mesh(start, problem.length), unit)
    else:
        answer = solve_on_mesh(scaled, _first_mesh(start, problem.length, 2 * FIRST), forms, unit=unit)
        motion = None if answer is None else answer.motion
    if motion is None:
        return None
    if OBJECTIVES[problem.objective].form == "peak":
        zone *= problem.length ** OBJECTIVES[problem.objective].order / abs(scale)
        motion = _smoothest(scaled, forms, motion, zone, unit)
    profile = _profile(motion, scaled)
    # hardly any return is left where the solver cannot keep its margin
    return unscale_profile(profile, problem, scale) if excess(profile, scaled) <= ALLOWED_EXCESS else None


def ramp_share(task: Task, problem: ReturnProblem) -> float | None:
    """Tell what share of the limits a line that ramps takes at least, of the returns of a mesh, in the return and in the sync zone.

    Returns
    -------
    float or None
        At most 1 where the mesh has a return on which the line may ramp; ``None`` where it has none that keeps the limits of a line that
        keeps its speed.
    """
    zone, scale = greatest_form(task.sync, task), motion_scale(problem)
    if abs(scale) <= NO_MOTION * problem.length:
        return max([zone, *(form.ratio * problem.start_ratio for form in ramp_forms(task))])
    forms = tuple(_scaled(form, problem.length, scale) for form in ramp_forms(task))
    share = least_ramp_share(scale_problem(problem, scale), _first_mesh(None, problem.length, 2 * FIRST), forms)
    return None if share is None else max(zone, share)


def _scaled(form: Form, length: float, scale: float) -> Form:
    """Write a form for the scaled return."""
    return Form(form.ratio * scale / length, form.slope * scale / length**2, form.jerk * scale / length**3)


def _first_mesh(start: CamProfile | None, length: float, count: int = FIRST) -> FloatArray:
    """Share out intervals over the arcs of a return."""
    arcs = np.ones(1) if start is None else np.diff(start.breaks) / length
    arcs = arcs[arcs > SHORTEST]
    return subdivide(arcs / arcs.sum(), count)


def _refined(problem: ScaledProblem, forms: tuple[Form, ...], lengths: FloatArray, unit: float) -> ScaledMotion | None:
    """Solve, and halve the intervals beside those places where the jerk steps, again and again; where there is no motion halve all."""
    best: ScaledMotion | None = None
    for _ in range(ROUNDS):
        answer = solve_on_mesh(problem, lengths, forms, unit=unit)
        if best is not None and (answer is None or excess(_profile(answer.motion, problem), problem) > ALLOWED_EXCESS):
            break
        best = None if answer is None else answer.motion
        worth = np.full(len(lengths), np.inf) if answer is None else _worth_halving(answer, problem)
        worth[lengths <= 2 * SHORTEST] = 0.0
        halved = np.argsort(-worth, kind="stable")[: min(int((worth > 1.0).sum()), MOST - len(lengths))]
        if not len(halved):
            break
        times = np.ones(len(lengths), dtype=int)
        times[halved] = 2
        lengths = np.repeat(lengths / times, times)
    return best


def _worth_halving(answer: MeshAnswer, problem: ScaledProblem) -> FloatArray:
    """How much each interval is worth halving: not where it is below 1.

    The optimum's arcs end where the jerk steps. Where it changes all along, as on the exponentials of two limits that bind, a mean square
    of it is dearer by the lengths times the squares of the steps. And the coefficients inside an interval cost what their multipliers say.
    """
    motion = answer.motion
    jerk = np.diff(motion.accelerations) / motion.lengths
    steps = np.abs(np.diff(jerk, prepend=jerk[0], append=jerk[-1]))
    if problem.objective == "rms_jerk":
        stairs = motion.lengths * (steps[1:] ** 2 + steps[:-1] ** 2) / 24.0 / float(motion.lengths @ jerk**2) / COST
    else:
        stairs = np.maximum(steps[1:], steps[:-1]) / float(np.abs(jerk).max()) / STEP
    return np.asarray(np.maximum(stairs, answer.dear / COST))


def _profile(motion: ScaledMotion, problem: ScaledProblem) -> CamProfile:
    return tidy(_joined(motion), problem, corners=False).profile()


def _joined(motion: ScaledMotion) -> ScaledMotion:
    """Join neighbouring intervals of the same jerk: far less than the margin changes by that."""
    jerk = np.diff(motion.accelerations) / motion.lengths
    kept, first = [0], 0
    for k in range(1, len(jerk)):
        run = jerk[first : k + 1]
        if float(run.max() - run.min()) > SAME_JERK * float(np.abs(jerk).max()):
            kept.append(k)
            first = k
    nodes = np.concatenate([[0.0], np.cumsum(motion.lengths)])
    kept.append(len(jerk))
    return ScaledMotion(np.diff(nodes[kept]), motion.accelerations[kept], motion.objective)


def _smoothest(
    problem: ScaledProblem, forms: tuple[Form, ...], motion: ScaledMotion, zone: float, unit: float
) -> ScaledMotion:
    """Of all returns of a least peak, or the sync zone's, take the one of least RMS acceleration; the given one if that fails."""
    measured = (
        motion.accelerations
        if OBJECTIVES[problem.objective].order == 2
        else np.diff(motion.accelerations) / motion.lengths
    )
    peak = max(float(np.abs(measured).max()) * (1 + KEPT_PEAK), zone)
    answer = solve_on_mesh(problem, motion.lengths, forms, peak, unit)
    return answer.motion if answer is not None and answer.exact else motion
