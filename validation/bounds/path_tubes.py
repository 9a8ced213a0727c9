"""Lower bounds of torque and energy where acceleration and jerk are limited: a convex programme in a tube that it makes narrower itself.

With ``w = u²`` over the place the acceleration is ``w' / 2`` and the jerk ``w'' √w / 2``, so a limit ``J`` of the jerk is
``|w''| <= 2 J / √w``. That is not convex in ``w``, but where ``w`` stays between two values the chord of ``1 / √w`` lies above it, and
``|w''| <= 2 J (α - β w)`` is. The time ``∫ dq / √w = T`` is no longer than that of the chord and no shorter than ``T``: both are
convex too. On ``n`` cells the unknowns are ``w`` at the nodes and the means over the cells of ``w`` and ``√w``; then

- of a cell the squared torque costs at least ``(ΔE)² / ∫ √w dq``, and it takes at least the time ``h² / ∫ √w dq`` (Jensen); the energy
  drawn is at least ``ΔE + F h``, the peak at least ``|ΔE| / h``;
- the mean of ``w`` is that of its ends to ``h²/12`` of the greatest ``|w''|``;
- the second difference of ``w`` is the mean of ``w''`` under a hat, the value of ``w`` there that of a straight line to ``h²/8`` of it,

so every motion within its limits, of a cost below the level whose tube it is, is in the programme, and its least is a bound of them. What
``w`` can be at a place is asked of the same programme: the tube grows narrower, and with it the chords better. Where it holds no motion
at all, none costs less than the level.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from camwright.profiles.polynomial.profile import FloatArray
from camwright.validation.bounds.path_dual import drawn_tube, peak_tube, square_tube
from camwright.validation.bounds.path_task import PathTask

CELLS, INSIDE = 100, 8
"""Cells of the path, and parts of each in which the tube is known."""
ASKED = tuple(range(5, 100, 5))
"""Nodes at which the programme is asked for the least and the greatest of ``w``."""
LEVELS = {"square": (0.93, 0.82, 0.7), "drawn": (0.98, 0.955, 0.925, 0.87), "peak": (0.99, 0.96, 0.91, 0.82, 0.7, 0.5)}
"""Shares of a level that are tried, until one is proved."""
ROUNDS, STAYS = 5, 0.01
"""How often a tube is made narrower at most, and the share of the level by which that must raise the bound to go on."""
HOPELESS = 0.05
"""Share of its level below which a tube is not made narrower: it holds motions that waste time for nothing, and then still does."""
SAFE = 1e-6
"""Share by which what the solver answers is lowered."""
BENT = 1e30
"""Bend that counts as any."""
ROUNDING = 1e-9


Kind = Literal["square", "drawn", "peak"]


def least_in_tubes(task: PathTask, kind: Kind, level: float, known: float = 0.0) -> float:
    """Lower bound of a cost of motions that never turn, at most the level; 0 where it would be no better than what is known.

    Parameters
    ----------
    task
        The motion.
    kind
        The integral of the squared torque over time, (N·m)² s; the energy drawn (J); or the peak of the torque (N·m).
    level
        Cost of a motion.
    known
        Lower bound of it that is known.
    """
    best = 0.0
    for share in LEVELS[kind]:
        if max(best, known / level) >= share:
            break
        best = max(best, share * _share_proved(task, kind, share * level))
    return best * level


def _share_proved(task: PathTask, kind: Kind, level: float) -> float:
    """Share of a level, at most all, below which no motion is."""
    tube = _tube(task, kind, level)
    best = 0.0
    for number in range(ROUNDS + 1):
        if tube.empty:
            return 1.0
        programme = _TubeProgramme(tube, kind)
        before, best = best, max(best, programme.least_cost())
        if best >= 1.0 or best < HOPELESS or number == ROUNDS or (number > 0 and best < before + STAYS):
            break
        tube = tube.narrowed(*programme.ranges())
    return min(best, 1.0)


@dataclass(frozen=True, eq=False)
class _Tube:
    """Least and greatest ``w`` of the motions below a level, on a fine grid, in units of way, time and mean inertia.

    ``scaled`` is the motion in these units, with its inertia at the nodes; the level is in them too.
    """

    scaled: PathTask
    level: float
    low: FloatArray
    high: FloatArray

    @property
    def empty(self) -> bool:
        """Whether no motion stays in it."""
        return bool((self.low > self.high * (1 + ROUNDING) + ROUNDING**2).any())

    @cached_property
    def cells(self) -> tuple[FloatArray, FloatArray]:
        """Both sides in each cell, a row for each place from its start to its end."""
        low, high = (np.stack([f[k::INSIDE][:CELLS] for k in range(INSIDE + 1)]) for f in (self.low, self.high))
        return low, high

    @cached_property
    def limited(self) -> NDArray[np.bool_]:
        """In which cells ``w`` has a least value above zero, so that the chord of ``1 / √w`` is one."""
        return np.asarray(self.cells[0].min(axis=0) > ROUNDING)

    @cached_property
    def chord(self) -> tuple[FloatArray, FloatArray]:
        """``α`` and ``β`` of the chord ``α - β w`` above ``1 / √w`` in each cell; infinite and zero where there is none."""
        low, high = self.cells[0].min(axis=0), self.cells[1].max(axis=0)
        root, top = (np.sqrt(np.where(self.limited, side, 1.0)) for side in (low, high))
        beta = np.where(self.limited, 1.0 / (root * top * (root + top)), 0.0)
        return np.where(self.limited, 1.0 / root + beta * root**2, math.inf), beta

    @cached_property
    def bend(self) -> FloatArray:
        """Greatest ``|w''|`` in each cell."""
        low = np.where(self.limited, self.cells[0].min(axis=0), 1.0)
        return np.where(self.limited, 2.0 * self.scaled.jerk / np.sqrt(low), math.inf)

    def narrowed(self, least: dict[int, float], greatest: dict[int, float]) -> _Tube:
        """Take in what ``w`` can be at nodes; between them it lies off the straight line by what the greatest ``|w''|`` bends it."""
        low, high = self.low.copy(), self.high.copy()
        for start, end in pairwise(sorted(least)):
            length, part = (end - start) / CELLS, slice(start * INSIDE, end * INSIDE + 1)
            share = np.linspace(0.0, 1.0, (end - start) * INSIDE + 1)
            bow = 0.5 * min(float(self.bend[start:end].max()), BENT) * length**2 * share * (1 - share)
            under, over = (side[start] + (side[end] - side[start]) * share for side in (least, greatest))
            low[part], high[part] = np.maximum(low[part], under - bow), np.minimum(high[part], over + bow)
        return replace(self, low=low, high=high)


def _tube(task: PathTask, kind: Kind, level: float) -> _Tube:
    """Tube of the motions below a level."""
    unit, mean = task.way / task.time, float(task.inertia.mean())
    places = np.linspace(0.0, 1.0, len(task.inertia))
    scaled = PathTask(
        np.interp(np.linspace(0.0, 1.0, CELLS + 1), places, task.inertia) / mean,
        1.0,
        (task.speeds[0] / unit, task.speeds[1] / unit),
        1.0,
        task.greatest / unit,
        task.acceleration * task.way / unit**2,
        task.jerk * task.way**2 / unit**3,
        (task.slopes[0] * task.way / unit**2, task.slopes[1] * task.way / unit**2),
        task.friction * task.way / (mean * unit**2),
    )
    tube_of = {"square": square_tube, "drawn": drawn_tube, "peak": peak_tube}[kind]
    costs = {
        "square": mean**2 * unit**4 / task.way**2 * task.time,
        "drawn": mean * unit**2,
        "peak": mean * unit**2 / task.way,
    }
    energies, half = tube_of(task, level), 0.5 * task.inertia * unit**2
    x = np.linspace(0.0, 1.0, CELLS * INSIDE + 1)
    low = np.interp(x, places, energies.low / half) * (1 - ROUNDING)
    high = np.interp(x, places, energies.high / half) * (1 + ROUNDING)
    for side in (low, high):
        side[0], side[-1] = (speed**2 for speed in scaled.speeds)
    return _Tube(scaled, level / costs[kind], low, high)


@dataclass(eq=False)
class _Rows:
    """Rows ``factors · unknowns + slack = right`` of a programme, as they are stated."""

    parts: list[tuple[Any, Any, Any]] = field(default_factory=list)
    right: list[FloatArray] = field(default_factory=list)
    count: int = 0

    def add(self, columns: list[Any], factors: list[Any], right: Any) -> None:
        """Add rows, one for each finite right side."""
        right = np.atleast_1d(np.asarray(right, dtype=float))
        kept = np.isfinite(right)
        rows = self.count + np.arange(int(kept.sum()))
        for column, factor in zip(columns, factors, strict=True):
            self.parts.append((rows, *(np.broadcast_to(each, right.shape)[kept] for each in (column, factor))))
        self.right.append(right[kept])
        self.count += len(rows)

    def add_sum(self, columns: Any, factors: Any, right: float) -> None:
        """Add one row of many unknowns."""
        self.parts.append((np.full(len(columns), self.count), columns, factors))
        self.right.append(np.array([right]))
        self.count += 1

    def add_cones(self, *lines: tuple[list[Any], list[Any], float]) -> None:
        """Add the three rows of a cone for each cell."""
        for number, (columns, factors, _) in enumerate(lines):
            rows = self.count + 3 * np.arange(CELLS) + number
            for column, factor in zip(columns, factors, strict=True):
                self.parts.append((rows, column, np.broadcast_to(factor, CELLS)))
        self.right.append(np.tile([line[2] for line in lines], CELLS))
        self.count += 3 * CELLS

    def matrix(self, size: int) -> Any:
        """Give all rows as a sparse array."""
        from scipy.sparse import csc_array

        rows, columns, factors = (np.concatenate([part[k] for part in self.parts]) for k in range(3))
        return csc_array((factors, (rows, columns)), shape=(self.count, size))


_CELL = np.arange(CELLS)
_W, _MEAN, _ROOT, _COST, _TIME = (_CELL, *(k * CELLS + 1 + _CELL for k in range(1, 5)))
"""Unknowns of a cell: ``w`` at its start, the means of ``w`` and ``√w``, its cost and its time over its length."""
_SIZE = 5 * CELLS + 1


class _TubeProgramme:
    """The programme in a tube."""

    def __init__(self, tube: _Tube, kind: Kind) -> None:
        import clarabel
        from scipy.sparse import csc_array

        self._tube = tube
        rows, h, limit = _Rows(), 1.0 / CELLS, tube.scaled.acceleration
        rows.add([np.array([0, CELLS])], [1.0], [speed**2 for speed in tube.scaled.speeds])
        equations = rows.count
        for sign, side, cells in ((-1.0, tube.low, tube.cells[0]), (1.0, tube.high, tube.cells[1])):
            rows.add([_W[1:]], [sign], sign * side[::INSIDE][1:-1])
            rows.add([_MEAN], [sign], sign * 0.5 * (cells[:-1] + cells[1:]).mean(axis=0))
            off = np.minimum(h**2 / 12 * tube.bend, h / 2 * limit)
            rows.add([_MEAN, _W, _W + 1], [sign, -sign / 2, -sign / 2], off)
            rows.add([_W + 1, _W], [sign, -sign], np.full(CELLS, 2.0 * limit * h))
        rows.add_sum(_TIME, np.full(CELLS, h), 1.0)
        alpha, beta = tube.chord
        if tube.limited.all():
            rows.add_sum(_MEAN, h * beta, float(h * alpha.sum()) - 1.0)
        if math.isfinite(tube.scaled.jerk):
            _limit_jerk(rows, tube)
        rows.add_sum(_COST, np.full(CELLS, h), 1.0)
        if kind != "square":
            _state_cost(rows, tube, kind)
        limits = rows.count - equations
        # |(2 x, y - z)| <= y + z is x² <= y z, with (x, y, z) = (√w, w, 1), (1, √w, time), (torque, cost, √w)
        none: tuple[list[Any], list[Any], float] = ([], [], 2.0)
        rows.add_cones(([_MEAN], [-1.0], 1.0), ([_MEAN], [-1.0], -1.0), ([_ROOT], [-2.0], 0.0))
        rows.add_cones(([_ROOT, _TIME], [-1.0, -1.0], 0.0), ([_ROOT, _TIME], [-1.0, 1.0], 0.0), none)
        if kind == "square":
            force = tube.scaled.inertia / h / math.sqrt(tube.level)
            torque: tuple[list[Any], list[Any], float] = ([_W + 1, _W], [-force[1:], force[:-1]], 0.0)
            rows.add_cones(([_COST, _ROOT], [-1.0, -1.0], 0.0), ([_COST, _ROOT], [-1.0, 1.0], 0.0), torque)
        cones = [clarabel.ZeroConeT(equations), clarabel.NonnegativeConeT(limits)]
        cones += [clarabel.SecondOrderConeT(3)] * ((rows.count - equations - limits) // 3)
        settings = clarabel.DefaultSettings()
        settings.verbose = settings.presolve_enable = False
        right, quadratic = np.concatenate(rows.right), csc_array((_SIZE, _SIZE))
        self._solver = clarabel.DefaultSolver(quadratic, np.zeros(_SIZE), rows.matrix(_SIZE), right, cones, settings)

    def least_cost(self) -> float:
        """Least cost in the tube, as a share of its level; infinite where there is no motion, zero where the solver does not end."""
        goal = np.zeros(_SIZE)
        goal[_COST] = 1.0 / CELLS
        found = self._asked(goal)
        return 0.0 if found is None else found

    def ranges(self) -> tuple[dict[int, float], dict[int, float]]:
        """Least and greatest ``w`` at the nodes asked, infinite where there is no motion; the ends as they are."""
        ends = {node: speed**2 for node, speed in zip((0, CELLS), self._tube.scaled.speeds, strict=True)}
        least, greatest = dict(ends), dict(ends)
        for node in ASKED:
            goal = np.zeros(_SIZE)
            goal[node] = 1.0
            low, high = self._asked(goal), self._asked(-goal)
            least[node] = 0.0 if low is None else max(low, 0.0)
            greatest[node] = float(self._tube.high[node * INSIDE]) if high is None else -high
        return least, greatest

    def _asked(self, goal: FloatArray) -> float | None:
        """Lower bound of a goal by the solver's own multipliers; infinite where there is no motion, None where it does not end."""
        self._solver.update(q=goal)
        answer = self._solver.solve()
        status = str(answer.status)
        if status == "PrimalInfeasible":
            return math.inf
        if status != "Solved":
            return None
        value = float(answer.obj_val_dual)
        return value - SAFE * max(1.0, abs(value))


def _state_cost(rows: _Rows, tube: _Tube, kind: Kind) -> None:
    """State what the cells cost as shares of the level: what they draw, or all of them the greatest force of any."""
    force = 0.5 * tube.scaled.inertia * CELLS / tube.level
    if kind == "drawn":
        rows.add(
            [_W + 1, _W, _COST], [force[1:], -force[:-1], -1.0], np.full(CELLS, -tube.scaled.friction / tube.level)
        )
        rows.add([_COST], [-1.0], np.zeros(CELLS))
        return
    for sign in (1.0, -1.0):
        rows.add([_W + 1, _W, _COST], [sign * force[1:], -sign * force[:-1], -1.0], np.zeros(CELLS))
        rows.add([_COST[1:], _COST[:-1]], [sign, -sign], np.zeros(CELLS - 1))


def _limit_jerk(rows: _Rows, tube: _Tube) -> None:
    """State the limit of the jerk under the hats of the nodes; of a cell a hat has ``h²/2``, two thirds of it by its own node."""
    h, double, (alpha, beta) = 1.0 / CELLS, 2.0 * tube.scaled.jerk, tube.chord
    first, last = (2.0 * slope for slope in tube.scaled.slopes)
    bent = np.where(tube.limited, tube.bend, 0.0) * h**4 / 24
    room = double * (alpha * h**2 / 2 + beta * bent)
    far, near = double * beta * h**2 / 6, double * beta * h**2 / 3
    before, after = _W[:-1], _W[1:]
    for sign in (1.0, -1.0):
        rows.add(
            [before, after, after + 1],
            [sign + far[:-1], near[:-1] + near[1:] - 2.0 * sign, sign + far[1:]],
            room[:-1] + room[1:],
        )
        rows.add([1, 0], [sign + far[0], near[0] - sign], room[0] + sign * h * first)
        rows.add([CELLS - 1, CELLS], [sign + far[-1], near[-1] - sign], room[-1] - sign * h * last)
