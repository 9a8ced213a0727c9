"""From a cutting machine's job to the optimal cycle."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from camwright.design.feasible.feasibility import is_feasible
from camwright.design.feasible.refusal import infeasible, require_feasible
from camwright.design.line.forms import keeps_ramp
from camwright.design.line.ramped import ramped_return
from camwright.design.line.refusal import ramp_infeasible
from camwright.design.line.slow_line import at_least, at_most, is_slow
from camwright.design.place import Placement
from camwright.design.place_cost import place_for
from camwright.design.returns.curve_limits import motor_limits, motor_speed_limits
from camwright.design.returns.grids import grid_objective
from camwright.design.returns.ipopt import SolveStatus
from camwright.design.returns.measures import objective_value
from camwright.design.returns.problem import ReturnProblem, return_problem
from camwright.design.returns.solver import solve_return
from camwright.design.servo_aware.axis_motion import AxisMotion
from camwright.design.torque.least_speed import drawn_power, least_speed
from camwright.design.torque.placing import place_by_objective
from camwright.design.torque.search import TorqueSolution, solve_torque, zone_peak
from camwright.design.torque.standing import standing
from camwright.design.torque.task import TorqueTask
from camwright.design.torque.within_curve import keeps_curve, least_load, solve_within_curve
from camwright.profiles.cut import Cut
from camwright.profiles.errors import InfeasibleError, InputError, SolverError
from camwright.profiles.line import STEADY
from camwright.profiles.machines import Machine
from camwright.profiles.message import Message
from camwright.profiles.objective import OBJECTIVES, CommandObjective, MotionObjective, ObjectiveName, of_motion
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.returns import assemble
from camwright.profiles.task import Task

# Share of a peak that its smoothest motion may give away; an RMS that is less by as little comes of that alone, not of another motion.
KEPT_PEAK, SMOOTHER = 1e-6, 1e-5


@dataclass(frozen=True)
class Agreement:
    """What several starts of a problem that is not convex agree on.

    Parameters
    ----------
    converged, agreeing
        Starts that converged, and those among them that found the best motion or one as good.
    spread
        Greatest objective over least, less one, of those that converged, each on a mesh of its own.
    residual
        Largest KKT residual of the best, scaled.
    valleys
        Local minima over the place of the sync zone; 1 where it was given or there is nothing to place.
    """

    converged: int
    agreeing: int
    spread: float
    residual: float
    valleys: int


@dataclass(frozen=True, eq=False)
class Solution:
    """An optimal cycle.

    Parameters
    ----------
    machine
        The machine, with everything that the design chose.
    profile
        The whole cycle over the master period ``[0, x_c]``.
    back
        The return alone, over ``[0, x_c - l_s]``.
    status
        How the solver ended.
    objective_name
        The objective that was asked for.
    minimised
        What the solver made least, over time at the job's line speed, of the slave: m/s² or m/s³ (rad for m with a crank), root mean
        squares over the return zone; for torque objectives the value of the motion objective that decided, or where the torque itself
        did its root mean square or peak (N or N·m), or the mean power drawn (W), at the slave over the return; the sync error in m.
    iterations
        Iterations of IPOPT, all together.
    agreement
        Agreement of several starts; None where the problem is convex.
    axis
        What a servo-aware design found, whose `iterations` are programmes solved; None for a servo-blind one.
    """

    machine: Machine
    profile: CamProfile
    back: CamProfile
    status: SolveStatus
    objective_name: ObjectiveName
    minimised: float
    iterations: int
    agreement: Agreement | None = None
    axis: AxisMotion | None = None


def solve(
    task: Task,
    objective: CommandObjective,
    *,
    suggest: bool = True,
    thorough: bool = True,
    starts: Sequence[CamProfile] = (),
) -> Solution:
    """Design the optimal cycle of a cutting machine.

    Parameters
    ----------
    task, objective
        The job.
    suggest
        Whether an `InfeasibleError` says what would work; finding that takes longer than finding what binds.
    thorough
        Whether a second road is taken where the first ends with less than the optimum, and the mesh of a return that bears the ramps of
        its line is refined. It takes many times as long, and gains little at the edge of what is possible, where motions have no room to
        differ.
    starts
        Returns from which an objective of the motor is searched for, instead of the least mean square of the acceleration.

    Raises
    ------
    InfeasibleError
        No motion keeps the limits; the message names the one that binds and what would work.
    InputError
        The machine cannot be in sync over the zone.
    SolverError
        The solver failed on a job that has an answer.

    Examples
    --------
    >>> from camwright.profiles.cut import Cut
    >>> from camwright.profiles.limits import Limits
    >>> from camwright.profiles.machines import RotaryKnife
    >>> knife = RotaryKnife(circumference=0.4)
    >>> cut = Cut(0.6, 80 / 60, 0.2, 0.04, 0.16, 1e-4)
    >>> result = solve(Task(knife, cut, Limits(200 / 60, 30.0, 3000.0)), "peak_acceleration")
    >>> result.status.value, round(result.minimised, 3), result.profile.pieces
    ('optimal', 9.072, 6)
    """
    machine, cut = task.machine, task.cut
    if not machine.placed:
        return _solve_free_place(task, objective, suggest, thorough)
    machine.sync_start(cut)
    if task.limits.motor is not None:
        return _solve_for_motor(task, objective, suggest, thorough, starts)
    require_feasible(task, suggest=suggest)
    require_moving(machine, objective)
    solution = _solve_steady(task.with_line(STEADY), objective, thorough, starts)
    if not keeps_ramp(solution.profile, task):
        found, as_good = _solve_slow(task, objective, solution, thorough)
        if found is not None and as_good:
            return found
        try:
            return _solve_ramped(task, objective, solution, suggest and found is None, thorough)
        except InfeasibleError:
            if found is None:
                raise
            return found  # the mesh has none
    if task.line.ramps and objective == "rms_jerk" and task.machine.guide is not None:
        # at the end of a stroke the jerk of the optimum steps at places that a grid of its own does not have
        other = _solve_ramped(task, objective, solution, suggest, thorough)
        return min(solution, other, key=lambda each: each.minimised)
    return solution


def _solve_steady(
    task: Task, objective: CommandObjective, thorough: bool, starts: Sequence[CamProfile] = ()
) -> Solution:
    """Design the cycle for a line that keeps its speed."""
    decisive = motion_objective(task.machine, objective)
    if decisive is None:
        return _solve_torque(task, objective, starts)
    back, status, value, iterations = _solve_motion(task, decisive, thorough)
    # of a slave that never leaves the line's speed it is 0, not −0
    return Solution(task.machine, assemble(back, task), back, status, objective, value + 0.0, iterations)


def _solve_slow(
    task: Task, objective: CommandObjective, steady: Solution, thorough: bool
) -> tuple[Solution | None, bool]:
    """Design within limits that leave the ramps what they take; gives also whether no cam that bears them is better, but for rounding."""
    if motion_objective(task.machine, objective) is None or not is_slow(steady.back, task):
        return None, False
    within = at_most(task)
    if not is_feasible(within):
        return None, False
    best = _solve_steady(within, objective, thorough)
    leaves = at_least(task, best.back)
    if leaves is None or not is_feasible(leaves):
        return None, False
    found = replace(_solve_steady(leaves, objective, thorough), status=SolveStatus.BEST_FOUND)
    return (found if keeps_ramp(found.profile, task) else None), found.minimised <= best.minimised * (1.0 + KEPT_PEAK)


def _solve_ramped(task: Task, objective: CommandObjective, steady: Solution, suggest: bool, thorough: bool) -> Solution:
    """Design the cycle so that it bears the line's ramps, from what is best on a line that keeps its speed.

    An objective of the motor that none of the motion stands for is searched for from the least mean square of the acceleration.

    Raises
    ------
    InfeasibleError
        No return was found that bears them.
    """
    decisive = motion_objective(task.machine, objective)
    problem = return_problem(task, decisive or "rms_acceleration")
    of = OBJECTIVES[problem.objective]
    zone = task.sync.peak(of.order) if of.form == "peak" else 0.0
    sync_bears = keeps_ramp(task.sync, task)
    back = ramped_return(task, problem, steady.back, zone, thorough=thorough) if sync_bears else None
    profile = None if back is None else assemble(back, task)
    if back is None or profile is None or not keeps_ramp(profile, task):
        raise ramp_infeasible(task, suggest=suggest)
    if decisive is None:
        return _solve_torque_ramped(task, objective, back, steady.iterations)
    value = max(_over_time(back, decisive, task.cut), of.over_time(zone, task.cut.line_speed))
    return Solution(task.machine, profile, back, SolveStatus.BEST_FOUND, objective, value, steady.iterations)


def _solve_torque_ramped(task: Task, objective: CommandObjective, start: CamProfile, iterations: int) -> Solution:
    """Search an objective of the motor among the returns that bear the line's ramps, from one of them."""
    floor = zone_peak(task) if objective == "peak_torque" else 0.0
    found = solve_torque(
        TorqueTask(task, return_problem(task, "peak_acceleration"), objective),
        lambda back: keeps_ramp(assemble(back, task), task),
        [start],
        floor,
    )
    return _searched(found, task, objective, found.value, iterations)


def _searched(
    found: TorqueSolution, task: Task, objective: CommandObjective, value: float, iterations: int = 0
) -> Solution:
    """Make the cycle of what a search from several starts found."""
    return Solution(
        task.machine,
        assemble(found.back, task),
        found.back,
        SolveStatus.BEST_FOUND,
        objective,
        value,
        iterations + found.iterations,
        Agreement(found.starts, found.agreeing, found.spread, found.residual, 1),
    )


def _solve_motion(task: Task, objective: MotionObjective, thorough: bool) -> tuple[CamProfile, SolveStatus, float, int]:
    """Solve an objective of the motion: the return, how the solver ended, the value over time, and the iterations.

    A peak is that of the cycle: where the sync zone has a higher one than the return needs, it is the zone's.
    """
    problem = return_problem(task, objective)
    back, status, iterations = solve_return(problem, thorough=thorough)
    if status is SolveStatus.BEST_FOUND and thorough:
        back, more = _second_opinion(task, problem, back)
        iterations += more
    if OBJECTIVES[objective].form != "peak":
        return back, status, _over_time(back, objective, task.cut), iterations
    zone = task.sync.peak(OBJECTIVES[objective].order)
    if not _unique(problem):
        back = _smoothest(problem, back, zone)
    zone_value = OBJECTIVES[objective].over_time(zone, task.cut.line_speed)
    return back, status, max(_over_time(back, objective, task.cut), zone_value), iterations


def _second_opinion(task: Task, problem: ReturnProblem, back: CamProfile) -> tuple[CamProfile, int]:
    """Look for a better return where the arcs of a structure could not be polished: on a mesh refined where the motion changes.

    The least RMS jerk of a carriage is a convex programme; its optimum touches the end of the stroke where a grid of its own has no node.
    """
    if problem.objective == "rms_jerk" and task.machine.guide is not None:
        meshed = ramped_return(task, problem, back)
        returns = (
            back if meshed is None else min(back, meshed, key=lambda each: objective_value(each, problem.objective))
        )
        return returns, 0
    try:
        found = solve_torque(TorqueTask(task, problem, problem.objective), starts=[back])
    except SolverError:
        return back, 0
    return min(back, found.back, key=lambda each: objective_value(each, problem.objective)), found.iterations


def _over_time(back: CamProfile, objective: MotionObjective, cut: Cut) -> float:
    """Objective of a return over time, at the line speed."""
    return OBJECTIVES[objective].over_time(objective_value(back, objective), cut.line_speed)


def _solve_for_motor(
    task: Task, objective: CommandObjective, suggest: bool, thorough: bool, starts: Sequence[CamProfile]
) -> Solution:
    """Solve without the motor's torque, which is the answer if it keeps to the curve; else within the curve, and take the best.

    Within the curve are its rectangles, of which the grid tells the best. Where they do not do, or say little, a programme knows the whole
    curve.

    Raises
    ------
    InfeasibleError
        The motor is too weak, as far as the programme's starts tell.
    """
    machine, limits = task.machine, task.limits
    curve, plain = limits.motor, motor_speed_limits(machine, limits)
    assert curve is not None  # noqa: S101 - that is what this function is for
    if not is_feasible(task.with_limits(plain)):
        raise infeasible(task, suggest=suggest)
    free = solve(task.with_limits(plain), objective, thorough=thorough, starts=starts)
    if keeps_curve(free.profile, task, curve):
        return free
    found: list[Solution] = []
    decisive = motion_objective(machine, objective)
    rectangles = [task.with_limits(each) for each in motor_limits(machine, limits)]
    rectangles = [each for each in rectangles if is_feasible(each)]
    if rectangles:
        rough = [grid_objective(return_problem(each, decisive or "rms_acceleration")) for each in rectangles]
        found += _within_rectangle(rectangles[int(np.argmin(rough))], objective, thorough)
    easiest = None
    # a rectangle says little where the torque depends on the place, and of energy, or where friction helps to brake, not all
    if not found or decisive is None or not machine.constant_inertia:
        easiest = None if found and machine.constant_inertia else least_load(task)
        near = [each.back for each in (*found, easiest) if each is not None]
        found += _within_curve(task, objective, decisive, [*starts, *near])
    if not found and task.line.ramps and is_feasible(task):
        raise ramp_infeasible(task, suggest=suggest)
    if not found:
        raise infeasible(task, suggest=suggest, load=None if easiest is None else easiest.value)
    return min(found, key=lambda solution: solution.minimised)


def _within_curve(
    task: Task, objective: CommandObjective, decisive: MotionObjective | None, starts: Sequence[CamProfile]
) -> list[Solution]:
    """Solve within the whole curve from starts of other kinds and these; nothing where none converges."""
    within = solve_within_curve(task, decisive or objective, starts)
    if within is None:
        return []
    value = within.value if decisive is None else _over_time(within.back, decisive, task.cut)
    return [_searched(within, task, objective, value)]


def _within_rectangle(task: Task, objective: CommandObjective, thorough: bool) -> list[Solution]:
    """Solve within one rectangle of a motor's curve; nothing where no return in it bears the line's ramps."""
    try:
        return [solve(task, objective, suggest=False, thorough=thorough)]
    except InfeasibleError:
        if not task.line.ramps:
            raise
        return []


def _unique(problem: ReturnProblem) -> bool:
    """Whether a peak has one minimiser only: from rest to rest it has, the extreme motion."""
    return problem.start_ratio == problem.end_ratio and problem.start_slope == problem.end_slope == 0.0


def _smoothest(problem: ReturnProblem, back: CamProfile, zone: float) -> CamProfile:
    """Of all returns with the least peak, or the sync zone's, take the one of least RMS acceleration; the given one if that fails."""
    peak = max(objective_value(back, problem.objective) * (1 + KEPT_PEAK), zone)
    limit = "greatest_slope" if problem.objective == "peak_acceleration" else "greatest_jerk"
    within = replace(problem, objective="rms_acceleration", **{limit: min(peak, getattr(problem, limit))})
    try:
        smooth, _, _ = solve_return(within)
    except SolverError:
        return back
    better = objective_value(smooth, "rms_acceleration") < (1 - SMOOTHER) * objective_value(back, "rms_acceleration")
    return smooth if better and objective_value(smooth, problem.objective) <= peak * (1 + KEPT_PEAK) else back


def require_moving(machine: Machine, objective: ObjectiveName) -> None:
    """Refuse an objective of the motor for a machine that moves nothing.

    Raises
    ------
    InputError
        A torque or energy is to be made least, and the machine has neither inertia nor mass nor friction.
    """
    if OBJECTIVES[objective].of == "motor" and not machine.moves_something:
        raise InputError(
            Message(
                f"{{@minimise}} = {objective!r} needs to know what the motor moves: give the machine's inertia or mass, or minimise "
                "rms_acceleration"
            )
        )


def motion_objective(machine: Machine, objective: CommandObjective) -> MotionObjective | None:
    """Objective of the motion alone that has the same minimiser, if there is one.

    With constant inertia ``I`` and no friction the force is ``I a``. With friction it matters how long the slave stands: that costs none.
    """
    if of_motion(objective) == objective:
        return of_motion(objective)
    if not machine.constant_inertia or objective == "energy":
        return None
    if machine.friction:
        return None
    return "rms_acceleration" if objective == "rms_torque" else "peak_acceleration"


def _solve_torque(task: Task, objective: CommandObjective, starts: Sequence[CamProfile]) -> Solution:
    """Solve an objective of the motor that no objective of the motion stands for."""
    machine, problem = task.machine, return_problem(task, "peak_acceleration")
    given = list(starts)
    if machine.constant_inertia and objective == "energy" and not machine.friction:
        back, iterations = least_speed(problem)
        if task.straight:
            power, profile = drawn_power(back, task), assemble(back, task)
            return Solution(machine, profile, back, SolveStatus.OPTIMAL, objective, power, iterations)
        given.append(back)
    elif machine.constant_inertia and objective == "rms_torque":  # the optimum of a slave that never stands
        given.append(solve_return(replace(problem, objective="rms_acceleration"))[0])
    floor = zone_peak(task) if objective == "peak_torque" else 0.0
    asked = TorqueTask(task, problem, objective)
    rested = standing(asked) if machine.constant_inertia and objective == "rms_torque" else None
    try:
        found = solve_torque(asked, starts=given, floor=floor)
    except SolverError:
        if rested is None:
            raise
        found = rested
    found = rested if rested and rested.value < found.value else found
    return _searched(found, task, objective, found.value)


def _solve_free_place(task: Task, objective: CommandObjective, suggest: bool, thorough: bool) -> Solution:
    """Choose the place of the sync zone first, by the objective of the whole cycle: a closed form's, or the programme's own."""
    placement: Placement | None = None
    if OBJECTIVES[objective].form != "peak" or OBJECTIVES[objective].of == "motor":
        require_moving(task.machine, objective)
        plain = motor_speed_limits(task.machine, task.limits)
        placement = place_by_objective(task.with_limits(plain).with_line(STEADY), objective, task.limits.motor)
    placed = placement or place_for(task.with_line(STEADY), objective)
    starts = () if placed.back is None else (placed.back,)
    at_place = placed.task.with_limits(task.limits).with_line(task.line)
    solution = solve(at_place, objective, suggest=suggest, thorough=thorough, starts=starts)
    solution = replace(solution, status=SolveStatus.BEST_FOUND)  # no bound knows all places
    if solution.agreement is None:
        return replace(solution, agreement=Agreement(1, 1, 0.0, 0.0, placed.valleys))
    return replace(solution, agreement=replace(solution.agreement, valleys=placed.valleys))
