"""First guesses of torque programmes, of kinds that differ: along the path, the motion's own optima, the quintic, and rests."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator

import numpy as np

from camwright.design.torque.mesh import density, spread
from camwright.design.torque.path_starts import PathStarts, path_starts
from camwright.design.torque.programme import Guess
from camwright.design.torque.task import ROOTS, Pattern, TorqueTask
from camwright.profiles.polynomial.profile import CamProfile, FloatArray

_States = Callable[[FloatArray], tuple[FloatArray, ...]]

# Points at which a profile is looked at for its mesh.
LOOKS = 400
# Decimals of the shares of the return at which it is looked at, beside where its own pieces meet: a mesh has no use for closer ones.
PLACES = 6
ANYHOW: Pattern = ("any",)
FORWARDS: Pattern = ("forth",)
RESTING: Pattern = ("forth", "rest", "forth")
TURNING: tuple[Pattern, ...] = (("forth", "back", "forth"), ("forth", "rest", "back", "rest", "forth"))
# Shares of the return after which a slave that is to rest stands first, and before whose end it still does.
STOPS = (0.1, 0.3)


def from_profile(back: CamProfile, task: TorqueTask, count: int) -> Guess:
    """Guess of one phase from a return over ``[0, length]``."""
    length, scale = task.problem.length, task.scale
    places = np.append(np.linspace(0.0, 1.0, LOOKS + 1), back.breaks[1:-1] / length if task.aim in ROOTS else [])
    look: FloatArray = np.unique(np.round(places, PLACES))
    mesh = spread(look, density(look, back(look * length), back(look * length, 2), task.aim), count)
    x = np.minimum(_nodes(mesh) * length, back.end)
    return Guess((mesh,), np.ones(1), back(x, 2) * length**2 / scale, back(x, 1) * length / scale, back(x) / scale)


def turning_from(back: CamProfile, task: TorqueTask, count: int) -> Guess | None:
    """Guess of three phases from a return that turns twice; None if it does not."""
    turns = back.roots(1)
    if len(turns) != len(TURNING[0]) - 1:
        return None
    length, scale = task.problem.length, task.scale
    edges = np.concatenate([[0.0], turns, [back.end]])
    meshes, rows = [], []
    for number, (first, last) in enumerate(itertools.pairwise(edges)):
        look = np.linspace(0.0, 1.0, LOOKS + 1)
        x = first + look * (last - first)
        meshes.append(spread(look, density(look, back(x), back(x, 2), task.aim), count))
        x = np.minimum(first + _nodes(meshes[-1]) * (last - first), back.end)[0 if number == 0 else 1 :]
        rows.append((back(x, 2) * length**2 / scale, back(x, 1) * length / scale, back(x) / scale))
    a, v, q = (np.concatenate([row[k] for row in rows]) for k in range(3))
    return Guess(tuple(meshes), np.diff(edges) / length, a, v, q)


def from_path(family: PathStarts, k: int, task: TorqueTask, count: int) -> Guess:
    """Guess of one phase from a return along the path."""
    passed = np.concatenate([[0.0], np.cumsum(family.times[k])])
    time = float(passed[-1])
    change = np.append(np.diff(family.speeds[k]) / family.times[k], 0.0)
    mesh = spread(passed / time, density(passed / time, family.y, change, task.aim), count)
    a, v, y = family.states(k, np.minimum(_nodes(mesh) * time, time))
    unit = task.duration / task.scale
    return Guess((mesh,), np.ones(1), a * task.duration * unit, v * unit, (y - family.y[0]) / task.scale)


def family_of(task: TorqueTask) -> PathStarts | None:
    """Make returns along the path; None where the slave must turn to get to its end."""
    problem, v = task.problem, task.cut.line_speed
    if problem.height <= 0 or min(problem.start_ratio, problem.end_ratio) <= 0:
        return None
    ends = task.start, task.start + problem.height
    speeds = problem.start_ratio * v, problem.end_ratio * v
    return path_starts(task.inertia, task.friction, ends, speeds, task.duration, task.aim)


def resting(task: TorqueTask, count: int) -> Iterator[tuple[Pattern, Guess]]:
    """Guesses of a slave that stops in the return, and stands for some of it."""
    for out in STOPS:
        for back in STOPS:
            ways = _stopping(task, out, back)
            lengths = np.array([out, 1.0 - out - back, back])
            yield RESTING, _joined(ways, [out, back], lengths, count, task.scale)


def turning(task: TorqueTask, count: int) -> Iterator[tuple[Pattern, Guess]]:
    """Guesses of a slave that turns twice in the return, with and without standing between."""
    problem = task.problem
    for share in (0.05, 0.15, 0.3):
        beyond = problem.start_ratio * problem.length * share / 3
        before = problem.end_ratio * problem.length * share / 3
        beyond, before = (
            min(beyond, 0.9 * problem.greatest_position),
            min(before, 0.9 * (problem.height - problem.least_position)),
        )
        out = _cubic(share, problem.start_ratio * problem.length, 0.0, beyond)
        again = _cubic(share, 0.0, problem.end_ratio * problem.length, before)
        for pattern, rest in zip(TURNING, (0.0, 0.1), strict=True):
            way = problem.height - before - beyond
            if way >= 0:
                continue
            middle = 1.0 - 2 * share - 2 * rest
            parts = [out, _cubic(middle, 0.0, 0.0, way), again]
            lengths = np.array([share, middle, share] if rest == 0.0 else [share, rest, middle, rest, share])
            yield pattern, _joined(parts, [share, middle, share], lengths, count, task.scale)


def _stopping(task: TorqueTask, out: float, back: float) -> list[_States]:
    problem, height = task.problem, task.problem.height
    first, last = problem.start_ratio * problem.length, problem.end_ratio * problem.length
    # the ways of two even brakings, both altered alike to add up to the height
    ways = np.array([first * out / 2, last * back / 2])
    ways += (height - ways.sum()) * ways / max(float(ways.sum()), 1e-300)
    return [_cubic(out, first, 0.0, float(ways[0])), _cubic(back, 0.0, last, float(ways[1]))]


def _cubic(time: float, first: float, last: float, way: float) -> _States:
    """Acceleration, velocity and position of the cubic that covers a way in a time between two velocities."""
    c = (3 * way / time - 2 * first - last) / time
    d = (first + last - 2 * way / time) / time**2

    def states(t: FloatArray) -> tuple[FloatArray, ...]:
        return 2 * c + 6 * d * t, first + t * (2 * c + 3 * d * t), t * (first + t * (c + d * t))

    return states


def _joined(
    parts: list[_States],
    times: list[float],
    lengths: FloatArray,
    count: int,
    scale: float,
) -> Guess:
    """Join phases to a guess; their states are those of the slave over shares of the return."""
    mesh = np.full(count, 1.0 / count)
    rows, place = [], 0.0
    for number, (part, time) in enumerate(zip(parts, times, strict=True)):
        a, v, q = part(_nodes(mesh) * time)
        first = 0 if number == 0 else 1
        rows.append((a[first:], v[first:], (place + q)[first:]))
        place += float(q[-1])
    a, v, q = (np.concatenate([row[k] for row in rows]) for k in range(3))
    return Guess(tuple(mesh for _ in parts), lengths, a / scale, v / scale, q / scale)


def _nodes(mesh: FloatArray) -> FloatArray:
    nodes = np.concatenate([[0.0], np.cumsum(mesh)])
    nodes[-1] = 1.0
    return nodes
