"""How hard a line may speed up and brake on a cam: the greatest ramp at which the slave keeps its limits, whatever the phase.

While the line moves at ``v`` with acceleration ``a`` and jerk ``j`` the slave has, by the chain rule, the acceleration
``y'' v² + y' a`` and the jerk ``y''' v³ + 3 y'' v a + y' j``. Each limit bounds ``a`` at each master position by a quotient of polynomials,
so the least bound over the cycle is exact: it lies at an end of a piece or where the quotient's derivative, a polynomial over a
square, is zero.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from camwright.profiles.polynomial import rows
from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.profiles.polynomial.roots import roots_between
from camwright.profiles.task import Task
from camwright.validation.motion import is_smooth, is_steady
from camwright.validation.production.torque_ramp import torque_ramp

SHARES = tuple(k / 20 for k in range(1, 21))
"""Line speeds of a curve, as shares of the job's."""

NOTHING = 1e-6
"""Below this a ramp is none (m/s²): what a solver's margin leaves."""

SAMPLES = 8
"""Parts of each piece whose ends are looked at beside the places where a quotient turns."""


@dataclass(frozen=True)
class Allowed:
    """The greatest ramp that a limit allows in one direction of the line's acceleration.

    Parameters
    ----------
    value
        Magnitude of the line's acceleration (m/s²); 0 where none is allowed, infinite where nothing binds.
    binds
        ``"acceleration"``, ``"jerk"`` or ``"torque"``, the limit that binds; ``"none"`` where nothing does.
    at
        Master position where it binds (m); None where nothing does.
    """

    value: float
    binds: str
    at: float | None


WAYS = 1.0, -1.0
"""A line that speeds up, and one that brakes."""

FREE = Allowed(math.inf, "none", None)


Quotient = tuple[rows.Rows, rows.Rows, FloatArray, FloatArray]
"""Coefficients over and under on pieces, as in `camwright.profiles.polynomial.rows`, where the pieces begin and how long they are (m). The
lower one is positive or zero on each; where it is zero the quotient is infinite, of the upper one's sign."""


@dataclass(frozen=True)
class LineRamp:
    """How hard the line may ramp.

    Parameters
    ----------
    line_speed
        The line speed, or the highest of those that it is said for (m/s).
    speeding, braking
        Greatest acceleration and greatest deceleration of the line, at any phase.
    """

    line_speed: float
    speeding: Allowed
    braking: Allowed

    @property
    def ramp(self) -> Allowed:
        """What is allowed both ways, up and down: the lesser of both."""
        return min(self.speeding, self.braking, key=lambda each: each.value)


def line_ramp(profile: CamProfile, task: Task, *, speeds: Literal["at", "up_to"] = "up_to") -> LineRamp:
    """Greatest ramp of the line that keeps the slave's limits of acceleration and jerk, and the motor's torque, at any phase.

    The line's jerk is that of the task, 0 where it is not known. For each phase the bound is exact over the polynomial pieces; that of the
    torque is looked for (`camwright.validation.production.torque_ramp`).

    Parameters
    ----------
    profile
        One cycle over ``[0, x_c]`` (slave unit).
    task
        The machine, its sync zone placed, the cut with the line speed, the limits, and the line with its jerk.
    speeds
        ``"at"`` for ramps at the line speed of the cut, ``"up_to"`` for ramps between standstill and it.

    Examples
    --------
    >>> from camwright import load_job, optimise
    >>> job = load_job()
    >>> found = line_ramp(optimise(job).profile, job.task)
    >>> round(found.ramp.value, 6), found.ramp.binds       # the jerk limit is used up
    (0.0, 'jerk')
    """
    whole = speeds == "up_to"
    parts, v = _parts(profile), task.cut.line_speed
    # at a standstill only the ratio counts
    by_acceleration = _by_acceleration(parts, task.limits.acceleration, (v, 0.0) if whole else (v,))
    by_jerk = _by_jerk(parts, task, whole=whole)
    found = []
    for number, way in enumerate(WAYS):
        bounds = [*by_acceleration[number], by_jerk[number]]
        if task.limits.motor is not None and task.machine.moves_something:
            speeds_at = tuple(share * v for share in (0.0, *SHARES)) if whole else (v,)
            value, at = torque_ramp(parts.profile, task, way, speeds_at)
            bounds.append(FREE if math.isinf(value) else Allowed(value, "torque", at))
        if not is_steady(profile, task.machine):
            bounds = [Allowed(0.0, "acceleration", _worst_jump(profile, 1))]
        elif not is_smooth(profile):
            bounds.append(Allowed(0.0, "jerk", _worst_jump(profile, 2)))
        worst = min(bounds, key=lambda each: each.value)
        found.append(worst if worst.value > NOTHING else replace(worst, value=0.0))
    return LineRamp(v, *found)


def by_acceleration_alone(profile: CamProfile, task: Task) -> Allowed:
    """Greatest ramp up and down at the cut's line speed that the limit of acceleration alone allows.

    Examples
    --------
    >>> from camwright import load_job, optimise
    >>> job = load_job()
    >>> round(by_acceleration_alone(optimise(job).profile, job.task).value, 1)
    21.1
    """
    if not is_steady(profile, task.machine):
        return Allowed(0.0, "acceleration", _worst_jump(profile, 1))
    found = _by_acceleration(_parts(profile), task.limits.acceleration, (task.cut.line_speed,))
    return min((each for (each,) in found), key=lambda each: each.value)


def ramp_curve(profile: CamProfile, task: Task) -> tuple[LineRamp, ...]:
    """Greatest ramps at shares of the job's line speed, each at that speed alone."""
    return tuple(line_ramp(profile, task.at_speed(share * task.cut.line_speed), speeds="at") for share in SHARES)


def _worst_jump(profile: CamProfile, order: int) -> float:
    """Master position of the greatest jump of a derivative."""
    return float(profile.breaks[1:][int(np.abs(profile.jumps(order)).argmax())])


@dataclass(frozen=True, eq=False)
class _Pieces:
    """Pieces of a cycle on which neither ratio nor ratio slope changes sign: tables as in `camwright.profiles.polynomial.rows`.

    Parameters
    ----------
    profile
        The cycle, split so.
    start, width
        Where the pieces begin, and how long they are (m).
    ratio, bend, jerk
        Derivatives over the master, the first three.
    turn, sway
        Signs of ratio and ratio slope, shape ``(pieces, 1)``.
    """

    profile: CamProfile
    start: FloatArray
    width: FloatArray
    ratio: rows.Rows
    bend: rows.Rows
    jerk: rows.Rows
    turn: FloatArray
    sway: FloatArray


def _pieces(profile: CamProfile) -> _Pieces:
    """Tabulate a cycle that is split where its ratio or its ratio slope changes sign."""
    breaks, ratio = profile.breaks, rows.differentiated(profile.coefficients)
    bend, inside = rows.differentiated(ratio), _middles(profile) - breaks[:-1]
    turn, sway = (np.sign(rows.at_ends(table, inside))[:, None] for table in (ratio, bend))
    return _Pieces(profile, breaks[:-1], breaks[1:] - breaks[:-1], ratio, bend, rows.differentiated(bend), turn, sway)


def _middles(profile: CamProfile) -> FloatArray:
    """Middles of the pieces (m)."""
    return np.asarray(0.5 * (profile.breaks[:-1] + profile.breaks[1:]))


def _parts(profile: CamProfile) -> _Pieces:
    """Split a profile where its ratio or its ratio slope changes sign."""
    return _pieces(profile.split(rows.ascending(np.concatenate([profile.roots(1), profile.roots(2)]))))


def _by_acceleration(parts: _Pieces, limit: float, speeds: Sequence[float]) -> list[list[Allowed]]:
    """Bound ``(A - σ y'' v²) / |y'|``, with the direction ``σ`` in which the ramp pushes the slave, each way at each line speed."""
    under = parts.ratio * parts.turn
    quotients = []
    for way in WAYS:
        for speed in speeds:
            room = parts.bend * (-way * parts.turn * speed**2)
            room[:, 0] += limit
            quotients.append((room, under, parts.start, parts.width))
    found = [_allowed(value, "acceleration", at) for value, at in least_quotients(quotients)]
    return [found[: len(speeds)], found[len(speeds) :]]


def _allowed(value: float, binds: str, at: float) -> Allowed:
    """Say what a bound leaves: all, where nothing binds; or nothing."""
    if math.isfinite(value):
        return Allowed(max(0.0, value), binds, at)
    return FREE if value > 0 else Allowed(0.0, binds, at)


def _by_jerk(parts: _Pieces, task: Task, *, whole: bool) -> list[Allowed]:
    """Bound ``(J - |y'| j - σ y''' v³) / (3 |y''| v)`` each way, with the direction ``σ`` in which the ramp jerks the slave.

    Of the line speeds up to ``v`` the highest is the worst where ``σ y''' >= 0``. Elsewhere it is that with
    ``2 |y'''| v³ = J - |y'| j``, if it is lower: there the bound is the cube root of ``(J - |y'| j)² |y'''| / (4 |y''|³)``.
    """
    v = task.cut.line_speed
    if v == 0.0:
        return [FREE] * len(WAYS)
    left, bend = _jerk_left(parts, task), parts.bend * parts.sway
    highest, lower = [], []
    for way in WAYS:
        against = parts.jerk * (-way * parts.sway)
        highest.append((rows.added(left, against * v**3), bend * (3.0 * v), parts.start, parts.width))
        if whole:
            lower.append(_at_lower_speed(parts, task, way))
    found = least_quotients(highest)
    if whole:
        roots = [(math.copysign(abs(value) ** (1 / 3), value), at) for value, at in least_quotients(lower)]
        found = list(map(min, found, roots))
    return [_allowed(value, "jerk", at) for value, at in found]


def _at_lower_speed(parts: _Pieces, task: Task, way: float) -> Quotient:
    """Give the cube of the bound by the jerk at the worst line speed, on the pieces where that is a lower one."""
    left, against = _jerk_left(parts, task), parts.jerk * (-way * parts.sway)
    # positive where a lower line speed is the worst
    eased = CamProfile(parts.profile.breaks, rows.added(against * (2.0 * task.cut.line_speed**3), -left))
    split = parts.profile.split(eased.roots())
    if split is not parts.profile:
        parts = _pieces(split)
        left, against = _jerk_left(parts, task), parts.jerk * (-way * parts.sway)
    lower = eased(_middles(split)) > 0
    left, bend, against = left[lower], (parts.bend * parts.sway)[lower], against[lower]
    over = rows.multiplied(rows.multiplied(left, left), against)
    under = rows.multiplied(rows.multiplied(bend, bend), bend) * 4.0
    return over, under, parts.start[lower], parts.width[lower]


def _jerk_left(parts: _Pieces, task: Task) -> rows.Rows:
    """Give ``J - |y'| j``."""
    left = parts.ratio * (-parts.turn * task.line.known_jerk)
    left[:, 0] += task.limits.jerk
    return left


def least_quotients(quotients: Sequence[Quotient]) -> list[tuple[float, float]]:
    """Least value of each of some quotients of like degree, exactly, and its place; infinite where it is nowhere finite."""
    over, under, start, width = (np.concatenate(each) for each in zip(*quotients, strict=True))
    turning = rows.added(
        rows.multiplied(rows.differentiated(over), under), -rows.multiplied(over, rows.differentiated(under))
    )
    inner = roots_between(turning, np.zeros(len(width)), width)
    sampled = width[:, None] * np.linspace(0.0, 1.0, SAMPLES + 1)  # a double root may hide from the roots
    local = np.column_stack([inner, sampled])
    local = np.where(np.isnan(local), 0.0, local)
    piece = np.arange(len(width))[:, None]
    high, low = rows.values(over, piece, local), rows.values(under, piece, local)
    quotient = np.where(low > 0, high / np.where(low > 0, low, 1.0), np.where(high < 0, -np.inf, np.inf))
    found, first = [], 0
    for *_, own in quotients:
        places = range(first, first + len(own))
        first = places.stop
        if places:
            row, column = divmod(int(quotient[places.start : places.stop].argmin()), local.shape[1])
            row += places.start
            found.append((float(quotient[row, column]), float(start[row] + local[row, column])))
        else:
            found.append((math.inf, math.inf))
    return found
