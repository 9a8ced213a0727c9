"""The programmes of a servo-aware design: a convex programme over the rows that stand, solved again until no row is missing."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import cast

import numpy as np
from numpy.typing import NDArray

from camwright.design.line.forms import keeps_ramp
from camwright.design.servo_aware.axis_problem import AxisProblem
from camwright.design.servo_aware.convex import ACCEPTED, NAME, ConvexProgramme
from camwright.design.servo_aware.gathered_rows import GatheredRows
from camwright.design.servo_aware.ramp_rows import RampRows
from camwright.design.servo_aware.rows import AxisRows
from camwright.design.servo_aware.simplex import Vertex
from camwright.design.servo_aware.zone_table import Tried
from camwright.profiles.errors import SolverError
from camwright.profiles.objective import OBJECTIVES, MotorObjective, ObjectiveName
from camwright.profiles.polynomial.profile import CamProfile, FloatArray

# Limits are drawn in by this share, twice what an answer may break its rows by.
LIMIT_MARGIN = 2 * ACCEPTED
# The band in the shear zone is drawn in by this share, as rows stand at single places and times; and by that where they stand at single
# line speeds too.
BAND_MARGIN, SPEED_MARGIN = 1e-3, 2e-3
# Rows of the axis may be broken by this share of their band, far less than it is drawn in by.
BAND_ACCEPTED = 1e-5
# Rounds of adding rows.
ROUNDS = 30
# Share by which the value of one round may be that of the round before, where rows beyond the tolerance have no effect.
STILL = 1e-7
# Shares of the tolerance below this one are not told apart.
LEAST_MISSED = 1e-3
# A tolerance that is missed by no more than this gets further rounds to tell by how much, until that rises by less than this share.
CLOSE, RISEN = 0.3, 0.1
# A peak that later programmes keep is taken as this share of its limit at least: the peak of a steady motion is rounding.
LEAST_PEAK = 1e-6


# Kinds of rows, the first number of their names; of limits one for each order.
_LIMIT, _RAMP, _BAND, _RATIO, _OWN, _PEAK = 0, 4, 5, 6, 7, 8

# What the programme of the least sync error is filed under.
_LEAST_ERROR: tuple[object, ...] = ("sync_error", None, (), False)


@dataclass
class _Before:
    """What earlier programmes leave to later ones.

    Parameters
    ----------
    tight
        Orders of the limits whose rows have been found to matter.
    turned
        Unknowns of the last answer whose motor's objective was made least.
    vertices
        Optima of linear programmes, by what was asked.
    answer
        The last answer that was looked at, and its command.
    bound
        The last answer of a linear programme (slave units), and the rows that it has; of a problem beside where there is none yet.
    beside
        Optima of a problem beside.
    """

    tight: set[int]
    turned: FloatArray | None = None
    vertices: dict[tuple[object, ...], Vertex | None] = field(default_factory=dict)
    answer: tuple[FloatArray, CamProfile] | None = None
    bound: tuple[GatheredRows, FloatArray] | None = None
    beside: dict[tuple[object, ...], Vertex] = field(default_factory=dict)


class AxisProgramme:
    """The programmes of one `AxisProblem`; rows found by one answer serve the next.

    Unknowns are in units of the slave's travel per cycle. The programmes count what they solve in `solved`.

    Parameters
    ----------
    problem
        The problem.
    beside
        Programmes of a problem that differs a little in cut length or line speed: rows like those that bound there stand from the start,
        and linear programmes begin at its vertices.
    own
        Whether linear programmes are solved so that programmes beside this one can go on from them.
    """

    def __init__(self, problem: AxisProblem, beside: AxisProgramme | None = None, *, own: bool = False) -> None:
        self.problem, self._own = problem, own
        self.rows = GatheredRows(problem)
        self.ramps: RampRows = RampRows(problem, None if beside is None else beside.ramps)
        self.solved = 0
        # a return alone comes near to its limits, a whole cycle has room: rows of its limits come when they matter
        self._before = _Before(set(range(4)) if problem.command == "in_sync" else set())
        if beside is not None:
            self._before.bound, self._before.beside = beside._before.bound, beside._vertices()

    @property
    def margin(self) -> float:
        """Share by which the band in the shear zone is drawn in."""
        return BAND_MARGIN if len(self.problem.shares) == 1 else SPEED_MARGIN

    def solve(
        self, cost: ObjectiveName, band: float | None, caps: dict[int, float] | None = None, rounds: int = ROUNDS
    ) -> tuple[FloatArray, float] | None:
        """Find the command with the least cost.

        Parameters
        ----------
        cost
            What is made least.
        band
            Sync error allowed, as a share of the tolerance; ``None`` if it is the cost. A band of 1 asks for the ratio, too.
        caps
            Peaks of derivatives over the master, by order, that must be kept beside the limits.
        rounds
            Most rounds of adding rows.

        Returns
        -------
        (unknowns, value) or None
            The value is a share of the tolerance, or the peak or root mean square over the master. ``None`` if no command will do: with
            limits of the axis none that misses the tolerance, which comes before them. Nor if fewer rounds than usual were too few.
        """
        before = math.nan
        for number in range(rounds + 1):
            found = self._feasible(cost, caps or {}) if band == 1.0 else self._solve_rows(cost, band, caps or {})
            if found is not None and band is None and self.problem.axis_limits and found[1] > 1.0:
                return None
            if found is None or _stands_still(found[1], before, found[1] if band is None else band):
                break
            if not self._add_worst(found[0], found[1] if band is None else band, ratio=band == 1.0):
                break
            if number == rounds < ROUNDS:
                return None
            before = found[1]
        return found

    def reaches(self, rounds: int = ROUNDS) -> bool | None:
        """Whether some command brings every axis into the tolerance, no more exactly than that asks for; ``None`` after too few rounds."""
        for _ in range(rounds):
            found = self._feasible(
                "peak_acceleration", {}
            )  # the gentlest command breaks the fewest limits between the rows
            if found is None:  # rows yet to come can only make it worse
                return False
            if not self._add_worst(found[0], 1.0, ratio=True):
                return True
        return None

    def keeps(self) -> bool:
        """Whether some command brings every axis into the tolerance, whatever its ratio; a design of least sync error is one."""
        return self.missed(ratio=False) <= 0.0

    def excludes(self) -> bool:
        """Whether no command brings every axis into the tolerance, whatever its ratio: some of the rows alone allow none."""
        missed = self._missed(ratio=False)
        return missed is not None and missed > 0.0

    def missed(self, *, ratio: bool) -> float:
        """By how much the commands miss the tolerance, of which the best keeps so much as a share.

        A logarithm, which goes evenly over the cut length. At most zero where some command keeps it: with the ratio where `reaches` is
        true, without where `keeps` is. Above zero the true share may be larger still, as rows that are yet to come can only make it worse.
        Infinite where none keeps the limits, or none was found.
        """
        missed = self._missed(ratio=ratio)
        return math.inf if missed is None else missed

    def _missed(self, *, ratio: bool) -> float | None:
        """Look for a command that brings every axis into the tolerance, as `missed`; ``None`` where the rounds do not tell."""
        allowed, before = 1.0 - self.margin if ratio else 1.0, -math.inf
        for _ in range(ROUNDS):
            found = self._solve_rows("sync_error", None, {}, elastic=ratio)
            if found is None:
                return math.inf
            missed = math.log(max(found[1] / allowed, LEAST_MISSED))
            # where programmes go on from each other a line through values that are nearly true ends a search sooner than many values
            known = not self._own or missed > CLOSE or missed - before < RISEN * missed
            if (missed > 0.0 and known) or not self._add_worst(found[0], max(1.0, found[1]), ratio=ratio):
                return missed
            before = missed
        return None if missed <= 0.0 else missed

    def holds(self, profile: CamProfile) -> bool:
        """Whether a command keeps its limits and the axes theirs; if not, later programmes begin with rows where it fails."""
        for order, (low, high) in self.problem.limits.items():
            least, greatest = (extremum.value for extremum in profile.extrema(order))
            room = LIMIT_MARGIN * max(abs(low), abs(high))
            if least < low - room or greatest > high + room:
                return False
        return keeps_ramp(profile, self.problem.task) and not self.rows.add_worst(Tried(profile), 1.0, ratio=True)

    def least_share(self) -> float | None:
        """Least share of the tolerance that a command keeps with every axis, in position and ratio; ``None`` if none keeps the limits."""
        share, before = None, math.nan
        for _ in range(ROUNDS + 1):
            found = self._solve_rows("sync_error", None, {}, elastic=True)
            if found is None:
                return None
            share = found[1] / (1.0 - self.margin)
            if _stands_still(found[1], before, found[1]) or not self._add_worst(found[0], found[1], ratio=True):
                break
            before = found[1]
        return share

    def _feasible(self, cost: ObjectiveName, caps: dict[int, float]) -> tuple[FloatArray, float] | None:
        """Solve within the tolerance; at its very edge, where the solver cannot tell, by how far it would have to be widened."""
        try:
            return self._solve_rows(cost, 1.0, caps)
        except SolverError:
            wider = self._solve_rows("sync_error", None, caps, elastic=True)
            if wider is None or wider[1] > 1.0 - self.margin:
                return None
            raise

    def _add_worst(self, unknowns: FloatArray, band: float, *, ratio: bool) -> bool:
        """Add rows where an answer leaves its band; as `GatheredRows.add_worst`."""
        return self.rows.add_worst(Tried(self.profile(unknowns), unknowns * self.problem.scale), band, ratio=ratio)

    def least_share_of_limit(self, order: int, kept: float) -> float:
        """Bound from below the peak of a derivative, as a share of its limit, of commands whose sync error is within a share of the least.

        By the prices of the last programme of least sync error: a limit that is drawn in by a share of itself makes the error greater by
        at least that share of the prices of its rows. 0 where no prices are known.
        """
        vertex = self._before.vertices.get(_LEAST_ERROR)
        if vertex is None:
            return 0.0
        cost = np.append(np.zeros(len(vertex.x) - 1), 1.0)
        prices = -np.linalg.solve(vertex.matrix.T, cost)
        matrix = self._limit_rows(order, math.inf)[0]
        rows = {row.tobytes() for row in (*matrix, *(-matrix))}
        price = sum(float(prices[number]) for number, row in enumerate(vertex.matrix[:, :-1]) if row.tobytes() in rows)
        return (1.0 - LIMIT_MARGIN) * (1.0 - kept * float(vertex.x[-1]) / price) if price > 0.0 else 0.0

    @property
    def last(self) -> CamProfile | None:
        """The command that was looked at last."""
        return None if self._before.answer is None else self._before.answer[1]

    def profile(self, unknowns: FloatArray) -> CamProfile:
        """Return the command of an answer, from the start of the return; asked again, the same one."""
        if self._before.answer is None or self._before.answer[0] is not unknowns:
            self._before.answer = unknowns, self.problem.basis.profile(unknowns * self.problem.scale)
        return self._before.answer[1]

    def keeps_axis_limits(self, profile: CamProfile) -> bool:
        """Whether the nominal axis keeps its limits, to the share that rows of it are drawn in by."""
        return self.rows.own.keeps(profile)

    def _solve_rows(
        self, cost: ObjectiveName, band: float | None, caps: dict[int, float], *, elastic: bool = False
    ) -> tuple[FloatArray, float] | None:
        """Solve with the rows there are; ``elastic`` widens the ratio's band with that of the position."""
        if not self.solved and self._before.bound is not None:
            self.rows.go_on(*self._before.bound)
        self.rows.begin(linear=_linear(cost), ratio=elastic or band == 1.0)
        if OBJECTIVES[cost].of == "motor" or cost == "sync_error":
            # the former are not quickly solved again; in the latter nothing but limits holds what the shear zone does not see
            self._before.tight = set(range(4))
        while True:
            found = self._solve_once(cost, band, caps, elastic=elastic)
            if found is None or not self._tighten(found[0]):
                return found

    def _tighten(self, unknowns: FloatArray) -> bool:
        """Ask from now on for the rows of limits that an answer without them breaks; whether there are any."""
        broken = set()
        for order, (low, high) in self.problem.limits.items():
            if order not in self._before.tight:
                matrix, constant = self.problem.basis.differences[order]
                values = matrix @ (unknowns * self.problem.scale) + constant
                room = LIMIT_MARGIN * max(abs(low), abs(high)) if order else 0.0
                if values.min() < low + room or values.max() > high - room:
                    broken.add(order)
        self._before.tight |= broken
        return self.ramps.tighten(unknowns, LIMIT_MARGIN) or bool(broken)

    def _solve_once(
        self, cost: ObjectiveName, band: float | None, caps: dict[int, float], *, elastic: bool
    ) -> tuple[FloatArray, float] | None:
        """Solve with those rows of the limits that have been found to matter."""
        self.solved += 1
        count = self.problem.basis.matrix.shape[1]
        peak = _linear(cost)
        # rows only ever come: the optimum with fewer of them is where the next programme begins
        kind = (cost, band, tuple(caps.items()), elastic)
        programme = ConvexProgramme(
            count + peak, self._before.vertices.get(kind), self._before.beside.get(kind), self._own
        )
        bounds = self.problem.limits
        for order in (each for each in bounds if each in self._before.tight | caps.keys()):
            matrix, low, high = self._limit_rows(order, caps.get(order, math.inf))
            programme.add(matrix, low, high, names=_numbered(_LIMIT + order, np.arange(len(matrix))))
        matrix, constant = self.ramps.rows()
        if len(matrix):
            names = _numbered(_RAMP, self.ramps.numbers)
            programme.add(matrix, -np.inf, 1.0 - LIMIT_MARGIN - constant, names=names)
        of_ratio = self.rows.ratios if elastic or band == 1.0 else []
        for kind_of, rows in [*((_BAND, rows) for rows in self.rows.bands), *((_RATIO, rows) for rows in of_ratio)]:
            names = _of(kind_of, rows)
            matrix, constant = rows.matrix * (self.problem.scale / rows.size)[:, None], rows.constant / rows.size
            below, above = rows.low / rows.size, rows.high / rows.size
            if band is None:
                programme.add_peak(matrix, constant, below, above, BAND_ACCEPTED, names=names)
            else:
                share = band * (1.0 - self.margin)
                programme.add(matrix, below * share - constant, above * share - constant, BAND_ACCEPTED, names=names)
        for rows in self.rows.own.rows:
            matrix, constant = rows.matrix * (self.problem.scale / rows.size)[:, None], rows.constant / rows.size
            low, high = rows.low / rows.size - constant, rows.high / rows.size - constant
            programme.add(matrix, low, high, BAND_ACCEPTED, names=_of(_OWN, rows))
        if OBJECTIVES[cost].of == "motor":
            return self._least_torque(programme, cast(MotorObjective, cost))
        if not peak:
            return self._mean_square(programme, OBJECTIVES[cost].order)
        unit = 1.0
        if cost != "sync_error":
            unit = bounds[OBJECTIVES[cost].order][1]
            matrix, constant = self.problem.basis.differences[OBJECTIVES[cost].order]
            names = _numbered(_PEAK, np.arange(len(matrix)))
            programme.add_peak(matrix * (self.problem.scale / unit), constant / unit, -1.0, 1.0, names=names)
        answer = programme.solve(np.append(np.zeros(count), 1.0))
        self._before.vertices[kind] = programme.vertex
        if answer is None:
            return None
        self._before.bound = self.rows, answer[:-1] * self.problem.scale
        return answer[:-1], max(0.0, float(answer[-1])) * unit

    def _vertices(self) -> dict[tuple[object, ...], Vertex]:
        """Give the last optima of linear programmes, of those beside where this one has none."""
        return self._before.beside | {
            kind: vertex for kind, vertex in self._before.vertices.items() if vertex is not None
        }

    def _limit_rows(self, order: int, cap: float) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Rows of a limit, or of a peak that must be kept beside it, as ``(matrix, low, high)``."""
        low, high = self.problem.limits[order]
        peak_allowed = max(cap, LEAST_PEAK * high)
        size = min(max(abs(low), abs(high)), peak_allowed)
        room = LIMIT_MARGIN * size if order else 0.0
        least, most = max(low, -peak_allowed) + room, min(high, peak_allowed) - room
        matrix, constant = self.problem.basis.differences[order]
        return matrix * (self.problem.scale / size), (least - constant) / size, (most - constant) / size

    def _least_torque(self, programme: ConvexProgramme, cost: MotorObjective) -> tuple[FloatArray, float] | None:
        """Least torque or energy, from the command of least mean square acceleration, and from the answer with fewer rows before."""
        gentle = self._mean_square(programme, 2)
        if gentle is None:
            return None
        start = gentle[0] if self._before.turned is None else self._before.turned
        self._before.turned = self.problem.torque.minimise(cost, programme.rows(), start)
        return self._before.turned, self.problem.torque.value(self._before.turned, cost)

    def _mean_square(self, programme: ConvexProgramme, order: int) -> tuple[FloatArray, float] | None:
        """Least mean square of a derivative: linear between the nodes (order 2) or constant on the intervals (order 3)."""
        matrix, constant = self.problem.basis.differences[order]
        widths = np.diff(self.problem.basis.nodes) / self.problem.basis.nodes[-1]
        gram = np.diag(widths)
        if order == 2:  # the mean of (a + (b - a) s)² over an interval is (a² + a b + b²) / 3
            gram = np.zeros((len(widths) + 1, len(widths) + 1))
            index = np.arange(len(widths))
            gram[index, index] += widths / 3
            gram[index + 1, index + 1] += widths / 3
            gram[index, index + 1] = gram[index + 1, index] = widths / 6
        matrix = matrix * self.problem.scale
        square, slope = matrix.T @ gram @ matrix, matrix.T @ gram @ constant
        size = float(np.trace(square)) / len(square)
        answer = programme.solve(slope / size, square / size)
        if answer is None:
            return None
        values = matrix @ answer + constant
        return answer, math.sqrt(float(values @ gram @ values))


def _numbered(kind: int, numbers: NDArray[np.intp]) -> FloatArray:
    """Name rows by number."""
    names = np.zeros((len(numbers), NAME))
    names[:, 0], names[:, 1] = kind, numbers
    return names


def _of(kind: int, rows: AxisRows) -> FloatArray:
    """Name rows by what they are of."""
    return np.column_stack([np.full(len(rows.origin), kind), rows.origin])


def _stands_still(value: float, before: float, band: float) -> bool:
    """Whether more rows are of no use: beyond the tolerance bands are scaled, and the tool of a crank is off by more than that."""
    return band > 1.0 and math.isclose(value, before, rel_tol=STILL)


def _linear(cost: ObjectiveName) -> bool:
    """Whether the programme is linear: a greatest magnitude of what is linear in the command, which a torque is not."""
    return OBJECTIVES[cost].form == "peak" and OBJECTIVES[cost].of != "motor"
