"""The return under a line that ramps, as a convex programme on a mesh.

The acceleration is a broken line over the mesh, so the jerk is constant on an interval, the ratio a quadratic and the position a cubic.
What the line's ramps ask is linear in these; it is asked of the Bernstein coefficients on each interval, between whose least and greatest
a polynomial lies: an answer keeps it everywhere, not only at nodes. The price is of the second order in the intervals' lengths.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from camwright.design.line.forms import Form
from camwright.design.returns.bernstein import ScaledMotion
from camwright.design.returns.scaling import ScaledProblem
from camwright.profiles.objective import OBJECTIVES
from camwright.profiles.polynomial.profile import FloatArray

MARGIN = 1e-7
"""Share by which limits are drawn in, so that the solver's tolerance carries no answer over them."""

TOLERANCE = 1e-9
"""Accuracy that the solver is asked for."""

MOST_STEPS = 200
"""Steps after which the solver gives up."""

FOUND = ("Solved", "AlmostSolved")
"""How the solver says that it has an answer."""

Row = tuple[Any, FloatArray]
"""A sparse matrix over the unknowns, and what its product with them must not exceed."""

Inner = tuple[Any, FloatArray, Any]
"""The same for a Bernstein coefficient inside each interval, and how much the coefficients bend there: a polynomial stays below the
coefficient by a share of that, which is what the mesh asks too much."""


@dataclass(frozen=True, eq=False)
class MeshAnswer:
    """What a mesh has for an answer.

    Parameters
    ----------
    dear
        Share of the objective that each interval would save, to first order, if its coefficients inside did not count: multipliers times
        bends, shape ``(n,)``.
    exact
        Whether the solver reached its tolerance, and not a looser one.
    """

    motion: ScaledMotion
    dear: FloatArray
    exact: bool


@dataclass(frozen=True, eq=False)
class Mesh:
    """Maps from the unknowns, accelerations, ratios and positions at the nodes and the bound of a peak, to what is asked of.

    Parameters
    ----------
    lengths
        Lengths of the intervals, their sum 1, shape ``(n,)``.
    unit
        Acceleration in which those at the nodes and the bound of a peak are counted.
    """

    lengths: FloatArray
    unit: float

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return 3 * (len(self.lengths) + 1) + 1

    def _nodes(self, kind: int) -> Any:
        from scipy.sparse import csr_array

        n = len(self.lengths) + 1
        unit = 1.0 if kind else self.unit
        return csr_array((np.full(n, unit), (np.arange(n), kind * n + np.arange(n))), shape=(n, self.size))

    @cached_property
    def a(self) -> Any:
        """Acceleration at the nodes."""
        return self._nodes(0)

    @cached_property
    def p(self) -> Any:
        """Ratio at the nodes."""
        return self._nodes(1)

    @cached_property
    def q(self) -> Any:
        """Position at the nodes."""
        return self._nodes(2)

    @cached_property
    def u(self) -> Any:
        """Jerk on the intervals."""
        return self.times(1.0 / self.lengths, self.a[1:] - self.a[:-1])

    @cached_property
    def coefficients(self) -> tuple[tuple[Any, Any], ...]:
        """Bernstein coefficients of degree 2 of ratio and acceleration on the intervals, one pair for each of the three."""
        middle = self.p[:-1] + self.times(0.5 * self.lengths, self.a[:-1])
        return (self.p[:-1], self.a[:-1]), (middle, 0.5 * (self.a[1:] + self.a[:-1])), (self.p[1:], self.a[1:])

    @cached_property
    def bend(self) -> Any:
        """How far the middle coefficient of the ratio is from the mean of its neighbours."""
        return self.times(0.25 * self.lengths, self.a[1:] - self.a[:-1])

    def times(self, factors: FloatArray, rows: Any) -> Any:
        """Multiply each row by a factor."""
        from scipy.sparse import diags_array

        return diags_array(factors) @ rows

    def bound(self, rows: int) -> Any:
        """Give rows of the bound of a peak."""
        from scipy.sparse import csr_array

        return csr_array(
            (np.full(rows, self.unit), (np.arange(rows), np.full(rows, self.size - 1))), shape=(rows, self.size)
        )


def solve_on_mesh(
    problem: ScaledProblem,
    lengths: FloatArray,
    forms: tuple[Form, ...],
    peak: float | None = None,
    unit: float = 1.0,
) -> MeshAnswer | None:
    """Solve for the accelerations at the nodes of a mesh.

    Parameters
    ----------
    problem
        The scaled return.
    lengths
        Lengths of the intervals, their sum 1.
    forms
        What must not exceed 1, as factors of the scaled ratio ``q' + drift`` and of ``q''`` and ``q'''``.
    peak
        Greatest peak allowed of an objective that is one: then the mean square of the acceleration is made least within it.
    unit
        Acceleration of about the motion's own peak: the solver ends short of its tolerance where numbers are far from one.

    Returns
    -------
    MeshAnswer or None
        ``None`` if the solver finds none on this mesh.
    """
    mesh = Mesh(lengths, unit)
    equal = list(_equalities(mesh, problem))
    inner = [*_within_limits(mesh, problem), *_within_ramps(mesh, problem, forms), *_stroke(mesh, problem)]
    less = [
        *((row, limit) for row, limit, _ in inner),
        *_limits(mesh, problem),
        *_ramps(mesh, problem, forms),
        *_peak(mesh, problem, peak),
    ]
    square, goal = _goal(mesh, problem, peak)
    answer, sizes = _solved(equal, less, square, goal)
    if str(answer.status) not in FOUND:
        return None
    found, n = np.array(answer.x), len(lengths)
    at, dear = sum(len(limit) for _, limit in equal), np.zeros(n)
    for _, _, bend in inner:
        dear += np.array(answer.z[at : at + n]) / sizes[at : at + n] * np.abs(bend @ found)
        at += n
    motion = ScaledMotion(lengths, unit * found[: n + 1], math.nan)
    dear /= max(abs(answer.obj_val), np.finfo(float).tiny)
    return MeshAnswer(motion, dear, str(answer.status) == "Solved")


def least_ramp_share(problem: ScaledProblem, lengths: FloatArray, forms: tuple[Form, ...]) -> float | None:
    """Find the least that forms can be kept below, of the returns of a mesh within the limits of a line that keeps its speed.

    Parameters
    ----------
    problem, lengths, forms
        As of `solve_on_mesh`; the objective is not looked at.

    Returns
    -------
    float or None
        At most 1 where the mesh has a return that bears the ramps; ``None`` where it has none within the other limits.
    """
    from scipy.sparse import csr_array

    mesh = Mesh(lengths, 1.0)
    ramps = [*_ramps(mesh, problem, forms), *((row, room) for row, room, _ in _within_ramps(mesh, problem, forms))]
    inner = (*_within_limits(mesh, problem), *_stroke(mesh, problem))
    less = [
        *((row, limit) for row, limit, _ in inner),
        *_limits(mesh, problem),
        *((row - (1.0 - MARGIN) * mesh.bound(len(room)), room - (1.0 - MARGIN)) for row, room in ramps),
    ]
    goal = np.zeros(mesh.size)
    goal[-1] = 1.0
    answer, _ = _solved(list(_equalities(mesh, problem)), less, csr_array((mesh.size, mesh.size)), goal)
    return float(answer.x[-1]) if str(answer.status) in FOUND else None


def _solved(equal: list[Row], less: list[Row], square: Any, goal: FloatArray) -> tuple[Any, FloatArray]:
    """Minimise with rows that must be equal and rows that must not be exceeded: Clarabel's answer, and what each row was divided by."""
    import clarabel
    from scipy.sparse import csc_array, diags_array, triu, vstack

    matrix = csc_array(vstack([row for row, _ in (*equal, *less)]))
    right = np.concatenate([limit for _, limit in (*equal, *less)])
    sizes = np.sqrt(np.asarray(matrix.multiply(matrix).sum(axis=1)).ravel())
    count = sum(len(limit) for _, limit in equal)
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.max_iter = MOST_STEPS
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = TOLERANCE
    cones = [clarabel.ZeroConeT(count), clarabel.NonnegativeConeT(len(right) - count)]
    scaled = csc_array(diags_array(1.0 / sizes) @ matrix)
    return clarabel.DefaultSolver(csc_array(triu(square)), goal, scaled, right / sizes, cones, settings).solve(), sizes


def _equalities(mesh: Mesh, problem: ScaledProblem) -> Iterator[Row]:
    """Give the motion's integration from node to node, and its ends."""
    h, a, p, q = mesh.lengths, mesh.a, mesh.p, mesh.q
    yield p[1:] - p[:-1] - mesh.times(0.5 * h, a[1:] + a[:-1]), np.zeros(len(h))
    yield q[1:] - q[:-1] - mesh.times(h, p[:-1]) - mesh.times(h**2 / 6, 2.0 * a[:-1] + a[1:]), np.zeros(len(h))
    yield a[[0, -1]], np.array([problem.start_slope, problem.end_slope])
    yield p[[0, -1]], np.array([0.0, problem.end_ratio])
    yield q[[0, -1]], np.array([0.0, problem.height])


def _limits(mesh: Mesh, problem: ScaledProblem) -> Iterator[Row]:
    """Give the limits of the line that keeps its speed at the nodes; what the ends have is given."""
    for sign, room in _ratio_room(problem):
        yield sign * mesh.p[1:-1], np.full(len(mesh.lengths) - 1, room)
    for sign in (1.0, -1.0):
        yield sign * mesh.a[1:-1], np.full(len(mesh.lengths) - 1, (1.0 - MARGIN) * problem.greatest_slope)
        yield sign * mesh.u, np.full(len(mesh.lengths), (1.0 - MARGIN) * problem.greatest_jerk)


def _within_limits(mesh: Mesh, problem: ScaledProblem) -> Iterator[Inner]:
    """Give the limit of the ratio inside the intervals."""
    middle, bend = mesh.coefficients[1][0], mesh.bend
    for sign, room in _ratio_room(problem):
        yield sign * middle, np.full(len(mesh.lengths), room), bend


def _ratio_room(problem: ScaledProblem) -> Iterator[tuple[float, float]]:
    """Give the sign of each limit of the ratio, and the room to it."""
    margin = MARGIN * max(problem.greatest_ratio, -problem.least_ratio)
    for sign, limit in ((1.0, problem.greatest_ratio), (-1.0, -problem.least_ratio)):
        yield sign, limit - margin if limit > margin else limit


def _ramps(mesh: Mesh, problem: ScaledProblem, forms: tuple[Form, ...]) -> Iterator[Row]:
    """Give what the line's ramps ask at the nodes, from the right and, with the jerk, from the left."""
    first, _, last = mesh.coefficients
    for form in forms:
        for ratio, slope in (first, last)[form.jerk == 0.0 :]:  # without the jerk a node is asked once
            yield form.ratio * ratio + form.slope * slope + form.jerk * mesh.u, _ramp_room(mesh, problem, form)


def _within_ramps(mesh: Mesh, problem: ScaledProblem, forms: tuple[Form, ...]) -> Iterator[Inner]:
    """Give what they ask inside the intervals."""
    ratio, slope = mesh.coefficients[1]
    for form in forms:
        rows = form.ratio * ratio + form.slope * slope + form.jerk * mesh.u
        yield rows, _ramp_room(mesh, problem, form), form.ratio * mesh.bend


def _ramp_room(mesh: Mesh, problem: ScaledProblem, form: Form) -> FloatArray:
    return np.full(len(mesh.lengths), 1.0 - MARGIN - form.ratio * problem.drift)


def _stroke(mesh: Mesh, problem: ScaledProblem) -> Iterator[Inner]:
    """Give the limits of the position, by its Bernstein coefficients of degree 3."""
    h, p, q = mesh.lengths, mesh.p, mesh.q
    x = np.concatenate([[0.0], np.cumsum(h)])
    inner = (
        (q[1:], x[1:], 0.0),
        (q[:-1] + mesh.times(h / 3, p[:-1]), x[:-1] + h / 3, 1.0),
        (q[1:] - mesh.times(h / 3, p[1:]), x[1:] - h / 3, 1.0),
    )
    bend = mesh.times(h**2 / 6.0, mesh.a[1:] + mesh.a[:-1])
    for sign, limit in ((1.0, problem.greatest_position), (-1.0, -problem.least_position)):
        if math.isfinite(limit):
            yield from (
                (sign * row, limit - MARGIN - sign * problem.drift * at, share * bend) for row, at, share in inner
            )


def _measured(mesh: Mesh, problem: ScaledProblem) -> Any:
    """Give what a peak is of, but for the ends, whose acceleration is given."""
    return mesh.a[1:-1] if OBJECTIVES[problem.objective].order == 2 else mesh.u


def _peak(mesh: Mesh, problem: ScaledProblem, peak: float | None) -> Iterator[Row]:
    """Give the bound of a peak, an unknown or a number; of a mean square the unknown is held at zero."""
    measured = _measured(mesh, problem)
    is_peak = OBJECTIVES[problem.objective].form == "peak"
    for sign in (1.0, -1.0):
        if not is_peak or peak is not None:
            yield sign * mesh.bound(1), np.zeros(1)
        if is_peak and peak is not None:
            yield sign * measured, np.full(measured.shape[0], peak)
        elif is_peak:
            yield sign * measured - mesh.bound(measured.shape[0]), np.zeros(measured.shape[0])


def _goal(mesh: Mesh, problem: ScaledProblem, peak: float | None) -> tuple[Any, FloatArray]:
    """Give the quadratic and the linear part of what is made least: a peak's bound, or a mean square in units of an easy motion's."""
    from scipy.sparse import csr_array

    goal = np.zeros(mesh.size)
    of = OBJECTIVES[problem.objective]
    if of.form == "peak" and peak is None:
        goal[-1] = 1.0
        return csr_array((mesh.size, mesh.size)), goal
    if of.form == "rms" and of.order == 3:
        return (2.0 / 720.0 / mesh.unit**2) * mesh.u.T @ mesh.times(mesh.lengths, mesh.u), goal
    first, last, third = mesh.a[:-1], mesh.a[1:], mesh.lengths / 3
    cross = first.T @ mesh.times(0.5 * third, last)
    mean = first.T @ mesh.times(third, first) + last.T @ mesh.times(third, last) + cross + cross.T
    return (2.0 / 12.0 / mesh.unit**2) * mean, goal
