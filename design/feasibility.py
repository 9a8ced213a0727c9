"""Whether a job can be done at all, and if not, what binds, by how much, and what would work.

Where the sync zone is a straight line and no stroke confines the slave, the answer is a closed form: the return is that line plus a
motion from rest to rest, and `profiles.reach` tells how far such a motion can go. Elsewhere the least common factor on all limits is
an optimisation of its own.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache, partial

from design.motor import motor_limits
from design.problem import ReturnProblem, return_problem
from design.scaling import resolved
from design.solver import limit_margin
from profiles.cycle import Cut
from profiles.errors import InfeasibleError, InputError, SolverError, Suggestion
from profiles.limits import Limits
from profiles.machines import LinearCarriage, Machine
from profiles.polynomial import CamProfile
from profiles.reach import greatest_reach, in_time, least_acceleration, least_jerk, least_speed

# A job short of its way by less than this share is feasible: rounding, not physics.
ROUNDING = 1e-12
# The same where an optimisation decides: its accuracy.
SOLVED = 1e-8
# Edges found by repeated optimisation are found to this share.
EDGE = 1e-7
# Suggested values are rounded to this many digits, towards the safe side.
SUGGESTED_DIGITS = 4
# Where an optimisation decides, suggestions keep this share away from the edge, so that every objective has a motion there.
ASIDE = 1e-3
# Line speeds down to this share of the job's, and strokes up to this multiple of the machine's, are looked at.
SLOWEST = 1e-6
LONGEST_STROKE = 64.0
# "Unlimited", as a multiple of the limit.
FREE = 1e6

_UNITS = {
    "m": {"speed": (60.0, "m/min"), "acceleration": (1.0, "m/s^2"), "jerk": (1.0, "m/s^3")},
    "rad": {"speed": (30.0 / math.pi, "rpm"), "acceleration": (1.0, "rad/s^2"), "jerk": (1.0, "rad/s^3")},
}


def require_feasible(machine: Machine, cut: Cut, limits: Limits) -> None:
    """Refuse a job that no motion can do.

    Raises
    ------
    InfeasibleError
        With the limit that binds, by how much, and the nearest line speed, cut length or limit that works.
    """
    if not is_feasible(machine, cut, limits):
        raise infeasible(machine, cut, limits)


def infeasible(machine: Machine, cut: Cut, limits: Limits) -> InfeasibleError:
    """Say why a job is infeasible and what would work; every suggestion has been checked."""
    need = needed_limits(machine, cut, limits)
    binding = binding_limit(machine, cut, limits, need)
    suggestions = tuple(_suggest(machine, cut, limits, need))
    excess, unit, words = _words(binding, need, machine, limits, cut)
    offers = "; ".join(_offer(suggestion) for suggestion in suggestions)
    return InfeasibleError(
        f"no motion returns the slave in time: {words} (cut.length {cut.length * 1e3:g} mm at cut.line_speed "
        f"{cut.line_speed * 60:g} m/min, sync zone {cut.sync_zone * 1e3:g} mm). "
        + (f"What works, each alone: {offers}" if offers else "No single change of speed, length or limit works"),
        binding,
        excess,
        unit,
        suggestions,
    )


def is_feasible(machine: Machine, cut: Cut, limits: Limits) -> bool:
    """Tell whether some motion keeps the limits. A zone that the machine cannot be in sync over counts as infeasible."""
    if limits.motor is not None:
        return any(is_feasible(machine, cut, each) for each in motor_limits(machine, limits))
    try:
        problem = resolved(return_problem(machine, cut, limits, "peak_acceleration"))
    except InputError:
        return False
    if max(_sync_shares(machine, cut, problem).values()) > 1 + SOLVED:
        return False
    if _straight(problem):
        distance, speed = _correction(problem)
        if distance > ROUNDING * problem.length:
            if speed <= 0:
                return False
            reach = greatest_reach(problem.length, speed, problem.greatest_slope, problem.greatest_jerk)
            if reach < distance * (1 - ROUNDING):
                return False
        if _closed(problem) or _keeps_stroke(problem):
            return True
    return _margin(problem) <= 1 + SOLVED


def margin(machine: Machine, cut: Cut, limits: Limits) -> float:
    """Least common factor on the limits with which the machine can do the cut, sync zone and return; at most 1 if it can.

    Infinite where the machine cannot be in sync over the zone at all.
    """
    if limits.motor is not None:
        return min((margin(machine, cut, each) for each in motor_limits(machine, limits)), default=math.inf)
    try:
        problem = return_problem(machine, cut, limits, "peak_acceleration")
    except InputError:
        return math.inf
    return max(_margin(problem), *_sync_shares(machine, cut, problem).values())


def _margin(problem: ReturnProblem) -> float:
    """Least common factor for the return alone; infinite where the solver does not find one."""
    try:
        return limit_margin(problem)
    except SolverError:
        return math.inf


def _keeps_stroke(problem: ReturnProblem) -> bool:
    """Whether the softest motion over the line stays within the stroke, so that the closed form is the whole truth."""
    distance, room = _correction(problem)
    if distance <= ROUNDING * problem.length:
        return problem.least_position <= min(0.0, problem.height) and problem.greatest_position >= max(
            0.0, problem.height
        )
    acceleration = least_acceleration(distance, problem.length, room, problem.greatest_jerk)
    if not math.isfinite(acceleration):
        return False
    motion = in_time(distance, problem.length, room, acceleration, problem.greatest_jerk).profile()
    sign = 1.0 if problem.height > problem.start_ratio * problem.length else -1.0
    low, high = motion.scale(slave=sign).add_line(problem.start_ratio).extrema(0)
    return low.value >= problem.least_position and high.value <= problem.greatest_position


def _sync_shares(machine: Machine, cut: Cut, problem: ReturnProblem) -> dict[str, float]:
    """Shares of the limits that the sync zone itself uses."""
    ratio, slope, jerk = _sync_peaks(machine.sync_profile(cut))
    return {
        "speed": ratio / problem.greatest_ratio,
        "acceleration": slope / problem.greatest_slope,
        "jerk": jerk / problem.greatest_jerk,
    }


@lru_cache(maxsize=256)
def _sync_peaks(sync: CamProfile) -> tuple[float, float, float]:
    """Greatest ratio, ratio slope and its slope in a sync zone, as magnitudes."""
    slope, jerk = (max(abs(extremum.value) for extremum in sync.extrema(order)) for order in (2, 3))
    return sync.extrema(1)[1].value, slope, jerk


def _straight(problem: ReturnProblem) -> bool:
    """Whether the return is a straight line plus a motion from rest to rest."""
    return problem.start_ratio == problem.end_ratio and problem.start_slope == problem.end_slope == 0.0


def _closed(problem: ReturnProblem) -> bool:
    """Whether the closed forms of `profiles.reach` are the whole truth: straight, and no stroke to keep."""
    return _straight(problem) and math.isinf(problem.least_position) and math.isinf(problem.greatest_position)


def _correction(problem: ReturnProblem) -> tuple[float, float]:
    """Distance of the motion over the line (slave unit), and the ratio it may have over that of the line."""
    distance = problem.height - problem.start_ratio * problem.length
    room = problem.start_ratio - problem.least_ratio if distance < 0 else problem.greatest_ratio - problem.start_ratio
    return abs(distance), room


def needed_limits(machine: Machine, cut: Cut, limits: Limits) -> dict[str, float]:
    """Least value of each limit that would do, the others as they are (over time, slave unit); infinite where none does."""
    none = {"speed": math.inf, "acceleration": math.inf, "jerk": math.inf}
    limits = replace(limits, motor=None)
    try:
        problem = resolved(return_problem(machine, cut, limits, "peak_acceleration"))
    except InputError:
        return none
    v = cut.line_speed
    if _straight(problem) and not (math.isfinite(problem.greatest_position) and _reaches(problem)):
        distance, room = _correction(problem)
        over = least_speed(distance, problem.length, problem.greatest_slope, problem.greatest_jerk)
        backwards = problem.height < problem.start_ratio * problem.length
        # standing still is the end of what a slave can do without reversal; the rest is reversal at up to the speed limit
        ratio = over - problem.start_ratio if backwards else over + problem.start_ratio
        if backwards and not (limits.reversal or machine.turns_back):
            ratio = problem.greatest_ratio if ratio <= problem.greatest_ratio else math.inf
        if room <= 0:
            return none | {"speed": ratio * v}
        return {
            "speed": ratio * v,
            "acceleration": least_acceleration(distance, problem.length, room, problem.greatest_jerk) * v**2,
            "jerk": least_jerk(distance, problem.length, room, problem.greatest_slope) * v**3,
        }

    def eased(name: str) -> float:
        """Value of one limit alone that would do: where the common factor on all limits is 1."""
        low = getattr(limits, name)

        def factor(value: float) -> float:
            return margin(machine, cut, with_limit(limits, name, value))

        good = low * 4.0
        while factor(good) > 1.0:
            good *= 8.0
            if good > FREE * low:
                return math.inf
        return low if factor(low) <= 1.0 else margin_edge(factor, good, low)

    return {name: eased(name) for name in none}


def _reaches(problem: ReturnProblem) -> bool:
    """Whether the limits of speed, acceleration and jerk are enough for a straight return, the stroke left aside."""
    distance, room = _correction(problem)
    return room > 0 and greatest_reach(
        problem.length, room, problem.greatest_slope, problem.greatest_jerk
    ) >= distance * (1 - ROUNDING)


def binding_limit(machine: Machine, cut: Cut, limits: Limits, need: dict[str, float]) -> str:
    """Name the limit that binds: the one that would have to give least, were it the only one to give.

    Where no single limit would be enough it is the one whose release carries the slave furthest; ``"reversal"`` where a
    slave at its speed limit would have to run backwards; ``"sync_zone"`` where the machine cannot be in sync over the zone; ``"motor"``
    where the slave's own limits would do.
    """
    if limits.motor is not None:
        alone = replace(limits, motor=None)
        if is_feasible(machine, cut, alone):
            return "motor"
        limits = alone
    have = {"speed": limits.speed, "acceleration": limits.acceleration, "jerk": limits.jerk}
    share = {name: value / have[name] for name, value in need.items()}
    try:
        problem = return_problem(machine, cut, limits, "peak_acceleration")
    except InputError:
        return "sync_zone"
    if _straight(problem) and not _reaches(problem):
        _, room = _correction(problem)
        backwards = problem.height < problem.start_ratio * problem.length
        binding = min(share, key=lambda name: share[name])
        if not math.isfinite(share[binding]):
            room = max(room, ROUNDING)
            a, j = problem.greatest_slope, problem.greatest_jerk
            reach = {
                "speed": greatest_reach(problem.length, room * FREE, a, j),
                "acceleration": greatest_reach(problem.length, room, a * FREE, j),
                "jerk": greatest_reach(problem.length, room, a, j * FREE),
            }
            binding = max(reach, key=lambda name: reach[name])
        forced = backwards and not (limits.reversal or machine.turns_back) and math.isfinite(share["speed"])
        return "reversal" if binding == "speed" and forced else binding
    finite = {name: value for name, value in share.items() if math.isfinite(value)}
    if finite:
        return min(finite, key=lambda name: finite[name])
    if math.isfinite(problem.greatest_position):
        return "stroke"
    own = _sync_shares(machine, cut, problem)
    return max(own, key=lambda name: own[name])


def _words(
    binding: str, need: dict[str, float], machine: Machine, limits: Limits, cut: Cut
) -> tuple[float | None, str, str]:
    if binding == "reversal":
        return (
            None,
            "",
            f"limits.reversal = false binds, the slave would have to run backwards from {cut.line_speed * 60:g} m/min",
        )
    if binding == "motor":
        return None, "", "limits.motor binds, the motor gives too little torque at the speeds that are needed"
    if binding == "sync_zone":
        return None, "", "cut.sync_zone binds, the machine cannot be in sync over it"
    if binding == "stroke":
        return None, "", "machine.stroke binds, the carriage cannot turn round within it"
    factor, unit = _UNITS[machine.slave_unit][binding]
    limit, needed = getattr(limits, binding) * factor, need[binding] * factor
    if not math.isfinite(needed):
        return None, unit, f"limits.{binding} {limit:g} {unit} binds, and no other value of it alone would do"
    return (
        needed - limit,
        unit,
        (
            f"limits.{binding} binds, {needed:.6g} {unit} is needed, {limit:g} {unit} is the limit "
            f"({100 * (needed / limit - 1):.3g} % more than allowed)"
        ),
    )


def _suggest(machine: Machine, cut: Cut, limits: Limits, need: dict[str, float]) -> list[Suggestion]:
    """Nearest changes that work: line speed, cut length, each limit, reversal; each checked as it is written."""
    found: list[Suggestion] = []

    def offer(change: str, value: float, factor: float, unit: str, up: bool, works: Callable[[float], bool]) -> None:
        for digits in (SUGGESTED_DIGITS, SUGGESTED_DIGITS + 2, SUGGESTED_DIGITS + 5, 15):
            rounded = rounded_to(value * factor, digits, up)
            if works(rounded / factor):
                found.append(Suggestion(change, rounded, unit))
                return

    def at_speed(v: float) -> bool:
        return is_feasible(machine, replace(cut, line_speed=v), limits)

    def at_length(length: float) -> bool:
        return length > cut.sync_zone and is_feasible(machine, replace(cut, length=length), limits)

    exact = _exact(machine, cut)
    tolerance, aside = (0.0, 0.0) if exact else (EDGE, ASIDE)
    slow = 0.5 * cut.line_speed
    while slow > SLOWEST * cut.line_speed and not at_speed(slow):
        slow *= 0.5
    slower = edge(at_speed, slow, 2 * slow, tolerance)
    if slower is not None:
        offer("line_speed", slower * (1 - aside), 60.0, "m/min", False, at_speed)
    for length, up in _lengths_to_try(machine, cut):
        nearest = edge(at_length, length, cut.length, tolerance)
        if nearest is not None:
            offer("length", nearest * (1 + aside if up else 1 - aside), 1e3, "mm", up, at_length)
            break
    if isinstance(machine, LinearCarriage):
        longer = _stroke_needed(machine, cut, limits)
        if longer is not None:
            found.append(Suggestion("stroke", longer, "mm"))
    for name, value in need.items():
        if not math.isfinite(value) or value <= getattr(limits, name):
            continue
        factor, unit = _UNITS[machine.slave_unit][name]
        offer(name, value * (1 + aside), factor, unit, True, partial(_works_with, machine, cut, limits, name))
    if not (limits.reversal or machine.turns_back) and is_feasible(machine, cut, replace(limits, reversal=True)):
        found.append(Suggestion("reversal", 1.0, ""))
    return found


def _stroke_needed(machine: LinearCarriage, cut: Cut, limits: Limits) -> float | None:
    """Longer stroke (mm) with which the job works; None if no stroke helps."""

    def works(stroke: float) -> bool:
        return is_feasible(replace(machine, stroke=stroke), cut, limits)

    enough = edge(works, LONGEST_STROKE * machine.stroke, machine.stroke, EDGE)
    return None if enough is None else rounded_to(enough * (1 + ASIDE) * 1e3, SUGGESTED_DIGITS, up=True)


def _works_with(machine: Machine, cut: Cut, limits: Limits, name: str, value: float) -> bool:
    return is_feasible(machine, cut, with_limit(limits, name, value))


def with_limit(limits: Limits, name: str, value: float) -> Limits:
    """Change one limit: ``"speed"``, ``"acceleration"`` or ``"jerk"``."""
    changed = {"speed": limits.speed, "acceleration": limits.acceleration, "jerk": limits.jerk, name: value}
    return Limits(changed["speed"], changed["acceleration"], changed["jerk"], limits.reversal, limits.motor)


def _exact(machine: Machine, cut: Cut) -> bool:
    """Whether feasibility is a closed form for this machine, so that edges can be found to the last digit."""
    try:
        return not machine.turns_back and machine.sync_profile(cut).degree == 1
    except InputError:
        return False


def _lengths_to_try(machine: Machine, cut: Cut) -> list[tuple[float, bool]]:
    """Cut lengths at which the slave has an easy time, and whether they are longer than the job's.

    A knife has none to do where the cut is as long as its own arc; a carriage or crank has more time the longer the cut.
    """
    if machine.slave_unit == "m" and machine.pitch > 0:
        return [(machine.pitch / cut.sync_ratio, machine.pitch / cut.sync_ratio > cut.length)]
    return [(cut.length * factor, True) for factor in (2.0, 8.0, 64.0)]


def edge(works: Callable[[float], bool], good: float, bad: float, tolerance: float = 0.0) -> float | None:
    """Find the value nearest to ``bad`` that works, by bisection from ``good``; None if ``good`` does not work."""
    if not works(good):
        return None
    while abs(good - bad) > tolerance * abs(bad):
        middle = 0.5 * (good + bad)
        if middle in (good, bad):
            break
        if works(middle):
            good = middle
        else:
            bad = middle
    return good


def margin_edge(factor: Callable[[float], float], good: float, bad: float) -> float:
    """Find where the least common factor on the limits is 1, between a value that works and one that does not."""
    from scipy.optimize import brentq

    def over(x: float) -> float:
        return math.log(min(max(factor(x), 1e-6), 1e6)) - 1e-9

    at_good, at_bad = over(good), over(bad)
    if at_good >= 0 or at_bad <= 0:
        return good
    return float(brentq(over, good, bad, rtol=EDGE))


def rounded_to(value: float, digits: int, up: bool) -> float:
    """Round to a number of digits, up or down."""
    scale = 10.0 ** (digits - 1 - math.floor(math.log10(abs(value))))
    return (math.ceil(value * scale - 1e-6) if up else math.floor(value * scale + 1e-6)) / scale


def _offer(suggestion: Suggestion) -> str:
    place = {"line_speed": "cut.line_speed", "length": "cut.length", "stroke": "machine.stroke"}.get(
        suggestion.change, f"limits.{suggestion.change}"
    )
    if suggestion.change == "reversal":
        return f"{place} = true"
    return f'{place} = "{suggestion.value:.15g} {suggestion.unit}"'
