"""Where the sync zone should lie, by the objective itself: a scan over all places, then the place as one more unknown."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from camwright.design.feasible.feasibility import is_feasible
from camwright.design.place import Placement, can_be_carried
from camwright.design.returns.problem import return_problem
from camwright.design.torque.finish import finish
from camwright.design.torque.guesses import ANYHOW, from_path
from camwright.design.torque.mesh import remesh
from camwright.design.torque.parts import greatest_share, zone_floors
from camwright.design.torque.path_starts import PathStarts, path_starts
from camwright.design.torque.programme import Guess, TorqueAnswer, TorqueProgramme
from camwright.design.torque.task import ROOTS, Aim, TorqueTask
from camwright.design.torque.zone import Zone
from camwright.profiles.machines import Machine
from camwright.profiles.motor import MotorCurve
from camwright.profiles.polynomial.profile import FloatArray
from camwright.profiles.task import Task

PLACES = 24
"""Places looked at first, evenly over the range that leaves room for the sync zone."""
LEAST_PLACES = 3
"""Places with a smooth sync zone that a scan needs."""
MARGIN = 0.01
"""Share of that range kept free at both ends: at a dead centre the crank would need infinite speed."""
COARSE, FINE, FINEST = 40, 120, 300
"""Intervals of the scan, of the search about its best places, and of the last look, where a finer mesh is no better laid."""
SETTLED = 1e-3
"""Share by which a finer mesh must be below the coarse one for another to be laid."""
STILL = 5e-3
"""Move of the place from mesh to mesh (rad) below which no other is laid: about a round valley the objective changes with its square."""
SCANNED = 1e-3
"""Accuracy of the solver on the scan, scaled: it tells valleys, whose floors are then looked for."""
EDGE = 1e-6
"""Accuracy of the places beyond which no motion keeps the limits (rad)."""
APART = 0.02
"""Places that differ by less are one (rad)."""
NEAR = 0.05
"""Valleys within this share of the best on the scan are gone down."""
PATHS = 2
"""Returns along the path that are started from at each place."""
OFF = 0.15
"""Share by which the best return along the path may cost more than the best of all: of 17 random cranks it costs 8 % more at most."""
HALVINGS = 60


def place_by_objective(task: Task, aim: Aim, curve: MotorCurve | None = None) -> Placement | None:
    """Place the sync zone where the objective of the whole cycle is least; None where no place has a motion on the scan's mesh.

    Parameters
    ----------
    task
        The machine, its cut and the slave's limits; their motor counts for nothing here.
    aim
        What is minimised.
    curve
        What the motor can give, in the sync zone too; None where that is no limit.

    Raises
    ------
    InputError
        The sync zone fits nowhere.
    """
    least, greatest = task.machine.place_range(task.cut)
    room = MARGIN * (greatest - least)
    looked = np.linspace(least + room, greatest - room, PLACES)
    looked = np.sort(np.concatenate([looked, _edges(task, looked)]))
    tasks = [placed for placed in (task.placed_at(float(place)) for place in looked) if can_be_carried(placed)]
    if len(tasks) < LEAST_PLACES:
        return None
    places = np.array([placed.machine.place for placed in tasks])
    starts = np.array([each.slave_at_sync_start for each in tasks])
    ends = np.array([each.slave_at_sync_end for each in tasks])
    middle = TorqueTask(tasks[len(tasks) // 2], return_problem(tasks[len(tasks) // 2], "peak_acceleration"), aim, curve)
    zone = Zone(((float(starts[0]), float(ends[0])), (float(starts[-1]), float(ends[-1]))))
    answers, floors = _scan(middle, zone, starts, ends)
    valleys = [
        k
        for k, answer in sorted(answers.items())
        if all(
            answer.value <= (answers[other].value if other in answers else floors[other])
            for other in _beside(k, floors)
        )
    ]
    best = min((answers[k].value for k in valleys), default=np.inf)
    found_valleys: list[TorqueAnswer] = []
    down = _Descent(middle, zone)
    for k in sorted(valleys, key=lambda k: answers[k].value):
        if answers[k].value > best * (1 + NEAR):
            break
        found_valleys.append(down.floor(answers[k]))
    if not found_valleys:
        return None
    deepest = min(found_valleys, key=lambda answer: answer.value)
    placed = task.placed_at(_middle(task.machine, deepest))
    apart = {round(_middle(task.machine, answer) / APART) for answer in found_valleys}
    apart |= {round(float(places[k]) / APART) for k in valleys if answers[k].value > best * (1 + NEAR)}
    if aim not in ROOTS:  # a peak has another least on each mesh, and an energy is flat: to search from it is no gain
        return Placement(placed, deepest.value, len(apart))
    found = TorqueTask(placed, return_problem(placed, "peak_acceleration"), aim, curve)
    return Placement(placed, deepest.value, len(apart), finish(deepest.guess, ANYHOW, found))


def _edges(task: Task, places: FloatArray) -> list[float]:
    """Places just inside those beyond which no motion keeps the limits, between neighbouring places: there the objective may be least."""

    def feasible(place: float) -> bool:
        placed = task.placed_at(place)
        return can_be_carried(placed) and is_feasible(placed)

    able = [feasible(float(place)) for place in places]
    found = []
    for k in range(len(places) - 1):
        if able[k] == able[k + 1]:
            continue
        inside, outside = (float(places[k]), float(places[k + 1]))[:: 1 if able[k] else -1]
        while abs(outside - inside) > EDGE:
            middle = 0.5 * (inside + outside)
            inside, outside = (middle, outside) if feasible(middle) else (inside, middle)
        found.append(inside)
    return found


class _Descent:
    """The way down to the floor of a valley: the place is one more unknown, on the scan's mesh, then on a finer one."""

    def __init__(self, middle: TorqueTask, zone: Zone) -> None:
        self._middle, self._zone = middle, zone

    def floor(self, answer: TorqueAnswer) -> TorqueAnswer:
        """Best answer about one at a place of the scan; of finer meshes the second is laid where the first still told."""
        coarse = self._beside(answer, COARSE)
        first = self._beside(coarse, FINE)
        moved = abs(_middle(self._middle.machine, first) - _middle(self._middle.machine, coarse))
        if first.value >= coarse.value * (1 - SETTLED) or moved < STILL:
            return first
        second = self._beside(first, FINE if self._middle.aim in ROOTS else FINEST)
        return second if second.value <= first.value * (1 + SETTLED) else first  # else that of another valley

    def _beside(self, answer: TorqueAnswer, count: int) -> TorqueAnswer:
        """Answer about one on a mesh laid for it, or on its own where that is as good and as fine; that one if there is none."""
        aim, same = self._middle.aim, count == len(answer.guess.mesh[0])
        guess = answer.guess if same and aim not in ROOTS else remesh(answer.guess, ANYHOW, (count,), aim)
        found = TorqueProgramme(self._middle, ANYHOW, (count,), self._zone, near=True).solve(guess)
        return found if found.success else answer


def _middle(machine: Machine, answer: TorqueAnswer) -> float:
    """Slave coordinate at which the tool is at mid sync zone."""
    assert answer.guess.ends is not None  # noqa: S101 - a placing programme's answer has them
    low, high = answer.guess.ends
    middle = 0.5 * (float(machine.tool(low)) + float(machine.tool(high)))
    for _ in range(HALVINGS):
        at = 0.5 * (low + high)
        low, high = (at, high) if float(machine.tool(at)) < middle else (low, at)
    return 0.5 * (low + high)


def _scan(
    task: TorqueTask, zone: Zone, starts: FloatArray, ends: FloatArray
) -> tuple[dict[int, TorqueAnswer], FloatArray]:
    """Best answers with the zone at places, and what the zone itself costs at each.

    None is looked for where the zone breaks a limit, or costs far more than the best.
    """
    programme = TorqueProgramme(task, ANYHOW, (COARSE,), zone, SCANNED)
    pairs = list(zip(starts.tolist(), ends.tolist(), strict=True))
    able = greatest_share(task, zone, starts, ends) <= 1.0
    floors = np.full(len(pairs), np.inf)
    floors[able] = zone_floors(task, zone, starts[able], ends[able])
    paths = _Paths(task, pairs, floors)
    # the place that seems best goes first, so that dear ones need not be looked at
    while able.any() and not paths.knows(first := int(np.argmin(paths.floors))):
        paths.guesses(first)
    answers: dict[int, TorqueAnswer] = {}
    best = np.inf
    for k in (int(np.argmin(paths.floors)), *np.nonzero(able)[0].tolist()):
        if k in answers or paths.floors[k] > best * (1 + NEAR):
            continue
        guesses = paths.guesses(k)
        if paths.floors[k] > best * (1 + NEAR):
            continue
        # to a smooth objective the neighbour's answer leads no other way where the path has one valley
        if k - 1 in answers and not (task.aim == "rms_torque" and len(guesses) == 1):
            guesses = [*guesses, answers[k - 1].guess]
        found = [programme.solve(replace(guess, ends=pairs[k]), rough=True, hold=True) for guess in guesses]
        found = [answer for answer in found if answer.success]
        if found:
            answers[k] = min(found, key=lambda answer: answer.value)
            best = min(best, answers[k].value)
    return answers, paths.floors


class _Paths:
    """Returns along the path with the zone at places, and what a place costs at least: by its zone, and by its path once known."""

    def __init__(self, task: TorqueTask, pairs: list[tuple[float, float]], floors: FloatArray) -> None:
        self._task, self._pairs = task, pairs
        self._known: dict[int, list[Guess]] = {}
        self.floors = floors

    def knows(self, k: int) -> bool:
        """Whether the path of a place is known."""
        return k in self._known

    def guesses(self, k: int) -> list[Guess]:
        """Guesses along the path with the zone at a place, whose floor they raise."""
        if k not in self._known:
            task = self._task
            family = _family(task, self._pairs[k])
            valleys = family.valleys()[:PATHS]
            if valleys:
                cost = _of_cycle(task, float(family.costs[valleys[0]]), self.floors[k])
                self.floors[k] = max(self.floors[k], cost / (1 + OFF))
            self._known[k] = [from_path(family, valley, task, COARSE) for valley in valleys]
        return self._known[k]


def _of_cycle(task: TorqueTask, cost: float, zone: float) -> float:
    """Objective of a cycle whose return has a cost and whose sync zone alone costs so much; 0 where that of the path tells nothing."""
    match task.aim:
        case "rms_torque":
            return math.hypot(zone, cost * math.sqrt(task.cut.return_zone / task.cut.length))
        case "energy":
            return zone + cost
        case "peak_torque":
            return max(zone, cost)
        case "rms_acceleration":  # of the return, scaled
            return cost * task.duration**2 / task.scale
    return 0.0


def _beside(k: int, places: FloatArray) -> list[int]:
    """Places next to one."""
    return [other for other in (k - 1, k + 1) if 0 <= other < len(places)]


def _family(task: TorqueTask, ends: tuple[float, float]) -> PathStarts:
    """Make the returns along the path with the zone at one place."""
    machine = task.machine
    pace = task.cut.sync_ratio * task.cut.line_speed
    speeds = pace / float(machine.tool_ratio(ends[1])), pace / float(machine.tool_ratio(ends[0]))
    way = ends[1], ends[0] + machine.pitch
    return path_starts(task.inertia, task.friction, way, speeds, task.duration, task.aim)
