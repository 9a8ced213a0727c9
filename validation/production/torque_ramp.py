"""How hard a line may ramp before the motor's torque is used up: looked for on each piece, since curve and inertia are no polynomials."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from camwright.profiles.motor import MotorCurve
from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.profiles.task import Task

PLACES = 24
"""Places on each piece that are looked at, beside its ends."""

NARROWINGS = 60
"""How often the neighbourhood of the worst place is narrowed by the golden section: to rounding."""

_GOLDEN = 0.5 * (5**0.5 - 1.0)
_STANDING = 1e-9
"""Ratio, relative to the cycle's greatest, below which the slave stands still: friction then asks for no torque."""


def torque_ramp(parts: CamProfile, task: Task, way: float, speeds: Sequence[float]) -> tuple[float, float]:
    """Greatest acceleration of the line, in one direction, that the motor's torque-speed curve allows at some line speeds.

    The torque at the slave is ``I(y) (y'' v² + y' a) + I'(y) y'² v² / 2 + F sign(y')``, linear in ``a``.

    Parameters
    ----------
    parts
        One cycle, split where its ratio changes sign.
    task
        The machine and its motor's curve.
    way
        1 for a line that speeds up, -1 for one that brakes.
    speeds
        Line speeds (m/s).

    Returns
    -------
    (value, at)
        Magnitude of the line's acceleration (m/s²), 0 where none is allowed, infinite where the motor does not bind; and the master
        position where it binds (m).
    """
    curve = task.limits.motor
    assert curve is not None  # noqa: S101 - that is what this function is for
    width = np.diff(parts.breaks)
    local = width[:, None] * np.linspace(0.0, 1.0, PLACES + 2)
    piece = np.broadcast_to(np.arange(len(width))[:, None], local.shape)
    fastest = parts.peak(1)

    def bound(piece: NDArray[np.intp], local: FloatArray, speed: float) -> FloatArray:
        return _bound(parts, task, curve, way, speed, piece, local, _STANDING * fastest)

    best = np.inf, parts.start
    for speed in speeds:
        values = bound(piece, local, speed)
        row, column = divmod(int(values.argmin()), PLACES + 2)
        low, high = local[row, max(column - 1, 0)], local[row, min(column + 1, PLACES + 1)]
        one = np.array([row])
        for _ in range(NARROWINGS):
            left, right = high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)
            if bound(one, np.array([left]), speed) <= bound(one, np.array([right]), speed):
                high = right
            else:
                low = left
        refined = float(bound(one, np.array([0.5 * (low + high)]), speed)[0])
        found = min((float(values.min()), float(local[row, column])), (refined, float(0.5 * (low + high))))
        best = min(best, (found[0], float(parts.breaks[row]) + found[1]))
    return max(0.0, best[0]), best[1]


def _bound(
    parts: CamProfile,
    task: Task,
    curve: MotorCurve,
    way: float,
    speed: float,
    piece: NDArray[np.intp],
    local: FloatArray,
    standing: float,
) -> FloatArray:
    """Bound of the line's acceleration at places, infinite where the slave stands."""
    machine = task.machine
    place = task.slave_zero(parts) + parts.on_pieces(piece, local)
    ratio, bend = parts.on_pieces(piece, local, 1), parts.on_pieces(piece, local, 2)
    turn = np.where(np.abs(ratio) <= standing, 0.0, np.sign(ratio))
    inertia = machine.inertia(place)
    steady = speed**2 * (inertia * bend + 0.5 * machine.inertia_slope(place) * ratio**2) + machine.friction * turn
    gives = curve.torque(ratio * speed * machine.motor_ratio) * machine.motor_ratio
    lever = inertia * np.abs(ratio)
    free = gives - way * turn * steady
    return np.asarray(np.where(lever > 0, free / np.where(lever > 0, lever, 1.0), np.inf))
