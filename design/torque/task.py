"""What a torque programme is made for, and the forms that its motions may have."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

from camwright.design.returns.problem import ReturnProblem
from camwright.design.returns.scaling import motion_scale
from camwright.profiles.cut import Cut
from camwright.profiles.machines import Machine
from camwright.profiles.motor import MotorCurve
from camwright.profiles.objective import MOTION_OBJECTIVES, CommandObjective
from camwright.profiles.task import Task

Aim = CommandObjective | Literal["load"]
"""What is minimised; the load is the greatest share of the motor's torque at its speed that is used."""
PEAKS: tuple[Aim, ...] = ("peak_torque", "load", "peak_acceleration", "peak_jerk")
"""Aims that are the greatest of something."""
ROOTS: tuple[Aim, ...] = ("rms_torque", "rms_acceleration", "rms_jerk")
"""Aims that are root mean squares."""

SHORTEST_CROSSING = 1e-3
"""Least share of a return that counts as its crossing."""

Phase = Literal["any", "forth", "rest", "back"]
"""What a stretch of the return is known to be: nothing, forwards, at rest, backwards. At rest friction asks for no torque."""

Pattern = tuple[Phase, ...]
"""The phases of a return in turn; how long each takes is for the programme to find."""


@dataclass(frozen=True)
class TorqueTask:
    """What a programme is made for.

    Parameters
    ----------
    task
        The machine, its cut and its limits. Where the sync zone lies counts unless the programme is to find it.
    problem
        The return as numbers over the master; its own objective does not count.
    aim
        What is minimised.
    curve
        What the motor can give; None where that is no limit.
    """

    task: Task
    problem: ReturnProblem
    aim: Aim
    curve: MotorCurve | None = None

    @cached_property
    def signed_scale(self) -> float:
        """Slave travel that is 1 in the scaled problem, signed as `camwright.design.returns.scaling.motion_scale` has it."""
        return motion_scale(self.problem)

    @property
    def scale(self) -> float:
        """Slave travel that is 1 in the programme (slave unit), positive."""
        return abs(self.problem.height) or abs(self.signed_scale)

    @property
    def crossing(self) -> float:
        """Share of the return in which the slave would be across at its speed in sync, at most 1: the time in which things happen."""
        at_once = max(self.problem.start_ratio, self.problem.end_ratio) * self.problem.length
        return min(1.0, max(self.scale / at_once, SHORTEST_CROSSING)) if at_once > 0 else 1.0

    @property
    def duration(self) -> float:
        """Time of the return (s)."""
        return self.problem.length / self.cut.line_speed

    @property
    def machine(self) -> Machine:
        """The machine."""
        return self.task.machine

    @property
    def cut(self) -> Cut:
        """Its cycle."""
        return self.task.cut

    @cached_property
    def start(self) -> float:
        """Slave coordinate at the start of the return (slave unit)."""
        return self.task.slave_at_sync_end

    def inertia(self, y: Any) -> Any:
        """Inertia that the aim weighs: the machine's for what the motor feels, one for what the slave does."""
        return 1.0 + 0.0 * y if self.aim in MOTION_OBJECTIVES else self.machine.inertia(y)

    @property
    def friction(self) -> float:
        """Friction against the motion that the aim weighs (N or N·m): none for what the slave does."""
        return 0.0 if self.aim in MOTION_OBJECTIVES else self.machine.friction

    @property
    def may_turn(self) -> bool:
        """Whether the slave may run backwards in the return."""
        return self.problem.least_ratio < 0.0
