"""From a cutting machine's job to a cycle whose axis keeps to the material."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Literal

from design.axis_programme import RATIO, AxisProblem, AxisProgramme, Cost
from design.command_basis import Command
from design.ipopt import SolveStatus
from design.motor import motor_limits, motor_speed_limits
from design.optimise import MOTION_OBJECTIVES, Objective, Solution, motion_objective, solve
from design.refusal import require_feasible
from design.servo_aware import AxisMotion, design_axis
from profiles.cycle import Cut
from profiles.errors import InfeasibleError, InputError, SolverError, Suggestion
from profiles.limits import Limits
from profiles.machines import CrankSlider, Machine
from profiles.polynomial import CamProfile
from profiles.servo import Servo

AxisObjective = Objective | Literal["sync_error"]
"""What a servo-aware design may be asked for."""

# Suggested values are searched to this share, and stand aside by it from the edge.
ASIDE = 2e-3
# Cuts up to so many times the asked length, and line speeds down to such a share, are looked at for a way out.
LONGEST, SLOWEST = 8.0, 0.02


def solve_axis(
    machine: Machine,
    cut: Cut,
    limits: Limits,
    objective: AxisObjective,
    command: Command,
    servos: tuple[Servo, ...],
    between: tuple[Servo, ...] = (),
) -> Solution:
    """Design the cycle of a cutting machine whose axis keeps to the material in the shear zone.

    The limits hold for the command, and for the axis too wherever the tolerance can then still be kept; `Solution.axis` says whether.

    Parameters
    ----------
    machine, cut, limits
        As for `design.optimise.solve`; the cut's sync tolerance is what the axis may be off.
    objective
        What is made least.
    command
        Whether the command keeps ``k = 1`` in the whole sync zone (``"in_sync"``), or may be anything that brings the axis into sync in
        the shear zone (``"shaped"``).
    servos
        Servos with which the tolerance must be kept, the nominal one first.
    between
        Servos between the corners of the ranges, which must keep the tolerance too, or be hardly worse than the corners.

    Raises
    ------
    InfeasibleError
        No command keeps the limits, or none brings the axis into the tolerance.
    InputError
        The objective cannot be made least with the servo in the problem; the servo is unstable.
    SolverError
        The solver failed.
    """
    cost = _cost(machine, objective)
    blind = None
    if command == "in_sync" or (isinstance(machine, CrankSlider) and math.isnan(machine.sync_at)):
        blind = solve(machine, cut, limits, "peak_acceleration" if cost == "sync_error" else cost)
        machine = blind.machine
    structure = None if blind is None or command == "shaped" else blind.back
    problem = AxisProblem(machine, cut, limits, command, servos, True, structure, between)
    found = [_either(replace(problem, limits=each), cost) for each in motor_limits(machine, limits)]
    motions = [motion for motion in found if motion is not None]
    if not motions:
        raise _infeasible(replace(problem, limits=motor_speed_limits(machine, limits), axis_limits=False))
    motion = min(motions, key=lambda each: each.value)
    order = {"sync_error": 0, "peak_acceleration": 2, "rms_acceleration": 2, "peak_jerk": 3, "rms_jerk": 3}[cost]
    value = motion.value * cut.line_speed**order
    profile = motion.profile
    back = profile.restrict(0.0, cut.return_zone)
    if cut.origin == "cut":
        profile = _from_mid_sync(profile, machine, cut)
    name: Objective = "peak_acceleration" if objective == "sync_error" else objective
    return Solution(machine, profile, back, SolveStatus.ON_GRID, name, value, motion.programmes, axis=motion)


def _cost(machine: Machine, objective: AxisObjective) -> Cost:
    """Objective of the motion that a programme can minimise."""
    if objective == "sync_error" or objective in MOTION_OBJECTIVES:
        return objective
    decisive = motion_objective(machine, objective)
    if decisive is None:
        raise InputError(
            f"[objective] minimise = {objective!r}: a servo-aware design of this machine minimises "
            f"{', '.join(MOTION_OBJECTIVES)} or sync_error; choose one of these, or servo_aware = false"
        )
    return decisive


def _either(problem: AxisProblem, cost: Cost) -> AxisMotion | None:
    """Design with the limits held by the axis too; without, where that costs the tolerance."""
    try:
        strict = design_axis(problem, cost)
    except SolverError:
        strict = None
    if strict is not None and strict.axis_limits and strict.error <= problem.cut.sync_tolerance:
        return strict
    return design_axis(replace(problem, axis_limits=False), cost)


def _from_mid_sync(profile: CamProfile, machine: Machine, cut: Cut) -> CamProfile:
    """Count master and slave from mid sync zone, the slave from where the machine is in sync there."""
    at = cut.length - 0.5 * cut.sync_zone
    sync = machine.sync_profile(cut)
    in_sync = machine.pitch - sync.advance + float(sync(0.5 * cut.sync_zone)) - float(sync(sync.start))
    return profile.roll(at).shift(slave=float(profile(at)) - in_sync)


def _infeasible(problem: AxisProblem) -> InfeasibleError:
    """Say by how much the tolerance is missed, and what would keep it, each solved."""
    tolerance, cut = problem.cut.sync_tolerance, problem.cut
    share = AxisProgramme(problem).least_share()
    if share is None:
        require_feasible(problem.machine, cut, problem.limits)
        raise SolverError(
            "a servo-aware design found no command that keeps the limits although the job allows one; report this job"
        )
    needed = max(1.0, share) * tolerance
    suggestions = []
    wider = _nearest(
        lambda factor: _works(replace(problem, cut=replace(cut, sync_tolerance=factor * needed))), 1.0, 1.5
    )
    if wider is not None:
        suggestions.append(Suggestion("sync_tolerance", wider * needed * 1e3, "mm"))
    slower = _nearest(
        lambda share: _works(replace(problem, cut=replace(cut, line_speed=cut.line_speed / share), structure=None)),
        1.0,
        1 / SLOWEST,
    )
    if slower is not None:
        suggestions.append(Suggestion("line_speed", cut.line_speed / slower * 60.0, "m/min"))
    longer = _nearest(
        lambda share: _works(replace(problem, cut=replace(cut, length=cut.length * share), structure=None)),
        1.0,
        LONGEST,
    )
    if longer is not None:
        suggestions.append(Suggestion("length", cut.length * longer * 1e3, "mm"))
    ways = "; ".join(f"{each.change} {each.value:.6g} {each.unit}" for each in suggestions)
    excess = (needed - tolerance) * 1e3
    return InfeasibleError(
        f"[cut] sync_tolerance = {tolerance * 1e3:g} mm: no {problem.command} command within the limits holds the axis to it in the shear "
        f"zone and the ratio of the axis to {_percent(cut, tolerance)} (twice the tolerance over the shear zone); the least that one holds "
        f"is {needed * 1e3:.6g} mm and {_percent(cut, needed)}, {excess:.4g} mm too much"
        + (f"; what works: {ways}" if ways else ""),
        "sync_tolerance",
        excess,
        "mm",
        tuple(suggestions),
    )


def _percent(cut: Cut, tolerance: float) -> str:
    """Error of the ratio that goes with a tolerance."""
    return f"{100 * RATIO * tolerance / cut.shear_zone:.3g} %" if cut.shear_zone else "any"


def _works(problem: AxisProblem) -> bool:
    """Whether a command brings the axis into the tolerance."""
    try:
        return AxisProgramme(problem).reaches()
    except (InputError, SolverError):
        return False


def _nearest(works: Callable[[float], bool], least: float, most: float) -> float | None:
    """Least share above ``least`` found to work: grown until it does, then bisected; ``None`` if none up to ``most`` works."""
    low, high = least, least * (1.0 + ASIDE)
    while not works(high):
        low, high = high, least + (high - least) * 2.0
        if high > most:
            return None
    while high - low > ASIDE * high:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if works(middle) else (middle, high)
    return high
