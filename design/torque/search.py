"""The search for the return of least torque or energy: starts that differ in kind, the mesh refined, the best kept."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from camwright.design.returns.measures import ALLOWED_EXCESS, excess
from camwright.design.returns.problem import ReturnProblem
from camwright.design.returns.scaling import scale_problem
from camwright.design.returns.solver import solve_return
from camwright.design.torque.finish import finish
from camwright.design.torque.guesses import (
    ANYHOW,
    FORWARDS,
    TURNING,
    family_of,
    from_path,
    from_profile,
    resting,
    turning,
    turning_from,
)
from camwright.design.torque.mesh import paces, remesh
from camwright.design.torque.peaks import ABOVE, drawn_between, peaks, sharpened
from camwright.design.torque.programme import MOST_ITERATIONS, Guess, TorqueAnswer, TorqueProgramme
from camwright.design.torque.task import ROOTS, Pattern, TorqueTask
from camwright.profiles.errors import SolverError
from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.profiles.returns import quintic_between
from camwright.profiles.task import Task

FIRST = 60
"""Intervals of the first look, all phases together."""
SECOND = 120
"""Intervals of the second look, at the best of the first."""
LADDER = (200, 300, 450, 675, 1000, 1500)
"""Intervals of the meshes on which the best of these is taken further, until the objective settles: hardly any but a slave that nearly
coasts, whose torque is what its mesh leaves over, goes beyond the second."""
PEAK_RUNGS = 2
"""Of these for a peak, which intervals divided where it hides bring down further than finer meshes do; none for one at its floor."""
GIVEN = 300
"""Intervals on which a return that is given is measured."""
SETTLED, SHRINKS = 1e-4, 0.45
"""Share of the cycle's objective that a finer mesh must promise to gain to be tried, and the share of the last one's gain that it promises:
it is finer by a half, and the error falls with the square of that."""
AGREEMENT = 1e-2
"""Starts whose objectives on their first meshes differ by less than this share are as good as each other, whatever their motions."""
NEAR = 0.25
"""Answers within this share of the best on the first mesh are taken further, one of each motion."""
MOST_PATHS = 4
"""Returns along the path that are started from."""
MOST_TAKEN = 3
"""Answers that are taken further."""
ONE_MOTION, ONE_EXACTLY, LOOKS = 0.15, 0.03, 101
"""Share of the greatest velocity by which motions differ that are two, for a root mean square and for all others, whose valleys are flat or
have corners; and the times at which they are looked at."""
PATIENCE = 100
"""Most iterations of a first look."""
TURNING_SHARE = 0.5
"""Share of its ratio in sync at which a return that is started from may run backwards where the slave may not."""
AT_FLOOR = 1e-2
"""A peak beyond this share of its floor on a mesh does not reach it on a finer one."""
REACHED = 1e-6
"""A peak within this share of its floor is the floor."""
ZONE_PLACES = 1001
"""Places of the sync zone at which its torque is looked at."""
SAME = 1e-7
"""Peaks that differ by less than this share are the same; the last found is the smoothest."""


_Given = Callable[[], Sequence[CamProfile]]
"""Returns to start from, not made before they are asked for."""


@dataclass(frozen=True, eq=False)
class TorqueSolution:
    """Best of several starts.

    Parameters
    ----------
    back
        The return over ``[0, length]`` from slave zero.
    value
        Its objective at the slave: root mean square or peak (N or N·m), or mean power drawn (W), over the return.
    starts, agreeing
        How many starts converged, and how many of them to the motion of the best, or to one as good. Each has a mesh of its own at first,
        whose error may be some per cent of the objective: so one motion need not have one value.
    spread
        Greatest objective over least, less one, of the starts that converged, each on its first mesh.
    residual
        Largest KKT residual of the best (scaled).
    iterations
        Iterations of IPOPT, all starts together.
    """

    back: CamProfile
    value: float
    spread: float
    starts: int
    agreeing: int
    residual: float
    iterations: int


def solve_torque(
    task: TorqueTask,
    keeps: Callable[[CamProfile], bool] | None = None,
    starts: Sequence[CamProfile] = (),
    floor: float = 0.0,
) -> TorqueSolution:
    """Find the return of least torque or energy, of least load, or the least of another objective within the motor's curve.

    Parameters
    ----------
    task
        What is asked.
    keeps
        What a return must fulfil besides its limits.
    starts
        Returns to start from, beside those of every search.
    floor
        Peak that the sync zone has anyhow, at the slave: no lower one is looked for, but the least mean square under it.

    Raises
    ------
    SolverError
        No start converged to a motion that keeps the limits.
    """

    @cache
    def profiles() -> Sequence[CamProfile]:
        return starts or [solve_return(replace(task.problem, objective="rms_acceleration"))[0]]

    first, iterations = _first_looks(task, profiles, floor)
    accepted = keeps or (lambda _: True)
    found: list[tuple[float, CamProfile, float]] = []

    def keep(answer: TorqueAnswer, pattern: Pattern) -> None:
        back = finish(answer.guess, pattern, task)
        if _keeps_limits(back, task) and accepted(back):
            found.append((max(_value(task, answer, pattern), floor), back, answer.residual))

    alike = ONE_MOTION if task.aim in ROOTS else ONE_EXACTLY
    taken, second, agreeing = _distinct(first, alike), list[tuple[TorqueAnswer, Pattern]](), 0
    for answer, pattern in taken:
        finer = _finer(task, pattern, answer, SECOND, floor)
        iterations += finer.iterations
        second.append((finer if finer.success else answer, pattern))
        keep(*second[-1])
    if second:
        best = min(range(len(second)), key=lambda at: second[at][0].value)
        answer, pattern = second[best]
        agreeing = _agreeing(first, taken[best], alike)
        iterations += _taken_further(task, pattern, answer, floor, keep)
    found += [entry for entry in _given(task, starts if found else profiles()) if accepted(entry[1])]
    if not found:
        raise SolverError(
            f"IPOPT found no return of least {task.aim} from any start, although the limits can be kept; minimise peak_acceleration or "
            f"rms_acceleration instead"
        )
    least = min(entry[0] for entry in found)
    value, back, residual = [entry for entry in found if entry[0] <= least * (1 + SAME)][-1]
    return TorqueSolution(back, value, _spread(first), len(first), agreeing, residual, iterations)


def _agreeing(first: list[tuple[TorqueAnswer, Pattern]], best: tuple[TorqueAnswer, Pattern], alike: float) -> int:
    """How many answers of the first look, the best value first, are as good as that, or one motion with the best."""
    as_good = first[0][0].value * (1 + AGREEMENT)
    return sum(entry[0].value <= as_good or _apart(best, entry) <= alike for entry in first)


def _spread(first: list[tuple[TorqueAnswer, Pattern]]) -> float:
    """Greatest value over least, less one, of the answers of the first look."""
    values = [answer.value for answer, _ in first]
    return values[-1] / values[0] - 1.0 if values and values[0] > 0 else 0.0


def _taken_further(
    task: TorqueTask,
    pattern: Pattern,
    answer: TorqueAnswer,
    floor: float,
    keep: Callable[[TorqueAnswer, Pattern], None],
) -> int:
    """Take an answer to finer meshes until it settles, then divide intervals where its peak hides; the iterations."""
    iterations, zone = 0, _zone_share(task)
    rungs = len(LADDER)
    if task.aim == "peak_torque":
        rungs = 0 if answer.value <= floor * (1 + REACHED) else PEAK_RUNGS
    for count in LADDER[:rungs]:
        finer = _finer(task, pattern, answer, count, floor)
        iterations += finer.iterations
        if not finer.success:
            break
        keep(finer, pattern)
        reached = _of_cycle(_value(task, finer, pattern), zone)
        gained = _of_cycle(_value(task, answer, pattern), zone) - reached
        answer = finer
        if SHRINKS * gained < SETTLED * reached:
            break
    for above in ABOVE if task.aim == "peak_torque" else ():
        guess = sharpened(answer.guess, pattern, task, max(answer.value, floor), above)
        if guess is None:
            continue
        finer = _solved(task, pattern, guess, answer.value, floor)
        iterations += finer.iterations
        if not finer.success:
            break
        keep(finer, pattern)
        answer = finer
    return iterations


def _first_looks(task: TorqueTask, profiles: _Given, floor: float) -> tuple[list[tuple[TorqueAnswer, Pattern]], int]:
    """Answers of a first look, of one that takes longer or of one on a finer mesh, whichever has any, and the iterations of all."""
    first, iterations = _first_look(task, profiles, FIRST, floor)
    # the limits of a motion can be kept, but maybe not so soon, or on so coarse a mesh
    for count in (FIRST, SECOND) if task.curve is None else ():
        if not first:
            first, more = _first_look(task, profiles, count, floor, MOST_ITERATIONS)
            iterations += more
    return first, iterations


def _first_look(
    task: TorqueTask, profiles: _Given, count: int, floor: float, patience: int = PATIENCE
) -> tuple[list[tuple[TorqueAnswer, Pattern]], int]:
    """Answers of the guesses of every kind on a mesh of a number of intervals, the best first, and the iterations of all."""
    answers: list[tuple[TorqueAnswer, Pattern]] = []
    for pattern, guess in _guesses(task, profiles, count):
        # a start that takes long has none of the best ends, and its iterations are slow ones: a Hessian that must be corrected each time
        answer = _programme(task, pattern, guess, patience).solve(guess, rough=True, floor=floor)
        answers.append((answer, pattern))
        if answer.success and answer.value <= floor * (1 + REACHED):
            break  # none goes below its floor
    good = sorted((entry for entry in answers if entry[0].success), key=lambda entry: entry[0].value)
    return good, sum(answer.iterations for answer, _ in answers)


def zone_peak(task: Task) -> float:
    """Greatest magnitude of the torque or force that the sync zone asks for, at the slave."""
    return float(np.abs(_zone_force(task)[1]).max())


def _zone_force(task: Task) -> tuple[FloatArray, FloatArray]:
    """Places of the sync zone, and the torque or force there, at the slave."""
    x = np.linspace(task.sync.start, task.sync.end, ZONE_PLACES)
    v, machine, y = task.cut.line_speed, task.machine, task.slave_at_sync_start + task.sync(x)
    inertial = machine.inertia(y) * task.sync(x, 2) + machine.inertia_slope(y) * task.sync(x, 1) ** 2 / 2
    return x, v**2 * inertial + machine.friction


def _zone_share(task: TorqueTask) -> tuple[float, int]:
    """Give what the sync zone adds to the aim, as if it were the return's own, and the power in which both add up; nothing to a peak."""
    x, force = _zone_force(task.task)
    match task.aim:
        case "rms_torque":
            return math.sqrt(float(np.trapezoid(force**2, x)) / task.problem.length), 2
        case "energy":
            power = force * task.task.sync(x, 1) * task.cut.line_speed
            return float(np.trapezoid(np.maximum(power, 0.0), x)) / task.problem.length, 1
        case _:
            return 0.0, 1


def _of_cycle(value: float, zone: tuple[float, int]) -> float:
    """Aim over the cycle, as a multiple of that over the return."""
    share, power = zone
    return float((value**power + share**power) ** (1 / power))


def _finer(task: TorqueTask, pattern: Pattern, answer: TorqueAnswer, count: int, floor: float) -> TorqueAnswer:
    """Solve again on a finer mesh."""
    parts = len(answer.guess.mesh)
    guess = remesh(answer.guess, pattern, (count // parts,) * parts, task.aim)
    return _solved(task, pattern, guess, answer.value, floor)


def _solved(task: TorqueTask, pattern: Pattern, guess: Guess, value: float, floor: float) -> TorqueAnswer:
    """Solve from a guess that has about a value; where the floor of a peak can be had, for the least mean square under it.

    Under a floor that the mesh does not reach the solver finds no end, so it is asked for the peak first.
    """
    programme = _programme(task, pattern, guess)
    answer = None
    if value > floor * (1 + REACHED):
        answer = programme.solve(guess, floor=floor)
        if value > floor * (1 + AT_FLOOR) or (answer.success and answer.value > floor * (1 + REACHED)):
            return answer
        guess = answer.guess if answer.success else guess
    under = programme.solve(guess, ceiling=floor)
    return under if under.success else answer or programme.solve(guess, floor=floor)


def _value(task: TorqueTask, answer: TorqueAnswer, pattern: Pattern) -> float:
    """Objective of an answer; a peak is looked for between the programme's points too, and what is drawn there."""
    if task.aim == "peak_torque":
        return float(peaks(answer.guess, pattern, task).max())
    return drawn_between(answer.guess, pattern, task) if task.aim == "energy" else answer.value


def _programme(task: TorqueTask, pattern: Pattern, guess: Guess, iterations: int = MOST_ITERATIONS) -> TorqueProgramme:
    return TorqueProgramme(task, pattern, tuple(len(mesh) for mesh in guess.mesh), iterations=iterations)


def _distinct(answers: list[tuple[TorqueAnswer, Pattern]], alike: float) -> list[tuple[TorqueAnswer, Pattern]]:
    """Best of the answers whose motions are alike, if not far above the best of all."""
    kept: list[tuple[TorqueAnswer, Pattern]] = []
    for entry in answers:
        if len(kept) == MOST_TAKEN or entry[0].value > answers[0][0].value * (1 + NEAR):
            break
        if not any(_apart(entry, other) <= alike for other in kept):
            kept.append(entry)
    return kept


def _apart(entry: tuple[TorqueAnswer, Pattern], other: tuple[TorqueAnswer, Pattern]) -> float:
    """By how much the velocities of two motions differ at most, as a share of the first one's greatest; infinite between patterns."""
    if entry[1] != other[1]:
        return math.inf
    times = np.linspace(0.0, 1.0, LOOKS)
    one, two = (paces(answer.guess, pattern, times) for answer, pattern in (entry, other))
    return float(np.abs(two - one).max()) / max(float(np.abs(one).max()), 1e-300)


def _given(task: TorqueTask, starts: Sequence[CamProfile]) -> list[tuple[float, CamProfile, float]]:
    """Give the returns started from, as answers: what is found is at least as good as the best of them."""
    kept = []
    for back in starts:
        if _keeps_limits(back, task):
            guess = from_profile(back, task, GIVEN)
            value = (
                float(peaks(guess, ANYHOW, task).max())
                if task.aim == "peak_torque"
                else _programme(task, ANYHOW, guess).value(guess)
            )
            kept.append((value, back, 0.0))
    return kept


def _keeps_limits(back: CamProfile, task: TorqueTask) -> bool:
    """Tell whether a return keeps its limits and meets its ends, exactly."""
    problem, scale = task.problem, task.signed_scale
    unit = back.add_line(-problem.start_ratio).scale(master=1.0 / problem.length, slave=1.0 / scale)
    unit = CamProfile(np.append(unit.breaks[:-1], 1.0), unit.coefficients.copy())
    return excess(unit, scale_problem(problem, scale)) <= ALLOWED_EXCESS


def _turns(back: CamProfile, problem: ReturnProblem) -> bool:
    """Tell whether a return turns although it may not, by more than a good start may miss."""
    return problem.least_ratio >= 0.0 and back.extrema(1)[0].value < -TURNING_SHARE * problem.start_ratio


def _profiles(task: TorqueTask, given: _Given) -> Iterator[CamProfile]:
    """Quintic and the returns given, these not before they are asked for."""
    quintic = quintic_between(task.task.sync, task.problem.length, task.problem.height)
    # where the slave may not turn, one that would is no start: the solver wanders from it
    if not _turns(quintic, task.problem):
        yield quintic
    yield from given()


def _guesses(task: TorqueTask, given: _Given, count: int) -> Iterator[tuple[Pattern, Guess]]:
    """Guesses of every kind that the task has, and from the returns given, on a mesh of a number of intervals."""
    rubs = task.machine.friction > 0
    turns = rubs and task.may_turn  # where friction counts its sign must be known
    one_way = FORWARDS if turns else ANYHOW
    for profile in _profiles(task, given):
        yield one_way, from_profile(profile, task, count)
    family = family_of(task)
    if family is not None:
        for k in family.valleys()[:MOST_PATHS]:
            yield one_way, from_path(family, k, task, count)
    if rubs:
        yield from resting(task, count // 2)
    if turns:
        yield from turning(task, count // 3)
    if turns or task.problem.height < 0:
        # where it turns a slave is at rest, so a stroke that it may not leave is kept there exactly
        for profile in _profiles(task, given):
            turned = turning_from(profile, task, count // 3)
            if turned is not None:
                yield TURNING[0], turned
