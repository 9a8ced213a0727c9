"""The map of cut length and line speed: what is possible, with which return, and what binds."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

from camwright.design.feasible.extremes import BEYOND, max_line_speed, placed_fastest
from camwright.design.feasible.feasibility import binding_limit, least_factor, needed_limits
from camwright.design.returns.measures import objective_value
from camwright.design.returns.problem import return_problem
from camwright.design.returns.solver import solve_return
from camwright.profiles.cross_cutter import quintic_return
from camwright.profiles.errors import InputError, SolverError
from camwright.profiles.machines import Machine
from camwright.profiles.message import Message, Value
from camwright.profiles.objective import OBJECTIVES, MotionObjective
from camwright.profiles.returns import assemble, quintic_between
from camwright.profiles.task import Task

# Rounding that a baseline may exceed a limit by.
ROUNDING = 1e-9
# What a point lacks is found to this share, to name the limit that lacks least.
NAMED = 1e-6


@dataclass(frozen=True)
class EnvelopePoint:
    """One cut length at one line speed.

    Parameters
    ----------
    length, line_speed
        The point (m, m/s).
    objective
        Least objective of the optimised return over time (slave unit per s² or s³); None where no return is possible.
    binding
        What forbids the point, or what would bind first at this cut length if the line ran faster; for machines without a closed
        form the latter in both cases.
    quintic, linear
        Whether the quintic return keeps all limits, and whether the linear return keeps the speed limit, the only one that S1
        asks of it.
    """

    length: float
    line_speed: float
    objective: float | None
    binding: str
    quintic: bool
    linear: bool

    @property
    def optimised(self) -> bool:
        """Whether some return keeps all limits."""
        return self.objective is not None


@dataclass(frozen=True)
class EnvelopeRow:
    """One cut length.

    Parameters
    ----------
    length
        The cut length (m).
    machine
        The machine as placed for it.
    optimised, quintic, linear
        Highest line speeds with each return (m/s), None where no speed works.
    binding
        What binds the first of these.
    """

    length: float
    machine: Machine
    optimised: float | None
    quintic: float | None
    linear: float | None
    binding: str


@dataclass(frozen=True)
class Envelope:
    """The map: its points by length and then speed, and a row for each length."""

    points: tuple[EnvelopePoint, ...]
    rows: tuple[EnvelopeRow, ...]


def envelope(
    task: Task,
    objective: MotionObjective,
    lengths: Sequence[float],
    line_speeds: Sequence[float],
    step: Callable[[str], None] = lambda _: None,
) -> Envelope:
    """Compute the map; every point is an optimisation of its own.

    Parameters
    ----------
    task, objective
        The job; its cut length and line speed are replaced by those of the points. A crank whose sync zone is free has it, at each cut
        length, where the line can run fastest.
    lengths, line_speeds
        Cut lengths (m), each above the sync zone, and line speeds (m/s).
    step
        Told before every cut length and every point.

    Raises
    ------
    InputError
        A cut length is not above the sync zone.
    """
    cut = task.cut
    short = [length for length in lengths if length <= cut.sync_zone]
    if short:
        raise InputError(
            Message(
                "the envelope cannot begin at a cut length of {length}: it must be above the sync zone, {@sync_zone} = {zone}",
                (("length", Value(min(short), "m", 6)), ("zone", Value(cut.sync_zone, "m", 6))),
            )
        )
    rows, points = [], []
    for length in lengths:
        step(f"cut length {length * 1e3:.4g} mm")
        at_length = task.with_length(length)
        placed = placed_fastest(at_length)
        row = _row(placed)
        rows.append(row)
        points += list(_points(placed, objective, line_speeds, row, step))
    return Envelope(tuple(points), tuple(rows))


def _row(task: Task) -> EnvelopeRow:
    cut = task.cut
    fastest = max_line_speed(task)
    beyond = task.designed_at((fastest or cut.line_speed) * (1 + BEYOND))
    binding = binding_limit(beyond, needed_limits(beyond))
    return EnvelopeRow(cut.length, task.machine, fastest, quintic_speed(task), linear_speed(task), binding)


def _points(
    task: Task,
    objective: MotionObjective,
    line_speeds: Sequence[float],
    row: EnvelopeRow,
    step: Callable[[str], None],
) -> Iterator[EnvelopePoint]:
    # where closed forms tell what a point lacks it is asked at the point, elsewhere at the edge of its cut length
    cut = task.cut
    straight = task.machine.slave_unit == "m" and task.straight
    for v in line_speeds:
        step(f"cut length {cut.length * 1e3:.4g} mm at {v * 60:.4g} m/min")
        here = task.designed_at(v)
        possible = row.optimised is not None and v <= row.optimised
        value = _objective(here, objective) if possible else None
        binding = row.binding
        if not possible and straight:
            binding = binding_limit(here, needed_limits(here, NAMED))
        quintic = row.quintic is not None and v <= row.quintic
        linear = row.linear is not None and v <= row.linear
        yield EnvelopePoint(cut.length, v, value, binding, quintic, linear)


def _objective(task: Task, objective: MotionObjective) -> float | None:
    try:
        back = solve_return(return_problem(task, objective), thorough=False)[0]
    except SolverError:
        return None
    return OBJECTIVES[objective].over_time(objective_value(back, objective), task.cut.line_speed)


def quintic_speed(task: Task) -> float | None:
    """Highest line speed at which the quintic return keeps all limits, exactly: its shape over the master does not depend on the speed.

    None if it reverses where it may not, or leaves the stroke. Where zones last a time the shape does depend on it, and the edge is
    looked for.
    """
    if task.cut.timed:
        return _own_edge(task, quintic_speed)
    cut, limits = task.cut, task.limits
    problem = return_problem(task.at_speed(1.0), "peak_acceleration")
    straight = task.straight and cut.sync_ratio == 1.0
    back = (
        quintic_return(cut.return_zone, problem.height)
        if straight
        else quintic_between(task.sync, cut.return_zone, problem.height)
    )
    cycle = assemble(back, task.from_return())
    low, high = cycle.extrema(1)
    if low.value < -ROUNDING * high.value and not task.reverses:
        return None
    place = back.extrema(0)
    if place[0].value < problem.least_position or place[1].value > problem.greatest_position:
        return None
    speed, slope, jerk = max(high.value, -low.value), cycle.peak(2), cycle.peak(3)
    bounds = [limits.speed / speed]
    bounds += [math.sqrt(limits.acceleration / slope)] if slope > 0 else []
    bounds += [math.cbrt(limits.jerk / jerk)] if jerk > 0 else []
    return min(bounds)


def linear_speed(task: Task) -> float | None:
    """Highest line speed at which the linear return keeps the speed limit (S1, eq. 8); None if it would reverse where it may not."""
    if task.cut.timed:
        return _own_edge(task, linear_speed)
    ratio = task.height / task.cut.return_zone
    if ratio < 0 and not task.reverses:
        return None
    return task.limits.speed / max(abs(ratio), task.sync.extrema(1)[1].value)


def _own_edge(task: Task, fastest: Callable[[Task], float | None]) -> float | None:
    """Highest line speed at which a return made for it may run; None if none may."""

    def works(slower: float) -> bool:
        there = task.designed_at(task.cut.line_speed / slower)
        if there.cut.return_zone <= 0.0 or there.machine.zone_faults(there.cut):
            return False
        zones = there.with_cut(replace(there.cut, sync_time=None, shear_time=None))
        return (fastest(zones) or 0.0) >= there.cut.line_speed

    factor = least_factor(works)
    return task.cut.line_speed / factor if math.isfinite(factor) else None
