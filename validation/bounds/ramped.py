"""Lower bound of what a return can reach on which the line may ramp: a convex programme of averages.

What the ramps ask is that linear forms of ``(y', y'', y''')`` do not exceed 1 (the chain rule, at the signs that are worst). Their averages
over the intervals of a mesh do not either, and averages of derivatives are differences of what is at the nodes: every motion, however it
moves inside the intervals, gives numbers at the nodes that keep the programme's rows. Its optimum is therefore a bound. What an interval
can hide is bounded too: with a jerk of at most ``U`` the integral of ``y''`` over a length ``h`` is that of the straight line but for
``(U h - |Δy''|) h / 2``, and its first moment about the middle but for ``U h³ / 12``; and it costs a mean square at least what its
projections on the Legendre polynomials cost (Bessel's inequality). Nothing is shared with the design, which asks more than is asked.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from camwright.profiles.objective import OBJECTIVES, MotionObjective
from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.profiles.task import Task
from camwright.validation.bounds.bound import NONE, Bound

METHOD = "convex programme of averages, with the line's ramps"

INTERVALS = 400
"""Intervals of the mesh; it holds the breaks of the motion that is judged."""

FINER, WIDE = 1600, 5e-4
"""Intervals of a second mesh, and the gap from which on it is tried."""

LIKE = 1e-3
"""Gap up to which a motion is called the best there is."""

SHORTEST = 1e-7
"""Intervals shorter than this part of the return are joined to their neighbours."""

ALMOST = 1e-4
"""Share by which it is lowered besides where the solver ends short of its tolerance: a hundred times what its residuals are then."""

ACCURACY = 1e-6
"""Share by which the bound is lowered for the solver's tolerance."""

Row = tuple[Any, FloatArray]


@dataclass(frozen=True, eq=False)
class _Nodes:
    """Maps from the unknowns: ``y''``, ``y'`` and ``y`` at the nodes, what each interval hides of the last two, and a peak's bound.

    The return has unit length; ``y`` is counted in a unit in which its derivatives are of the order of one. What is hidden is counted in
    the square and the cube of the interval's length, which keeps the numbers alike however short it is.
    """

    h: FloatArray

    @property
    def size(self) -> int:
        return 3 * (len(self.h) + 1) + 2 * len(self.h) + 1

    def _rows(self, first: int, count: int) -> Any:
        from scipy.sparse import csr_array

        return csr_array((np.ones(count), (np.arange(count), first + np.arange(count))), shape=(count, self.size))

    @cached_property
    def states(self) -> tuple[Any, Any, Any]:
        """Slope, ratio and position at the nodes."""
        n = len(self.h) + 1
        return self._rows(0, n), self._rows(n, n), self._rows(2 * n, n)

    @cached_property
    def hidden(self) -> tuple[Any, Any]:
        """What the slope's integral is off the straight line's, over ``h²``; and its moment about the middle, over ``h³``."""
        n = len(self.h)
        return self._rows(3 * n + 3, n), self._rows(4 * n + 3, n)

    def times(self, factors: FloatArray, rows: Any) -> Any:
        from scipy.sparse import diags_array

        return diags_array(factors) @ rows

    @cached_property
    def means(self) -> tuple[Any, Any, Any]:
        """Average jerk, slope and ratio on each interval: differences of the states."""
        (a, p, _), off, h = self.states, self.hidden[0], self.h
        jerk = self.times(1.0 / h, a[1:] - a[:-1])
        slope = 0.5 * (a[1:] + a[:-1]) + self.times(h, off)
        ratio = 0.5 * (p[1:] + p[:-1]) + self.times(h, self.moment)
        return jerk, slope, ratio

    @cached_property
    def moment(self) -> Any:
        """First moment of the slope about the middle of each interval, over ``h²``."""
        a, beside = self.states[0], self.hidden[1]
        return self.times(self.h, beside) - (a[1:] - a[:-1]) / 12.0

    def bound(self, rows: int) -> Any:
        from scipy.sparse import csr_array

        return csr_array((np.ones(rows), (np.arange(rows), np.full(rows, self.size - 1))), shape=(rows, self.size))


def ramped_bound(profile: CamProfile, task: Task, objective: MotionObjective) -> Bound:
    """Lower bound of an objective of the motion over all returns on which the line may ramp as the task says.

    Parameters
    ----------
    profile
        One cycle over ``[0, x_c]``, whose breaks the mesh takes: that makes the bound the sharper.
    task
        Machine, its sync zone placed, cut, limits and line. The motor's curve and its torque are not looked at.

    Returns
    -------
    Bound
        The value over time at the line speed, of the cycle for a peak; without one where the solver fails.
    """
    of = OBJECTIVES[objective]
    start = task.cut.return_start
    back = profile.restrict(start, start + task.cut.return_zone)
    ends = [abs(each.value) for each in back.extrema(of.order)]
    own = (math.sqrt(back.mean_square(of.order)) if of.form == "rms" else max(ends)) * task.cut.line_speed**of.order
    found = _on_mesh(back, task, objective, INTERVALS)
    zone = task.cut.line_speed**of.order * task.sync.peak(of.order)
    least = zone if of.form == "peak" else 0.0
    if not max(found, least) >= own * (1.0 - WIDE):  # wide, or not a number
        found = float(np.fmax(found, _on_mesh(back, task, objective, FINER)))
    if of.form == "peak" and not max(found, least) >= own * (1.0 - LIKE):
        found = float(np.fmax(found, _on_mesh(back, task, objective, FINER, exactly=True)))
    return Bound(math.nan, NONE) if math.isnan(found) else Bound(max(found, least), METHOD)


def _on_mesh(
    back: CamProfile, task: Task, objective: MotionObjective, intervals: int, *, exactly: bool = False
) -> float:
    """Bound the return on a mesh of so many intervals and its own breaks; not a number where the solver fails.

    A peak's programme is linear: ``exactly`` solves it to a vertex, which takes three times as long.
    """
    length, v, of, start = task.cut.return_zone, task.cut.line_speed, OBJECTIVES[objective], back.start
    unit = back.peak(2) * length**2 or 1.0
    nodes = _Nodes(_mesh((back.breaks - start) / length, intervals))
    equal = list(_ends(nodes, task, unit))
    own = back.mean_square(of.order) * (length**of.order / unit) ** 2 if of.form == "rms" else 1.0
    less = [*_limits(nodes, task, unit, objective), *_asked(nodes, task, unit), *_hiding(nodes, task, unit, objective)]
    square, goal = _goal(nodes, objective)
    square = square / own  # the solver ends short of its tolerance where numbers are far from one
    value = _by_highs(nodes, equal, less, goal) if exactly else _solved(nodes, equal, less, square, goal)
    if value is None:
        return math.nan
    reached = math.sqrt(max(0.0, value * own)) if of.form == "rms" else value
    return reached * unit / length**of.order * v**of.order * (1.0 - ACCURACY)


def _mesh(own: FloatArray, intervals: int) -> FloatArray:
    """Lengths of intervals: even ones, cut at a motion's own breaks."""
    nodes = np.union1d(np.linspace(0.0, 1.0, intervals + 1), np.clip(own, 0.0, 1.0))
    kept = np.concatenate([[True], np.diff(nodes) > SHORTEST])
    nodes = nodes[kept]
    nodes[0], nodes[-1] = 0.0, 1.0
    return np.diff(nodes)


def _ends(nodes: _Nodes, task: Task, unit: float) -> Iterator[Row]:
    """Give what the sync zone's ends fix, and how the states follow from each other."""
    sync, length = task.sync, task.cut.return_zone
    for order, state in ((2, nodes.states[0]), (1, nodes.states[1])):
        ends = np.array([float(sync(sync.end, order, side="left")), float(sync(sync.start, order))])
        yield state[[0, -1]], ends * length**order / unit
    (a, p, q), (off, _), h = nodes.states, nodes.hidden, nodes.h
    yield q[[0, -1]], np.array([0.0, task.height / unit])
    yield p[1:] - p[:-1] - nodes.times(0.5 * h, a[1:] + a[:-1]) - nodes.times(h**2, off), np.zeros(len(h))
    yield q[1:] - q[:-1] - nodes.times(h, nodes.means[2]), np.zeros(len(h))


def _limits(nodes: _Nodes, task: Task, unit: float, objective: MotionObjective) -> Iterator[Row]:
    """Give the limits of a line that keeps its speed, at the nodes and on average, and the bound of a peak."""
    length = task.cut.return_zone
    a, p, q = nodes.states
    jerk, slope, ratio = nodes.means
    fastest, slowest = task.greatest_ratio * length / unit, task.least_ratio * length / unit
    bend, sharp = task.greatest_slope * length**2 / unit, task.greatest_jerk * length**3 / unit
    for rows in (p[1:-1], ratio):
        yield rows, np.full(rows.shape[0], fastest)
        yield -rows, np.full(rows.shape[0], -slowest)
    for sign in (1.0, -1.0):
        yield sign * slope, np.full(slope.shape[0], bend)
        yield sign * a[1:-1], np.full(a.shape[0] - 2, bend)
        yield sign * jerk, np.full(jerk.shape[0], sharp)
    if task.machine.guide is not None:
        end = task.slave_at_sync_end
        low, high = ((each - end) / unit for each in task.machine.guide)
        yield q, np.full(q.shape[0], high)
        yield -q, np.full(q.shape[0], -low)
    of = OBJECTIVES[objective]
    if of.form == "peak":
        beside = 2.0 * nodes.moment  # the slope's average with a weight that falls from one end to the other
        measured = (a[1:-1], slope + beside, slope - beside) if of.order == 2 else (jerk,)
        for rows in measured:
            for sign in (1.0, -1.0):
                yield sign * rows - nodes.bound(rows.shape[0]), np.zeros(rows.shape[0])
    else:
        yield nodes.bound(1), np.zeros(1)
        yield -nodes.bound(1), np.zeros(1)


def _asked(nodes: _Nodes, task: Task, unit: float) -> Iterator[Row]:
    """Give what the line's ramps ask: on average, and of slope and ratio at the nodes too."""
    length, v, limits, line = task.cut.return_zone, task.cut.line_speed, task.limits, task.line
    a, p, _ = nodes.states
    jerk, slope, ratio = nodes.means
    turns = (1.0, -1.0) if task.reverses else (1.0,)
    to_jerk, to_slope, to_ratio = (v**order * unit / length**order for order in (3, 2, 1))
    for turn in turns:
        for push in (1.0, -1.0):
            ramp = line.speeding if push == turn else line.braking
            for bent, fast in ((a, p), (slope, ratio)):
                rows = (turn * ramp / v * to_ratio) * fast + push * to_slope * bent
                yield rows / limits.acceleration, np.ones(rows.shape[0])
        if line.ramps:
            yield (turn * line.hardest / v * to_ratio / limits.acceleration) * ratio, np.ones(len(nodes.h))
        for push in (1.0, -1.0):
            for bend in (1.0, -1.0):
                ramp = line.speeding if push == bend else line.braking
                rows = (turn * line.known_jerk / v * to_ratio) * ratio + (bend * 3.0 * ramp / v * to_slope) * slope
                yield (rows + push * to_jerk * jerk) / limits.jerk, np.ones(len(nodes.h))


def _hiding(nodes: _Nodes, task: Task, unit: float, objective: MotionObjective) -> Iterator[Row]:
    """Bound what an interval can hide, by the limit of the jerk, or by the bound of a peak of it."""
    count, jerk, (off, beside) = len(nodes.h), nodes.means[0], nodes.hidden
    sharp = task.greatest_jerk * task.cut.return_zone**3 / unit
    found = []
    for sign in (1.0, -1.0):
        found += [sign * 2.0 * off + way * jerk for way in (1.0, -1.0)]  # |off| + |jerk| / 2 <= U / 2
        found.append(sign * 12.0 * beside)
    for rows in found:
        if objective == "peak_jerk":
            yield rows - nodes.bound(count), np.zeros(count)
        else:
            yield rows, np.full(count, sharp)


def _goal(nodes: _Nodes, objective: MotionObjective) -> tuple[Any, FloatArray]:
    """Give half the quadratic's matrix doubled, and the linear part, of what is made least: a peak's bound, or what a mean square costs."""
    from scipy.sparse import csr_array

    goal, h = np.zeros(nodes.size), nodes.h
    of = OBJECTIVES[objective]
    if of.form == "peak":
        goal[-1] = 1.0
        return csr_array((nodes.size, nodes.size)), goal
    jerk, slope, _ = nodes.means
    off, beside = nodes.hidden
    # the projections of the slope, or of the jerk, on the Legendre polynomials of an interval
    parts = (
        [(h, slope), (12.0 * h, nodes.moment)] if of.order == 2 else [(h, jerk), (12.0 * h, off), (720.0 * h, beside)]
    )
    return 2.0 * sum(rows.T @ nodes.times(weight, rows) for weight, rows in parts), goal


def _solved(nodes: _Nodes, equal: list[Row], less: list[Row], square: Any, goal: FloatArray) -> float | None:
    """Solve the programme: the value of its dual, which is below its own; None where the solver does not end."""
    import clarabel
    from scipy.sparse import csc_array, triu

    scaled, right, count = _scaled(nodes, equal, less)
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.max_iter = 200
    cones = [clarabel.ZeroConeT(count), clarabel.NonnegativeConeT(len(right) - count)]
    answer = clarabel.DefaultSolver(csc_array(triu(square)), goal, csc_array(scaled), right, cones, settings).solve()
    if str(answer.status) not in ("Solved", "AlmostSolved"):
        return None
    aside = ALMOST if str(answer.status) == "AlmostSolved" else 0.0
    return float(min(answer.obj_val, answer.obj_val_dual)) * (1.0 - aside)


def _scaled(nodes: _Nodes, equal: list[Row], less: list[Row]) -> tuple[Any, FloatArray, int]:
    """Put rows below each other, each of size one: the matrix, its right side, and how many rows are equal and not at most."""
    from scipy.sparse import csr_array, vstack

    matrix = csr_array(vstack([row for row, _ in (*equal, *less)]))
    right = np.concatenate([limit for _, limit in (*equal, *less)])
    sizes = np.sqrt(np.asarray(matrix.multiply(matrix).sum(axis=1)).ravel())
    return csr_array(nodes.times(1.0 / sizes, matrix)), right / sizes, sum(len(limit) for _, limit in equal)


def _by_highs(nodes: _Nodes, equal: list[Row], less: list[Row], goal: FloatArray) -> float | None:
    """Solve a linear programme to a vertex; None where that fails."""
    from scipy.optimize import linprog

    rows, right, count = _scaled(nodes, equal, less)
    found = linprog(
        goal,
        A_ub=rows[count:],
        b_ub=right[count:],
        A_eq=rows[:count],
        b_eq=right[:count],
        bounds=(None, None),
        method="highs-ipm",
    )
    return float(found.fun) if found.status == 0 else None
