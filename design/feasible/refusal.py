"""The refusal of a job that no motion can do: what binds, by how much, and the nearest single changes that work."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace

from camwright.design.feasible.feasibility import (
    LIMIT_NAMES,
    binding_limit,
    edge,
    is_feasible,
    least_factor,
    needed_limits,
    slowdown,
    stroke_of,
    with_limit,
)
from camwright.profiles.errors import InfeasibleError, Suggestion
from camwright.profiles.message import MOST_PERCENT, Message, Value, part_of, rounded_to
from camwright.profiles.motor import MotorCurve
from camwright.profiles.task import Task

# Suggested values are rounded to this many digits, towards the safe side; to more where that misses.
DIGITS = (4, 6, 9, 15)
# Suggestions keep this share away from the edge, so that the motion is not the only one.
ASIDE = 1e-3
# Where more than feasibility is asked of a suggestion it may lie further from the edge, by these factors.
FURTHER = (1.0, 1.02, 1.07, 1.15, 1.3, 1.6, 2.0)
# Cut lengths are looked for in steps of this factor, up to the longest multiple of the job's.
STEP = 2**0.125
LONGEST = 64.0
# Edges of the cut length are found to this share.
EDGE = 1e-9

_UNITS = {
    "m": {"stroke": (1e3, "mm"), "speed": (60.0, "m/min"), "acceleration": (1.0, "m/s^2"), "jerk": (1.0, "m/s^3")},
    "rad": {
        "stroke": (math.degrees(1.0), "deg"),
        "speed": (30.0 / math.pi, "rpm"),
        "acceleration": (1.0, "rad/s^2"),
        "jerk": (1.0, "rad/s^3"),
    },
}


LINE_UNITS = {"line.acceleration": "m/s^2", "line.stop": "m/s^2", "line.jerk": "m/s^3"}
"""Units of what the line does, SI and as they are offered."""

_SI_POWERS = {"stroke": "", "speed": "/s", "acceleration": "/s^2", "jerk": "/s^3"}


def require_feasible(task: Task, *, suggest: bool = True) -> None:
    """Refuse a job that no motion can do.

    Parameters
    ----------
    suggest
        Whether to look for what would work.

    Raises
    ------
    InfeasibleError
        With the limit that binds, by how much, and the nearest line speed, cut length or limit that works.
    """
    if not is_feasible(task):
        raise infeasible(task, suggest=suggest)


def infeasible(
    task: Task, *, suggest: bool = True, load: float | None = None, designs: Callable[[Task], bool] | None = None
) -> InfeasibleError:
    """Say why a job is infeasible and, if asked, what would work; every suggestion has been checked.

    Parameters
    ----------
    suggest
        Whether to look for what would work.
    load
        Least share of the motor's torque that a motion needs, if that is known; else the motor's rectangles tell
        (`camwright.design.returns.curve_limits.motor_limits`).
    designs
        Tells whether a task can be designed, where that asks more than a motion within the limits: of the axis. Each suggestion is.
    """
    cut = task.cut
    need = needed_limits(task)
    binding = binding_limit(task, need)
    torque = _torque_needed(task) if load is None else load
    excess, unit, why = _why(task, binding, need, torque)
    text = f"no motion returns the slave in time: {why.text} ({{@length}} {{length}} at {{@line_speed}} {{line_speed}}, sync zone {{zone}})"
    values = (
        *why.values,
        ("length", Value(cut.length, "m", 6)),
        ("line_speed", Value(cut.line_speed, "m/s", 6)),
        ("zone", Value(cut.sync_zone, "m", 6)),
    )
    if not suggest:
        return InfeasibleError(Message(text, values), binding, excess, unit, ())
    return refused(task, Message(text, values), binding, excess, unit, tuple(_suggestions(task, need, torque, designs)))


def refused(
    task: Task, why: Message, binding: str, excess: float | None, unit: str, suggestions: tuple[Suggestion, ...]
) -> InfeasibleError:
    """Make the refusal of a job from why it is refused and from the single changes that work."""
    offers = "; ".join(_offer(suggestion, f"offer_{number}") for number, suggestion in enumerate(suggestions))
    offered = (
        (f"offer_{number}", _offered(each, task))
        for number, each in enumerate(suggestions)
        if each.unit not in ("", "%")
    )
    works = f"What works, each alone: {offers}" if offers else "No single change of speed, length or limit works"
    return InfeasibleError(Message(f"{why.text}. {works}", (*why.values, *offered)), binding, excess, unit, suggestions)


def _torque_needed(task: Task) -> float:
    """Factor on the torque of the motor's curve that would do; infinite if there is no curve, or no torque is enough."""
    curve = task.limits.motor
    if curve is None:
        return math.inf
    return least_factor(
        lambda f: f >= 1.0 and is_feasible(task.with_limits(replace(task.limits, motor=_stronger(curve, f))))
    )


def _stronger(curve: MotorCurve, factor: float) -> MotorCurve:
    return MotorCurve(tuple((speed, torque * factor) for speed, torque in curve.points))


def _why(task: Task, binding: str, need: dict[str, float], torque: float) -> tuple[float | None, str, Message]:
    """By how much the binding limit is exceeded, its unit, and both in words."""
    if binding == "reversal":
        text = "{@reversal} = false binds, the slave would have to run backwards from {from}"
        return None, "", Message(text, (("from", Value(task.cut.line_speed, "m/s", 6)),))
    if binding == "sync_zone":
        return None, "", Message("{@sync_zone} binds, the machine cannot be in sync over it")
    if binding == "motor":
        if math.isinf(torque):
            return None, "%", Message("{@motor} binds, the motor does not reach the speed that is needed")
        more = 100 * (torque - 1)
        return (
            more,
            "%",
            Message(f"{{@motor}} binds, {_told(torque, 'more')} torque is needed at the speeds of the motion"),
        )
    slave = task.machine.slave_unit
    factor, unit = _UNITS[slave][binding]
    si = slave + _SI_POWERS[binding]
    have = stroke_of(task.machine) if binding == "stroke" else float(getattr(task.limits, binding))
    needed = need[binding]
    values = ("have", Value(have, si, 6)), ("needed", Value(needed, si, 6))
    if not math.isfinite(needed):
        text = f"{_named(binding)} {{have}} binds, and no other value of it alone would do"
        return None, unit, Message(text, values[:1])
    text = f"{_named(binding)} binds, {{needed}} is needed, {{have}} is given ({_told(needed / have, 'too little')})"
    return (needed - have) * factor, unit, Message(text, values)


def _told(times: float, more: str) -> str:
    """Tell by how much something must be more than it is: in per cent, as a multiple where these are too many."""
    share = 100.0 * (times - 1.0)
    return f"{share:.3g} % {more}" if share <= MOST_PERCENT else f"{part_of(times)} as much"


def _suggestions(
    task: Task, need: dict[str, float], torque: float, designs: Callable[[Task], bool] | None
) -> Iterator[Suggestion]:
    """Nearest changes that work: line speed, cut length, stroke, each limit, motor, reversal; each checked as it is written."""
    machine, cut, limits = task.machine, task.cut, task.limits
    works, further = (is_feasible, FURTHER[:1]) if designs is None else (designs, FURTHER)

    def at_speed(v: float) -> bool:
        return works(task.designed_at(v))

    def at_length(length: float) -> bool:
        return length > cut.sync_zone and is_feasible(task.with_length(length))

    slower = slowdown(task)
    if slower > 0:
        yield from written("line_speed", slower * cut.line_speed, 60.0, "m/min", False, at_speed, further)
    length = _nearest_length(at_length, task)
    if length is not None:
        yield from written(
            "length", length, 1e3, "mm", length > cut.length, lambda value: works(task.with_length(value)), further
        )
    if stroke_of(machine) < need.get("stroke", math.inf) < math.inf:

        def with_stroke(stroke: float) -> bool:
            return works(task.with_machine(machine.with_guide(stroke)))

        yield from written("stroke", need["stroke"], *_UNITS[machine.slave_unit]["stroke"], True, with_stroke, further)
    for name in LIMIT_NAMES:
        if not getattr(limits, name) < need[name] < math.inf:
            continue

        def with_value(value: float, name: str = name) -> bool:
            return works(task.with_limits(with_limit(limits, name, value)))

        factor, unit = _UNITS[machine.slave_unit][name]
        yield from written(name, need[name], factor, unit, True, with_value, further)
    if limits.motor is not None and designs is None and 1.0 < torque < math.inf:
        yield from written("motor", torque, 100.0, "%", True, lambda factor: factor > torque, further)
    if not task.reverses and works(task.with_limits(replace(limits, reversal=True))):
        yield Suggestion("reversal", 1.0, "")


def written(
    change: str,
    value: float,
    factor: float,
    unit: str,
    up: bool,
    works: Callable[[float], bool],
    further: tuple[float, ...],
) -> Iterator[Suggestion]:
    """Write a value at an edge a little aside of it, or further, in a unit, with as few digits as work."""
    for far in further:
        safe = value * ((1 + ASIDE) * far if up else (1 - ASIDE) / far)
        for digits in DIGITS if len(further) == 1 else DIGITS[:1]:
            rounded = rounded_to(safe * factor, digits, up)
            if works(rounded / factor):
                yield Suggestion(change, rounded, unit)
                return


def _nearest_length(works: Callable[[float], bool], task: Task) -> float | None:
    """Find the cut length nearest to the job's that works, looking at longer and shorter ones in steps; None if none does.

    Among them is the one at which a slave as fast as it leaves the sync zone would be back just in time: it can be the only one.
    """
    cut = task.cut
    sync = task.sync
    easy = (cut.sync_zone + task.height / float(sync(sync.end, 1))) / cut.length
    count = 1 + round(math.log(LONGEST) / math.log(STEP))
    factors = [STEP**number for number in range(1 - count, count)]
    factors += [easy] if easy > 0 else []
    for factor in sorted(factors, key=lambda factor: abs(math.log(factor))):
        if factor != 1.0 and works(cut.length * factor):
            bad = factor / STEP if factor > 1.0 else factor * STEP
            bad = max(bad, 1.0) if factor > 1.0 else min(bad, 1.0)
            return edge(works, cut.length * factor, cut.length * bad, EDGE)
    return None


def _named(change: str) -> str:
    """Name what binds or may change, as in a `Message`; a stroke is the machine's own."""
    return "{@machine.stroke}" if change == "stroke" else f"{{@{change}}}"


def _offer(suggestion: Suggestion, hole: str) -> str:
    """Write a suggestion, its quantity and its value as in a `Message`."""
    quantity = _named(suggestion.change)
    if suggestion.change == "reversal":
        return f"{quantity} = true"
    if suggestion.change == "motor":
        return f"{quantity} with {suggestion.value:.15g} % of its torque"
    return f'{quantity} = "{{{hole}}}"'


def _offered(suggestion: Suggestion, task: Task) -> Value:
    """Give the value of a suggestion for a `Message`: printed as it was checked in its unit, in another one beyond it, which works too.

    What is offered lies `ASIDE` beyond the edge, a thousand times what is rounded off in another unit.
    """
    slave, chosen = task.machine.slave_unit, f"{suggestion.value:.15g} {suggestion.unit}"
    if suggestion.change == "length":
        up = suggestion.value > task.cut.length * 1e3
        return Value(suggestion.value / 1e3, "m", 6, "above" if up else "below", chosen)
    if suggestion.change == "line_speed":
        return Value(suggestion.value / 60.0, "m/s", 6, "below", chosen)
    if suggestion.change in LINE_UNITS:
        return Value(suggestion.value, LINE_UNITS[suggestion.change], 6, "below", chosen)
    factor, _ = _UNITS[slave][suggestion.change]
    return Value(suggestion.value / factor, slave + _SI_POWERS[suggestion.change], 6, "above", chosen)
