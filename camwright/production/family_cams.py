"""The cams of a family: the fewest that together keep the axis in sync at every line speed of a job, each over a band."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from camwright.design.optimise import Solution
from camwright.house.numbers import with_unit
from camwright.house.progress import Step, ignore
from camwright.jobs.job import Job
from camwright.jobs.servos import servos_of
from camwright.production.cams import ListCam, list_job
from camwright.profiles.errors import InfeasibleError, InputError, Suggestion
from camwright.profiles.objective import OBJECTIVES
from camwright.studies.axis_study import solve_job
from camwright.studies.covering import FOUND_TO, Overlap, Uncovered
from camwright.studies.family_bands import OVERLAP, ROOM, asking, band_job, family_bands, placed_for_all, within
from camwright.studies.remedies import solve_or_advise
from camwright.studies.speed_band import SpeedBand, job_band
from camwright.validation.report import ValidationReport, judge
from camwright.validation.servo.line_speeds import line_speed_errors

SPEEDS, PHASES = 40, 64
"""Line speeds and sampling phases at which the sync error over a band is looked at."""

_ROUNDING = 1e-6
"""Share by which a tolerance that a design used up may be exceeded: the accuracy of its programme."""

_SHORTER = (1, 2, 4, 8)
"""By so many times `FOUND_TO` a band is shortened whose cam does not pass every check."""

_NARROWER = (0.5, 0.2, 0.1)
"""Shares of an overlap that are tried where it is too wide."""


_SLOWER = (0.97, 0.9, 0.8, 0.65, 0.5, 0.35)
"""Shares of a line speed that are tried where no cam holds a band below it."""


@dataclass(frozen=True, eq=False)
class FamilyCam(ListCam):
    """A cam of a family; its line speed is the upper end of its band.

    Parameters
    ----------
    band
        Line speeds at which it passes every check.
    errors
        Greatest sync error of each servo over that band, the job's first, then those at the corners of its ranges (m): at `SPEEDS` line
        speeds and `PHASES` sampling phases.
    """

    band: SpeedBand
    errors: tuple[float, ...]

    @property
    def line_speeds(self) -> tuple[float, float]:
        """Lower and upper end of the band that it is for (m/s)."""
        return self.job.line_speeds

    @property
    def passed(self) -> bool:
        """Whether every check passed, and every servo keeps the tolerance."""
        return self.report.passed and max(self.errors) <= self.job.cut.sync_tolerance * (1.0 + _ROUNDING)

    @property
    def objective(self) -> float:
        """The objective at its line speed, in the unit of `camwright.profiles.objective.OBJECTIVES`."""
        if OBJECTIVES[self.job.objective].of != "motor":
            return self.solution.minimised
        value: float | None = getattr(self.report.motor, self.job.objective)
        return math.inf if value is None else value


@dataclass(frozen=True, eq=False)
class FamilyCams:
    """The cams of a family.

    Parameters
    ----------
    job
        The job, its sync zone placed, its origin at the end of the sync zone.
    cams
        Its cams, numbered from 1 at the slowest.
    overlap
        How neighbouring bands overlap.
    holds_line
        Whether the line must keep its speed until a change is over: its ramps would leave the bands.
    at_least
        So many cams any family with this overlap has, as was shown.
    """

    job: Job
    cams: tuple[FamilyCam, ...]
    overlap: Overlap
    holds_line: bool
    at_least: int

    @property
    def fewest(self) -> bool:
        """Whether no family with this overlap has fewer cams."""
        return len(self.cams) == self.at_least


def family_cams(job: Job, overlap: float = OVERLAP, step: Step = ignore, *, hold: bool = False) -> FamilyCams:
    """Find the fewest cams that cover the line speeds of a job, and design them.

    Parameters
    ----------
    job
        A servo-aware job with a range of line speeds.
    overlap
        Share of the line speed by which neighbouring bands overlap; more where the line's ramps ask for it.
    hold
        Whether the line is to keep its speed until a change is over, whatever its ramps.

    Raises
    ------
    InputError
        The job is not servo-aware, or for one line speed alone.
    InfeasibleError
        At some line speed no cam keeps the tolerance and the limits, or over too narrow a band.
    SolverError
        The solver failed.
    """
    _require_band(job)
    step("placing the sync zone")
    asked = _placed(list_job(replace(job, cut=replace(job.cut, origin="return"))))
    step("finding the bands")
    found = family_bands(asked, overlap, hold=hold)
    if isinstance(found, Uncovered):
        raise _uncovered(asked, found.top, overlap)
    covering = found.covering
    cams: list[FamilyCam] = []
    top, many = job.cut.line_speed, len(covering.bands)
    for number in range(many, 0, -1):  # from the fastest down: each begins where the one above it needs it
        step(f"designing cam {number} of {many}")
        cams.append(_cam(number, asked, covering.bands[number - 1][0], top, last=number == 1))
        top = found.overlap.top(cams[-1].line_speeds[0])
    return FamilyCams(asked, tuple(reversed(cams)), found.overlap, found.holds_line, covering.at_least)


def _require_band(job: Job) -> None:
    """Refuse jobs whose cam is in sync, or judged, at one line speed alone."""
    if not job.servo_aware:
        raise InputError(
            f"{job.name}: [objective] servo_aware = false: a family is of servo-aware cams, each in sync over its band of line speeds; "
            "write servo_aware = true"
        )
    if job.slowest == 1.0:
        raise InputError(
            f"{job.name}: [objective] line_speeds is the one line speed of the job, and one cam covers it; write a range, e.g. "
            'line_speeds = ["10 %", "100 %"]'
        )


def _placed(job: Job) -> Job:
    """Put the sync zone where all cams share it; where there is no cam for the full line speed alone, say what would work."""
    try:
        return placed_for_all(job)
    except InfeasibleError:
        return replace(job, machine=solve_or_advise(replace(job, slowest=1.0)).machine)


def _cam(number: int, job: Job, low: float, top: float, *, last: bool) -> FamilyCam:
    """Design the cam of a band; where that does not pass, of one a little shorter, but for the last."""
    share = 1.0 if job.objective == "sync_error" else 1.0 - ROOM  # what makes the error least needs no other bound
    for times in (0,) if last else (0, *_SHORTER):
        asked = replace(band_job(job, low * (1.0 + times * FOUND_TO), top), name=_name(number, job))
        solution = solve_job(within(asked, share), suggest=False)
        report = judge(solution.profile, asked.task, asked.servo, servo_aware=True, slowest=asked.slowest)
        if report.passed:
            break
    return _judged(number, asked, solution, report)


def _judged(number: int, job: Job, solution: Solution, report: ValidationReport) -> FamilyCam:
    """Put a cam with what is known of it."""
    low, top = job.line_speeds
    speeds = np.linspace(low, top, SPEEDS)
    errors = line_speed_errors(solution.profile, job.task, servos_of(job), speeds, PHASES).max(axis=1)
    band = job_band(solution.profile, job, report)
    return FamilyCam(number, job, top, solution, report, band, tuple(errors.tolist()))


def _name(number: int, job: Job) -> str:
    """Name a cam so that no two cams in a controller are called alike."""
    return f"F{number:03d} {job.name}"[:60].rstrip(" .")


def _uncovered(job: Job, top: float, share: float) -> InfeasibleError:
    """Say at which line speed no cam can go on, and what would do; where not even one for that speed alone is possible, why."""
    speed = with_unit(top, "m/s", 6, job.units)
    holds, _ = asking(job)
    try:
        alone = solve_or_advise(band_job(job, top, top))
    except InfeasibleError as error:
        return InfeasibleError(
            f"{job.name}: no family of cams covers its line speeds: at {speed} there is none for that line speed alone. {error.message}",
            error.binding,
            error.excess,
            error.unit,
            error.suggestions,
        )
    narrower = next((share * part for part in _NARROWER if holds(top / (1.0 + share * part), top)), None)
    if narrower is not None:
        return InfeasibleError(
            f"{job.name}: below {speed} no cam holds a band as wide as the overlap of {100 * share:.3g} %; with --overlap "
            f"{100 * narrower:.3g}% the next one follows",
            "overlap",
            None,
            "1",
            (Suggestion("overlap", narrower, "1"),),
        )
    slower = next((part * top for part in _SLOWER if holds(part * top / (1.0 + share), part * top)), None)
    kept = alone.axis is not None and alone.axis.axis_limits
    why = "over a band that is worth a change" if kept else "with the axis, too, within its limits"
    way = (
        "a wider [cut] sync_tolerance is what is left"
        if slower is None
        else f"up to {with_unit(slower, 'm/s', 4, job.units)} one does"
    )
    return InfeasibleError(
        f"{job.name}: no family of cams covers its line speeds: at {speed} no cam keeps the tolerance {why}; {way}",
        "sync_tolerance" if kept else "axis_limits",
        None,
        "m",
        () if slower is None else (Suggestion("line_speed", slower * 60, "m/min"),),
    )
