"""`AxisProblem`: a servo-aware design in numbers, and what follows from them once."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from camwright.design.servo_aware.axis_response import Axis
from camwright.design.servo_aware.command_basis import Command, CommandBasis, command_basis
from camwright.design.servo_aware.torque import AxisTorque
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.servo import Servo
from camwright.profiles.task import Task


@dataclass(frozen=True, eq=False)
class AxisProblem:
    """A servo-aware design in numbers.

    Parameters
    ----------
    task
        The machine, its sync zone placed, the cut, whose sync tolerance is the band of the axis, and the limits of the command.
    command
        What may be chosen: the return alone, or the whole cycle.
    servos
        Servos that must keep to the band, the nominal one first.
    axis_limits
        Whether the nominal axis, too, must keep the limits of speed, acceleration and reversal.
    structure
        A return whose breaks the command may share.
    between
        Servos between the corners of the ranges, whose error must not be much larger than that of the others.
    wider
        Factor by which the band of these servos is wider than that of the others.
    """

    task: Task
    command: Command
    servos: tuple[Servo, ...]
    axis_limits: bool
    structure: CamProfile | None = None
    between: tuple[Servo, ...] = ()
    wider: float = 1.0

    @cached_property
    def axes(self) -> tuple[Axis, ...]:
        """Axes of the servos that must keep to the band."""
        return tuple(Axis(self.task, servo) for servo in self.servos)

    @cached_property
    def basis(self) -> CommandBasis:
        """Commands that may be chosen."""
        return command_basis(self.task, self.command, self.structure, robust=len(self.servos) > 1)

    @cached_property
    def scale(self) -> float:
        """Slave travel that is 1 in the unknowns: that of a cycle (slave unit)."""
        return max(abs(self.task.machine.pitch), abs(self.task.sync.advance))

    @cached_property
    def torque(self) -> AxisTorque:
        """Torque of the commands."""
        return AxisTorque(self.task, self.basis, self.scale)

    @cached_property
    def limits(self) -> dict[int, tuple[float, float]]:
        """Limits of the command over the master, by order of the derivative."""
        task = self.task
        machine, slope, jerk = task.machine, task.greatest_slope, task.greatest_jerk
        found = {1: (task.least_ratio, task.greatest_ratio), 2: (-slope, slope), 3: (-jerk, jerk)}
        if machine.guide is not None:
            end = task.slave_at_sync_start + task.sync.advance
            found[0] = (machine.guide[0] - end, machine.guide[1] - end)
        return found

    @cached_property
    def own_limits(self) -> dict[int, tuple[float, float]]:
        """Limits that the axis' own motion is held to: speed, reversal and acceleration."""
        return {order: limits for order, limits in self.limits.items() if order in (1, 2)}

    def errors(self, profile: CamProfile) -> tuple[float, ...]:
        """Largest sync error of the tool in the shear zone (m), by servo."""
        return tuple(float(np.abs(axis.zone_errors(profile)[2]).max()) for axis in self.axes)
