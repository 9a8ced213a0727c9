"""The sync zone where its place is unknown, in symbols: what the return must join, and what the zone itself asks of the motor."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from camwright.design.torque.task import TorqueTask
from camwright.profiles.polynomial.profile import FloatArray


def available_torque(task: TorqueTask, velocity: Any, count: int) -> Any:
    """Give the torque of the motor at a number of the slave's velocities, seen at the slave, in scalar symbols (`casadi.SX`)."""
    if task.curve is None:
        return ca.DM.inf(count)
    speeds, torques = (ca.DM(list(column)) for column in zip(*task.curve.points, strict=True))
    motor = ca.vertsplit(ca.fabs(velocity) * task.machine.motor_ratio)
    return ca.vertcat(*[ca.pw_lin(each, speeds, torques) for each in motor]) * task.machine.motor_ratio


@dataclass(frozen=True, eq=False)
class Joined:
    """What a sync zone between two slave coordinates means to a programme, scaled as there.

    Parameters
    ----------
    closure
        Zero where the tool travels the sync zone between the two.
    states
        Acceleration and velocity at the start of the return, and at its end.
    travel
        Travel of the return.
    torque, power, available
        Of the zone at its points, at the slave; the last is what the motor gives there.
    weights
        Of these points in a mean over time, the return counting as 1.
    shares
        Shares of the limits of speed, acceleration and jerk that the zone uses at its points.
    accelerations, jerks
        Of the zone at its points.
    """

    closure: Any
    states: tuple[Any, Any, Any, Any]
    travel: Any
    torque: Any
    power: Any
    available: Any
    weights: Any
    shares: Any
    accelerations: Any
    jerks: Any


@dataclass(frozen=True, eq=False)
class Zone:
    """A sync zone to be placed.

    Parameters
    ----------
    range
        Least and greatest slave coordinates of the zone's start and end, a pair of arrays (slave unit).
    points
        Gauss-Legendre points at which the zone is looked at, besides its ends.
    """

    range: tuple[FloatArray, FloatArray]
    points: int = 12

    def join(self, start: Any, end: Any, task: TorqueTask) -> Joined:
        """Say what a zone between two slave coordinates means to a task's programme."""
        machine, cut, limits, v = task.machine, task.cut, task.task.limits, task.cut.line_speed
        length, scale = task.problem.length, task.scale
        one, other, angle = (ca.SX.sym(name) for name in ("s", "e", "y"))
        ratio = cut.sync_ratio / machine.tool_ratio(angle)
        slope = ca.gradient(ratio, angle) * ratio
        moves = ca.Function("moves", [angle], [ratio, slope, ca.gradient(slope, angle) * ratio])
        node, weight = np.polynomial.legendre.leggauss(self.points)
        # the points of the zone, then its two ends
        y = ca.vertcat(one + (other - one) * ca.DM(0.5 + 0.5 * node), one, other)
        ratios, slopes, bends = (ca.vec(part) for part in moves.map(self.points + 2)(y.T))
        velocity, acceleration, jerk = v * ratios, v**2 * slopes, v**3 * bends
        torque = machine.inertia(y) * acceleration + machine.inertia_slope(y) * velocity**2 / 2
        used = acceleration / limits.acceleration, jerk / limits.jerk
        shares = ca.vertcat(velocity / limits.speed, used[0], -used[0], used[1], -used[1])
        weights = ca.vertcat(ca.DM(0.5 * weight) * (other - one) / velocity[: self.points] / task.duration, 0, 0)
        unit = length / scale
        meet, leave = self.points, self.points + 1
        parts = ca.Function(
            "zone",
            [one, other],
            [
                (machine.tool(other) - machine.tool(one)) / (cut.sync_ratio * cut.sync_zone) - 1.0,
                slopes[leave] * length * unit,
                ratios[leave] * unit,
                slopes[meet] * length * unit,
                ratios[meet] * unit,
                (machine.pitch - (other - one)) / scale,
                torque,
                torque * velocity,
                available_torque(task, velocity, self.points + 2),
                weights,
                shares,
                slopes * length * unit,
                bends * length**2 * unit,
            ],
        )(start, end)
        return Joined(parts[0], (parts[1], parts[2], parts[3], parts[4]), *parts[5:])
