"""`GatheredRows`: the rows of a servo-aware programme that stand so far, and those that an answer shows to be needed.

The sync error of the axis is a row of numbers for every place, sampling phase and servo. A few rows stand from the start; after each answer
those are added where it is worst, until it holds everywhere.
"""

from __future__ import annotations

import math

import numpy as np

from camwright.design.servo_aware.axis_problem import AxisProblem
from camwright.design.servo_aware.axis_response import PHASES, SUBSTEPS, Axis
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
from camwright.profiles.polynomial.profile import CamProfile, FloatArray

# Limits of the axis' own speed and acceleration are drawn in by this share, for the same reason.
AXIS_MARGIN = 1e-3
# Places in the shear zone that have rows from the start, one for each sample in it, at least so many, and times after a sample: few where
# rounds are cheap, more for the linear programmes of a single servo.
FEW, MORE = (6, 2), (12, 4)
# Most rows of the axis' own motion added in a round: it runs along its limits where the tool only touches its band.
MOST_OWN = 24
# Most servos between the corners that get rows in a round.
MOST_SERVOS = 12
# Least band that is asked for (share of the tolerance): below it the motion matters more.
LEAST_ERROR = 5e-3
# Share by which a band may be missed without another round.
NEARLY = 1e-3


class GatheredRows:
    """Rows of one `AxisProblem`: bands in the shear zone, ratios there, and the nominal axis' own limits.

    Servos between the corners get rows only where they prove worse.
    """

    def __init__(self, problem: AxisProblem) -> None:
        self.problem = problem
        self.bands: list[AxisRows] = []
        self.ratios: list[AxisRows] = []
        self.own = OwnRows(problem)
        self._between = BetweenServos(problem)
        self._begun: set[str] = set()

    def begin(self, *, linear: bool, ratio: bool) -> None:
        """Make the first rows of a design, unless a mean square is made least of a command in sync, which may well need none."""
        in_sync, mean = self.problem.command == "in_sync", not linear
        if in_sync and mean:
            return
        first = FEW if in_sync or mean or len(self.problem.axes) > 1 else MORE
        if "band" not in self._begun:
            self._begun.add("band")
            self.bands += [
                band_rows(axis, self.problem.basis, *first_places(axis, *first)) for axis in self.problem.axes
            ]
        if ratio and "ratio" not in self._begun and self.problem.task.cut.shear_zone:
            self._begun.add("ratio")
            self.ratios.append(
                ratio_rows(self.problem.axes[0], self.problem.basis, *first_places(self.problem.axes[0], *first))
            )

    def add_worst(self, profile: CamProfile, band: float, *, ratio: bool) -> bool:
        """Add rows where a command leaves its band, or the nominal axis breaks a limit; whether there were any."""
        nearly = 1.0 if band == 1.0 else 1.0 + NEARLY
        limit = max(band, LEAST_ERROR) * self.problem.task.cut.sync_tolerance * nearly
        added = False
        for axis in self.problem.axes:
            places, times, errors = axis.zone_errors(profile)
            worst = worst_places(np.abs(errors) - limit, _most(self.problem))
            if len(worst):
                self.bands.append(band_rows(axis, self.problem.basis, places[worst], times[worst]))
                added = True
        if ratio and self.problem.task.cut.shear_zone:
            added |= self._add_ratio(profile, max(1.0, band))
        if self.problem.axis_limits:
            added |= self.own.add_worst(profile)
        between = self._between.rows(profile, self.problem.wider * limit, unseen=not added)
        self.bands += between
        return bool(between) or added

    def _add_ratio(self, profile: CamProfile, band: float) -> bool:
        """Add rows where the ratio of the nominal axis leaves its band, widened to a share of itself."""
        axis, cut = self.problem.axes[0], self.problem.task.cut
        places, times, errors = axis.zone_ratios(profile)
        worst = worst_places(np.abs(errors) - band * RATIO * cut.sync_tolerance / cut.shear_zone)
        if len(worst):
            self.ratios.append(ratio_rows(axis, self.problem.basis, places[worst], times[worst]))
        return bool(len(worst))


class OwnRows:
    """Rows that hold the nominal axis' own motion to its limits."""

    def __init__(self, problem: AxisProblem) -> None:
        self.problem = problem
        self.rows: list[AxisRows] = []
        self._judged: CamProfile | None = None
        self._excess: dict[int, FloatArray] = {}

    def keeps(self, profile: CamProfile) -> bool:
        """Whether the nominal axis keeps its limits, to the share that rows of it are drawn in by."""
        return all(
            self.problem.axes[0].keeps_within(profile, order, low, high)
            or float(self._over(profile, order).max()) <= AXIS_MARGIN * high
            for order, (low, high) in self.problem.own_limits.items()
        )

    def add_worst(self, profile: CamProfile) -> bool:
        """Add rows where the nominal axis breaks a limit by half of what rows are drawn in by; whether there were any."""
        axis, added = self.problem.axes[0], False
        for order, (low, high) in self.problem.own_limits.items():
            if axis.keeps_within(profile, order, low, high):
                continue
            excess = self._over(profile, order)
            worst = worst_places(excess.max(axis=0) - 0.5 * AXIS_MARGIN * high, MOST_OWN)
            if len(worst):  # what is pressed down there rises a sample aside, so that gets rows too
                worst = np.unique((worst[:, None] + PHASES * np.arange(-1, 2)) % excess.shape[1])
                times = np.asarray(
                    excess[:, worst].argmax(axis=0) * (axis.servo.sample_time / SUBSTEPS), dtype=np.float64
                )
                places = np.asarray(worst * (axis.sample / PHASES), dtype=np.float64)
                matrix, constant = axis.rows(self.problem.basis, places, times, order)
                room, ones = high * AXIS_MARGIN, np.ones(len(matrix))
                self.rows.append(AxisRows(matrix, constant, (low + room) * ones, (high - room) * ones))
                added = True
        return added

    def _over(self, profile: CamProfile, order: int) -> FloatArray:
        """By how much the nominal axis breaks a limit over the cycle, by time after a sample and place; negative within it."""
        if self._judged is not profile:
            self._judged, self._excess = profile, {}
        if order in self._excess:
            return self._excess[order]
        low, high = self.problem.own_limits[order]
        axis = self.problem.axes[0]
        count = math.ceil(self.problem.task.cut.length / (axis.sample / PHASES))
        values = axis.on_grid(profile, 0, count, order)
        self._excess[order] = np.maximum(values - high, low - values)
        return self._excess[order]


class BetweenServos:
    """Servos between the corners of the ranges: those that have rows, and those that have none yet."""

    def __init__(self, problem: AxisProblem) -> None:
        self._problem = problem
        self._unseen = [Axis(problem.task, servo) for servo in problem.between]
        self._seen: list[Axis] = []

    def rows(self, profile: CamProfile, limit: float, *, unseen: bool) -> list[AxisRows]:
        """Make rows where a servo between the corners is worse than its limit; those without rows are looked at last."""
        over = []
        for axis in self._seen + (self._unseen if unseen else []):
            places, times, errors = axis.zone_errors(profile)
            worst = worst_places(np.abs(errors) - limit, _most(self._problem))
            if len(worst):
                over.append((float(np.abs(errors).max()), axis, places[worst], times[worst]))
        over.sort(key=lambda each: -each[0])
        found = []
        for _, axis, places, times in over[:MOST_SERVOS]:
            found.append(band_rows(axis, self._problem.basis, places, times, self._problem.wider))
            if axis in self._unseen:
                self._unseen.remove(axis)
                self._seen.append(axis)
        return found


def _most(problem: AxisProblem) -> int:
    """Most rows of one servo that are added at a time."""
    return MOST_EACH if len(problem.servos) > 1 else MOST_ROWS
