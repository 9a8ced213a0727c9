"""Ways out of a job that fails a check or cannot be done: single changes of the job file, each designed and judged before it is told."""

from __future__ import annotations

from collections.abc import Iterator
from copy import deepcopy
from dataclasses import dataclass, replace
from typing import Any

from camwright.design.optimise import Solution
from camwright.house.numbers import METRIC, Units, inside, with_unit
from camwright.house.toml_file import toml_data
from camwright.jobs.job import Job, read_job
from camwright.jobs.wording import place_of
from camwright.profiles.errors import CamwrightError, Covered, InfeasibleError, SolverError, Suggestion
from camwright.profiles.objective import OBJECTIVES
from camwright.profiles.servo import mean_lag
from camwright.studies.axis_study import beyond_reach, greatest_sync_error, solve_job
from camwright.studies.covering import Uncovered
from camwright.studies.family_bands import family_bands, placed_for_all
from camwright.studies.reach import stand_in, verdict
from camwright.studies.speed_band import SpeedBand, failed_checks
from camwright.validation.report import ValidationReport, judge

MOST, LONG = 30, 3
"""Designs after which no more changes are tried, and as how many one counts for the axis or of the motor, which takes longer: a count, so
that the answer is the same on every machine."""

_SLOWER = (1.0, 0.97, 0.9, 0.8, 0.65, 0.5, 0.35, 0.25, 0.15, 0.1, 0.05)
_ZONES = (1.1, 0.9, 1.25, 0.75, 1.5, 0.5, 1.75, 2.0, 0.3)
_WIDER = (1.02, 1.1, 1.3, 1.7, 2.5, 4.0)
"""Factors that are tried in turn on a line speed, a sync zone and a tolerance."""

_FURTHER = (1.03, 1.1, 1.18, 1.27, 1.4, 1.6, 2.0)
_SLOWER_YET = (2.7, 4.0, 6.0, 10.0, 20.0)
"""Factors by which a change is taken further that makes a motion possible but does not yet pass; a line speed further still."""

_DIGITS = 4
"""Significant digits of a value that is told."""

_FINE_DIGITS = 6
"""Significant digits of a suggestion that is told in other units than it was found in."""

_METRIC = {"mm": "m", "m/min": "m/s", "m/s^2": "m/s^2", "m/s^3": "m/s^3"}
"""SI unit of the units of suggestions that a job in other units is not told in."""

_TABLES = {"servo_aware": "objective", "command": "objective", "stroke": "machine"}
"""Tables of a job file with keys that no message names."""

Bands = tuple[tuple[float, float], ...]
"""Lower and upper end (m/s) of the bands of a family, ascending."""


@dataclass(frozen=True)
class Remedy:
    """A single change with which a job was designed and passed every check.

    Parameters
    ----------
    change
        Key of the job file. ``"command"`` goes with ``servo_aware = true``.
    value, unit
        What to write: a number and its unit, or a word, or true, without one. For ``"line_speeds"`` it is where they begin.
    also
        What must be changed with it: line speeds that end at the old one.
    """

    change: str
    value: float | str | bool
    unit: str
    also: str = ""

    @property
    def words(self) -> str:
        """The change as a line of a job file, its table before it, and what must go with it."""
        return f"{self._alone}, {self.also}" if self.also else self._alone

    @property
    def _alone(self) -> str:
        also = "servo_aware = true, " if self.change == "command" else ""
        return f"{_place(self.change).replace(f'] {self.change}', f'] {also}{self.change}')} = {_written(self)}"


class _Trial:
    """A job whose changes are tried, up to a number of designs."""

    def __init__(self, job: Job) -> None:
        self._data = toml_data(job.text, "job", "job file")
        self._left = MOST
        band = self._data.get("objective", {}).get("line_speeds")
        self._slowest = str(band[0]) if isinstance(band, list) and len(band) == 2 else ""

    def works(self, remedy: Remedy) -> bool:
        """Whether the job with a change is designed and passes every check; false where no design is left to see."""
        if self._left <= 0:
            return False
        data = deepcopy(self._data)
        if remedy.also:
            data["objective"]["line_speeds"] = [self._slowest, "100 %"]
        table = data.setdefault(_table(remedy.change), {})
        value = f"{remedy.value:.15g} {remedy.unit}" if remedy.unit else remedy.value
        table[_key(remedy.change)] = [value, "100 %"] if remedy.change == "line_speeds" else value
        if remedy.change == "command":
            table["servo_aware"] = True
        try:
            other = read_job(data, None, "job")
            if _hopeless(other):
                return False
            self._left -= LONG if other.servo_aware or OBJECTIVES[other.objective].of == "motor" else 1
            return _passes(other)
        except CamwrightError:
            return False

    def first(self, remedies: Iterator[Remedy]) -> Iterator[Remedy]:
        """Give the first of some changes that works, if any."""
        for remedy in remedies:
            whole = self._with(remedy)
            if self.works(whole):
                yield whole
                return

    def _with(self, remedy: Remedy) -> Remedy:
        """Add to another line speed that line speeds which end at the old one end at it too."""
        if remedy.change != "line_speed" or not self._slowest:
            return remedy
        return replace(remedy, also=f'[objective] line_speeds = ["{self._slowest}", "100 %"]')


def _hopeless(job: Job) -> bool:
    """Whether even the motion that stands in for a job of the motor fails, or some line speeds prove that no axis keeps to the material.

    Either is known in a fraction of the time of a design.
    """
    if job.servo_aware:
        return beyond_reach(job)
    return OBJECTIVES[job.objective].of == "motor" and bool(verdict(job, job.task, stand_in(job))[0])


def _passes(job: Job) -> bool:
    """Whether a job is designed, passes every check, and keeps the tolerance over the ranges of its servo."""
    solution = solve_job(job, suggest=False)
    task = job.task.with_machine(solution.machine)
    if not judge(solution.profile, task, job.servo, servo_aware=job.servo_aware, slowest=job.slowest).passed:
        return False
    if job.servo_tolerance is None:
        return True
    worst = greatest_sync_error(solution.profile, job)
    return worst is not None and worst <= job.cut.sync_tolerance * (1 + 1e-6)


def remedies(job: Job, report: ValidationReport, band: SpeedBand) -> tuple[Remedy, ...]:
    """Try what may make a job pass of whose cam a check failed.

    The lead time that makes up for the mean lag, a lower line speed, a wider tolerance, a command for the servo, in sync or shaped, least
    RMS jerk and another sync zone, each alone and in this order; of a number the nearest of some values. What was not tried in `MOST`
    designs is not told.

    Parameters
    ----------
    band
        The line speeds at which that cam passes.

    Returns
    -------
    tuple
        Changes that were designed and passed; none where every check passed.
    """
    if not failed_checks(report, band, job.cut.line_speed):
        return ()
    trial, cut = _Trial(job), job.cut
    error = next((check.value for check in report.checks if check.name == "shear_zone_error"), None)
    lower = [high for _, high in band.parts if high < cut.line_speed]
    start = lower[-1] if lower else cut.line_speed
    ways = [_led(job), _values("line_speed", start, "m/s", _SLOWER if lower else _SLOWER[1:], job.units, up=False)]
    if error is not None:
        ways.append(_values("sync_tolerance", max(error, cut.sync_tolerance), "m", _WIDER, job.units, up=True))
    if not job.servo_aware:
        ways.append(iter([Remedy("servo_aware", True, "")]))
    if job.command != "shaped":
        ways.append(iter([Remedy("command", "shaped", "")]))
    if job.objective != "rms_jerk":
        ways.append(iter([Remedy("minimise", "rms_jerk", "")]))
    ways.append(_values("sync_zone", cut.sync_zone, "m", _ZONES, job.units, up=False))
    return tuple(remedy for way in ways for remedy in trial.first(way))


def solve_or_advise(job: Job) -> Solution:
    """Design the cycle of a job; where that cannot be, say what would work, every change designed and judged first.

    Raises
    ------
    InfeasibleError
        No motion keeps the limits, or none brings the axis into the tolerance; its suggestions are designed and pass every check.
    SolverError
        The solver failed.
    """
    try:
        return solve_job(job, suggest=False)
    except InfeasibleError as error:
        reason, excess = error, error.excess
    try:
        return solve_job(job, proved=False)  # every change is designed and judged below
    except InfeasibleError as error:
        offered, line_speeds = error.suggestions, error.covered.part
        if excess is None and error.binding == reason.binding:
            excess = error.excess  # by how much is found with what would work
    trial = _Trial(job)
    found = list(trial.first(_led(job))) if job.servo_aware else []
    found += [remedy for suggestion in offered for remedy in trial.first(_taken_further(suggestion, job.units))]
    if job.servo_aware and job.command != "shaped":
        found += trial.first(iter([Remedy("command", "shaped", "")]))
    offers = "; ".join(remedy.words for remedy in found)
    works = (
        f"What works, each alone, designed and checked: {offers}" if offers else "No single change that was tried works"
    )
    kept = tuple(Suggestion(each.change, _number(each), each.unit) for each in found)
    part = ""
    if line_speeds is not None and line_speeds[0] < line_speeds[1]:
        low, high = (with_unit(speed, "m/s", units=job.units) for speed in line_speeds)
        part = f". One is held to it from {low} to {high}"
    bands = family_of(job)
    family = f". {family_words(bands, job.units)}" if bands else ""
    raise InfeasibleError(
        f"{reason.message}{part}. {works}{family}",
        reason.binding,
        excess,
        reason.unit,
        kept,
        Covered(line_speeds, bands),
    ) from reason


def family_of(job: Job) -> Bands | None:
    """Find the bands of a family of cams where no single one holds a job's line speeds; ``None`` where there is no such family."""
    if not job.servo_aware or job.slowest == 1.0:
        return None
    try:  # zones that last a time are as long on the material as at the job's line speed, for all cams alike
        fixed = replace(job, cut=replace(job.cut, sync_time=None, shear_time=None))
        found = family_bands(placed_for_all(fixed))
    except (InfeasibleError, SolverError):
        return None
    return None if isinstance(found, Uncovered) or len(found.covering.bands) == 1 else found.covering.bands


def family_words(bands: Bands, units: Units) -> str:
    """Tell the bands of a family."""
    speeds = [tuple(with_unit(speed, "m/s", 4, units) for speed in band) for band in bands]
    told = ", ".join(f"{low} to {high}" for low, high in speeds)
    return f"A family of {len(bands)} cams covers its line speeds, each holds a band (camwright family): {told}"


def _led(job: Job) -> Iterator[Remedy]:
    """Give the lead time that makes up for the mean lag, where another is set."""
    lag = float(f"{mean_lag(job.servo) * 1e3:.{_DIGITS}g}")
    if abs(lag - job.servo.lead_time * 1e3) > 0.01 * lag:
        yield Remedy("lead_time", lag, "ms")


def _taken_further(suggestion: Suggestion, units: Units) -> Iterator[Remedy]:
    """Give a suggestion in the units that the job is written in, and if that does not pass yet, more of it."""
    if suggestion.change == "reversal":
        yield Remedy("reversal", True, "")
        return
    if suggestion.change == "motor":
        return  # a curve of many numbers: no single value to write
    up = suggestion.change != "line_speed" and not suggestion.change.startswith("line.")
    value, unit = inside(suggestion.value, _FINE_DIGITS, up=up), suggestion.unit
    si = _METRIC.get(unit)
    if si is not None and units is not METRIC:
        shown = units.shown[si]
        value = inside(value / METRIC.shown[si].factor * shown.factor, _FINE_DIGITS, up=up)
        unit = shown.typed or shown.printed
    yield Remedy(suggestion.change, value, unit)
    for factor in _FURTHER + (_SLOWER_YET if suggestion.change == "line_speed" else ()):
        yield Remedy(suggestion.change, inside(value * (factor if up else 1.0 / factor), _DIGITS, up=up), unit)


def _values(
    change: str, value: float, unit: str, factors: tuple[float, ...], units: Units, *, up: bool
) -> Iterator[Remedy]:
    """Give multiples of an SI value in the unit that the job is written in, rounded to the safe side."""
    shown = units.shown[unit]
    for factor in factors:
        yield Remedy(change, inside(factor * value * shown.factor, _DIGITS, up=up), shown.typed or shown.printed)


def _number(remedy: Remedy) -> float:
    """Give the number of a suggestion: 1 for a word or a truth."""
    return float(remedy.value) if isinstance(remedy.value, float) else 1.0


def _table(change: str) -> str:
    """Name the table of a job file that holds a key."""
    return _place(change).partition("]")[0].removeprefix("[")


def _key(change: str) -> str:
    """Name the key of a change: that of ``"line.stop"`` is ``stop``."""
    return change.rpartition(".")[2]


def _place(change: str) -> str:
    """Say where in a job file a key stands."""
    table = _TABLES.get(change)
    return place_of(change) if table is None else f"[{table}] {change}"


def _written(remedy: Remedy) -> str:
    """Write the value as TOML."""
    value: Any = remedy.value
    if isinstance(value, bool):
        return "true"
    if remedy.change == "line_speeds":
        return f'["{value:.15g} {remedy.unit}", "100 %"]'
    return f'"{value}"' if isinstance(value, str) else f'"{value:.15g} {remedy.unit}"'
