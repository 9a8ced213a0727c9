"""How far a return is from the best possible: lower bounds by a road that shares nothing with the design's.

Where a closed form holds it is the bound. Else the objective is convex, so it lies above its tangent at the profile in question; the least
value of that tangent under the limits is a linear programme. HiGHS solves it on a fine grid, and its multipliers are put into the
dual function in continuous time, which any multipliers make a lower bound (weak duality): what the grid misses makes the
bound a little lower, never wrong.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from profiles.cycle import Cut
from profiles.errors import InputError
from profiles.limits import Limits
from profiles.machines import Machine
from profiles.polynomial import CamProfile, FloatArray
from profiles.reach import least_acceleration, least_jerk
from profiles.returns import is_straight
from validation.motor import moves_something

OBJECTIVES = ("peak_acceleration", "rms_acceleration", "peak_jerk", "rms_jerk", "rms_torque", "peak_torque", "energy")
INTERVALS = 400
CLOSED_FORM = "closed form, double-S"
QUINTIC = "closed form, quintic"
DUAL = "weak duality, multipliers by HiGHS on 400 intervals"
NONE = "none"


@dataclass(frozen=True)
class Bound:
    """A lower bound of an objective over time (m/s², m/s³ or N·m at the motor), and how it was found; not a number with method "none"."""

    value: float
    method: str


@dataclass(frozen=True)
class _Return:
    """The rest-to-rest motion over the line, scaled to unit length and unit height, and its limits."""

    low: float
    high: float
    slope: float
    jerk: float


def lower_bound(profile: CamProfile, machine: Machine, cut: Cut, limits: Limits, objective: str) -> Bound:
    """Lower bound of what any return of this job can reach.

    Bounds are known where the slave's ratio is constant in sync: then the return is a straight line plus a motion from rest to rest. The
    stroke of a carriage is left out, which can only lower them. Elsewhere there is none.

    Parameters
    ----------
    profile
        One cycle over ``[0, x_c]``. Root-mean-square bounds are tangents at this profile: exact at the optimum, lower elsewhere.
    machine, cut, limits
        The job.
    objective
        ``"peak_acceleration"``, ``"rms_acceleration"``, ``"peak_jerk"`` or ``"rms_jerk"``; root mean squares over the return zone. Or
        ``"rms_torque"`` (over the whole cycle), ``"peak_torque"`` or ``"energy"`` at the motor, as `validation.motor` measures them.

    Raises
    ------
    InputError
        The objective is not one of these.
    """
    if objective not in OBJECTIVES:
        raise InputError(f"there is no objective {objective!r}; the objectives are {', '.join(OBJECTIVES)}")
    if not is_straight(machine, cut) or objective == "energy":
        return Bound(math.nan, NONE)
    if objective in ("rms_torque", "peak_torque"):
        return _torque_bound(profile, machine, cut, limits, objective)
    length, v = cut.return_zone, cut.line_speed
    ratio = float(machine.sync_profile(cut)(0.0, 1))
    height = machine.pitch - ratio * cut.length  # of the motion over the line that sync zone and return zone share
    time = length / v
    if abs(height) <= 1e-13 * length:
        return Bound(0.0, CLOSED_FORM)
    least = -limits.speed if machine.turns_back else limits.least_velocity
    up, down = limits.speed - ratio * v, ratio * v - least
    speed = up if height > 0 else down
    if objective == "peak_acceleration":
        return Bound(least_acceleration(abs(height), time, speed, limits.jerk), CLOSED_FORM)
    if objective == "peak_jerk":
        return Bound(least_jerk(abs(height), time, speed, limits.acceleration), CLOSED_FORM)
    order = 2 if objective == "rms_acceleration" else 3
    unit = abs(height) / time**order
    job = _Return(
        low=-(down if height > 0 else up) * time / abs(height),
        high=speed * time / abs(height),
        slope=limits.acceleration * time**2 / abs(height),
        jerk=limits.jerk * time**3 / abs(height),
    )
    if order == 3 and job.high >= 15 / 8 and job.slope >= 10 / math.sqrt(3) and job.jerk >= 60:
        return Bound(math.sqrt(720) * unit, QUINTIC)
    start = cut.return_start
    back = profile.restrict(start, start + length).shift(-start, -float(profile(start)))
    scaled = back.add_line(-ratio).scale(master=1.0 / length, slave=1.0 / height)
    scaled = CamProfile(np.append(scaled.breaks[:-1], 1.0), scaled.coefficients.copy())
    return Bound(math.sqrt(max(0.0, _dual_bound(scaled, job, order))) * unit, DUAL)


def _torque_bound(profile: CamProfile, machine: Machine, cut: Cut, limits: Limits, objective: str) -> Bound:
    """Bound of a torque at the motor where the inertia ``I`` is constant, as it is where the slave's ratio in sync is.

    The mean of ``ÿ sign(ẏ)`` over a closed cycle is zero, so the mean square of the force is ``I²`` times that of the acceleration, plus
    ``F²`` times the share of the cycle in which the slave moves: at least the sync zone and the way back at the speed limit.
    """
    if not moves_something(machine) or (objective == "peak_torque" and machine.friction > 0):
        return Bound(math.nan, NONE)
    motion = lower_bound(profile, machine, cut, limits, objective.replace("torque", "acceleration"))
    inertial = float(machine.inertia(0.0)) * motion.value / machine.motor_ratio
    if objective == "peak_torque":
        return Bound(inertial, motion.method)
    way = abs(machine.pitch - machine.sync_profile(cut).advance)
    moving = min(1.0, (cut.sync_zone + cut.line_speed * way / limits.speed) / cut.length)
    friction = machine.friction / machine.motor_ratio
    return Bound(
        math.hypot(inertial * math.sqrt(cut.return_zone / cut.length), friction * math.sqrt(moving)), motion.method
    )


def _dual_bound(motion: CamProfile, job: _Return, order: int) -> float:
    """Lower bound of the mean square of the derivative ``order`` (2 or 3) of any motion from 0 to 1, rest to rest, in unit time."""
    x = _grid(motion)
    weight = _weight(motion, order)
    slope_price, speed_price, constant = _multipliers(x, weight, job)
    breaks = np.unique(np.concatenate([x, weight.breaks]))
    middle = 0.5 * (breaks[:-1] + breaks[1:])
    cell = np.clip(np.searchsorted(x, middle, side="right") - 1, 0, len(x) - 2)
    later = [np.append(np.cumsum(values[::-1])[::-1], 0.0)[cell + 1] for values in (speed_price[0], speed_price[0] * x)]
    atoms, spread = _spread(slope_price)

    def price(s: FloatArray) -> FloatArray:
        """Price of the jerk at s: what it adds to the tangent, less what it uses of the constraints that lie ahead."""
        ahead = np.append(np.cumsum(atoms[::-1])[::-1], 0.0)[cell + 1] + _spread_ahead(spread, x, cell, s)
        return np.asarray(weight(s) - ahead - (later[1] - s * later[0]) - speed_price[1] * (1.0 - s) ** 2 / 2)

    # three values on each part make the quadratic that the price is there
    h = np.diff(breaks)
    inside = 1e-9 * h
    first, centre, last = price(breaks[:-1] + inside), price(middle), price(breaks[1:] - inside)
    tangent = constant - job.jerk * float(_absolute_integral(first, centre, last, h).sum())
    return 2 * tangent - motion.mean_square(order)


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


def _spread_ahead(spread: FloatArray, x: FloatArray, cell: FloatArray, s: FloatArray) -> FloatArray:
    """Integral beyond ``s`` of densities that rise from the node before and fall to the node after, one for each price."""
    h = np.concatenate([[0.0], np.diff(x), [0.0]])  # h[k + 1] is the cell after node k
    width = h[:-1] + h[1:]  # the two cells at each node
    here = h[cell + 1]
    beyond = np.append(np.cumsum(spread[::-1])[::-1], [0.0, 0.0])[cell + 2]
    rising = spread[cell + 1] * (1.0 - (s - x[cell]) ** 2 / (here * width[cell + 1]))
    falling = spread[cell] * (x[cell + 1] - s) ** 2 / (here * width[cell])
    return np.asarray(beyond + rising + falling)


def _grid(motion: CamProfile) -> FloatArray:
    """Return the profile's own breaks and uniform nodes, without those that nearly coincide with a break."""
    uniform = np.linspace(0.0, 1.0, INTERVALS + 1)
    near = np.abs(uniform[:, None] - motion.breaks[None, :]).min(axis=1)
    return np.union1d(uniform[near > 0.01 / INTERVALS], motion.breaks)


def _weight(motion: CamProfile, order: int) -> CamProfile:
    """Gradient of half the mean square with respect to the jerk: the jerk itself, or minus the ratio (rest to rest, by parts)."""
    table = motion.coefficients
    if order == 3:
        for _ in range(3):
            table = table[:, 1:] * np.arange(1, table.shape[1])
        return CamProfile(motion.breaks.copy(), table.copy())
    return CamProfile(motion.breaks.copy(), -(table[:, 1:] * np.arange(1, table.shape[1])))


def _multipliers(x: FloatArray, weight: CamProfile, job: _Return) -> tuple[FloatArray, tuple[FloatArray, float], float]:
    """Solve the tangent's linear programme on a grid with the jerk constant on each interval.

    Returns
    -------
    (slope prices, (speed prices, price of the position at the end), constant of the dual function)
        Multipliers of ``q''`` and ``q'`` at the nodes, the end conditions among them.
    """
    from scipy.optimize import linprog
    from scipy.sparse import bmat, diags_array, eye_array

    n = len(x) - 1
    h = np.diff(x)
    node = 0.5 * (1 + np.polynomial.legendre.leggauss(3)[0])
    gauss = np.polynomial.legendre.leggauss(3)[1] / 2
    cost = (weight(x[:-1, None] + h[:, None] * node) @ gauss) * h
    ahead = eye_array(n, n + 1, k=1) - eye_array(n, n + 1)
    at = eye_array(n, n + 1)
    # unknowns: jerks (n), then q'', q', q at the nodes (n + 1 each); the jerk divided by its limit
    scale = job.jerk
    matrix = bmat(
        [
            [-diags_array(h * scale), ahead, None, None],
            [-diags_array(h**2 / 2 * scale), -diags_array(h) @ at, ahead, None],
            [-diags_array(h**3 / 6 * scale), -diags_array(h**2 / 2) @ at, -diags_array(h) @ at, ahead],
        ],
        format="csr",
    )
    bounds = np.full((4 * n + 3, 2), [-np.inf, np.inf])
    bounds[:n] = [-1.0, 1.0]
    slope, speed, place = n + np.arange(n + 1), 2 * n + 1 + np.arange(n + 1), 3 * n + 2 + np.arange(n + 1)
    bounds[slope] = [-job.slope, job.slope]
    bounds[speed] = [job.low, job.high]
    for index in (slope[0], slope[-1], speed[0], speed[-1], place[0]):
        bounds[index] = 0.0
    bounds[place[-1]] = 1.0
    objective = np.concatenate([cost * scale, np.zeros(3 * n + 3)])
    for wider in (
        0.0,
        1e-4,
        1e-2,
    ):  # a tight job may have no motion on the grid; wider limits change the multipliers little
        answer = linprog(
            objective,
            A_eq=matrix,
            b_eq=np.zeros(3 * n),
            bounds=bounds * (1 + wider * (bounds[:, :1] != bounds[:, 1:])),
            method="highs",
        )
        if answer.status == 0:
            break
    else:
        return np.zeros(n + 1), (np.zeros(n + 1), 0.0), 0.0  # a bound all the same: the trivial one
    lower = np.minimum(0.0, -answer.lower.marginals)  # signs forced, so that rounding cannot spoil the bound
    upper = np.minimum(0.0, answer.upper.marginals)
    price = upper - lower
    fixed = bounds[:, 0] == bounds[:, 1]
    price[fixed] = (answer.lower.marginals + answer.upper.marginals)[fixed]
    finite = np.isfinite(bounds[:, 0])
    constant = np.zeros(len(bounds))
    constant[finite] = np.where(
        fixed[finite],
        price[finite] * bounds[finite, 0],
        upper[finite] * bounds[finite, 1] - lower[finite] * bounds[finite, 0],
    )
    states = np.concatenate([slope, speed, place[-1:]])
    return price[slope], (price[speed], float(price[place[-1]])), float(constant[states].sum())


def _absolute_integral(first: FloatArray, centre: FloatArray, last: FloatArray, h: FloatArray) -> FloatArray:
    """Integral of the absolute value of quadratics given at both ends and the middle of intervals of length ``h``."""
    c = first
    b = -3 * first + 4 * centre - last
    a = 2 * first - 4 * centre + 2 * last
    square = b * b - 4 * a * c
    root = np.sqrt(np.maximum(square, 0.0))
    q = -0.5 * (b + np.where(b >= 0, root, -root))
    with np.errstate(divide="ignore", invalid="ignore"):
        one, two = q / a, c / q
    roots = np.stack(
        [np.where((square > 0) & (r > 0) & (r < 1), r, 0.0) for r in (np.nan_to_num(one), np.nan_to_num(two))]
    )
    edges = np.sort(np.concatenate([np.zeros((1, len(h))), roots, np.ones((1, len(h)))]), axis=0)
    primitive = edges * (c + edges * (b / 2 + edges * a / 3))
    return np.asarray(np.abs(np.diff(primitive, axis=0)).sum(axis=0) * h)
