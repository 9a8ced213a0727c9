"""The programmes of a servo-aware design: rows over a command's unknowns, made where they matter.

The sync error of the axis is a row of numbers for every place, sampling phase and servo. A few rows stand from the start; after each answer
those are added where it is worst, until it holds everywhere.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import cast

import numpy as np

from camwright.design.servo_aware.axis_response import PHASES, SUBSTEPS, Axis
from camwright.design.servo_aware.command_basis import Command, command_basis
from camwright.design.servo_aware.convex import ACCEPTED, ConvexProgramme
from camwright.design.servo_aware.rows import (
    MOST_EACH,
    MOST_ROWS,
    RATIO,
    AxisRows,
    band_rows,
    first_places,
    ratio_rows,
    worst_places,
)
from camwright.design.servo_aware.torque import AxisTorque
from camwright.profiles.errors import SolverError
from camwright.profiles.objective import OBJECTIVES, MotorObjective, ObjectiveName
from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.profiles.servo import Servo
from camwright.profiles.task import Task

# Limits are drawn in by this share, twice what an answer may break its rows by.
LIMIT_MARGIN = 2 * ACCEPTED
# The band in the shear zone is drawn in by this share, as rows stand at single places and times.
BAND_MARGIN = 1e-3
# Rows of the axis may be broken by this share of their band, far less than it is drawn in by.
BAND_ACCEPTED = 1e-5
# Limits of the axis' own speed and acceleration are drawn in by this share, for the same reason.
AXIS_MARGIN = 1e-3
# Places in the shear zone that have rows from the start, one for each sample in it, at least so many, and times after a sample: few where
# rounds are cheap, more for the linear programmes of a single servo.
FEW, MORE = (6, 2), (12, 4)
# Rounds of adding rows, and the share by which a band may be missed without another round.
ROUNDS, NEARLY = 30, 1e-3
# Share by which the value of one round may be that of the round before, where rows beyond the tolerance have no effect.
STILL = 1e-7
# Most rows of the axis' own motion added in a round: it runs along its limits where the tool only touches its band.
MOST_OWN = 24
# A peak that later programmes keep is taken as this share of its limit at least: the peak of a steady motion is rounding.
LEAST_PEAK = 1e-6
# Most servos between the corners that get rows in a round.
MOST_SERVOS = 12
# Least band that is asked for (share of the tolerance): below it the motion matters more.
LEAST_ERROR = 5e-3


@dataclass(frozen=True, eq=False)
class AxisProblem:
    """A servo-aware design in numbers.

    Parameters
    ----------
    task
        The machine, its sync zone placed, the cut, whose sync tolerance is the band of the axis, and the limits of the command.
    command
        What may be chosen: the return alone, or the whole cycle.
    servos
        Servos that must keep to the band, the nominal one first.
    axis_limits
        Whether the nominal axis, too, must keep the limits of speed, acceleration and reversal.
    structure
        A return whose breaks the command may share.
    between
        Servos between the corners of the ranges, whose error must not be much larger than that of the others.
    """

    task: Task
    command: Command
    servos: tuple[Servo, ...]
    axis_limits: bool
    structure: CamProfile | None = None
    between: tuple[Servo, ...] = ()


class AxisProgramme:
    """The programmes of one `AxisProblem`; rows found by one answer serve the next.

    Unknowns are in units of the slave's travel per cycle. The programmes count what they solve in `solved`. Servos between the corners get
    rows only where they prove worse, and a band wider than the others' by a factor.
    """

    def __init__(self, problem: AxisProblem, wider: float = 1.0) -> None:
        self.problem = problem
        self._wider = wider
        self._unseen = [Axis(problem.task, servo) for servo in problem.between]
        self._seen: list[Axis] = []
        self.axes = tuple(Axis(problem.task, servo) for servo in problem.servos)
        self.basis = command_basis(problem.task, problem.command, problem.structure, robust=len(problem.servos) > 1)
        self.scale = max(abs(problem.task.machine.pitch), abs(problem.task.sync.advance))
        self.solved = 0
        self._bands: list[AxisRows] = []
        self._ratios: list[AxisRows] = []
        self._own: list[AxisRows] = []
        self._begun: set[str] = set()
        self._most = MOST_EACH if len(self.axes) > 1 else MOST_ROWS
        self._turned: FloatArray | None = None
        # a return alone comes near to its limits, a whole cycle has room: rows of its limits come when they matter
        self._tight = set(range(4)) if problem.command == "in_sync" else set[int]()
        self._answer: tuple[FloatArray, CamProfile] | None = None
        self._judged: CamProfile | None = None
        self._excess: dict[int, FloatArray] = {}

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
            if not self._add_worst(self.profile(found[0]), found[1] if band is None else band, ratio=band == 1.0):
                break
            if number == rounds < ROUNDS:
                return None
            before = found[1]
        return found

    def reaches(self) -> bool:
        """Whether some command brings every axis into the tolerance; no more exactly than that asks for."""
        for _ in range(ROUNDS):
            found = self._feasible(
                "peak_acceleration", {}
            )  # the gentlest command breaks the fewest limits between the rows
            if found is None:  # rows yet to come can only make it worse
                return False
            if not self._add_worst(self.profile(found[0]), 1.0, ratio=True):
                return True
        return False

    def holds(self, profile: CamProfile) -> bool:
        """Whether a command keeps its limits and the axes theirs; if not, later programmes begin with rows where it fails."""
        for order, (low, high) in self._limits().items():
            least, greatest = (extremum.value for extremum in profile.extrema(order))
            room = LIMIT_MARGIN * max(abs(low), abs(high))
            if least < low - room or greatest > high + room:
                return False
        return not self._add_worst(profile, 1.0, ratio=True)

    def least_share(self) -> float | None:
        """Least share of the tolerance that a command keeps with every axis, in position and ratio; ``None`` if none keeps the limits."""
        share, before = None, math.nan
        for _ in range(ROUNDS + 1):
            found = self._solve_rows("sync_error", None, {}, elastic=True)
            if found is None:
                return None
            share = found[1] / (1.0 - BAND_MARGIN)
            if _stands_still(found[1], before, found[1]) or not self._add_worst(
                self.profile(found[0]), found[1], ratio=True
            ):
                break
            before = found[1]
        return share

    def _feasible(self, cost: ObjectiveName, caps: dict[int, float]) -> tuple[FloatArray, float] | None:
        """Solve within the tolerance; at its very edge, where the solver cannot tell, by how far it would have to be widened."""
        try:
            return self._solve_rows(cost, 1.0, caps)
        except SolverError:
            wider = self._solve_rows("sync_error", None, caps, elastic=True)
            if wider is None or wider[1] > 1.0 - BAND_MARGIN:
                return None
            raise

    def profile(self, unknowns: FloatArray) -> CamProfile:
        """Return the command of an answer, from the start of the return; asked again, the same one."""
        if self._answer is None or self._answer[0] is not unknowns:
            self._answer = unknowns, self.basis.profile(unknowns * self.scale)
        return self._answer[1]

    def errors(self, profile: CamProfile) -> tuple[float, ...]:
        """Largest sync error of the tool in the shear zone (m), by servo."""
        return tuple(float(np.abs(axis.zone_errors(profile)[2]).max()) for axis in self.axes)

    def keeps_axis_limits(self, profile: CamProfile) -> bool:
        """Whether the nominal axis keeps its limits, to the share that rows of it are drawn in by."""
        return all(
            self.axes[0].keeps_within(profile, order, low, high)
            or float(self._own_excess(profile, order).max()) <= AXIS_MARGIN * high
            for order, (low, high) in self._own_limits().items()
        )

    def _solve_rows(
        self, cost: ObjectiveName, band: float | None, caps: dict[int, float], *, elastic: bool = False
    ) -> tuple[FloatArray, float] | None:
        """Solve with the rows there are; ``elastic`` widens the ratio's band with that of the position."""
        self._begin(cost, ratio=elastic or band == 1.0)
        if OBJECTIVES[cost].of == "motor" or cost == "sync_error":
            # the former are not quickly solved again; in the latter nothing but limits holds what the shear zone does not see
            self._tight = set(range(4))
        while True:
            found = self._solve_once(cost, band, caps, elastic=elastic)
            if found is None or not self._tighten(found[0]):
                return found

    def _begin(self, cost: ObjectiveName, *, ratio: bool) -> None:
        """Make the first rows of a design, unless a mean square is made least of a command in sync, which may well need none."""
        in_sync, mean = self.problem.command == "in_sync", not _linear(cost)
        if in_sync and mean:
            return
        first = FEW if in_sync or mean or len(self.axes) > 1 else MORE
        if "band" not in self._begun:
            self._begun.add("band")
            self._bands += [band_rows(axis, self.basis, *first_places(axis, *first)) for axis in self.axes]
        if ratio and "ratio" not in self._begun and self.problem.task.cut.shear_zone:
            self._begun.add("ratio")
            self._ratios.append(ratio_rows(self.axes[0], self.basis, *first_places(self.axes[0], *first)))

    def _tighten(self, unknowns: FloatArray) -> bool:
        """Ask from now on for the rows of limits that an answer without them breaks; whether there are any."""
        broken = set()
        for order, (low, high) in self._limits().items():
            if order not in self._tight:
                matrix, constant = self.basis.differences[order]
                values = matrix @ (unknowns * self.scale) + constant
                room = LIMIT_MARGIN * max(abs(low), abs(high)) if order else 0.0
                if values.min() < low + room or values.max() > high - room:
                    broken.add(order)
        self._tight |= broken
        return bool(broken)

    def _solve_once(
        self, cost: ObjectiveName, band: float | None, caps: dict[int, float], *, elastic: bool
    ) -> tuple[FloatArray, float] | None:
        """Solve with those rows of the limits that have been found to matter."""
        self.solved += 1
        count = self.basis.matrix.shape[1]
        peak = _linear(cost)
        programme = ConvexProgramme(count + peak)
        bounds = self._limits()
        for order, (low, high) in bounds.items():
            if order not in self._tight and order not in caps:
                continue
            peak_allowed = max(caps.get(order, math.inf), LEAST_PEAK * high)
            size = min(max(abs(low), abs(high)), peak_allowed)
            room = LIMIT_MARGIN * size if order else 0.0
            least, most = max(low, -peak_allowed) + room, min(high, peak_allowed) - room
            matrix, constant = self.basis.differences[order]
            programme.add(matrix * (self.scale / size), (least - constant) / size, (most - constant) / size)
        for rows in self._bands + (self._ratios if elastic or band == 1.0 else []):
            matrix, constant = rows.matrix * (self.scale / rows.size)[:, None], rows.constant / rows.size
            below, above = rows.low / rows.size, rows.high / rows.size
            if band is None:
                programme.add_peak(matrix, constant, below, above, BAND_ACCEPTED)
            else:
                share = band * (1.0 - BAND_MARGIN)
                programme.add(matrix, below * share - constant, above * share - constant, BAND_ACCEPTED)
        for rows in self._own:
            matrix, constant = rows.matrix * (self.scale / rows.size)[:, None], rows.constant / rows.size
            programme.add(matrix, rows.low / rows.size - constant, rows.high / rows.size - constant, BAND_ACCEPTED)
        if OBJECTIVES[cost].of == "motor":
            return self._least_torque(programme, cast(MotorObjective, cost))
        if not peak:
            return self._mean_square(programme, OBJECTIVES[cost].order, sure=not caps)
        unit = 1.0
        if cost != "sync_error":
            unit = bounds[OBJECTIVES[cost].order][1]
            matrix, constant = self.basis.differences[OBJECTIVES[cost].order]
            programme.add_peak(matrix * (self.scale / unit), constant / unit, -1.0, 1.0)
        answer = programme.solve(np.append(np.zeros(count), 1.0))
        return None if answer is None else (answer[:-1], max(0.0, float(answer[-1])) * unit)

    def _least_torque(self, programme: ConvexProgramme, cost: MotorObjective) -> tuple[FloatArray, float] | None:
        """Least torque or energy, from the command of least mean square acceleration, and from the answer with fewer rows before."""
        gentle = self._mean_square(programme, 2, sure=True)
        if gentle is None:
            return None
        start = gentle[0] if self._turned is None else self._turned
        self._turned = self.torque.minimise(cost, programme.rows(), start)
        return self._turned, self.torque.value(self._turned, cost)

    @cached_property
    def torque(self) -> AxisTorque:
        """Torque of the commands."""
        return AxisTorque(self.problem.task, self.basis, self.scale)

    def _mean_square(self, programme: ConvexProgramme, order: int, *, sure: bool) -> tuple[FloatArray, float] | None:
        """Least mean square of a derivative: linear between the nodes (order 2) or constant on the intervals (order 3)."""
        matrix, constant = self.basis.differences[order]
        widths = np.diff(self.basis.nodes) / self.basis.nodes[-1]
        gram = np.diag(widths)
        if order == 2:  # the mean of (a + (b - a) s)² over an interval is (a² + a b + b²) / 3
            gram = np.zeros((len(widths) + 1, len(widths) + 1))
            index = np.arange(len(widths))
            gram[index, index] += widths / 3
            gram[index + 1, index + 1] += widths / 3
            gram[index, index + 1] = gram[index + 1, index] = widths / 6
        matrix = matrix * self.scale
        square, slope = matrix.T @ gram @ matrix, matrix.T @ gram @ constant
        size = float(np.trace(square)) / len(square)
        answer = programme.solve(slope / size, square / size, sure=sure)
        if answer is None:
            return None
        values = matrix @ answer + constant
        return answer, math.sqrt(float(values @ gram @ values))

    def _limits(self) -> dict[int, tuple[float, float]]:
        """Limits of the command over the master, by order of the derivative."""
        task = self.problem.task
        machine, slope, jerk = task.machine, task.greatest_slope, task.greatest_jerk
        found = {1: (task.least_ratio, task.greatest_ratio), 2: (-slope, slope), 3: (-jerk, jerk)}
        if machine.guide is not None:
            end = task.slave_at_sync_start + task.sync.advance
            found[0] = (machine.guide[0] - end, machine.guide[1] - end)
        return found

    def _add_worst(self, profile: CamProfile, band: float, *, ratio: bool) -> bool:
        """Add rows where a command leaves its band, or the nominal axis breaks a limit; whether there were any."""
        nearly = 1.0 if band == 1.0 else 1.0 + NEARLY
        limit = max(band, LEAST_ERROR) * self.problem.task.cut.sync_tolerance * nearly
        added = False
        for axis in self.axes:
            places, times, errors = axis.zone_errors(profile)
            worst = worst_places(np.abs(errors) - limit, self._most)
            if len(worst):
                self._bands.append(band_rows(axis, self.basis, places[worst], times[worst]))
                added = True
        if ratio and self.problem.task.cut.shear_zone:
            added |= self._add_ratio(profile, max(1.0, band))
        if self.problem.axis_limits:
            added |= self._add_own(profile)
        return self._add_between(profile, self._wider * limit, unseen=not added) or added

    def _add_between(self, profile: CamProfile, limit: float, *, unseen: bool) -> bool:
        """Add rows where a servo between the corners is worse than its limit; those without rows are looked at last."""
        over = []
        for axis in self._seen + (self._unseen if unseen else []):
            places, times, errors = axis.zone_errors(profile)
            worst = worst_places(np.abs(errors) - limit, self._most)
            if len(worst):
                over.append((float(np.abs(errors).max()), axis, places[worst], times[worst]))
        over.sort(key=lambda each: -each[0])
        for _, axis, places, times in over[:MOST_SERVOS]:
            self._bands.append(band_rows(axis, self.basis, places, times, self._wider))
            if axis in self._unseen:
                self._unseen.remove(axis)
                self._seen.append(axis)
        return bool(over)

    def _add_ratio(self, profile: CamProfile, band: float) -> bool:
        """Add rows where the ratio of the nominal axis leaves its band, widened to a share of itself."""
        axis, cut = self.axes[0], self.problem.task.cut
        places, times, errors = axis.zone_ratios(profile)
        worst = worst_places(np.abs(errors) - band * RATIO * cut.sync_tolerance / cut.shear_zone)
        if len(worst):
            self._ratios.append(ratio_rows(axis, self.basis, places[worst], times[worst]))
        return bool(len(worst))

    def _add_own(self, profile: CamProfile) -> bool:
        """Add rows where the nominal axis breaks a limit by half of what rows are drawn in by; whether there were any."""
        axis, added = self.axes[0], False
        for order, (low, high) in self._own_limits().items():
            if axis.keeps_within(profile, order, low, high):
                continue
            excess = self._own_excess(profile, order)
            worst = worst_places(excess.max(axis=0) - 0.5 * AXIS_MARGIN * high, MOST_OWN)
            if len(worst):  # what is pressed down there rises a sample aside, so that gets rows too
                worst = np.unique((worst[:, None] + PHASES * np.arange(-1, 2)) % excess.shape[1])
                times = np.asarray(
                    excess[:, worst].argmax(axis=0) * (axis.servo.sample_time / SUBSTEPS), dtype=np.float64
                )
                places = np.asarray(worst * (axis.sample / PHASES), dtype=np.float64)
                matrix, constant = axis.rows(self.basis, places, times, order)
                room, ones = high * AXIS_MARGIN, np.ones(len(matrix))
                self._own.append(AxisRows(matrix, constant, (low + room) * ones, (high - room) * ones))
                added = True
        return added

    def _own_limits(self) -> dict[int, tuple[float, float]]:
        """Limits that the axis' own motion is held to: speed, reversal and acceleration."""
        return {order: limits for order, limits in self._limits().items() if order in (1, 2)}

    def _own_excess(self, profile: CamProfile, order: int) -> FloatArray:
        """By how much the nominal axis breaks a limit over the cycle, by time after a sample and place; negative within it."""
        if self._judged is not profile:
            self._judged, self._excess = profile, {}
        if order in self._excess:
            return self._excess[order]
        low, high = self._own_limits()[order]
        axis = self.axes[0]
        count = math.ceil(self.problem.task.cut.length / (axis.sample / PHASES))
        values = axis.on_grid(profile, 0, count, order)
        self._excess[order] = np.maximum(values - high, low - values)
        return self._excess[order]


def _stands_still(value: float, before: float, band: float) -> bool:
    """Whether more rows are of no use: beyond the tolerance bands are scaled, and the tool of a crank is off by more than that."""
    return band > 1.0 and math.isclose(value, before, rel_tol=STILL)


def _linear(cost: ObjectiveName) -> bool:
    """Whether the programme is linear: a greatest magnitude of what is linear in the command, which a torque is not."""
    return OBJECTIVES[cost].form == "peak" and OBJECTIVES[cost].of != "motor"
