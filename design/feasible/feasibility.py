"""Whether a job can be done at all, what each limit would have to be, and which limit binds.

Whether a return is possible is a closed form for every machine (`camwright.design.returns.possible`), so the edges of what is possible
are found by
bisection.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache

from camwright.design.returns.curve_limits import motor_limits
from camwright.design.returns.possible import is_possible
from camwright.design.returns.problem import ReturnProblem, return_problem
from camwright.design.returns.scaling import resolved
from camwright.profiles.closed_forms.overshoot import least_overshoot
from camwright.profiles.closed_forms.transfer import Bounds
from camwright.profiles.errors import InputError
from camwright.profiles.halving import halved
from camwright.profiles.limits import Limits
from camwright.profiles.machines import Machine
from camwright.profiles.task import Task

LIMIT_NAMES = ("speed", "acceleration", "jerk")
# The sync zone may use this much more than a limit: rounding.
ALLOWED = 1e-9
# Edges are found to this share.
EDGE = 1e-12
# The least peak is found to this share.
PEAK = 1e-6
# "Unlimited", as a multiple of the limit.
FREE = 1e6
# The shortest cut is looked for up to this multiple of its sync zone.
LONGEST = 1024.0
# A search for an edge starts with steps of this factor.
STRIDE = 4.0


@dataclass(frozen=True)
class Demand:
    """A return and its sync zone over the master, to be held against limits that are multiples of those given.

    Parameters
    ----------
    shares
        Shares of the limits of speed, acceleration and jerk that the sync zone uses.
    """

    problem: ReturnProblem
    shares: tuple[float, float, float]

    def met(
        self, speed: float = 1.0, acceleration: float = 1.0, jerk: float = 1.0, length: float | None = None
    ) -> bool:
        """Tell whether limits that are these multiples of the given ones are kept by some motion, in a return of another length (m)."""
        of_speed, of_acceleration, of_jerk = self.shares
        if (
            of_speed > speed * (1 + ALLOWED)
            or of_acceleration > acceleration * (1 + ALLOWED)
            or of_jerk > jerk * (1 + ALLOWED)
        ):
            return False
        given = self.problem
        # dataclasses.replace takes several times as long, and this is asked thousands of times
        problem = ReturnProblem(
            given.length if length is None else length,
            given.height,
            given.start_ratio,
            given.end_ratio,
            given.start_slope,
            given.end_slope,
            given.least_ratio * speed,
            given.greatest_ratio * speed,
            given.greatest_slope * acceleration,
            given.greatest_jerk * jerk,
            given.objective,
            given.least_position,
            given.greatest_position,
        )
        return is_possible(resolved(problem))


@lru_cache(maxsize=32)  # a design asks, and then what is possible beside it
def demands(task: Task) -> tuple[Demand, ...]:
    """Make a job's demand on each of the limits that its motor's curve stands for.

    There is none where the machine cannot be in sync at all, or no return zone is left.
    """
    found = []
    if task.cut.return_zone <= 0.0:
        return ()
    for each in motor_limits(task.machine, task.limits):
        try:
            problem = return_problem(task.with_limits(each), "peak_acceleration")
            ratio, slope, jerk = task.sync.extrema(1)[1].value, task.sync.peak(2), task.sync.peak(3)
        except InputError:
            return ()
        shares = (ratio / problem.greatest_ratio, slope / problem.greatest_slope, jerk / problem.greatest_jerk)
        found.append(Demand(problem, shares))
    return tuple(found)


def is_feasible(task: Task) -> bool:
    """Tell whether some motion keeps the limits. A zone that the machine cannot be in sync over counts as infeasible."""
    return any(demand.met() for demand in demands(task))


def feasible_lengths(*tasks: Task) -> Callable[[float], bool]:
    """Give what tells of a cut length (m) whether some motion of one of some tasks keeps the limits, as `is_feasible` of that length.

    A sync zone is the same at every cut length, so the demands are made once.
    """
    asked = [(demand, task.cut.sync_zone) for task in tasks for demand in demands(task)]
    return lambda length: any(length > zone and demand.met(length=length - zone) for demand, zone in asked)


def shortest_length(task: Task) -> float | None:
    """Shortest cut length (m) with which some motion keeps the limits, as `feasible_lengths`; None if none up to `LONGEST` zones is known.

    It is the same whatever the task's own cut length, so tasks that differ in nothing else share it.
    """
    asked = tuple(Demand(replace(demand.problem, length=1.0), demand.shares) for demand in demands(task))
    return _shortest(asked, task.cut.sync_zone)


@lru_cache(maxsize=256)
def _shortest(asked: tuple[Demand, ...], zone: float) -> float | None:
    def works(length: float) -> bool:
        return any(demand.met(length=length - zone) for demand in asked)

    good = 2.0 * zone
    while not works(good):
        good *= 2.0
        if good > LONGEST * zone:
            return None
    return halved(works, good, 0.5 * good)[0]


def margin(task: Task) -> float:
    """Least common factor on the limits with which the machine can do the cut, sync zone and return; at most 1 if it can.

    Infinite where the machine cannot be in sync over the zone at all, or where no limits would be enough.
    """
    found = [least_factor(lambda f, each=demand: each.met(f, f, f)) for demand in demands(task)]  # type: ignore[misc]
    return min(found, default=math.inf)


def least_limit(task: Task, name: str) -> float:
    """Least value of one limit that is enough for sync zone and return, the others as they are; infinite if the given one is not enough."""
    place = LIMIT_NAMES.index(name)
    found = [
        least_factor(lambda f, each=demand: f <= 1.0 and each.met(*(f if k == place else 1.0 for k in range(3))), PEAK)  # type: ignore[misc]
        for demand in demands(task)
        if demand.met()
    ]
    return float(getattr(task.limits, name)) * min(found, default=math.inf)


def slowdown(task: Task, tolerance: float = EDGE) -> float:
    """Greatest factor on the line speed with which the machine can do the cut; zero if it cannot at any speed.

    Zones that last a time grow with the line speed, so each factor is then a cut of its own; else it is a factor on the limits.
    """
    cut = task.cut
    if cut.timed:
        return 1.0 / least_factor(lambda f: is_feasible(task.designed_at(cut.line_speed / f)), tolerance)
    found = [
        least_factor(lambda f, each=demand: each.met(f, f**2, f**3), tolerance)  # type: ignore[misc]
        for demand in demands(task)
    ]
    return 1.0 / min(found, default=math.inf)


def least_factor(works: Callable[[float], bool], tolerance: float = EDGE) -> float:
    """Least positive factor that works, where all greater ones do too; infinite if none up to `FREE` does."""
    good = bad = 1.0
    if works(1.0):
        while works(bad / STRIDE):
            good = bad = bad / STRIDE
            if bad < 1 / FREE:
                return bad
        bad /= STRIDE
    else:
        while not works(good * STRIDE):
            good = bad = good * STRIDE
            if good > FREE:
                return math.inf
        good *= STRIDE
    found = edge(works, good, bad, tolerance)
    return math.inf if found is None else found


def needed_limits(task: Task, tolerance: float = EDGE) -> dict[str, float]:
    """Least value of each limit that would do, the others as they are (over time, slave unit), infinite where none does.

    Where a guide holds the slave in also its length, the ``"stroke"`` (slave unit).

    Parameters
    ----------
    task
        The job.
    tolerance
        Share to which a limit is found.
    """
    limits = task.limits
    asked = demands(task)

    def works(name: str, factor: float) -> bool:
        if limits.motor is None:  # then a limit's factor is its demand's
            return any(demand.met(**{name: factor}) for demand in asked)
        return is_feasible(task.with_limits(with_limit(limits, name, float(getattr(limits, name)) * factor)))

    def alone(name: str) -> float:
        return float(getattr(limits, name)) * least_factor(lambda f: f >= 1.0 and works(name, f), tolerance)

    need = {name: alone(name) for name in LIMIT_NAMES}
    if task.machine.guide is not None:
        need["stroke"] = _stroke_needed(task)
    return need


def _stroke_needed(task: Task) -> float:
    """Least stroke with which the job works (slave unit); infinite if none does."""
    travel = task.sync.advance
    wide = task.machine.with_guide(max(stroke_of(task.machine), 2 * travel))
    found = math.inf
    for demand in demands(task.with_machine(wide)):
        problem = resolved(demand.problem)
        bounds = Bounds(problem.least_ratio, problem.greatest_ratio, problem.greatest_slope, problem.greatest_jerk)
        beyond = least_overshoot(problem.length, problem.start_ratio, -problem.height, bounds)
        if beyond is not None and max(demand.shares) <= 1 + ALLOWED:
            found = min(found, travel + 2 * beyond.distance)
    return found


def binding_limit(task: Task, need: dict[str, float]) -> str:
    """Name the limit that binds: the one that would have to give least, were it the only one to give.

    Where no single limit would be enough it is the one whose release helps most; ``"reversal"`` where running backwards would be
    enough; ``"sync_zone"`` where the machine cannot be in sync over the zone; ``"motor"`` where the slave's own limits would do.

    Parameters
    ----------
    need
        What `needed_limits` says.
    """
    if task.limits.motor is not None:
        task = task.with_limits(replace(task.limits, motor=None))
        if is_feasible(task):
            return "motor"
        need = needed_limits(task)
    limits = task.limits
    if not demands(task):
        return "sync_zone"
    if not task.reverses and is_feasible(task.with_limits(replace(limits, reversal=True))):
        return "reversal"
    share = {name: value / _have(task, name) for name, value in need.items()}
    binding = min(share, key=lambda name: share[name])
    if math.isfinite(share[binding]):
        return binding
    rest = {
        name: margin(task.with_limits(with_limit(limits, name, FREE * getattr(limits, name)))) for name in LIMIT_NAMES
    }
    return min(rest, key=lambda name: rest[name])


def stroke_of(machine: Machine) -> float:
    """Length of the guide that holds the slave in (slave unit); infinite where there is none."""
    return math.inf if machine.guide is None else machine.guide[1] - machine.guide[0]


def _have(task: Task, name: str) -> float:
    return stroke_of(task.machine) if name == "stroke" else float(getattr(task.limits, name))


def with_limit(limits: Limits, name: str, value: float) -> Limits:
    """Change one limit: ``"speed"``, ``"acceleration"`` or ``"jerk"``."""
    changed = {"speed": limits.speed, "acceleration": limits.acceleration, "jerk": limits.jerk, name: value}
    return Limits(changed["speed"], changed["acceleration"], changed["jerk"], limits.reversal, limits.motor)


def edge(works: Callable[[float], bool], good: float, bad: float, tolerance: float = 0.0) -> float | None:
    """Find the value nearest to ``bad`` that works, by bisection from ``good``; None if ``good`` does not work."""
    if not works(good):
        return None
    return halved(works, good, bad, tolerance)[0]
