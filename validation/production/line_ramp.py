"""How hard a line may speed up and brake on a cam: the greatest ramp at which the slave keeps its limits, whatever the phase.

While the line moves at ``v`` with acceleration ``a`` and jerk ``j`` the slave has, by the chain rule, the acceleration
``y'' v² + y' a`` and the jerk ``y''' v³ + 3 y'' v a + y' j``. Each limit bounds ``a`` at each master position by a quotient of polynomials,
so the least bound over the cycle is exact: it lies at an end of a piece or where the quotient's derivative, a polynomial over a
square, is zero.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from camwright.profiles.polynomial.profile import CamProfile, FloatArray, steps
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


FREE = Allowed(math.inf, "none", None)


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
    parts = _parts(profile)
    found = []
    for way in (1.0, -1.0):
        bounds = [_by_acceleration(parts, task, way)]
        if whole:  # at a standstill only the ratio counts
            bounds.append(_by_acceleration(parts, task.at_speed(0.0), way))
        bounds.append(_by_jerk(parts, task, way, whole=whole))
        if task.limits.motor is not None and task.machine.moves_something:
            speeds_at = (
                tuple(share * task.cut.line_speed for share in (0.0, *SHARES)) if whole else (task.cut.line_speed,)
            )
            value, at = torque_ramp(parts, task, way, speeds_at)
            bounds.append(FREE if math.isinf(value) else Allowed(value, "torque", at))
        if not is_steady(profile, task.machine):
            bounds = [Allowed(0.0, "acceleration", _worst_jump(profile, 1))]
        elif not is_smooth(profile):
            bounds.append(Allowed(0.0, "jerk", _worst_jump(profile, 2)))
        worst = min(bounds, key=lambda each: each.value)
        found.append(worst if worst.value > NOTHING else replace(worst, value=0.0))
    return LineRamp(task.cut.line_speed, *found)


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
    parts = _parts(profile)
    return min((_by_acceleration(parts, task, way) for way in (1.0, -1.0)), key=lambda each: each.value)


def ramp_curve(profile: CamProfile, task: Task) -> tuple[LineRamp, ...]:
    """Greatest ramps at shares of the job's line speed, each at that speed alone."""
    return tuple(line_ramp(profile, task.at_speed(share * task.cut.line_speed), speeds="at") for share in SHARES)


def _worst_jump(profile: CamProfile, order: int) -> float:
    """Master position of the greatest jump of a derivative."""
    return float(profile.breaks[1:][int(np.abs(profile.jumps(order)).argmax())])


def _parts(profile: CamProfile) -> CamProfile:
    """Split a profile where its ratio or its ratio slope changes sign."""
    return profile.split(np.union1d(profile.roots(1), profile.roots(2)))


def _signs(parts: CamProfile, order: int) -> FloatArray:
    """Sign of a derivative on each piece, on which it does not change; shape ``(pieces,)``."""
    return np.asarray(np.sign(parts(0.5 * (parts.breaks[:-1] + parts.breaks[1:]), order)))


def _times(parts: CamProfile, order: int, levels: FloatArray) -> CamProfile:
    """Multiply a derivative by a constant on each piece."""
    return parts.derivative(order).times(steps(parts.breaks, levels))


def _by_acceleration(parts: CamProfile, task: Task, way: float) -> Allowed:
    """Bound ``(A - σ y'' v²) / |y'|``, with the direction ``σ`` in which the ramp pushes the slave."""
    v, push = task.cut.line_speed, way * _signs(parts, 1)
    room = _times(parts, 2, -push * v**2).plus(steps(parts.breaks, np.full(parts.pieces, task.limits.acceleration)))
    value, at = least_quotient(room, _times(parts, 1, way * push))
    return Allowed(max(0.0, value), "acceleration", at) if math.isfinite(value) else _nothing(value, "acceleration", at)


def _nothing(value: float, binds: str, at: float) -> Allowed:
    """Say that nothing binds, or that nothing is allowed."""
    return FREE if value > 0 else Allowed(0.0, binds, at)


def _by_jerk(parts: CamProfile, task: Task, way: float, *, whole: bool) -> Allowed:
    """Bound ``(J - |y'| j - σ y''' v³) / (3 |y''| v)``, with the direction ``σ`` in which the ramp jerks the slave.

    Of the line speeds up to ``v`` the highest is the worst where ``σ y''' >= 0``. Elsewhere it is that with
    ``2 |y'''| v³ = J - |y'| j``, if it is lower: there the bound is the cube root of ``(J - |y'| j)² |y'''| / (4 |y''|³)``.
    """
    if task.cut.line_speed == 0.0:
        return FREE
    left, bend, against, room, eased = _jerk_terms(parts, task, way)
    value, at = least_quotient(room, bend.scale(slave=3.0 * task.cut.line_speed))
    if whole:
        left, bend, against, room, eased = _jerk_terms(parts.split(eased.roots()), task, way)
        relevant = eased(0.5 * (eased.breaks[:-1] + eased.breaks[1:])) > 0
        cube = bend.times(bend).times(bend).scale(slave=4.0)
        lower, place = least_quotient(left.times(left).times(against), cube, relevant)
        value, at = min((value, at), (math.copysign(abs(lower) ** (1 / 3), lower), place))
    return Allowed(max(0.0, value), "jerk", at) if math.isfinite(value) else _nothing(value, "jerk", at)


def _jerk_terms(
    parts: CamProfile, task: Task, way: float
) -> tuple[CamProfile, CamProfile, CamProfile, CamProfile, CamProfile]:
    """Give what the bounds by the jerk are made of.

    Returns
    -------
    (left, bend, against, room, eased)
        ``J - |y'| j``, ``|y''|``, ``-σ y'''``, ``J - |y'| j - σ y''' v³``, and what is positive where a lower line speed is the worst.
    """
    v = task.cut.line_speed
    push = way * _signs(parts, 2)
    limit = steps(parts.breaks, np.full(parts.pieces, task.limits.jerk))
    left = _times(parts, 1, -_signs(parts, 1) * task.line.known_jerk).plus(limit)
    against = _times(parts, 3, -push)
    room = left.plus(against.scale(slave=v**3))
    eased = against.scale(slave=2.0 * v**3).plus(left.scale(slave=-1.0))
    return left, _times(parts, 2, way * push), against, room, eased


def least_quotient(over: CamProfile, under: CamProfile, wanted: NDArray[np.bool_] | None = None) -> tuple[float, float]:
    """Least quotient of two polynomials on each of the same pieces, exactly, the lower one positive or zero on each.

    Parameters
    ----------
    over, under
        Numerator and denominator. Where the denominator is zero the quotient is infinite, of the numerator's sign.
    wanted
        Pieces to look at; all if not given.

    Returns
    -------
    (value, at)
        The least quotient and its place; infinite where no piece is wanted or the denominator is zero everywhere.
    """
    turning = over.derivative().times(under).plus(over.times(under.derivative()).scale(slave=-1.0))
    width = np.diff(over.breaks)
    inner = roots_between(turning.coefficients, np.zeros(len(width)), width)
    sampled = width[:, None] * np.linspace(0.0, 1.0, SAMPLES + 1)  # a double root may hide from the roots
    local = np.column_stack([inner, sampled])
    local = np.where(np.isnan(local), 0.0, local)
    piece = np.arange(len(width))[:, None]
    high, low = over.on_pieces(piece, local), under.on_pieces(piece, local)
    quotient = np.where(low > 0, high / np.where(low > 0, low, 1.0), np.where(high < 0, -np.inf, np.inf))
    if wanted is not None:
        quotient[~wanted] = np.inf
    worst = int(quotient.argmin())
    return float(quotient.flat[worst]), float(over.breaks[worst // local.shape[1]] + local.flat[worst])
