"""How far a return is from the best possible: lower bounds by a road that shares nothing with the design's.

Where a closed form holds it is the bound. That leaves the mean square of the jerk under limits that bind. It is a quadratic programme: on a
grid an interior point method gives its multipliers, and these are put into the dual function in continuous time, which any multipliers
make a lower bound (weak duality): what the grid misses makes the bound a little lower, never wrong. The quadratic stays in the dual
function, so an error of the multipliers enters squared.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

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
from camwright.validation.bounds.motor_bound import bent_bound, motor_bound
from camwright.validation.bounds.quadratic import multipliers
from camwright.validation.bounds.ramped import ramped_bound

INTERVALS = 140
"""Intervals of half a motion."""
GREATEST = 1e3
"""Largest limit that the quadratic programme is told; none that matters is that large."""
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

    Bounds are known where the slave's ratio is constant in sync: then the return is a straight line plus a motion from rest to rest. Of the
    stroke of a carriage only that it must turn round within it is looked at, by itself, which can only lower them. Elsewhere there is none.

    Parameters
    ----------
    profile
        One cycle over ``[0, x_c]``. Where the bound is the dual's, its grid holds this profile's breaks; that makes it the sharper.
    task
        The job.
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
        if task.straight and objective != "energy":
            motion = lower_bound(
                profile, task, "peak_acceleration" if objective == "peak_torque" else "rms_acceleration"
            )
        return motor_bound(profile, task, objective, motion)
    if objective == "sync_error":
        return Bound(math.nan, NONE)
    steady = _steady_bound(profile, task, objective)
    if not task.line.ramps or steady.value >= _reached(profile, task, objective) * (1.0 - SAME):
        return steady
    ramped = ramped_bound(profile, task, objective)
    return ramped if math.isnan(steady.value) or ramped.value > steady.value else steady


def _reached(profile: CamProfile, task: Task, objective: MotionObjective) -> float:
    """Objective of a profile over time: a peak of the cycle, a root mean square of the return."""
    of, start = OBJECTIVES[objective], task.cut.return_start
    if of.form == "peak":
        value = max(abs(each.value) for each in profile.extrema(of.order))
    else:
        value = math.sqrt(profile.mean_square(of.order, start, min(start + task.cut.return_zone, profile.end)))
    return of.over_time(value, task.cut.line_speed)


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
        return braking if braking.value > free.value else free
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
    for _ in range(60):
        middle = 0.5 * (low + high)
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
    x = _half_grid(motion)
    slope_price, speed_price, (turn, way), constant = _multipliers(x, job, math.sqrt(motion.mean_square(3)))
    cell: NDArray[np.intp] = np.arange(len(x) - 1)
    lever, later = (_beyond(values)[cell + 1] for values in (speed_price, speed_price * x))
    atoms, spread = _spread(slope_price)

    def price(s: FloatArray) -> FloatArray:
        ahead = _beyond(atoms)[cell + 1] + _spread_ahead(spread, x, cell, s)
        return np.asarray(ahead + later - s * lever - turn - way * (0.5 - s) ** 2 / 2)

    # three values on each interval make the quadratic that the price is there
    h = np.diff(x)
    inside = 1e-9 * h
    prices = price(x[:-1] + inside), price(0.5 * (x[:-1] + x[1:])), price(x[1:] - inside)
    return 4 * (constant - float(_integral_of_least(*prices, h, job.jerk).sum()))


def _beyond(values: FloatArray) -> FloatArray:
    """Add up from each place on; last comes zero."""
    return np.append(np.cumsum(values[::-1])[::-1], 0.0)


def _spread(price: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Split prices at nodes into single ones and such as belong to an arc along which the limit is active.

    On an arc the true price is a density; left at the nodes it would make the price of the jerk a saw-tooth.
    """
    active = np.abs(price) > 1e-9 * np.abs(price).max(initial=1e-300)
    same = np.sign(price[1:]) == np.sign(price[:-1])
    inner = np.zeros(len(price), dtype=bool)
    inner[1:-1] = active[1:-1] & active[:-2] & active[2:] & same[:-1] & same[1:]
    inner[[1, -2]] = False  # the ends are fixed, their prices are no part of an arc
    return np.where(inner, 0.0, price), np.where(inner, price, 0.0)


def _spread_ahead(spread: FloatArray, x: FloatArray, cell: NDArray[np.intp], s: FloatArray) -> FloatArray:
    """Integral beyond ``s`` of densities that rise from the node before and fall to the node after, one for each price."""
    h = np.concatenate([[0.0], np.diff(x), [0.0]])  # h[k + 1] is the cell after node k
    width = h[:-1] + h[1:]  # the two cells at each node
    here = h[cell + 1]
    beyond = np.append(np.cumsum(spread[::-1])[::-1], [0.0, 0.0])[cell + 2]
    rising = spread[cell + 1] * (1.0 - (s - x[cell]) ** 2 / (here * width[cell + 1]))
    falling = spread[cell] * (x[cell + 1] - s) ** 2 / (here * width[cell])
    return np.asarray(beyond + rising + falling)


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


def _multipliers(x: FloatArray, job: _Return, unit: float) -> tuple[FloatArray, FloatArray, FloatArray, float]:
    """Solve the quadratic programme of half a motion on a grid with the jerk constant on each interval, ``unit`` its jerk that counts as 1.

    Returns
    -------
    (slope prices, speed prices, end prices, constant of the dual function)
        Multipliers of ``q''`` and ``q'`` at the nodes; of ``q''`` and ``q`` in the middle.
    """
    from scipy.sparse import block_array, csr_array, diags_array, eye_array

    n, h = len(x) - 1, np.diff(x)
    slope = min(job.slope, GREATEST) / unit
    high, low = min(job.high, GREATEST) / unit, max(job.low, -GREATEST) / unit
    jerk = min(job.jerk / unit, GREATEST)
    # unknowns: the jerk of each interval, then q'', q', q at its end, all over the unit
    ahead = eye_array(n) - eye_array(n, k=-1)
    before = eye_array(n, k=-1)
    end = np.zeros((1, n))
    end[0, -1] = 1.0
    system = block_array(
        [
            [-diags_array(h), ahead, None, None],
            [-diags_array(h**2 / 2), -diags_array(h) @ before, ahead, None],
            [-diags_array(h**3 / 6), -diags_array(h**2 / 2) @ before, -diags_array(h) @ before, ahead],
            [None, csr_array(end), None, None],
            [None, None, None, csr_array(end)],
        ],
        format="csr",
    )
    none = np.full(n, np.inf)
    slopes = np.append(np.full(n - 1, slope), np.inf)
    top = np.concatenate([np.full(n, jerk), slopes, np.full(n, high), none])
    bottom = np.concatenate([np.full(n, -jerk), -slopes, np.full(n, low), -none])
    goal = np.append(np.zeros(3 * n + 1), 0.5 / unit)
    upper, lower, prices = multipliers(np.concatenate([h, np.zeros(3 * n)]), bottom, top, system, goal)
    limited = np.isfinite(top) & (np.arange(4 * n) >= n)
    constant = goal[-1] * prices[-1] - float(upper[limited] @ top[limited] - lower[limited] @ bottom[limited])
    price = np.concatenate([[0.0], (upper - lower)[n : 2 * n], [0.0], (upper - lower)[2 * n : 3 * n]])
    return unit * price[: n + 1], unit * price[n + 1 :], unit * prices[-2:], unit**2 * constant


def _integral_of_least(
    first: FloatArray, centre: FloatArray, last: FloatArray, h: FloatArray, limit: float
) -> FloatArray:
    """Integral of ``-min(j² / 2 + c j)`` over ``|j| <= limit``, ``c`` quadratics given at both ends and the middle of intervals ``h``.

    That is ``c² / 2`` up to ``|c| = limit``, beyond it ``limit |c| - limit² / 2``; between the places where it changes Gauss-Legendre
    with three points is exact.
    """
    b = -3 * first + 4 * centre - last
    a = 2 * first - 4 * centre + 2 * last
    places = [np.zeros_like(h), np.ones_like(h)]
    for level in (limit, -limit):
        c = first - level
        root = np.sqrt(np.maximum(b * b - 4 * a * c, 0.0))
        q = -0.5 * (b + np.where(b >= 0, root, -root))
        with np.errstate(divide="ignore", invalid="ignore"):
            found = np.nan_to_num(q / a), np.nan_to_num(c / q)
        places += [np.where((b * b > 4 * a * c) & (r > 0) & (r < 1), r, 0.0) for r in found]
    edges = np.sort(np.stack(places), axis=0)
    node, weight = np.polynomial.legendre.leggauss(3)
    s = edges[:-1, None] + np.diff(edges, axis=0)[:, None] * (0.5 * (node + 1))[:, None]
    size = np.abs(first + s * (b + s * a))
    least = np.where(size <= limit, 0.5 * size**2, limit * size - 0.5 * limit**2)
    return np.asarray((np.diff(edges, axis=0) * (least * weight[:, None] / 2).sum(axis=1)).sum(axis=0) * h)
