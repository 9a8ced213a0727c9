"""The sync zone where its place is unknown, in symbols: what the return must join, and what the zone itself asks of the motor."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import casadi as ca
import numpy as np

from camwright.design.torque.numbers import TorqueForm
from camwright.profiles.polynomial.profile import FloatArray


def available_torque(form: TorqueForm, velocity: Any) -> Any:
    """Give the torque of the motor at a velocity of the slave, seen at the slave, in a scalar symbol (`casadi.SX`)."""
    if form.curve is None:
        return ca.SX.inf()
    speeds, torques = (ca.DM(list(column)) for column in zip(*form.curve.points, strict=True))
    return ca.pw_lin(ca.fabs(velocity) * form.machine.motor_ratio, speeds, torques) * form.machine.motor_ratio


@dataclass(frozen=True, eq=False)
class ZonePoint:
    """What a sync zone asks at one of its points.

    Parameters
    ----------
    velocity, torque, available
        Of the slave, at the slave; the last is what the motor gives there.
    weight
        Of the point in a mean over time, the return counting as 1, per weight of the point in a mean over the slave's way.
    shares
        Shares of the limits of speed, acceleration and jerk that the zone uses.
    acceleration, jerk
        Of the zone, scaled as in the programme.
    """

    velocity: Any
    torque: Any
    available: Any
    weight: Any
    shares: Any
    acceleration: Any
    jerk: Any


@dataclass(frozen=True)
class Zone:
    """A sync zone to be placed.

    Parameters
    ----------
    range
        Least slave coordinates of the zone's start and end, and the greatest (slave unit).
    points
        Gauss-Legendre points at which the zone is looked at, besides its ends.
    """

    range: tuple[tuple[float, float], tuple[float, float]]
    points: int = 12


@lru_cache(maxsize=4)
def zone_looks(points: int) -> tuple[FloatArray, FloatArray]:
    """Points of a zone as shares of the slave's way through it, its ends last, and their weights."""
    node, weight = np.polynomial.legendre.leggauss(points)
    return np.append(0.5 + 0.5 * node, [0.0, 1.0]), np.append(0.5 * weight, [0.0, 0.0])


def zone_point(start: Any, end: Any, share: Any, form: TorqueForm) -> ZonePoint:
    """Say what a zone between two slave coordinates asks at a share of the slave's way through it."""
    machine, numbers = form.machine, form.numbers
    v, unit = numbers.line_speed, numbers.length / numbers.scale
    y = start + (end - start) * share
    ratio, slope, bend = _moves(y, form)
    velocity, acceleration, jerk = v * ratio, v**2 * slope, v**3 * bend
    used = acceleration * numbers.of_acceleration, jerk * numbers.of_jerk
    return ZonePoint(
        velocity,
        machine.inertia(y) * acceleration + machine.inertia_slope(y) * velocity**2 / 2,
        available_torque(form, velocity),
        (end - start) / velocity / numbers.duration,
        ca.vertcat(velocity * numbers.of_speed, used[0], -used[0], used[1], -used[1]),
        slope * numbers.length * unit,
        bend * numbers.length**2 * unit,
    )


def zone_met(start: Any, end: Any, form: TorqueForm) -> tuple[Any, Any]:
    """Say what a zone between two slave coordinates means to the return.

    That is what is zero where the tool travels the sync zone between the two, and acceleration, velocity and position at the return's
    start and its end.
    """
    machine, numbers = form.machine, form.numbers
    unit = numbers.length / numbers.scale
    closure = (machine.tool(end) - machine.tool(start)) / numbers.travel - 1.0
    states = []
    for y, place in ((end, 0.0), (start, (machine.pitch - (end - start)) / numbers.scale)):
        ratio, slope, _ = _moves(y, form)
        states.append(ca.vertcat(slope * numbers.length * unit, ratio * unit, place))
    return closure, states


def _moves(y: Any, form: TorqueForm) -> tuple[Any, Any, Any]:
    """Ratio of the slave in sync at a slave coordinate, and its first two derivatives over the master."""
    angle, sync_ratio = ca.SX.sym("y"), form.numbers.sync_ratio
    ratio = sync_ratio / form.machine.tool_ratio(angle)
    slope = ca.gradient(ratio, angle) * ratio
    moves = ca.Function("moves", [angle, sync_ratio], [ratio, slope, ca.gradient(slope, angle) * ratio])
    return tuple(moves(y, sync_ratio))
