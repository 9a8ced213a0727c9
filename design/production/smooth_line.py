"""The fastest line speed over a list of pieces where the line's jerk is limited, too: S-shaped changes of the speed.

Between nodes at given places on the material the acceleration changes evenly, so that speeds and places follow exactly. The durations are
what is made least; nodes stand close where a line without a limit of its jerk would change its acceleration. The line may dip below a
slow piece's speed inside the piece, where that lets it brake later and speed up earlier. It comes and leaves at a steady speed.
"""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from camwright.design.production.line_plan import fastest_plan
from camwright.design.returns.ipopt import QUIET
from camwright.profiles.errors import InputError, SolverError
from camwright.profiles.line_run import LineRun
from camwright.profiles.polynomial.profile import FloatArray

MOST_CHANGES = 5000
"""Most changes of the highest speed along a list."""

_OPTIONS: dict[str, Any] = QUIET | {
    "ipopt.acceptable_iter": 15,
    "ipopt.mu_strategy": "adaptive",
    "ipopt.tol": 1e-7,
    "ipopt.constr_viol_tol": 1e-10,
    "ipopt.bound_relax_factor": 0.0,
    "ipopt.max_iter": 400,
}
_FINEST, _COARSEST = 12.0, 1.5
"""Nodes in the time that the acceleration needs to come, at most and at least."""

_NODES = 800, 14_000
"""Nodes that are enough, and the most."""

_REACH = 2.0
"""Such times about each corner that nodes stand in."""

_INSIDE = 1e-6
"""Share by which speeds stay below their limits: a solver's accuracy."""

_NOISE = 1e-4
"""Share of its limit below which an acceleration is none."""

_SLOWEST = 1e-3
"""Share of the least highest speed that the line never falls below."""

_ROUNDS = 60
"""Halvings and more in which the time of a stretch is found."""


def smooth_line(
    lengths: FloatArray, highest: FloatArray, acceleration: float, jerk: float, steady: NDArray[np.bool_] | None = None
) -> LineRun:
    """Run the line over pieces as fast as their highest speeds, its ramp and its jerk allow.

    Parameters
    ----------
    lengths, highest, acceleration
        As of `camwright.design.production.line_plan.fastest_plan`.
    jerk
        Greatest jerk of the line (m/s³), positive.
    steady
        Pieces on which the line keeps its speed, shape ``(n,)``; nowhere if not given.

    Returns
    -------
    LineRun
        The plan, at most 0.1 % slower than the fastest on the lists compared; from a steady speed to a steady speed.

    Raises
    ------
    InputError
        As of `fastest_plan`, or the speed changes more often than `MOST_CHANGES`.
    SolverError
        The solver failed.

    Examples
    --------
    >>> import numpy as np
    >>> run = smooth_line(np.array([4.0, 1.0]), np.array([2.0, 1.0]), 1.0, 2.0, np.array([False, True]))
    >>> round(run.time, 2), round(float(run.speed(0.0)), 4), round(float(run.speed(run.time)), 4), round(run.hardest, 4)
    (3.38, 2.0, 1.0, 1.0)
    """
    kept = np.zeros(len(lengths), dtype=bool) if steady is None else steady
    new = np.flatnonzero((np.diff(highest) != 0.0) | (kept[1:] != kept[:-1])) + 1
    if len(new) > MOST_CHANGES:
        raise InputError(
            f"the line's highest speed changes {len(new)} times along the list; with its jerk limited at most {MOST_CHANGES} are planned: "
            "sort the list, split it, or leave [line] jerk out"
        )
    firsts = np.concatenate([[0], new])
    ways = np.add.reduceat(lengths, firsts)
    tops, still = highest[firsts], kept[firsts]
    ramps = fastest_plan(ways, tops, acceleration)  # refuses what is no plan
    if len(ways) == 1:
        return ramps
    places, of = _nodes(ways, ramps, acceleration, jerk)
    speeds, accelerations = _solved(places, tops[of], still[of], acceleration, jerk, ramps)
    plan = _run(places, speeds, accelerations)
    plain = _run(*_without_noise(places, speeds, accelerations, acceleration))
    joints = np.concatenate([[0.0], np.cumsum(ways)])
    return plain if (plain.fastest_between(joints) <= tops).all() else plan


def _without_noise(
    places: FloatArray, speeds: FloatArray, accelerations: FloatArray, acceleration: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Let the line keep its speed where its accelerations are a solver's noise, and leave out nodes in between."""
    calm = np.abs(accelerations) <= _NOISE * acceleration
    inside = np.zeros(len(calm), dtype=bool)
    inside[1:-1] = calm[:-2] & calm[1:-1] & calm[2:]
    kept = np.where(calm, 0.0, accelerations)[~inside]
    return places[~inside], speeds[~inside], kept


def _nodes(ways: FloatArray, ramps: LineRun, acceleration: float, jerk: float) -> tuple[FloatArray, NDArray[np.intp]]:
    """Choose the nodes: all joints, and about the corners of a plan without a limit of the jerk.

    Returns
    -------
    (places, of)
        Places on the material (m), shape ``(n + 1,)``; which way each stretch between them lies on, shape ``(n,)``.
    """
    density = _COARSEST * 2.0
    places = _spread(ways, ramps, acceleration / jerk, density)
    while len(places) < _NODES[0] and density < _FINEST:
        density *= 2.0
        places = _spread(ways, ramps, acceleration / jerk, density)
    if len(places) > _NODES[1]:
        places = _spread(ways, ramps, acceleration / jerk, _COARSEST)
    joints = np.concatenate([[0.0], np.cumsum(ways)])
    middle = 0.5 * (places[:-1] + places[1:])
    return places, np.clip(np.searchsorted(joints, middle, side="right") - 1, 0, len(ways) - 1)


def _spread(ways: FloatArray, ramps: LineRun, time: float, density: float) -> FloatArray:
    """Give joints and the places about corners, none nearer to another than they need be.

    Parameters
    ----------
    ways
        Ways of one highest speed each (m).
    ramps
        The plan whose corners are taken.
    time
        Time in which the acceleration comes (s).
    density
        Nodes in that time.
    """
    joints = np.concatenate([[0.0], np.cumsum(ways)])
    offsets = np.linspace(-_REACH, _REACH, int(2 * _REACH * density) + 1)
    sizes = ramps.speeds * time
    about = (ramps.positions[:, None] + sizes[:, None] * offsets).ravel()
    gaps = np.repeat(0.7 * sizes / density, len(offsets))
    inside = (about > 0.0) & (about < joints[-1])
    order = np.argsort(about[inside], kind="stable")
    about, gaps = about[inside][order], gaps[inside][order]
    after = np.searchsorted(joints, about, side="right")
    kept, last = [], 0.0
    for place, gap, joint in zip(about.tolist(), gaps.tolist(), after.tolist(), strict=True):
        last = max(last, float(joints[joint - 1]))
        if place - last >= gap and joints[joint] - place >= 0.5 * gap:
            kept.append(place)
            last = place
    return np.union1d(joints, np.array(kept))


def _solved(
    places: FloatArray, tops: FloatArray, still: NDArray[np.bool_], acceleration: float, jerk: float, ramps: LineRun
) -> tuple[FloatArray, FloatArray]:
    """Find speeds and accelerations at the nodes.

    Parameters
    ----------
    places
        Nodes (m), shape ``(n + 1,)``.
    tops, still
        Highest speed on each stretch (m/s), and whether the line keeps its speed there, shape ``(n,)``.
    acceleration, jerk
        Limits of the line.
    ramps
        A plan without the limit of the jerk: the start.
    """
    count, way = len(tops), np.diff(places)
    v, a, t = ca.SX.sym("v", count + 1), ca.SX.sym("a", count + 1), ca.SX.sym("t", count)
    faster = v[1:] - v[:-1] - (a[:-1] + a[1:]) * t / 2
    farther = (v[:-1] * t + (2 * a[:-1] + a[1:]) * t * t / 6) / way - 1
    jerks = (a[1:] - a[:-1]) / (jerk * t)
    within = (v[:-1] + a[:-1] * t / 2) / (tops * (1 - _INSIDE))  # the speed lies between its ends and this
    problem = {"x": ca.vertcat(v, a, t), "f": ca.sum1(t), "g": ca.vertcat(faster, farther, jerks, within)}
    solver = ca.nlpsol("line", "ipopt", problem, _OPTIONS)
    most = np.full(count + 1, acceleration)
    most[[0, -1]] = 0.0
    most[:-1][still] = 0.0
    most[1:][still] = 0.0
    low = np.full(count + 1, _SLOWEST * tops.min())
    high = (1 - _INSIDE) * np.minimum(np.append(tops, tops[-1]), np.append(tops[0], tops))
    begin = np.minimum(0.98 * ramps.speed(ramps.when(places)), high)
    times = 2 * way / (begin[:-1] + begin[1:])
    bend = np.gradient(begin) / np.gradient(np.concatenate([[0.0], np.cumsum(times)]))
    starts = [(begin, np.clip(bend, -0.9 * most, 0.9 * most), times)]
    starts.append((np.full(count + 1, 0.9 * high.min()), np.zeros(count + 1), way / (0.9 * high.min())))
    zeros, ones = np.zeros(2 * count), np.ones(count)
    for guess in starts:
        found = solver(
            x0=np.concatenate(guess),
            lbx=np.concatenate([low, -most, 1e-3 * guess[2]]),
            ubx=np.concatenate([high, most, 1e3 * guess[2]]),
            lbg=np.concatenate([zeros, -ones, 0.0 * ones]),
            ubg=np.concatenate([zeros, ones, ones]),
        )
        if solver.stats()["success"]:
            values = np.asarray(found["x"]).ravel()
            return values[: count + 1], np.clip(values[count + 1 : 2 * count + 2], -most, most)
    raise SolverError(
        f"no fastest line within its jerk was found on {count} stretches ({solver.stats()['return_status']}); leave out [line] jerk, or "
        "report this list"
    )


def _run(places: FloatArray, speeds: FloatArray, accelerations: FloatArray) -> LineRun:
    """Run the accelerations from node to node, so that speeds, times and places are one motion."""
    speed, now = float(speeds[0]), 0.0
    times, kept = [now], [speed]
    bends = accelerations.tolist()
    for way, first, last in zip(np.diff(places).tolist(), bends[:-1], bends[1:], strict=True):
        lasts = _lasts(way, speed, first, last)
        speed += 0.5 * (first + last) * lasts
        now += lasts
        times.append(now)
        kept.append(speed)
    return LineRun(np.array(times), np.array(kept), np.array(bends))


def _lasts(way: float, speed: float, first: float, last: float) -> float:
    """Time in which a way is gone while the acceleration changes evenly, by Newton's method."""
    time, bend = way / speed, (2.0 * first + last) / 6.0
    for _ in range(_ROUNDS):
        step = (time * (speed + bend * time) - way) / (speed + 2.0 * bend * time)
        time -= step
        if abs(step) <= 1e-15 * time:
            break
    return time
