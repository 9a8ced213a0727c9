"""`GatheredRows`: the rows of a servo-aware programme that stand so far, and those that an answer shows to be needed.

The sync error of the axis is a row of numbers for every place, sampling phase and servo. A few rows stand from the start; after each answer
those are added where it is worst, until it holds everywhere.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from camwright.design.servo_aware.axis_problem import AxisProblem, thinned
from camwright.design.servo_aware.axis_response import PHASES, SUBSTEPS, Axis
from camwright.design.servo_aware.rows import (
    MOST_EACH,
    MOST_ROWS,
    RATIO,
    AxisRows,
    merged,
    worst_places,
)
from camwright.design.servo_aware.zone_points import ZonePoints, zone_points
from camwright.design.servo_aware.zone_table import Tried, ZoneTable
from camwright.profiles.polynomial.profile import CamProfile, FloatArray

# Limits of the axis' own speed and acceleration are drawn in by this share, for the same reason.
AXIS_MARGIN = 1e-3
# Places in the shear zone that have rows from the start, one for each sample in it, at least so many, and times after a sample: few where
# rounds are cheap, fewest for each of several servos, more for the linear programmes of a single one.
FEWEST, FEW, MORE = (6, 1), (6, 2), (12, 4)
# Of several line speeds about so many have rows from the start, of those of a servo at a corner so many, and each so many-th has the axis'
# own motion looked at.
BEGUN, CORNERS_BEGUN, OWN = 11, 1, 4
# Line speeds that stayed below this share of their limit when they were looked at last are far from it. Where one exceeds it, places above
# that share of it get rows.
FAR, BESIDE = 0.7, 0.9
# Most line speeds of a servo that get rows in a round.
MOST_SPEEDS = 16
# Between line speeds where a servo comes so near to its limit (share of it) the one in the middle is looked at, down to this step (share of
# the band of line speeds).
NEAR, FINEST = 0.05, 1 / 240
# Share of the largest error of a servo from which on its line speeds are looked at in the end.
NEAR_WORST = 0.95
# Limits of an axis' own motion that keep so great a share of them free are far.
FAR_OWN = 0.02
# Most rows of the axis' own motion added in a round: it runs along its limits where the tool only touches its band.
MOST_OWN = 24
# Most servos between the corners that get rows in a round.
MOST_SERVOS = 12
# Least band that is asked for (share of the tolerance): below it the motion matters more.
LEAST_ERROR = 5e-3
# Share by which a band may be missed without another round: at one line speed, and at many, where rounds bring less and cost more.
NEARLY, NEARLY_EACH = 1e-3, 1e-2


class GatheredRows:
    """Rows of one `AxisProblem`: bands in the shear zone, ratios there, and the nominal axis' own limits.

    Line speeds, and servos between the corners, get rows only where they prove worse.
    """

    def __init__(self, problem: AxisProblem) -> None:
        self.problem = problem
        self.bands: list[AxisRows] = []
        self.ratios: list[AxisRows] = []
        self.own = OwnRows(problem)
        tables = NewTables(problem)
        self._between = BetweenServos(problem, tables)
        self._tables = [[tables.of(axis, number) for axis in axes] for number, axes in enumerate(problem.axes)]

    def begin(self, *, linear: bool, ratio: bool) -> None:
        """Make the first rows of a design, unless a mean square is made least of a command in sync, which may well need none."""
        in_sync, mean = self.problem.command == "in_sync", not linear
        if in_sync and mean:
            return
        first = FEWEST if self.problem.several else FEW if in_sync or mean else MORE
        if not self.bands:
            for number, tables in enumerate(self._tables):
                for table in thinned(tables, max(1, len(tables) // (CORNERS_BEGUN if number else BEGUN))):
                    self.bands.append(table.band_rows(table.points.spread(*first)))
        if ratio and not self.ratios and self.problem.task.cut.shear_zone:
            table = self._tables[0][0]
            self.ratios.append(table.ratio_rows(table.points.spread(*first)))

    def go_on(self, beside: GatheredRows, unknowns: FloatArray) -> None:
        """Make rows like those that nearly bound at an answer of a problem beside; of the ratio where that is asked for."""
        start, corners = self._tables[0][0].axis.shear_zone[0], len(self._tables)
        for rows in beside.bands:
            for (number, share), (places, times) in rows.near(unknowns).items():
                table = self._between.table(number) if number >= corners else self._table(number, share)
                if table is not None:
                    wider = 1.0 if number < corners else self.problem.wider
                    self.bands.append(table.band_rows(table.points.nearest(start + places, times), wider))
        table = self._tables[0][0]
        for rows in beside.ratios if self.ratios else []:
            for places, times in rows.near(unknowns).values():
                self.ratios.append(table.ratio_rows(table.points.nearest(start + places, times)))
        self.own.go_on(beside.own, unknowns)

    def _table(self, number: int, share: float) -> ZoneTable:
        """Give the table of a servo at a line speed, which is taken in where it is not yet."""
        tables = self._tables[number]
        found = next((table for table in tables if table.axis.share == share), None)
        if found is None:
            axis = tables[0].axis
            found = self._between.tables.of(Axis(axis.task, axis.servo.at_speed(share / axis.share), share), number)
            tables.append(found)
            tables.sort(key=lambda table: -table.axis.share)
        return found

    def add_worst(self, command: Tried, band: float, *, ratio: bool) -> bool:
        """Add rows where a command leaves its band, or the nominal axis breaks a limit; whether there were any.

        Parameters
        ----------
        band
            Its band, as a share of the tolerance.
        ratio
            Whether the band of the ratio counts too.
        """
        nearly = 1.0 if band == 1.0 else 1.0 + (NEARLY if len(self.problem.shares) == 1 else NEARLY_EACH)
        limit = max(band, LEAST_ERROR) * self.problem.task.cut.sync_tolerance * nearly
        added = self._add_band(command, limit)
        if ratio and self.problem.task.cut.shear_zone:
            added |= self._add_ratio(command, max(1.0, band))
        between = self._between.rows(command, self.problem.wider * limit, unseen=not added)
        self.bands += between
        added |= bool(between)
        # limits of the axis bind in the first rounds or never: after one without any they are looked at in the end again
        if self.problem.axis_limits and (self.own.due or not added):
            added |= self.own.add_worst(command.profile)
        self.bands = merged(self.bands)  # a programme takes one block quicker than many
        return added

    def _add_band(self, command: Tried, limit: float) -> bool:
        """Add rows where a servo exceeds a limit at its line speeds; whether there were any.

        Those that were far from the limit when they were looked at last are looked at where the others keep it, and line speeds between
        where all do.
        """
        near = [[table for table in tables if table.last > FAR * limit] for tables in self._tables]
        if self._add_over(near, command, limit) or self._add_over(self._tables, command, limit):
            return True
        if self.problem.sketch:
            return False
        return self._add_over([self._finer(tables, limit) for tables in self._tables], command, limit)

    def _add_over(self, every: list[list[ZoneTable]], command: Tried, limit: float) -> bool:
        """Add rows where line speeds exceed a limit; whether one does."""
        added = False
        # servos that share their samples one after another
        for table in sorted((table for tables in every for table in tables), key=lambda table: table.sampled):
            table.peak(command)
        for tables in every:
            over = np.array([table.last for table in tables]) - limit
            for number in np.argsort(-over, kind="stable")[:MOST_SPEEDS].tolist():
                if over[number] <= 0.0:
                    break
                table = tables[number]
                places = worst_places(np.abs(table.errors(command)) - BESIDE * limit, _most(self.problem))
                self.bands.append(table.band_rows(places))
                added = True
        return added

    def _finer(self, tables: list[ZoneTable], limit: float) -> list[ZoneTable]:
        """Take in line speeds beside those where a servo comes near to its limit, and give them."""
        least = FINEST * (self.problem.shares[0] - self.problem.shares[-1])
        shares = [table.axis.share for table in tables]
        peaks = np.array([table.last for table in tables])
        near = set(worst_places(peaks - (1.0 - NEAR) * limit, MOST_SPEEDS).tolist())
        middles = [
            0.5 * (shares[number] + shares[number + 1])
            for number in range(len(tables) - 1)
            if shares[number] - shares[number + 1] > least and (number in near or number + 1 in near)
        ]
        return [self._table(tables[0].number, share) for share in middles]

    def errors(self, profile: CamProfile) -> tuple[dict[float, float], ...]:
        """Largest sync error of the tool in the shear zone (m), by servo and there by line speed, as a share of the cut's.

        Of the nominal servo at the problem's line speeds and those that have rows, of the others where their errors are about the largest.
        """
        found = []
        for number, tables in enumerate(self._tables):
            asked = [table for table in tables if table.begun or table.axis.share in self.problem.shares]
            if number:
                command = Tried(profile)
                least = NEAR_WORST * max(table.peak(command) for table in asked)
                asked = [table for table in asked if table.last >= least]
            found.append({table.axis.share: float(np.abs(table.axis.zone_errors(profile)[2]).max()) for table in asked})
        return tuple(found)

    @property
    def shares(self) -> tuple[float, ...]:
        """Line speeds that have rows, as shares of the cut's, from the full one down."""
        begun = {table.axis.share for tables in self._tables for table in tables if table.begun}
        return tuple(sorted(begun | self._between.shares, reverse=True)) or (1.0,)

    def _add_ratio(self, command: Tried, band: float) -> bool:
        """Add rows where the ratio of the nominal axis at full line speed leaves its band, widened to a share of itself."""
        cut, table = self.problem.task.cut, self._tables[0][0]
        worst = worst_places(np.abs(table.ratios(command)) - band * RATIO * cut.sync_tolerance / cut.shear_zone)
        if len(worst):
            self.ratios.append(table.ratio_rows(worst))
        return bool(len(worst))


class NewTables:
    """Tables of the axes of a problem as they are asked for; servos that sample at the same times share their points."""

    def __init__(self, problem: AxisProblem) -> None:
        self._basis = problem.basis
        self._points: dict[tuple[float, float], ZonePoints] = {}

    def of(self, axis: Axis, number: int) -> ZoneTable:
        """Make the table of the axis of a servo, given by its number."""
        at = axis.share, axis.sample
        if at not in self._points:
            self._points[at] = zone_points(axis, self._basis.step)
        return ZoneTable(axis, self._basis, number, self._points[at])


class OwnRows:
    """Rows that hold the nominal axis' own motion to its limits."""

    def __init__(self, problem: AxisProblem) -> None:
        self.problem = problem
        self.rows: list[AxisRows] = []
        self.due = True  # whether the last look added some, or there was none yet
        self._judged: CamProfile | None = None
        self._excess: dict[tuple[float, int], tuple[NDArray[np.intp], FloatArray]] = {}
        self._last: dict[tuple[float, int], float] = {}

    def keeps(self, profile: CamProfile) -> bool:
        """Whether the nominal axis keeps its limits at its line speeds, to the share that rows of it are drawn in by."""
        return all(
            axis.keeps_within(profile, order, low, high)
            or float(self._over(axis, profile, order)[1].max(initial=0.0)) <= AXIS_MARGIN * high
            for axis in thinned(self.problem.axes[0], OWN)
            for order, (low, high) in self.problem.own_limits(axis).items()
        )

    def add_worst(self, profile: CamProfile) -> bool:
        """Add rows where the nominal axis breaks a limit by half of what rows are drawn in by; whether there were any.

        Limits that were far when they were looked at last are looked at where the others are kept.
        """
        every = [
            (axis, order) for axis in thinned(self.problem.axes[0], OWN) for order in self.problem.own_limits(axis)
        ]
        far = [each for each in every if self._last.get((each[0].share, each[1]), 0.0) < -FAR_OWN]
        near = [each for each in every if each not in far]
        # all of a kind get rows in a round
        self.due = (
            sum(self._add(profile, *each) for each in near) > 0 or sum(self._add(profile, *each) for each in far) > 0
        )
        return self.due

    def _add(self, profile: CamProfile, axis: Axis, order: int) -> bool:
        """Add rows where an axis breaks a limit; whether there were any."""
        low, high = self.problem.own_limits(axis)[order]
        if axis.keeps_within(profile, order, low, high):
            return False
        steps, excess = self._over(axis, profile, order)
        worst = worst_places(excess.max(axis=0) - 0.5 * AXIS_MARGIN * high, MOST_OWN)
        if not len(worst):
            return False
        # what is pressed down there rises a sample aside, so that gets rows too, where the command does not tell that it cannot
        beside = steps[worst, None] + PHASES * np.arange(-1, 2)
        found = np.flatnonzero(np.isin(steps, beside % self._steps(axis)))
        times = np.asarray(excess[:, found].argmax(axis=0) * (axis.servo.sample_time / SUBSTEPS), dtype=np.float64)
        self._make(axis, order, np.asarray(steps[found] * (axis.sample / PHASES), dtype=np.float64), times)
        return True

    def _make(self, axis: Axis, order: int, places: FloatArray, times: FloatArray) -> None:
        """Make rows at places (m) and times since the sampling instant before (s)."""
        low, high = self.problem.own_limits(axis)[order]
        matrix, constant = axis.rows(self.problem.basis.rows, places, times, order)
        room, ones = high * AXIS_MARGIN, np.ones(len(matrix))
        origin = np.column_stack([np.full((len(matrix), 2), (order, axis.share)), places, times])
        self.rows.append(AxisRows(matrix, constant, (low + room) * ones, (high - room) * ones, origin))

    def go_on(self, beside: OwnRows, unknowns: FloatArray) -> None:
        """Make rows like those that nearly bound at an answer of a problem beside, if the axis is held to its limits."""
        if not self.problem.axis_limits:
            return
        longer = self.problem.task.cut.length / beside.problem.task.cut.length
        axes = {axis.share: axis for axis in self.problem.axes[0]}
        for rows in beside.rows:
            for (order, share), (places, times) in rows.near(unknowns).items():
                if share in axes:
                    self._make(axes[share], order, places * longer, times)

    def _over(self, axis: Axis, profile: CamProfile, order: int) -> tuple[NDArray[np.intp], FloatArray]:
        """By how much the nominal axis breaks a limit, by time after a sample and place; negative within it.

        At the steps of the common grid that are given: those where the command's range does not tell that it keeps the limit.
        """
        if self._judged is not profile:
            self._judged, self._excess = profile, {}
        key = axis.share, order
        if key not in self._excess:
            low, high = self.problem.own_limits(axis)[order]
            steps, excess = [np.zeros(0, np.intp)], [np.zeros((SUBSTEPS, 0))]
            for first, count in axis.loud(profile, order, low, high):
                values = axis.on_grid(profile, first, count, order)
                steps.append(np.arange(first, first + count))
                excess.append(np.maximum(values - high, low - values))
            self._excess[key] = np.concatenate(steps), np.concatenate(excess, axis=1)
            self._last[key] = float(self._excess[key][1].max(initial=-math.inf)) / high
        return self._excess[key]

    def _steps(self, axis: Axis) -> int:
        """Count the steps of the common grid over the cycle."""
        return math.ceil(self.problem.task.cut.length / (axis.sample / PHASES))


class BetweenServos:
    """Servos between the corners of the ranges: those that have rows, and those that have none yet."""

    def __init__(self, problem: AxisProblem, tables: NewTables) -> None:
        self._problem, self.tables = problem, tables
        corners = len(problem.servos)
        self._unseen = [tables.of(axis, corners + number) for number, axis in enumerate(problem.axes_between)]
        self._seen: list[ZoneTable] = []

    @property
    def shares(self) -> set[float]:
        """Line speeds of those that have rows, as shares of the cut's."""
        return {table.axis.share for table in self._seen}

    def rows(self, command: Tried, limit: float, *, unseen: bool) -> list[AxisRows]:
        """Make rows where a servo between the corners is worse than its limit; those without rows are looked at last."""
        over = []
        for table in sorted(self._seen + (self._unseen if unseen else []), key=lambda table: table.sampled):
            excess = np.abs(table.errors(command)) - limit
            if excess.max() > 0.0:
                over.append((float(excess.max()), table, worst_places(excess, _most(self._problem))))
        over.sort(key=lambda each: -each[0])
        found = []
        for _, table, points in over[:MOST_SERVOS]:
            found.append(table.band_rows(points, self._problem.wider))
            self._see(table)
        return found

    def table(self, number: int) -> ZoneTable | None:
        """Give that of a servo, which has rows from now on; ``None`` where the problem does not ask for it."""
        found = next((table for table in self._unseen if table.number == number), None)
        if found is not None:
            self._see(found)
        return found

    def _see(self, table: ZoneTable) -> None:
        """Count a servo among those that have rows."""
        if table in self._unseen:
            self._unseen.remove(table)
            self._seen.append(table)


def _most(problem: AxisProblem) -> int:
    """Most rows of one servo that are added at a time."""
    return MOST_EACH if problem.several else MOST_ROWS
