"""Whether a job can be done at all, and if not, what binds, by how much, and what would work.

For a machine whose sync zone is a straight line the answer is a closed form: the return is the line ``y = x`` plus a motion from rest to
rest, and `profiles.reach` tells how far such a motion can go.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

from profiles.cycle import Cut
from profiles.errors import InfeasibleError, Suggestion
from profiles.limits import Limits
from profiles.machines import RotaryKnife
from profiles.reach import greatest_reach, least_acceleration, least_jerk, least_speed

# A job short of its way by less than this share is feasible: rounding, not physics.
ROUNDING = 1e-12
# Suggested values are rounded to this many digits, towards the safe side.
SUGGESTED_DIGITS = 4


@dataclass(frozen=True)
class _Correction:
    """The rest-to-rest motion over the straight line, over time: distance (m), time (s) and the speed it may have (m/s)."""

    distance: float
    time: float
    speed: float
    backwards: bool


def require_feasible(machine: RotaryKnife, cut: Cut, limits: Limits) -> None:
    """Refuse a job that no motion can do.

    Raises
    ------
    InfeasibleError
        With the limit that binds, by how much, and the nearest line speed, cut length or limit that works.
    """
    if is_feasible(machine, cut, limits):
        return
    need = _needed_limits(machine, cut, limits)
    have = {"speed": limits.speed, "acceleration": limits.acceleration, "jerk": limits.jerk}
    # the limit that binds is the one that would have to give least, were it the only one to give
    share = {name: value / have[name] for name, value in need.items()}
    motion = _correction(machine, cut, limits)
    standing = motion.backwards and not limits.reversal and math.isfinite(share["speed"])
    binding = min(share, key=lambda name: share[name])
    if not math.isfinite(share[binding]):
        binding = _most_confining(motion, limits)
    if binding == "speed" and standing:
        binding = "reversal"
    suggestions = tuple(_suggest(machine, cut, limits, need))
    excess, unit, words = _words(binding, need, have, cut)
    offers = "; ".join(_offer(suggestion) for suggestion in suggestions)
    raise InfeasibleError(
        f"no motion returns the slave in time: {words} (cut.length {cut.length * 1e3:g} mm at cut.line_speed "
        f"{cut.line_speed * 60:g} m/min, sync zone {cut.sync_zone * 1e3:g} mm). "
        + (f"What works, each alone: {offers}" if offers else "No single change of speed, length or limit works"),
        binding,
        excess,
        unit,
        suggestions,
    )


def is_feasible(machine: RotaryKnife, cut: Cut, limits: Limits) -> bool:
    """Tell whether some motion keeps the limits."""
    if limits.speed < cut.line_speed:
        return False
    motion = _correction(machine, cut, limits)
    if motion.distance <= ROUNDING * cut.length:
        return True
    if motion.speed <= 0:
        return False
    reach = greatest_reach(motion.time, motion.speed, limits.acceleration, limits.jerk)
    return reach >= motion.distance * (1 - ROUNDING)


def _correction(machine: RotaryKnife, cut: Cut, limits: Limits) -> _Correction:
    distance = machine.pitch - cut.length
    backwards = distance < 0
    speed = cut.line_speed - limits.least_velocity if backwards else limits.speed - cut.line_speed
    return _Correction(abs(distance), cut.return_zone / cut.line_speed, speed, backwards)


def _needed_limits(machine: RotaryKnife, cut: Cut, limits: Limits) -> dict[str, float]:
    """Least value of each limit that would do, the others as they are; infinite where none does."""
    motion = _correction(machine, cut, limits)
    over = least_speed(motion.distance, motion.time, limits.acceleration, limits.jerk)
    if motion.backwards:
        # standing still is the end of what a slave can do without reversal; the rest is reversal at up to the speed limit
        speed = over - cut.line_speed if limits.reversal else (limits.speed if over - cut.line_speed <= limits.speed else math.inf)
    else:
        speed = over + cut.line_speed
    return {
        "speed": speed,
        "acceleration": least_acceleration(motion.distance, motion.time, motion.speed, limits.jerk)
        if motion.speed > 0
        else math.inf,
        "jerk": least_jerk(motion.distance, motion.time, motion.speed, limits.acceleration)
        if motion.speed > 0
        else math.inf,
    }


def _most_confining(motion: _Correction, limits: Limits) -> str:
    """Limit whose release alone would carry the slave furthest, where no single one is enough."""
    far = 1e12
    reach = {
        "speed": greatest_reach(motion.time, far, limits.acceleration, limits.jerk),
        "acceleration": greatest_reach(motion.time, max(motion.speed, 1e-12), far, limits.jerk),
        "jerk": greatest_reach(motion.time, max(motion.speed, 1e-12), limits.acceleration, far),
    }
    return max(reach, key=lambda name: reach[name])


_UNITS = {"speed": (60.0, "m/min"), "acceleration": (1.0, "m/s^2"), "jerk": (1.0, "m/s^3")}


def _words(
    binding: str, need: dict[str, float], have: dict[str, float], cut: Cut
) -> tuple[float | None, str, str]:
    if binding == "reversal":
        return None, "", f"limits.reversal = false binds, the slave would have to run backwards from {cut.line_speed * 60:g} m/min"
    factor, unit = _UNITS[binding]
    limit, needed = have[binding] * factor, need[binding] * factor
    if not math.isfinite(needed):
        return None, unit, f"limits.{binding} {limit:g} {unit} binds, and no other value of it alone would do"
    return (
        needed - limit,
        unit,
        f"limits.{binding} binds, {needed:.6g} {unit} is needed, {limit:g} {unit} is the limit "
        f"({100 * (needed / limit - 1):.3g} % short)",
    )


def _suggest(machine: RotaryKnife, cut: Cut, limits: Limits, need: dict[str, float]) -> list[Suggestion]:
    """Nearest changes that work: line speed, cut length, each limit, reversal; each checked as it is written."""
    found: list[Suggestion] = []

    def offer(change: str, value: float, factor: float, unit: str, up: bool, works: Callable[[float], bool]) -> None:
        for digits in (SUGGESTED_DIGITS, SUGGESTED_DIGITS + 4, 15):
            rounded = _rounded(value * factor, digits, up)
            if works(rounded / factor):
                found.append(Suggestion(change, rounded, unit))
                return

    def at_speed(v: float) -> bool:
        return is_feasible(machine, replace(cut, line_speed=v), limits)

    def at_length(length: float) -> bool:
        return length > cut.sync_zone and is_feasible(machine, replace(cut, length=length), limits)

    slower = _edge(at_speed, cut.line_speed * 1e-6, min(cut.line_speed, limits.speed))
    if slower is not None:
        offer("line_speed", slower, 60.0, "m/min", False, at_speed)
    if limits.speed >= cut.line_speed:
        # at the pitch itself the slave need not leave the line, so between it and the job lies the edge
        length = _edge(at_length, machine.pitch, cut.length)
        if length is not None:
            offer("length", length, 1e3, "mm", cut.length < machine.pitch, at_length)
    for name, value in need.items():
        if not math.isfinite(value):
            continue
        if name == "speed" and machine.pitch < cut.length and not limits.reversal:
            if is_feasible(machine, cut, replace(limits, reversal=True)):
                found.append(Suggestion("reversal", 1.0, ""))
            continue
        factor, unit = _UNITS[name]
        offer(name, value, factor, unit, True, lambda x, name=name: is_feasible(machine, cut, replace(limits, **{name: x})))
    return found


def _edge(works: Callable[[float], bool], good: float, bad: float) -> float | None:
    """Find the value nearest to ``bad`` that works, by bisection from ``good``; None if ``good`` does not work."""
    if not works(good):
        return None
    while True:
        middle = 0.5 * (good + bad)
        if middle in (good, bad):
            return good
        if works(middle):
            good = middle
        else:
            bad = middle


def _rounded(value: float, digits: int, up: bool) -> float:
    scale = 10.0 ** (digits - 1 - math.floor(math.log10(abs(value))))
    return (math.ceil(value * scale - 1e-6) if up else math.floor(value * scale + 1e-6)) / scale


def _offer(suggestion: Suggestion) -> str:
    place = {"line_speed": "cut.line_speed", "length": "cut.length"}.get(suggestion.change, f"limits.{suggestion.change}")
    if suggestion.change == "reversal":
        return f"{place} = true"
    return f'{place} = "{suggestion.value:.15g} {suggestion.unit}"'
