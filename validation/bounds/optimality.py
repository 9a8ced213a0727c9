"""How far a return is from the best possible: lower bounds by a road that shares nothing with the design's.

Where a closed form holds it is the bound. That leaves the mean square of the jerk under limits that bind. It is a quadratic programme: on a
grid an interior point method gives its multipliers, and these are put into the dual function in continuous time, which any multipliers
make a lower bound (weak duality): what the grid misses makes the bound a little lower, never wrong. The quadratic stays in the dual
function, so an error of the multipliers enters squared.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from camwright.profiles.closed_forms.overshoot import shortest_stop
from camwright.profiles.closed_forms.reach import least_acceleration, least_jerk
from camwright.profiles.closed_forms.softest import softest
from camwright.profiles.closed_forms.transfer import Bounds
from camwright.profiles.errors import InputError
from camwright.profiles.limits import Limits
from camwright.profiles.objective import OBJECTIVES, MotionObjective, ObjectiveName
from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.profiles.task import Task
from camwright.validation.bounds.bound import NONE, Bound
from camwright.validation.bounds.mean_square import mean_square_bound
from camwright.validation.bounds.motor_bound import bent_bound, motor_bound
from camwright.validation.bounds.ramped import ramped_bound
from camwright.validation.bounds.return_dual import DualTask, least_square_jerk

INTERVALS = 140
"""Intervals of half a motion."""
TURNS, EARLIEST = 40_000, 1e-6
"""Times of the first standstill of a carriage that are looked at, from this share of the latest on; each is later by a 3000th."""
SAME = 1e-6
"""A profile within this share of the bound for a line that keeps its speed needs no other."""
ROUNDING = 1e-11
"""A bound that a design may reach exactly is lowered by this share."""
CLOSED_FORM = "closed form, double-S"
SOFTEST = "closed form, softest motion"
QUINTIC = "closed form, quintic"
BRAKING = "closed form, braking within the stroke"
DUAL = f"weak duality, multipliers by an interior point on {2 * INTERVALS} intervals"


@dataclass(frozen=True)
class _Return:
    """The rest-to-rest motion over the line, scaled to unit length and unit height, and its limits."""

    low: float
    high: float
    slope: float
    jerk: float


def lower_bound(profile: CamProfile, task: Task, objective: ObjectiveName) -> Bound:
    """Lower bound of what any return of this job can reach.

    With a line that ramps the bound is that of its ramps too (`camwright.validation.bounds.ramped`), where that is the sharper.

    Where the slave's ratio is constant in sync the return is a straight line plus a motion from rest to rest, and closed forms hold. Of the
    stroke of a carriage they know only that it must turn round within it, by itself; weak duality knows all of it.

    Parameters
    ----------
    profile
        One cycle over ``[0, x_c]``. Where the bound is the dual's, its grid holds this profile's breaks; that makes it the sharper.
    objective
        ``"peak_acceleration"``, ``"rms_acceleration"``, ``"peak_jerk"`` or ``"rms_jerk"``; root mean squares over the return zone. Or
        ``"rms_torque"`` (over the whole cycle), ``"peak_torque"`` or ``"energy"`` at the motor, as `camwright.validation.motor`
        measures them. None is known of the energy, and of the sync error, which is not the return's.

    Raises
    ------
    InputError
        The objective is not one of these.
    """
    if objective not in OBJECTIVES:
        raise InputError(f"there is no objective {objective!r}; the objectives are {', '.join(OBJECTIVES)}")
    if objective == "rms_torque" or objective == "peak_torque" or objective == "energy":
        motion = Bound(math.nan, NONE)
        if task.machine.constant_inertia and objective != "energy":
            motion = lower_bound(
                profile, task, "peak_acceleration" if objective == "peak_torque" else "rms_acceleration"
            )
        return motor_bound(profile, task, objective, motion)
    if objective == "sync_error":
        return Bound(math.nan, NONE)
    steady = _steady_bound(profile, _within_ratio(profile, task), objective)
    if not task.line.ramps or steady.value >= _reached(profile, task, objective) * (1.0 - SAME):
        return steady
    ramped = ramped_bound(profile, task, objective)
    return ramped if math.isnan(steady.value) or ramped.value > steady.value else steady


def _reached(profile: CamProfile, task: Task, objective: MotionObjective) -> float:
    """Objective of a profile over time: a peak of the cycle, a root mean square of the return."""
    of, start = OBJECTIVES[objective], task.cut.return_start
    if of.form == "peak":
        value = profile.peak(of.order)
    else:
        value = math.sqrt(profile.mean_square(of.order, start, min(start + task.cut.return_zone, profile.end)))
    return of.over_time(value, task.cut.line_speed)


def _within_ratio(profile: CamProfile, task: Task) -> Task:
    """Give limits whose speed is no more than the line's own acceleration and jerk leave of the slave's, if a profile keeps it."""
    v, line, limits = task.cut.line_speed, task.line, task.limits
    taken = ((limits.acceleration, line.hardest), (limits.jerk, line.known_jerk))
    ratio = min((room / own for room, own in taken if own), default=math.inf)
    if ratio * v >= limits.speed or profile.peak(1) > ratio * (1.0 + SAME):
        return task
    return task.with_limits(replace(limits, speed=ratio * v))


def _steady_bound(profile: CamProfile, task: Task, objective: MotionObjective) -> Bound:
    """Lower bound for a line that keeps its speed, which is one for a line that ramps too."""
    machine, cut = task.machine, task.cut
    if not task.straight:
        return bent_bound(profile, task, objective)
    length, v = cut.return_zone, cut.line_speed
    ratio = float(task.sync(0.0, 1))
    height = machine.pitch - ratio * cut.length  # of the motion over the line that sync zone and return zone share
    time = length / v
    if machine.guide is not None:
        low, high = machine.guide
        room = 0.5 * (high - low - task.sync.advance)
        way = task.sync.advance
        braking = Bound(_braking(ratio * v, room, way, time, task.limits, objective), BRAKING)
        free = _free_bound(profile, task, objective, height)
        found = max(braking, free, key=lambda bound: bound.value)
        return mean_square_bound(profile, task, objective, found) if OBJECTIVES[objective].form != "peak" else found
    return _free_bound(profile, task, objective, height)


def _braking(velocity: float, room: float, way: float, time: float, limits: Limits, objective: ObjectiveName) -> float:
    """Bound of a carriage that comes out of its sync zone at a velocity and must turn round within half of what the stroke leaves.

    On one side of the zone there is no more room than that, and by mirroring the time both ends of the return are alike.
    """
    if room <= 0:
        return math.inf
    if objective == "rms_acceleration":
        return math.sqrt(_softest_turns(velocity, room, way, time) / time)
    if objective not in ("peak_acceleration", "peak_jerk"):
        return 0.0
    peak = objective == "peak_acceleration"
    given = limits.acceleration if peak else limits.jerk

    def stops(limit: float) -> bool:
        slope, jerk = (limit, limits.jerk) if peak else (limits.acceleration, limit)
        return shortest_stop(velocity, Bounds(-limits.speed, limits.speed, slope, jerk)) <= room

    low, high = 0.0, given
    if not stops(given):
        return given * (1 - ROUNDING)
    while low < (middle := 0.5 * (low + high)) < high:  # on a slow line far below what is given
        low, high = (low, middle) if stops(middle) else (middle, high)
    return low * (1 - ROUNDING)


def _softest_turns(velocity: float, room: float, way: float, time: float) -> float:
    """Bound of the integral of the squared acceleration of a carriage that turns on both sides of its way back.

    With a motion its mirror image in time keeps the limits, and so does the mean of the two, whose integral is no greater. So it comes to
    its first standstill ``t`` after it set out, ``d`` beyond, and to its last ``t`` before the end. Each of these takes at least
    ``4 v² / t - 12 v d / t² + 12 d² / t³``, and the way between the standstills, ``way + 2 d`` in what time is left, at least
    ``12 (way + 2 d)² / (time - 2 t)³``. A standstill later than ``3 d / v`` is no better than one at that time. The former falls with ``t``
    and the latter rises: between two times the one at the later and the other at the earlier bound them, a quadratic in ``d``.
    """
    latest = min(0.5 * time, 3 * room / velocity)
    t = np.concatenate([[0.0], latest * np.geomspace(EARLIEST, 1.0, TURNS)])
    before, after = t[:-1], t[1:]
    rest = time - 2 * before
    least = (velocity / (2 * after**2) - way / rest**3) / (1 / after**3 + 2 / rest**3)
    d = np.clip(least, np.minimum(velocity * before / 3, room), room)
    turn = 4 * velocity**2 / after - 12 * velocity * d / after**2 + 12 * d**2 / after**3
    return float((2 * turn + 12 * (way + 2 * d) ** 2 / rest**3).min()) * (1 - ROUNDING)


def _free_bound(profile: CamProfile, task: Task, objective: ObjectiveName, height: float) -> Bound:
    """Bound without the stroke, of a motion over the line that covers a height."""
    cut, limits = task.cut, task.limits
    length, v = cut.return_zone, cut.line_speed
    ratio = float(task.sync(0.0, 1))
    time = length / v
    if abs(height) <= 1e-13 * length:
        return Bound(0.0, CLOSED_FORM)
    up, down = limits.speed - ratio * v, ratio * v - task.least_velocity
    speed = up if height > 0 else down
    if objective == "peak_acceleration":
        return Bound(least_acceleration(abs(height), time, speed, limits.jerk), CLOSED_FORM)
    if objective == "peak_jerk":
        return Bound(least_jerk(abs(height), time, speed, limits.acceleration), CLOSED_FORM)
    if objective == "rms_acceleration":
        motion = softest(abs(height), time, speed, limits.acceleration, limits.jerk)
        return Bound(math.inf if motion is None else math.sqrt(motion.mean_square), SOFTEST)
    unit = abs(height) / time**3
    job = _Return(
        low=-(down if height > 0 else up) * time / abs(height),
        high=speed * time / abs(height),
        slope=limits.acceleration * time**2 / abs(height),
        jerk=limits.jerk * time**3 / abs(height),
    )
    if job.high >= 15 / 8 and job.slope >= 10 / math.sqrt(3) and job.jerk >= 60:
        return Bound(math.sqrt(720) * unit, QUINTIC)
    start = cut.return_start
    back = profile.restrict(start, start + length).shift(-start, -float(profile(start)))
    scaled = back.add_line(-ratio).scale(master=1.0 / length, slave=1.0 / height).over(0.0, 1.0)
    return Bound(math.sqrt(max(0.0, _dual_bound(scaled, job))) * unit, DUAL)


def _dual_bound(motion: CamProfile, job: _Return) -> float:
    """Lower bound of the mean square of the jerk of any motion from 0 to 1, rest to rest, in unit time.

    With a motion its mirror image about the middle keeps the limits, and so does the mean of the two, whose mean square is no greater.
    So half of the motion is all there is to look at: it ends in the middle at half the way without acceleration, at any speed.
    The dual function is that of the half's integral; what the jerk adds to it at ``s``, with the price ``c(s)`` of the constraints
    that lie ahead, is the least of ``j² / 2 + c j`` over ``|j| <= J``.
    """
    half = DualTask(0.5, (0.0, 0.0), (0.5, None, 0.0), (job.low, job.high), job.slope, job.jerk)
    return 4 * least_square_jerk(half, _half_grid(motion), math.sqrt(motion.mean_square(3)))


def _half_grid(motion: CamProfile) -> FloatArray:
    """Return nodes on half the motion: uniform ones and, of a motion with few pieces, its breaks folded and as many between each two."""
    nodes = np.linspace(0.0, 0.5, INTERVALS // 2 + 1)
    own = np.unique(np.concatenate([np.minimum(motion.breaks, 1.0 - motion.breaks), [0.5]]))
    own = own[np.append(True, np.diff(own) > 1e-3 / INTERVALS)]
    if len(own) <= INTERVALS // 8:
        own[-1] = 0.5
        parts = INTERVALS // 2 // (len(own) - 1)
        own = np.interp(np.arange((len(own) - 1) * parts + 1) / parts, np.arange(len(own)), own)
        near = np.abs(nodes[:, None] - own[None, :]).min(axis=1)
        nodes = np.union1d(nodes[near > 0.02 / INTERVALS], own)
    return nodes
