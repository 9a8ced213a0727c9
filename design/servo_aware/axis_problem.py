"""`AxisProblem`: a servo-aware design in numbers, and what follows from them once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TypeVar

from camwright.design.servo_aware.axis_response import Axis
from camwright.design.servo_aware.command_basis import Command, CommandBasis, command_basis
from camwright.design.servo_aware.torque import AxisTorque
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.servo import Servo
from camwright.profiles.task import Task

Each = TypeVar("Each")
"""What is thinned out."""

# Of the line speeds that are looked at, servos at the corners of their ranges are looked at at each so many-th.
CORNERED = 5


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
        Servos between the corners of the ranges, whose error must not be much larger than that of the others; each at a line speed of its
        own.
    wider
        Factor by which the band of these servos is wider than that of the others.
    shares
        Line speeds at which all this is to hold, as shares of the cut's, from the full line speed down.
    sketch
        Whether these line speeds alone are looked at, and none between where the axis comes near to its tolerance.
    """

    task: Task
    command: Command
    servos: tuple[Servo, ...]
    axis_limits: bool
    structure: CamProfile | None = None
    between: tuple[Servo, ...] = ()
    wider: float = 1.0
    shares: tuple[float, ...] = (1.0,)
    sketch: bool = False

    @cached_property
    def axes(self) -> tuple[tuple[Axis, ...], ...]:
        """Axes of the servos that must keep to the band, by servo: the nominal one at all line speeds, the others at fewer of them."""
        fewer = thinned(self.shares, CORNERED)
        return tuple(
            tuple(Axis(self.task, servo.at_speed(share), share) for share in (fewer if number else self.shares))
            for number, servo in enumerate(self.servos)
        )

    @cached_property
    def axes_between(self) -> tuple[Axis, ...]:
        """Axes of the servos between the corners; their line speeds are spread over all."""
        shares = [self.shares[number % len(self.shares)] for number in range(len(self.between))]
        return tuple(
            Axis(self.task, servo.at_speed(share), share) for servo, share in zip(self.between, shares, strict=True)
        )

    @property
    def several(self) -> bool:
        """Whether more than one axis must keep to the band."""
        return len(self.servos) > 1 or len(self.shares) > 1

    @cached_property
    def basis(self) -> CommandBasis:
        """Commands that may be chosen."""
        return command_basis(self.task, self.command, self.structure, robust=self.several)

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

    def own_limits(self, axis: Axis) -> dict[int, tuple[float, float]]:
        """Limits over the master that an axis' own motion is held to at its line speed: speed, reversal and acceleration."""
        return {
            order: (low / axis.share**order, high / axis.share**order)
            for order, (low, high) in self.limits.items()
            if order in (1, 2)
        }


def thinned(every: Sequence[Each], step: int) -> tuple[Each, ...]:
    """Take each so many-th of a sequence, the first and the last among them."""
    return tuple(every) if len(every) == 1 else (*every[:-1:step], every[-1])
