"""Lower bounds of torque and energy over the path, where the inertia depends on the place: a value function that sees the time.

A slave that never turns goes from ``q_0`` to ``q_1`` with the kinetic energy ``E(q) = I u² / 2``; its torque is ``dE/dq``. With
``s = ∫ √(2/I) dq`` and ``z = E^(3/4)`` the integral of the squared torque over time is ``16/9 ∫ (dz/ds)² ds``: so what it costs to come by
a kinetic energy somewhere is a closed form, and all motions that cost less than a level stay in a *tube* about the straight line. In the
tube any function ``φ(s, z)`` and any ``λ`` with ``φ_s + λ (I/2) z^(-2/3) >= 9/64 φ_z²`` bound the integral of every motion that takes
the time ``T`` from below by ``φ(start) - φ(end) - λ T``. The best such spline is a cone programme. Where it breaks its inequality between
the points at which it was asked for, the bound is lowered by what that can cost at most. The lesser of level and bound holds for all
motions. Energy and peak have tubes and inequalities of their own.

Friction ``F`` takes ``F dq`` of what is drawn, and nothing while the slave stands: then ``φ_q - F φ_E`` stands for ``φ_q``. The bounds of
the squared torque and the peak are those without friction.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from camwright.profiles.polynomial.profile import FloatArray
from camwright.validation.bounds.path_spline import PathSpline, Tube
from camwright.validation.bounds.path_task import PathTask
from camwright.validation.bounds.path_weights import square_weights

ASKED = (60, 18)
"""Places along the path and across it at which the inequality of energy or peak is asked for."""
ASKED_SQUARE = (60, 24)
"""Those of the squared torque: a second round is seldom asked."""
LOOKED = (320, 90)
"""Places at which it is looked at afterwards."""
ROUNDS, MORE = 2, 300
"""How often the places where it is broken most are added, and how many of them."""
SMALL = 1e-3
"""What broken inequalities may cost, as a share of the bound."""
SMALL_SQUARE, MORE_COLUMNS = 1e-2, 20
"""The same of the squared torque; how many columns of places are added."""
LEVELS = 6
"""How many levels are tried for the greatest that is proved."""
GOOD, GAIN = 0.95, 5e-3
"""Share of the level beyond which another is tried only if the last raised what is proved by so much of it."""
HOPELESS, TOWARDS = 0.8, 0.6
"""Share of the level tried next where little was proved; how far between what is proved and what is not the others lie."""
ACCURACY = 1e-4
"""Accuracy of the linear programmes (scaled): what they leave broken is looked at afterwards."""
ENOUGH = {"square": 0.985, "drawn": 0.985, "peak": 0.0}
"""Share of a level that need not be made any better, nor parted any finer; a peak's is proved or not."""
MOST = 1.1
"""Multiple of the level that is asked for at most: where no motion at all is in a tube its spline would run away."""
REGULAR = 1e-9
"""Weight that keeps what no place asks for from running away."""

RESTS, RESTS_OUT = 4001, 12.0
"""Times of a rest that are looked at, and how far the logarithm of the ratio of its two parts goes on either side."""
BETWEEN_RESTS = 1e-3
"""Share by which a bound is lowered for rests between these times, each 0.6 % later than the one before."""


def _within_reach(task: PathTask, low: FloatArray, high: FloatArray) -> Tube:
    """Tube of the motions between two kinetic energies that keep to speed and acceleration."""
    least, greatest = task.reach
    return Tube(np.maximum(low, least), np.minimum(high, greatest))


def square_tube(task: PathTask, level: float) -> Tube:
    """Tube of the motions whose integral of the squared torque over time is below a level."""
    s = task.stretched
    ends = [energy**0.75 for energy in task.energies]
    whole = s[-1]
    line = ends[0] + (ends[1] - ends[0]) * s / whole
    spare = max(9.0 / 16.0 * level - (ends[1] - ends[0]) ** 2 / whole, 0.0)
    half = np.sqrt(spare * s * (whole - s) / whole)
    return _within_reach(task, np.maximum(line - half, 0.0) ** (4 / 3), (line + half) ** (4 / 3))


def standing_square(task: PathTask) -> float:
    """Least integral of the squared torque of a motion that stands somewhere; infinite where the acceleration forbids that."""
    s = task.stretched[1:-1][task.reach[0][1:-1] <= 0.0]
    if not len(s) or not task.may_rest:
        return math.inf
    first, last = (energy**1.5 for energy in task.energies)
    return 16.0 / 9.0 * float((first / s + last / (task.stretched[-1] - s)).min())


def turning_square(task: PathTask, inertia: FloatArray) -> float:
    """Least integral of the squared torque of a motion that turns, or stands beyond the ends of its path.

    Parameters
    ----------
    task
        The motion.
    inertia
        Least inertia of all places: where a motion may go beyond its path it may have this.
    """
    # it comes to rest from the first speed and sets out to the last, in no more room than its greatest speed covers
    least = float(np.min(inertia))
    room = task.greatest * task.time * math.sqrt(2.0 / least)
    first, last = (energy**1.5 for energy in task.energies)
    return max(float(16.0 / 9.0 * (first + last) / room), 2.0 * least * _softest_turn(task))


def turning_peak(task: PathTask, inertia: FloatArray) -> float:
    """Least peak of the torque of a motion that turns, or stands beyond the ends of its path; the inertia as in `turning_square`.

    The root of the kinetic energy changes by no more than the peak over ``√(2 I)`` a second, and the energy by no more than the peak
    over the way.
    """
    one, other = (math.sqrt(energy) for energy in task.energies)
    in_time = math.sqrt(2.0 * float(np.min(inertia))) * (one + other) / task.time
    return max(max(task.energies) / (task.greatest * task.time), in_time)


def _softest_turn(task: PathTask) -> float:
    """Least integral of the squared second derivative of ``σ = ∫ √(I/2) dq`` of a motion that comes to rest on its way (J/s).

    ``dσ/dt`` is the root of the kinetic energy and the torque is ``√(2 I) d²σ/dt²``, so the least inertia makes this a bound of the
    integral of the squared torque. From a speed ``v`` to rest over a way ``d`` in a time ``t`` it is at least
    ``4 v² / t - 12 v d / t² + 12 d² / t³``; before and after the rest together, the least is taken over the way before it, a
    quadratic, and over the time of the rest, on a grid that is even in the shares of both parts.
    """
    one, other = (math.sqrt(energy) for energy in task.energies)
    root = np.sqrt(task.inertia / 2.0)
    whole = float(np.trapezoid(root, dx=task.way / (len(root) - 1)))
    share = 1.0 / (1.0 + np.exp(-np.linspace(-RESTS_OUT, RESTS_OUT, RESTS)))
    t, left = share * task.time, (1.0 - share) * task.time
    d = (one / (2 * t**2) - other / (2 * left**2) + whole / left**3) / (1 / t**3 + 1 / left**3)
    before = 4 * one**2 / t - 12 * one * d / t**2 + 12 * d**2 / t**3
    rest = whole - d
    after = 4 * other**2 / left - 12 * other * rest / left**2 + 12 * rest**2 / left**3
    return float((before + after).min()) * (1.0 - BETWEEN_RESTS)


def drawn_tube(task: PathTask, level: float) -> Tube:
    """Tube of the motions that draw less energy than a level."""
    first, last = task.energies
    rubbed = task.friction * np.linspace(0.0, task.way, len(task.inertia))
    low = last - level + task.friction * task.way - rubbed
    return _within_reach(task, np.maximum(low, 0.0), np.maximum(first + level - rubbed, 0.0))


def peak_tube(task: PathTask, level: float) -> Tube:
    """Tube of the motions whose torque is nowhere above a level."""
    first, last = task.energies
    q = np.linspace(0.0, task.way, len(task.inertia))
    low = np.maximum(first - level * q, last - level * (task.way - q))
    high = np.minimum(first + level * q, last + level * (task.way - q))
    return _within_reach(task, np.maximum(low, 0.0), high)


def least_square(task: PathTask, level: float) -> float:
    """Lower bound of the integral of the squared torque over time of every motion: at most the level, (N·m)² s."""
    return _proved(task, square_tube, "square", level)


def least_drawn(task: PathTask, level: float) -> float:
    """Lower bound of the energy drawn by every motion: at most the level (J)."""
    return _proved(task, drawn_tube, "drawn", level)


def no_motion_below(task: PathTask, level: float) -> bool:
    """Tell whether it is proved that every motion has a torque above a level somewhere."""
    tube = peak_tube(task, level)
    return tube.empty or _bound(task, tube, "peak", level, 0.0) > 0.0


def _proved(task: PathTask, tube_of: Callable[[PathTask, float], Tube], kind: str, level: float) -> float:
    """Best bound of the lesser levels and the one given.

    The lower a level the narrower its tube, so the better its spline: a tube that holds motions that all but stand has time to waste in
    it for nothing. So the level is sought that is just proved.
    """
    best, tried, high = 0.0, level, level
    for _ in range(LEVELS):
        tube = tube_of(task, tried)
        found = tried if tube.empty else _bound(task, tube, kind, tried, max(best, HOPELESS * level))
        before, best = best, max(best, min(found, tried))
        if found < tried:
            high = tried
        if high - best < (1.0 - ENOUGH[kind]) * level or GOOD * level < best < before + GAIN * level:
            break
        tried = best + TOWARDS * (high - best) if best > 0.0 else HOPELESS * level
    return best


def _bound(task: PathTask, tube: Tube, kind: str, level: float, least: float) -> float:
    """Best bound of a spline in a tube, less what it is broken by; for a peak positive where the level is proved to be too low.

    What comes to less than ``least`` even if it were not broken is not made any better, nor what is near enough to the level.
    """
    spline = PathSpline(task, tube)
    far_x, far_energy = spline.places(*LOOKED)
    ends = spline.ends()
    if kind == "square":
        return _square_bound(spline, far_x, far_energy, level, least)
    x, energy = (part.ravel() for part in spline.places(*ASKED))
    value, unit = -math.inf, task.time if kind == "peak" else level
    for _ in range(ROUNDS):
        found = _best(spline, x, energy, kind, level)
        if found is None:
            break
        broken = _broken(spline, far_x, far_energy, found, kind, level)
        cost = _cost(spline, far_x, broken)
        value = max(value, float(ends @ found) - cost)
        if cost <= SMALL * unit or value + cost < least or value >= ENOUGH[kind] * level:
            break
        worst = np.argsort(broken, axis=None)[-MORE:]
        x, energy = np.append(x, far_x.ravel()[worst]), np.append(energy, far_energy.ravel()[worst])
    return value


def _square_bound(spline: PathSpline, far_x: FloatArray, far_energy: FloatArray, level: float, least: float) -> float:
    """Bound of the squared torque, as `_bound`: its places lie in columns, and so do those that are added where it is broken most."""
    ends, value = spline.ends(), -math.inf
    places, energy = spline.places(*ASKED_SQUARE)
    x = places[0]
    for _ in range(ROUNDS):
        weights = square_weights(spline, x, energy, level)
        broken = _broken(spline, far_x, far_energy, weights, "square", level)
        cost = _cost(spline, far_x, broken)
        value = max(value, float(ends @ weights) - cost)
        if cost <= SMALL_SQUARE * level or value + cost < least or value >= ENOUGH["square"] * level:
            break
        worst = np.argsort(broken.max(axis=0))[-MORE_COLUMNS:]
        highest = np.argsort(broken[:, worst], axis=0)[-ASKED_SQUARE[1] :]
        x = np.append(x, far_x[0, worst])
        energy = np.column_stack([energy, np.take_along_axis(far_energy[:, worst], highest, axis=0)])
    return value


def _cost(spline: PathSpline, x: FloatArray, broken: FloatArray) -> float:
    """Most that a broken inequality can cost: a motion passes each place once, at the worst energy at most."""
    return float(np.trapezoid(np.maximum(broken.max(axis=0), 0.0), x[0])) * spline.whole


def _broken(
    spline: PathSpline, x: FloatArray, energy: FloatArray, weights: FloatArray, kind: str, level: float
) -> FloatArray:
    """By how much the inequality is broken at places, per stretched length."""
    linear, slope = spline.values(x, energy, weights)
    if kind == "square":  # φ_z² 9/64 with φ_z = φ_E 4/3 z^(1/3)
        return np.asarray(0.25 * slope**2 * np.sqrt(energy) - linear)
    if kind == "peak":
        return np.asarray(level * np.sqrt(spline.inertia(x[0]) / 2) * np.abs(slope) - linear)
    return -linear


def _best(spline: PathSpline, x: FloatArray, energy: FloatArray, kind: str, level: float) -> FloatArray | None:
    """Solve the linear programme of energy or peak on given places; None where the solver does not end."""
    import clarabel
    from scipy.sparse import csc_array, csr_array, eye_array, vstack

    count, size = len(x), spline.size
    # the spline in units of the level, over time where the level is a torque
    unit = np.full(size, level)
    unit[-1] = level / spline.ends()[-1] * -1.0
    per_place = level / spline.whole
    columns, linear, slope = spline.rows(x, energy)
    linear, slope = (factors * unit[columns] / per_place for factors in (linear, slope))
    goal = -(spline.ends() * unit) / level

    def rows(*each: FloatArray) -> Any:
        """Rows of the programme, so many for each place."""
        of, starts = np.repeat(columns, len(each), axis=0), np.arange(len(each) * count + 1) * columns.shape[1]
        return csr_array((np.stack(each, axis=1).ravel(), of.ravel(), starts), shape=(len(each) * count, size))

    if kind == "drawn":
        rises, least = spline.rises()
        rises, most = rises * unit / level, -least / level
        blocks = [rows(-linear), csr_array(rises), csr_array(-rises)]
        right = np.concatenate([np.zeros(count + len(most)), most])
        cones = [clarabel.NonnegativeConeT(len(right))]
    else:
        push = level * np.sqrt(spline.inertia(x) / 2)[:, None] * slope
        blocks = [rows(push - linear, -push - linear), eye_array(size), -eye_array(size)]
        right = np.concatenate([np.zeros(2 * count), np.ones(2 * size)])
        cones = [clarabel.NonnegativeConeT(2 * count + 2 * size)]
    if kind != "peak":
        blocks.append(csr_array(-goal[None, :]))
        right = np.append(right, MOST)
        cones = [*cones, clarabel.NonnegativeConeT(1)]
    if spline.stands:
        blocks.append(csr_array(([-1.0], ([0], [size - 1])), shape=(1, size)))
        right = np.append(right, 0.0)
        cones = [*cones, clarabel.NonnegativeConeT(1)]
    settings = clarabel.DefaultSettings()
    settings.verbose = settings.presolve_enable = settings.iterative_refinement_enable = False
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = ACCURACY
    regular, matrix = csc_array(REGULAR * eye_array(size)), csc_array(vstack(blocks))
    matrix.eliminate_zeros()
    answer = clarabel.DefaultSolver(regular, goal, matrix, right, cones, settings).solve()
    weights = np.asarray(answer.x) * unit
    return weights if np.isfinite(weights).all() else None
