"""From a cutting machine's job to a cycle whose axis keeps to the material."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

from camwright.design.feasible.refusal import infeasible
from camwright.design.line.refusal import ramp_infeasible
from camwright.design.optimise import (
    Solution,
    motion_objective,
    require_moving,
    solve,
)
from camwright.design.place import place_beside
from camwright.design.place_cost import place_for
from camwright.design.returns.curve_limits import motor_limits, motor_speed_limits
from camwright.design.returns.ipopt import SolveStatus
from camwright.design.servo_aware.axis_motion import AxisMotion, design_axis, motion_of, servo_blind_optimum
from camwright.design.servo_aware.axis_problem import AxisProblem, thinned
from camwright.design.servo_aware.command_basis import Command
from camwright.design.servo_aware.programme import AxisProgramme
from camwright.design.servo_aware.refusal import LOOKED, axis_infeasible
from camwright.design.servo_aware.servo_weights import memory
from camwright.profiles.cut import Cut
from camwright.profiles.errors import (
    InfeasibleError,
    InputError,
    SolverError,
)
from camwright.profiles.limits import Limits
from camwright.profiles.machines import Machine
from camwright.profiles.message import Message, Value
from camwright.profiles.objective import OBJECTIVES, ObjectiveName, of_command
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.returns import assemble
from camwright.profiles.servo import Servo
from camwright.profiles.task import Task

# Rounds after which a job that is not proved to be impossible is designed.
HOPELESS = 3
# Samples that a servo remembers and those of a cycle, together, that are looked at.
MOST_SAMPLES = 2**15


def solve_axis(
    task: Task,
    objective: ObjectiveName,
    command: Command,
    servos: tuple[Servo, ...],
    between: tuple[Servo, ...] = (),
    shares: tuple[float, ...] = (1.0,),
    *,
    suggest: bool = True,
    proved: bool = True,
) -> Solution:
    """Design the cycle of a cutting machine whose axis keeps to the material in the shear zone.

    The limits hold for the command, and for the axis too wherever the tolerance can then still be kept; `Solution.axis` says whether.
    A free place is that of the servo-blind design, or for a shaped command a better one beside it.

    Parameters
    ----------
    task
        As for `camwright.design.optimise.solve`; the cut's sync tolerance is what the axis may be off.
    objective
        What is made least.
    command
        Whether the command keeps ``k = 1`` in the whole sync zone (``"in_sync"``), or may be anything that brings the axis into sync in
        the shear zone (``"shaped"``).
    servos
        Servos with which the tolerance must be kept, the nominal one first.
    between
        Servos between the corners of the ranges, which must keep the tolerance too, or be hardly worse than the corners.
    shares
        Line speeds at which all this must hold, as shares of the cut's, from the full line speed down.
    suggest
        Whether an `InfeasibleError` says what would work; finding that takes longer than the design.
    proved
        Whether that is designed before it is told; otherwise some of the line speeds tell, and designing it is for the caller.

    Raises
    ------
    InfeasibleError
        No command keeps the limits, or none brings the axis into the tolerance.
    InputError
        The servo is unstable; a torque is to be made least of a machine that moves nothing.
    SolverError
        The solver failed.
    """
    machine, limits = task.machine, task.limits
    require_moving(machine, objective)
    _require_samples(task.cut, (*servos, *between), min(shares))
    cost = _cost(machine, objective)

    def designs(other: Task, fewer: tuple[float, ...] = shares) -> bool:
        return not proved or _designs(
            lambda: solve_axis(other, objective, command, servos, between, fewer, suggest=False)
        )

    blind = None
    if command == "in_sync" or not machine.placed:
        blind = _servo_blind(task, cost, designs if suggest else None)
    placed = machine if blind is None else blind.machine
    if command == "shaped":
        placed = _placed_beside(task, placed, objective, servos[0])
    structure = None if blind is None or command == "shaped" else blind.back
    problem = AxisProblem(task.with_machine(placed), command, servos, True, structure, between, shares=shares)
    motions = _motions(problem, cost, blind)
    if not motions:
        loosest = _within(replace(problem, axis_limits=False), motor_speed_limits(placed, limits))
        ways = (lambda cut: designs(task.with_cut(cut))), (lambda fewer: designs(task, fewer))
        raise axis_infeasible(loosest, ways if suggest else None)
    motion = min(motions, key=lambda each: each.value)
    status = blind.status if blind is not None and not motion.programmes else SolveStatus.BEST_FOUND
    return _solution(motion, status, task.with_machine(placed), objective, OBJECTIVES[cost].order)


def _placed_beside(task: Task, found: Machine, objective: ObjectiveName, servo: Servo) -> Machine:
    """Place a free sync zone for the axis of a shaped command, at the full line speed, beside the place found without a servo."""
    cost = _cost(task.machine, objective)
    if task.machine.placed or cost == "sync_error":
        return found

    def at_full_speed(there: Task) -> float:
        try:
            return solve_axis(there, objective, "shaped", (servo,), suggest=False).minimised
        except (InfeasibleError, InputError, SolverError):
            return math.inf

    return place_beside(task.with_machine(found), at_full_speed, 1 if OBJECTIVES[cost].of == "motor" else 3).machine


def _motions(problem: AxisProblem, cost: ObjectiveName, blind: Solution | None) -> list[AxisMotion]:
    """Find motions within the motor's curve, else its widest rectangles, else such as only the command keeps to it, else the one left."""
    limits, cut = problem.task.limits, problem.task.cut
    # the servo-blind optimum keeps the motor's curve, though it may lie in none of the rectangles that stand for it
    by_motor = _within(problem, motor_speed_limits(problem.task.machine, limits))
    motions = _kept(by_motor, cost) if limits.motor is not None else []
    if not motions:
        found = [_either(_within(problem, each), cost) for each in widest(motor_limits(problem.task.machine, limits))]
        motions = [motion for motion in found if motion is not None]
    if not motions and limits.motor is not None:
        motions = _kept(replace(by_motor, axis_limits=False), cost)
    if not motions and blind is not None and problem.command == "in_sync":
        least = None if cost == "sync_error" else blind.minimised / cut.line_speed ** OBJECTIVES[cost].order
        motions = _without_choice(problem, blind, least)
    return motions


def may_keep(task: Task, servos: tuple[Servo, ...], shares: tuple[float, ...]) -> bool:
    """Whether a shaped command may keep the tolerance, the axis within its limits: false where some of the line speeds prove it cannot.

    A fraction of the time of a design. Arguments as in `solve_axis`, the machine placed.
    """
    problem = AxisProblem(task, "shaped", servos, True, shares=thinned(shares, LOOKED))
    try:
        return AxisProgramme(problem).reaches(HOPELESS) is not False
    except SolverError:
        return True  # it was not told


def _designs(design: Callable[[], Solution]) -> bool:
    """Whether a job can be designed so that its axis keeps its limits too."""
    try:
        found = design()
    except (InfeasibleError, InputError, SolverError):
        return False
    return found.axis is None or found.axis.axis_limits


def _servo_blind(task: Task, cost: ObjectiveName, designs: Callable[[Task], bool] | None) -> Solution:
    """Solve a job as if there were no servo; where no motion keeps the limits, what is offered instead is designed with the servo.

    Raises
    ------
    InfeasibleError
        No motion keeps the limits.
    """
    try:
        return solve(task, of_command(cost), suggest=False)
    except InfeasibleError as error:
        if designs is None:
            raise
        placed = task if task.machine.placed else place_for(task, of_command(cost)).task
        if error.binding.startswith("line."):
            raise ramp_infeasible(placed) from error
        raise infeasible(placed, designs=designs) from error


def _require_samples(cut: Cut, servos: tuple[Servo, ...], share: float = 1.0) -> None:
    """Refuse a lowest line speed, a share of the cut's, for which the rows of a servo-aware design are too many.

    A servo follows so slow a line well without one.
    """
    shortest = min(servo.sample_time for servo in servos)
    past = max(memory(servo.loop) for servo in servos)
    samples = past + math.ceil(cut.period / share / shortest)
    if samples <= MOST_SAMPLES:
        return
    slowest = cut.length / (shortest * (MOST_SAMPLES - past - 1))
    at = " at {lowest}, the lowest of {@line_speeds}" if share < 1.0 else ""
    begin = "begin {@line_speeds} above {slowest}, or " if share < 1.0 and cut.line_speed > slowest else ""
    values = {"line_speed": cut.line_speed, "lowest": share * cut.line_speed}
    least = {"slowest": slowest, "raised": slowest / share}
    raise InputError(
        Message(
            f"{{@line_speed}} = {{line_speed}}: a servo-aware design looks at every sample of a cycle, {samples} here{at}, the limit is "
            f"{MOST_SAMPLES}; {begin}raise the line speed above {{raised}}, or the sample time, or leave servo_aware out: on so slow a "
            f"line the axis is near any smooth command, and the check shear_zone_error says how near",
            (
                *((name, Value(value, "m/s", 6)) for name, value in values.items()),
                *((name, Value(value, "m/s", 6, "above")) for name, value in least.items()),
            ),
        )
    )


def _within(problem: AxisProblem, limits: Limits) -> AxisProblem:
    """Put a problem within other limits."""
    return replace(problem, task=problem.task.with_limits(limits))


def widest(rectangles: Sequence[Limits]) -> list[Limits]:
    """Leave out rectangles of a motor's curve that lie in another one, each once: a command within it is within the other."""
    found: list[Limits] = []
    for each in sorted(rectangles, key=lambda limits: (-limits.speed, -limits.acceleration)):
        if all(each.acceleration > other.acceleration for other in found):
            found.append(each)
    return found


def _kept(problem: AxisProblem, cost: ObjectiveName) -> list[AxisMotion]:
    """Take the servo-blind optimum of a job in sync where its axis keeps to everything."""
    kept = None if cost == "sync_error" else servo_blind_optimum(AxisProgramme(problem), cost)
    return [] if kept is None else [kept]


def _solution(motion: AxisMotion, status: SolveStatus, task: Task, objective: ObjectiveName, order: int) -> Solution:
    """Put a motion as the cycle that was asked for."""
    cut = task.cut
    profile = motion.profile
    back = profile.restrict(0.0, cut.return_zone)
    if cut.origin == "cut":
        profile = _from_mid_sync(profile, task)
    value = motion.value * cut.line_speed**order
    return Solution(task.machine, profile, back, status, objective, value, motion.programmes, axis=motion)


def _cost(machine: Machine, objective: ObjectiveName) -> ObjectiveName:
    """Objective of the motion that a programme can minimise."""
    return objective if objective == "sync_error" else motion_objective(machine, objective) or objective


def _either(problem: AxisProblem, cost: ObjectiveName) -> AxisMotion | None:
    """Design with the limits held by the axis too; without, where that costs the tolerance."""
    try:
        strict = design_axis(problem, cost)
    except SolverError:
        strict = None
    if strict is not None and strict.axis_limits and strict.error <= problem.task.cut.sync_tolerance:
        return strict
    return design_axis(replace(problem, axis_limits=False), cost)


def _without_choice(problem: AxisProblem, blind: Solution, value: float | None) -> list[AxisMotion]:
    """Take the servo-blind command where the limits leave no other, if its axis will do; ``value`` as in `AxisMotion`."""
    programme = AxisProgramme(replace(problem, axis_limits=False))
    if programme.least_share() is not None:
        return []
    profile = assemble(blind.back, problem.task.from_return())
    motion = motion_of(programme, profile, value, axis_limits=programme.keeps_axis_limits(profile))
    return [] if value is not None and motion.error > problem.task.cut.sync_tolerance else [motion]


def _from_mid_sync(profile: CamProfile, task: Task) -> CamProfile:
    """Count master and slave from mid sync zone, the slave from where the machine is in sync there."""
    cut = task.cut
    at = cut.length - 0.5 * cut.sync_zone
    sync = task.sync
    in_sync = task.height + float(sync(0.5 * cut.sync_zone)) - float(sync(sync.start))
    return profile.roll(at).shift(slave=float(profile(at)) - in_sync)
