"""Torque and energy of a servo-aware command: a cost that is not convex, over the linear rows that keep its axis in sync."""

from __future__ import annotations

import math
from typing import Any

import casadi as ca
import numpy as np

from camwright.design.returns.ipopt import QUIET
from camwright.design.servo_aware.command_basis import CommandBasis
from camwright.design.servo_aware.convex import Rows, sparse
from camwright.design.torque.layout import LOBATTO
from camwright.profiles.errors import SolverError
from camwright.profiles.objective import MotorObjective
from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.profiles.task import Task

# A slave that turns back has its friction smoothed over this share of the line speed.
SMOOTH = 0.01
# A force below this share of inertia times line speed squared over the cut length is rounding.
STANDING = 1e-6
# A peak, and the energy, also pay this share of the mean square, so that of all motions with that peak the smoothest is taken.
ROUNDING = 1e-4
_OPTIONS: dict[str, Any] = QUIET | {
    "ipopt.tol": 1e-8,
    "ipopt.constr_viol_tol": 1e-8,
    "ipopt.bound_relax_factor": 0.0,
    "ipopt.max_iter": 500,
}
_PLACES, _WEIGHTS = LOBATTO


class AxisTorque:
    """Torque and power of the commands of a basis at the Gauss-Lobatto points of its intervals.

    Parameters
    ----------
    task
        The machine, its sync zone placed, and its cut.
    basis
        The commands; their slave zero is the machine at the end of its sync zone.
    scale
        Slave travel that is 1 in the unknowns.
    """

    def __init__(self, task: Task, basis: CommandBasis, scale: float) -> None:
        self._machine, self._cut, self._scale = task.machine, task.cut, scale
        self._start = task.slave_at_sync_end
        self._derivatives = _at_points(basis)
        widths = np.diff(basis.nodes)
        self._shares = (widths[:, None] * _WEIGHTS).ravel() / widths.sum()

    def value(self, unknowns: FloatArray, cost: MotorObjective) -> float:
        """Objective of a command (N or N·m, or W)."""
        motion = [(matrix @ unknowns) * self._scale + known for matrix, known in self._derivatives]
        return self._value(motion, self._shares, cost)

    def value_of(self, back: CamProfile, cost: MotorObjective) -> float:
        """Objective of a return that counts from the end of the sync zone."""
        widths = np.diff(back.breaks)
        x = (back.breaks[:-1, None] + widths[:, None] * _PLACES).ravel()
        shares = (widths[:, None] * _WEIGHTS).ravel() / back.length
        return self._value([back(x), back(x, 1), back(x, 2)], shares, cost)

    def _value(self, motion: list[FloatArray], shares: FloatArray, cost: MotorObjective) -> float:
        force, power = (np.asarray(part, dtype=np.float64).ravel() for part in self._force(*motion))
        if cost == "rms_torque":
            return math.sqrt(float(shares @ force**2))
        return float(np.abs(force).max()) if cost == "peak_torque" else float(shares @ np.maximum(power, 0.0))

    def _force(self, y: Any, ratio: Any, slope: Any) -> tuple[Any, Any]:
        """Torque or force at the slave, and its power, where the slave is at ``y`` from the end of its sync zone; numbers or symbols."""
        machine, v = self._machine, self._cut.line_speed
        place, velocity = self._start + y, v * ratio
        force = machine.inertia(place) * (v * v * slope) + machine.inertia_slope(place) * velocity**2 / 2
        force = force + machine.friction * (np.tanh(velocity / (SMOOTH * v)) if machine.turns_back else 1.0)
        return force, force * velocity

    def minimise(self, cost: MotorObjective, rows: Rows, start: FloatArray) -> FloatArray:
        """Find a command of least torque or energy that keeps rows, near a start.

        Parameters
        ----------
        cost
            What is minimised.
        rows
            What is to be kept.
        start
            Unknowns of a command that keeps them, about.

        Returns
        -------
        ndarray
            The unknowns of a local optimum.

        Raises
        ------
        SolverError
            IPOPT ended without an answer.
        """
        count, points = len(start), len(self._shares)
        z, peak, drawn = ca.SX.sym("z", count), ca.SX.sym("t"), ca.SX.sym("d", points if cost == "energy" else 0)
        terms = [ca.SX.sym(name, points) for name in ("y", "r", "s")]
        measure = ca.Function("measure", terms, list(self._force(*terms)))
        force, power = measure(
            *(ca.mtimes(sparse(matrix * self._scale), z) + ca.DM(known) for matrix, known in self._derivatives)
        )
        begun = self.value(start, "rms_torque")
        inertia = float(np.max(self._machine.inertia(self._start + self._derivatives[0][1])))
        if begun <= STANDING * inertia * self._cut.line_speed**2 / self._cut.length:
            return start  # even speed will do, and nothing drives it
        unit = max(self.value(start, cost), 1e-300)
        mean_square = ca.dot(ca.DM(self._shares), (force / begun) ** 2)
        above: list[Any] = []
        match cost:
            case "rms_torque":
                least = mean_square
            case "peak_torque":
                above = [peak - force / unit, peak + force / unit]
                least = peak + ROUNDING * mean_square
            case "energy":
                above = [drawn - power / unit]  # what is drawn is the power or, as its bound says, nothing
                least = ca.dot(ca.DM(self._shares), drawn) + ROUNDING * mean_square
        beside = sum(part.numel() for part in above)
        programme = {
            "x": ca.vertcat(z, peak, drawn),
            "f": least,
            "g": ca.densify(ca.vertcat(ca.mtimes(sparse(rows.matrix), z), *above)),
        }
        status = ""
        for strategy in ("adaptive", "monotone"):  # the former is quicker, the latter ends where that one stumbles
            solver = ca.nlpsol("camwright_axis_torque", "ipopt", programme, _OPTIONS | {"ipopt.mu_strategy": strategy})
            answer = solver(
                x0=np.concatenate([start, [1.5], np.full(drawn.numel(), 1.5)]),
                lbx=np.concatenate([np.full(count, -np.inf), np.zeros(1 + drawn.numel())]),
                lbg=np.concatenate([rows.low, np.zeros(beside)]),
                ubg=np.concatenate([rows.high, np.full(beside, np.inf)]),
            )
            found: FloatArray = np.asarray(answer["x"], dtype=np.float64).ravel()[:count]
            status = str(solver.stats()["return_status"])
            if solver.stats()["success"] and rows.missed(found) <= 0.0:
                return found
        raise SolverError(
            f"IPOPT ended a servo-aware design of least {cost} with {status!r}; minimise rms_acceleration instead"
        )


def _at_points(basis: CommandBasis) -> tuple[tuple[FloatArray, FloatArray], ...]:
    """Slave, ratio and ratio slope of a command at the Gauss-Lobatto points of its intervals, each as ``(matrix, constant)``."""
    widths = np.diff(basis.nodes)
    s = (widths[:, None] * _PLACES).ravel()
    interval = np.repeat(np.arange(len(widths)), len(_PLACES))
    one, none = np.ones_like(s), np.zeros_like(s)
    found = []
    for powers in ([one, s, s**2, s**3], [none, one, 2 * s, 3 * s**2], [none, none, 2 * one, 6 * s]):
        weights = np.einsum("pi,ipc->ic", np.array(powers), basis.pieces[interval])
        table = np.zeros((len(s), len(basis.constant)))
        for spline in range(4):
            table[np.arange(len(s)), interval + spline] = weights[:, spline]
        found.append((table @ basis.matrix, table @ basis.constant))
    return tuple(found)
