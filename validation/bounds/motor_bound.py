"""Lower bounds of the motor's objectives over a whole cycle: the sync zone as it is, the return by what no return can go below."""

from __future__ import annotations

import math

import numpy as np

from camwright.profiles.objective import OBJECTIVES, MotionObjective, MotorObjective
from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.profiles.task import Task
from camwright.validation.bounds.bent_peaks import least_bent_acceleration, least_bent_jerk
from camwright.validation.bounds.bound import NONE, Bound
from camwright.validation.bounds.constant_inertia import ROUNDING, drawn, peak_with_friction, square_with_friction
from camwright.validation.bounds.mean_square import mean_square_bound
from camwright.validation.bounds.path_convex import least_square_in_time
from camwright.validation.bounds.path_dual import (
    least_drawn,
    least_square,
    no_motion_below,
    standing_square,
    turning_peak,
    turning_square,
)
from camwright.validation.bounds.path_limits import least_square_limited
from camwright.validation.bounds.path_task import PathTask
from camwright.validation.bounds.path_tubes import least_in_tubes
from camwright.validation.bounds.path_turns import Around, turning_peak_around, turning_square_around
from camwright.validation.motion import greatest_magnitude
from camwright.validation.motor import motor_torque, work_drawn

CONVEX = "convex programme over the path, by its dual"
PATH = "value function over the path, by a cone programme"
TUBES = "convex programme over the path, in tubes"
STANDING = "closed form, standing"
FRICTION = "closed form, friction"
SPEEDS = "closed form, change of speed"
ZONE = "peak of the sync zone"
BENT = "closed form, from end to end of the sync zone"
BELOW = 0.985
"""Share of the cost of standing still below which a value function is asked where standing is cheaper than what was found."""
PLACES = 2001
"""Places of the path at which the inertia is taken."""
NEAR = 1e-2
"""Share of the mean square below which no value function is asked: it is made no better than to 1.5 times that."""
WAITING = 0.1
"""Share of the mean square below which the convex programme shows that time is wasted: a value function is asked first."""
LOOSE = 0.05
"""Share of the mean square or the energy below which a bound that knows the jerk is asked too."""
KNOWN = 0.02
"""Share of the energy within which a closed form is good enough, and of the mean square within which a value function is."""
EDGE = 5e-3
"""Share by which a peak may lie above that of the zone to need no other bound."""
PEAKS = (0.97, 0.91, 0.85, 0.7)
"""Shares of a peak that are tried for the greatest that is proved to be too low, as long as the tubes prove less."""


def motor_bound(profile: CamProfile, task: Task, objective: MotorObjective, motion: Bound) -> Bound:
    """Lower bound of a motor's objective (N·m or J at the motor).

    Parameters
    ----------
    profile
        One cycle over ``[0, x_c]``: what its return needs tells which motions need not be looked at.
    task
        The job.
    motion
        Bound of the RMS acceleration over the return, or for the peak torque of the peak acceleration; none where none is known.
    """
    machine = task.machine
    if not machine.moves_something:
        return Bound(math.nan, NONE)
    if not machine.constant_inertia:
        return _along_path(profile, task, objective)
    if objective != "energy":
        return (_constant if task.straight else _bent_constant)(profile, task, objective, motion)
    known = Bound(drawn(task), FRICTION if machine.friction else SPEEDS) if task.straight else Bound(0.0, PATH)
    if task.height <= 0 or known.value >= work_drawn(motor_torque(profile, task), profile, machine) * (1 - KNOWN):
        return known
    return max(known, _along_path(profile, task, objective), key=lambda bound: bound.value)


def bent_bound(profile: CamProfile, task: Task, objective: MotionObjective) -> Bound:
    """Bound of an objective of the motion where the slave's ratio changes in sync.

    A peak is that of the cycle: the greater of the sync zone's own and the return's least.
    """
    table = OBJECTIVES[objective]
    if table.form != "peak":
        return mean_square_bound(profile, task, objective)
    zone = task.sync.peak(table.order)
    own = table.over_time(zone, task.cut.line_speed)
    back = least_bent_acceleration(task) if table.order == 2 else least_bent_jerk(task)
    return Bound(own, ZONE) if own >= back or not math.isfinite(back) else Bound(back, BENT)


def _path(task: Task, inertia: FloatArray) -> PathTask:
    """Path of the return, with an inertia at its places."""
    v, sync, limits = task.cut.line_speed, task.sync, task.limits
    speeds, slopes = ((float(sync(sync.end, k)) * v**k, float(sync(sync.start, k)) * v**k) for k in (1, 2))
    time = task.cut.return_zone / v
    reach = limits.speed, limits.acceleration, limits.jerk
    return PathTask(inertia, task.height, speeds, time, *reach, slopes, task.machine.friction)


def _constant(profile: CamProfile, task: Task, objective: MotorObjective, motion: Bound) -> Bound:
    """Bound of a torque where inertia and ratio in sync are constant."""
    machine, cut = task.machine, task.cut
    inertia, friction = float(machine.inertia(task.slave_at_sync_start)), machine.friction
    if objective == "peak_torque":
        if not friction:
            return Bound(inertia * motion.value / machine.motor_ratio, motion.method)
        zone = _zone_peak(profile, task)
        back = 0.0 if task.reverses else peak_with_friction(task) / machine.motor_ratio
        return Bound(zone, ZONE) if zone >= back else Bound(back, FRICTION)
    time = cut.return_zone / cut.line_speed
    square, method = inertia**2 * motion.value**2 * time, motion.method
    if friction:
        # the mean of ÿ sign(ẏ) over a return between equal speeds is zero: friction adds its square while the slave moves
        least = square + friction**2 * min(abs(task.height) / task.limits.speed, time)
        with_friction = least if task.reverses else square_with_friction(task, motion.value**2 * time)
        square, method = max(least, with_friction), FRICTION
    zone = (friction / machine.motor_ratio) ** 2 * cut.sync_zone / cut.line_speed
    return Bound(math.sqrt((square / machine.motor_ratio**2 + zone) / cut.period), method)


def _bent_constant(profile: CamProfile, task: Task, objective: MotorObjective, motion: Bound) -> Bound:
    """Bound of a torque where the inertia is constant and the ratio changes in sync.

    Over the return the integral of ``ÿ sign(ẏ)`` is what the speed gains, so friction adds that and its square while the slave moves.
    """
    machine, cut = task.machine, task.cut
    inertia, friction = float(machine.inertia(task.slave_at_sync_start)), machine.friction
    if objective == "peak_torque":
        zone, back = _zone_peak(profile, task), (inertia * motion.value - friction) / machine.motor_ratio
        return Bound(zone, ZONE) if zone >= back else Bound(back, motion.method)
    v, time = cut.line_speed, cut.return_zone / cut.line_speed
    gained = (float(task.sync(task.sync.start, 1)) - float(task.sync(task.sync.end, 1))) * v
    softest = motion.value**2 * time
    square = inertia**2 * softest + friction**2 * min(abs(task.height) / task.limits.speed, time)
    if friction and not task.reverses:
        square = max(square, square_with_friction(task, softest))
    square += 2 * inertia * friction * gained
    zone = _zone_square(motor_torque(profile, task), task)
    return Bound(math.sqrt((square / machine.motor_ratio**2 + zone) / cut.period), motion.method)


def _zone_square(torque: CamProfile, task: Task) -> float:
    """Integral of the squared torque over the sync zone (N² m² s)."""
    parts = task.cut.sync_parts
    return sum(torque.restrict(*part).mean_square(0) * (part[1] - part[0]) for part in parts) / task.cut.line_speed


def _along_path(profile: CamProfile, task: Task, objective: MotorObjective) -> Bound:
    """Bound along the path, for a slave that goes one way round, of any inertia and with friction."""
    machine = task.machine
    q = task.slave_at_sync_end + np.linspace(0.0, task.height, PLACES)
    path = _path(task, np.asarray(machine.inertia(q)) + 0.0 * q)
    ratio, torque, turns = machine.motor_ratio, motor_torque(profile, task), task.reverses and path.may_rest
    if objective == "rms_torque":
        return _square(path, torque, task)
    if objective == "energy":
        zone = _zone_energy(profile, torque, task)
        found = work_drawn(torque, profile, machine) - zone
        # a motion that turns must come from rest to the last speed; it has rolled as far as friction lets it
        first, last = path.energies
        rubbed = path.friction * path.way
        turning = last + max(rubbed - first, 0.0) if turns else math.inf
        back, method = _least_drawn(path, found) if found > 0 else (0.0, PATH)
        back = min(back, turning)
        return Bound(zone + max(back, (rubbed + last - first) * (1 - ROUNDING)), method)
    zone = _zone_peak(profile, task)
    greatest = greatest_magnitude(torque, 0).value
    if greatest <= zone * (1 + EDGE):
        return Bound(zone, ZONE)
    level = greatest * ratio
    if turns:
        turning = turning_peak(path, _everywhere(task))
        level = min(level, max(turning, turning_peak_around(path, _around(task), level)))
    back, method = _least_peak(path, zone * ratio, level)
    return Bound(zone, ZONE) if zone >= back / ratio else Bound(back / ratio, method)


def _everywhere(task: Task) -> FloatArray:
    """Inertia at all places of the machine, where a slave that turns may come."""
    return np.asarray(task.machine.inertia(np.linspace(0.0, task.machine.pitch, PLACES)))


def _around(task: Task) -> Around:
    """Give what lies ahead of the return's start, and behind its end."""
    machine, way, start = task.machine, np.linspace(0.0, task.machine.pitch, PLACES), task.slave_at_sync_end
    ahead, behind = (np.asarray(machine.inertia(q)) for q in (start + way, start + task.height - way))
    return Around(ahead, behind, machine.pitch)


def _square(path: PathTask, torque: CamProfile, task: Task) -> Bound:
    """Bound of the RMS torque of a cycle: that of its zone, and the better of what a value function says at two levels."""
    cut, ratio = task.cut, task.machine.motor_ratio
    whole = torque.mean_square(0) * cut.period
    zone = _zone_square(torque, task)
    level = max(whole - zone, 1e-300) * ratio**2
    if task.reverses and path.may_rest:
        turning = turning_square(path, _everywhere(task))
        if turning < level:
            turning = max(turning, turning_square_around(path, _around(task), level))
        level = min(level, turning)
    found, method = _least_square(path, level)
    return Bound(math.sqrt((max(found, 0.0) / ratio**2 + zone) / cut.period), method)


def _least_square(path: PathTask, level: float) -> tuple[float, str]:
    """Bound of the integral of the squared torque by both roads, at most the level, and the better one's name."""
    in_time = least_square_in_time(path)
    waits = in_time < WAITING * level
    found, method = min(in_time if waits else max(in_time, least_square_limited(path)), level), CONVEX
    if found < level * (1 - NEAR):
        standing = standing_square(path)
        below = level if standing > level else BELOW**2 * standing
        seen = least_square(path, below)
        if seen > found:
            found, method = seen, STANDING if below < level and seen > 0.999 * below else PATH
    if waits and found < level * (1 - KNOWN):
        found, method = max((found, method), (min(least_square_limited(path), level), CONVEX))
    if found < level * (1 - LOOSE) and math.isfinite(path.acceleration):
        return max((found, method), (least_in_tubes(path, "square", level, found), TUBES))
    return found, method


def _least_drawn(path: PathTask, level: float) -> tuple[float, str]:
    """Bound of the energy drawn on the way, at most the level, and the better road's name."""
    found = least_drawn(path, level), PATH
    if found[0] < level * (1 - LOOSE) and math.isfinite(path.acceleration):
        return max(found, (least_in_tubes(path, "drawn", level, found[0]), TUBES))
    return found


def _least_peak(path: PathTask, low: float, high: float) -> tuple[float, str]:
    """Bound of the peak torque on the way, at most the high one, and its road; the low one, that of the zone, if it is none."""
    found = least_in_tubes(path, "peak", high, low) if math.isfinite(path.acceleration) else 0.0
    for share in PEAKS:
        if high * share <= max(low, found):
            break
        if no_motion_below(path, high * share):
            return high * share, PATH
    return max((found, TUBES), (low, ZONE))


def _zone_peak(profile: CamProfile, task: Task) -> float:
    """Greatest torque of the sync zone at the motor (N·m)."""
    torque = motor_torque(profile, task)
    return max(greatest_magnitude(torque.restrict(*part), 0).value for part in task.cut.sync_parts)


def _zone_energy(profile: CamProfile, torque: CamProfile, task: Task) -> float:
    """Energy drawn in the sync zone (J)."""
    parts = task.cut.sync_parts
    return sum(work_drawn(torque.restrict(*part), profile.restrict(*part), task.machine) for part in parts)
