"""The refusal of a job whose cam cannot bear the ramps of its line: what is borne, and the single changes that work."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

from camwright.design.feasible.feasibility import is_feasible, with_limit
from camwright.design.feasible.refusal import LINE_UNITS, refused, written
from camwright.design.line.forms import KEPT
from camwright.design.line.ramped import ramp_share
from camwright.design.returns.curve_limits import motor_limits
from camwright.design.returns.problem import return_problem
from camwright.profiles.errors import InfeasibleError, InputError, Suggestion
from camwright.profiles.halving import halved
from camwright.profiles.message import Message, Value
from camwright.profiles.task import Task

HALVINGS = 12
"""Edges are found to this power of a half of the range, on the side that works."""

LARGEST = 8.0
"""Limits and cut lengths up to this multiple are looked at."""


def can_ramp(task: Task) -> bool:
    """Tell whether the line may ramp in the sync zone and some return bears it, as far as a mesh of some intervals tells."""
    try:
        if not is_feasible(task):
            return False
        within = [task.with_limits(each) for each in motor_limits(task.machine, task.limits)]
        shares = (ramp_share(each, return_problem(each, "rms_acceleration")) for each in within if is_feasible(each))
        return any(share is not None and share <= 1.0 + KEPT for share in shares)
    except InputError:
        return False


def ramp_infeasible(task: Task, *, suggest: bool = True) -> InfeasibleError:
    """Say that no return was found that bears the line's ramps, which is borne, and what would work; each was tried.

    Parameters
    ----------
    task
        The job, its sync zone placed; it can be done on a line that keeps its speed.
    suggest
        Whether to look for what would work.
    """
    cut = task.cut
    binding, hardest, unit = _binding(task)
    text = (
        f"no motion keeps the limits while the line ramps: {{@{binding}}} = {{ramp}} binds ({{@length}} {{length}} at {{@line_speed}} "
        "{line_speed}; on a line that keeps its speed there is a motion)"
    )
    values = (
        ("ramp", Value(hardest, unit, 6)),
        ("length", Value(cut.length, "m", 6)),
        ("line_speed", Value(cut.line_speed, "m/s", 6)),
    )
    if not suggest:
        return InfeasibleError(Message(text, values), binding, None, unit, ())
    found = tuple(_suggestions(task))
    borne = next((each.value for each in found if each.change == binding), None)
    excess = None if borne is None else hardest - borne
    return refused(task, Message(text, values), binding, excess, unit, found)


def _binding(task: Task) -> tuple[str, float, str]:
    """Name the key of ``[line]`` that binds, its value and unit: the jerk where the ramps are borne without one, else the hardest."""
    line = task.line
    if line.jerk is not None and can_ramp(task.with_line(replace(line, jerk=None))):
        return "line.jerk", line.jerk, LINE_UNITS["line.jerk"]
    name, hardest = max(("line.stop", line.stop or 0.0), ("line.acceleration", line.speeding), key=lambda each: each[1])
    return name, hardest, LINE_UNITS[name]


def _suggestions(task: Task) -> Iterator[Suggestion]:
    """Give gentler ramps, a slower line, a higher limit and another cut length, each alone, as far as it works."""
    for change, unit in LINE_UNITS.items():
        key = change.rpartition(".")[2]
        given = getattr(task.line, key)
        if given is None:
            continue

        def with_ramp(value: float, key: str = key) -> bool:
            return can_ramp(task.with_line(replace(task.line, **{key: value})))

        yield from _nearest(change, given, 0.0, 1.0, unit, with_ramp)
    speed = task.cut.line_speed
    yield from _nearest("line_speed", speed, 0.0, 60.0, "m/min", lambda v: can_ramp(task.at_speed(v)))
    for name, unit in (("acceleration", "/s^2"), ("jerk", "/s^3")):
        given = float(getattr(task.limits, name))

        def with_value(value: float, name: str = name) -> bool:
            return can_ramp(task.with_limits(with_limit(task.limits, name, value)))

        yield from _nearest(name, given, LARGEST * given, 1.0, task.machine.slave_unit + unit, with_value)
    length = task.cut.length
    for far in (LARGEST * length, task.cut.sync_zone):
        longer = tuple(_nearest("length", length, far, 1e3, "mm", lambda value: can_ramp(task.with_length(value))))
        yield from longer[:1]
        if longer:
            return


def _nearest(
    change: str, given: float, far: float, factor: float, unit: str, works: Callable[[float], bool]
) -> Iterator[Suggestion]:
    """Find the nearest value that works on the way from the given one to a far one, which may be zero; none where none was seen to."""
    shares = (0.25, 0.5, 0.75, 0.9, 0.97, 0.99, 0.999) if far < given else (0.02, 0.07, 0.2, 0.45, 1.0)
    steps = [given + (far - given) * share for share in shares]
    bad = given
    for good in steps:
        if works(good):
            break
        bad = good
    else:
        return
    good, _ = halved(works, good, bad, most=HALVINGS)
    yield from written(change, good, factor, unit, far > given, works, (1.0,))
