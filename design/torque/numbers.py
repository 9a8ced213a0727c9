"""What a torque programme is made of: its form, by which programmes are kept, and the numbers in which jobs of one form differ.

To build a programme takes as long as to solve it ten times. Cut lengths, line speeds, limits and places of the sync zone are therefore
parameters of it; the machine's own numbers are in its formulas.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import chain
from typing import Any, NamedTuple, Self

import casadi as ca

from camwright.design.line.forms import ramp_forms
from camwright.design.torque.task import Aim, TorqueTask
from camwright.profiles.machines import Machine
from camwright.profiles.motor import MotorCurve
from camwright.profiles.objective import MOTION_OBJECTIVES

FAR_SLOPE, FAR_JERK = 1e5, 1e8
"""Limits of the scaled acceleration and jerk are no greater than these, times how much its ends alone move it. On slow lines they are by
powers of ten, and the solver, whose steps go by the room to a limit, takes hundreds of them or finds no end."""


class TorqueNumbers(NamedTuple):
    """Numbers in which the programmes of one form differ, or the symbols that stand for them.

    Parameters
    ----------
    pace
        Scaled velocity that is 1 to the solver; of acceleration it is the square.
    sharpest
        Greatest scaled jerk.
    start
        Slave coordinate at the start of the return, where the zone is not placed (slave unit).
    scale, length, duration
        Slave travel, master length and time that are 1 in the programme (slave unit, m, s).
    line_speed, sync_ratio, travel
        Speed of the material (m/s), that of the tool over it in sync, and the tool's way through the sync zone (m).
    hardest
        Greatest magnitude of the line's acceleration over its speed (1/s).
    of_speed, of_acceleration, of_jerk
        One over each limit (slave unit, s).
    forms
        Factors of scaled velocity, acceleration and jerk in what must not exceed 1 while the line ramps, form by form.
    """

    pace: Any
    sharpest: Any
    start: Any
    scale: Any
    length: Any
    duration: Any
    line_speed: Any
    sync_ratio: Any
    travel: Any
    hardest: Any
    of_speed: Any
    of_acceleration: Any
    of_jerk: Any
    forms: tuple[tuple[Any, Any, Any], ...]

    @property
    def flat(self) -> tuple[Any, ...]:
        """All numbers in one row."""
        return (*self[:-1], *chain.from_iterable(self.forms))

    @classmethod
    def of(cls, task: TorqueTask) -> Self:
        """Numbers of a task."""
        problem, cut, limits, line = task.problem, task.cut, task.task.limits, task.task.line
        scale, length = task.scale, problem.length
        forms = ramp_forms(task.task) if line.ramps else ()
        return cls(
            pace=1.0 / task.crossing,
            sharpest=min(problem.greatest_jerk * length**3 / scale, FAR_JERK * moved(task)),
            start=task.start,
            scale=scale,
            length=length,
            duration=task.duration,
            line_speed=cut.line_speed,
            sync_ratio=cut.sync_ratio,
            travel=cut.sync_ratio * cut.sync_zone,
            hardest=line.hardest / cut.line_speed,
            of_speed=1.0 / limits.speed,
            of_acceleration=1.0 / limits.acceleration,
            of_jerk=1.0 / limits.jerk,
            forms=tuple(
                (form.ratio * scale / length, form.slope * scale / length**2, form.jerk * scale / length**3)
                for form in forms
            ),
        )


@dataclass(frozen=True)
class TorqueForm:
    """What the pieces of a programme are made of, but for its numbers.

    Parameters
    ----------
    machine
        The machine, its sync zone at no place of its own: formulas in slave coordinates are the same wherever it lies.
    aim
        What is minimised.
    curve
        What the motor can give; None where that is no limit.
    forms
        How many linear forms must not exceed 1 while the line ramps.
    """

    machine: Machine
    aim: Aim
    curve: MotorCurve | None
    forms: int

    @classmethod
    def of(cls, task: TorqueTask) -> Self:
        """Form of a task."""
        machine = task.machine
        machine = machine.placed_at(0.0) if machine.place_name else machine
        forms = len(ramp_forms(task.task)) if task.task.line.ramps else 0
        return cls(machine, task.aim, task.curve, forms)

    @cached_property
    def numbers(self) -> TorqueNumbers:
        """A symbol for each number, called as it is."""
        named = {name: ca.SX.sym(name) for name in TorqueNumbers._fields if name != "forms"}
        of_order = "ratio", "slope", "jerk"
        forms: Any = tuple(tuple(ca.SX.sym(f"form_{k}_{name}") for name in of_order) for k in range(self.forms))
        return TorqueNumbers(**named, forms=forms)

    @property
    def feels_motor(self) -> bool:
        """Whether the motor's torque counts, in what is minimised or in what limits it."""
        return self.curve is not None or self.aim not in MOTION_OBJECTIVES

    @property
    def count(self) -> int:
        """How many numbers there are."""
        return len(TorqueNumbers._fields) - 1 + 3 * self.forms


def moved(task: TorqueTask) -> float:
    """How much the ratios and slopes at the ends move the slave over the return, in units of its scale, at least 1."""
    problem = task.problem
    ratios = (problem.start_ratio * problem.length, problem.end_ratio * problem.length)
    slopes = (problem.start_slope * problem.length**2, problem.end_slope * problem.length**2)
    return max(task.scale, *map(abs, (*ratios, *slopes))) / task.scale
