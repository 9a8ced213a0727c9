"""The rows of a book's index and of its limit table."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import groupby

from camwright.book.entry import Entry, Limit
from camwright.book.plan import Book
from camwright.book.units import BookUnits

Cell = str | float | int | None
"""A text, a number, or nothing."""

COLUMNS = (
    "number",
    "length_mm",
    "line_speed_m_per_min",
    "objective",
    "status",
    "value",
    "unit",
    "peak_speed_m_per_s",
    "peak_acceleration_m_per_s2",
    "rms_acceleration_m_per_s2",
    "peak_jerk_m_per_s3",
    "following_error_mm",
    "settling_mm",
    "shear_zone_error_mm",
    "worst_shear_zone_error_mm",
    "released_m_per_min",
    "tables",
    "failed_checks",
    "binding",
    "reason",
    "folder",
)
"""Columns of the index, of a metric book. ``worst_shear_zone_error_mm`` is that of the worst servo of the corners of ``[servo.tolerance]``;
``released_m_per_min`` are the line speeds at which this very cam passes every check; ``tables`` names each target with the points of
its table."""

LIMIT_COLUMNS = (
    "length_mm",
    "objective",
    "highest_line_speed_m_per_min",
    "released_m_per_min",
    "lower_that_fail",
    "next_line_speed_m_per_min",
    "binding",
    "physical_line_speed_m_per_min",
    "physical_binding",
    "axis_in_tolerance_line_speed_m_per_min",
    "axis_in_tolerance_binding",
    "mark_earliest_mm",
    "mark_latest_mm",
    "line_ramp_m_per_s2",
    "line_stop_m_per_s2",
)
"""Columns of the limit table of a metric book, see `limit_rows`."""


@dataclass(frozen=True)
class Counts:
    """How many combinations ended how."""

    designs: int = 0
    passed: int = 0
    check_failed: int = 0
    infeasible: int = 0
    failed: int = 0


def count(entries: Iterable[Entry]) -> Counts:
    """Count entries by how they ended."""
    found = dict.fromkeys(("passed", "check_failed", "infeasible", "failed"), 0)
    for entry in entries:
        found[entry.status] += 1
    return Counts(designs=sum(found.values()), **found)


def index_rows(book: Book, entries: Iterable[Entry]) -> Iterator[list[Cell]]:
    """Give a row of `COLUMNS` for every combination, in the units of the book."""
    units = book.units
    length = float(units.per_metre)
    for entry in entries:
        of = book.combination(entry.number)
        value, unit = units.valued(entry.objective, entry.unit)
        yield [
            entry.number,
            float(of.length * units.per_metre),
            float(of.line_speed * units.per_metre_per_second),
            of.objective,
            entry.status,
            value,
            unit or None,
            _times(entry.peak_speed, units.velocity),
            _times(entry.peak_acceleration, units.acceleration),
            _times(entry.rms_acceleration, units.acceleration),
            _times(entry.peak_jerk, units.jerk),
            _times(entry.following_error, length),
            _times(entry.settling, length),
            _times(entry.shear_zone_error, length),
            _times(entry.worst_shear_zone_error, length),
            _released(entry.speed_band, units),
            " ".join(f"{name}:{points}" for name, points in entry.tables) or None,
            "; ".join(entry.failed_checks) or None,
            entry.binding or None,
            entry.reason or None,
            of.folder if entry.files else None,
        ]


def limit_rows(book: Book, entries: Iterable[Entry]) -> Iterator[list[Cell]]:
    """Give a row of `LIMIT_COLUMNS` for every cut length and objective, in the units of the book.

    The highest line speed is the highest of the book's own at which every check passed and every table was released; how many lower
    ones of the book do not is said beside it. Beside it, too, stand the line speeds at which the cam of that highest speed passes every
    check: it is released for no others, and starting up takes it through what lies below them. What binds is what forbids the next one
    of the book. The physical line speed is that of the limits of speed, acceleration, jerk and reversal alone, as ``camwright limits``
    finds it; the servo may not settle there. That with the axis in tolerance is the one to which a PLC may let an operator go, with a cam
    designed for it. Last stand the corrections to which a PLC clamps print marks at the highest line speed of the book,
    and how hard its line may ramp and stop between standstill and that speed.
    """
    for _, group in groupby(entries, key=lambda entry: book.indices(entry.number)[0]):
        at_length = list(group)
        limit = next((entry.limit for entry in at_length if entry.limit), None)
        for index, objective in enumerate(book.objectives):
            own = [entry for entry in at_length if book.indices(entry.number)[2] == index]
            yield _limit_row(book, own, objective, limit)


def _limit_row(book: Book, entries: list[Entry], objective: str, limit: Limit | None) -> list[Cell]:
    """Give the row of one cut length and one objective; the entries ascend by line speed."""
    works = [index for index, entry in enumerate(entries) if entry.status == "passed"]
    beyond = works[-1] + 1 if works else 0
    of, units = book.combination(entries[0].number), book.units
    speed = units.per_metre_per_second
    highest, next_one = (
        float(book.combination(entry.number).line_speed * speed)
        for entry in (entries[beyond - 1], entries[min(beyond, len(entries) - 1)])
    )
    bound = limit or Limit(None, "", None, "")
    may, holds = (
        None if value is None else _rounded_down(value * float(speed))
        for value in (bound.line_speed, bound.in_tolerance)
    )
    return [
        float(of.length * units.per_metre),
        objective,
        highest if works else None,
        _released(entries[beyond - 1].speed_band, units) if works else None,
        beyond - len(works),
        *((next_one, _binding(entries[beyond])) if beyond < len(entries) else (None, None)),
        may,
        None if limit is None else limit.binding,
        holds,
        None if limit is None else limit.failing,
        *((*_mark_ends(entries[beyond - 1]), *_ramps(entries[beyond - 1], units)) if works else (None,) * 4),
    ]


def _mark_ends(entry: Entry) -> tuple[float | None, float | None]:
    """Write both ends of what a print mark may ask (mm), rounded towards zero; nothing for no limit."""
    early, late = (None if end is None else int(end * 1e6) / 1e3 for end in (entry.mark_earliest, entry.mark_latest))
    return early, late


def _ramps(entry: Entry, units: BookUnits) -> tuple[float | None, float | None]:
    """Write how hard the line may ramp and stop, rounded down; nothing for no limit."""
    ramp, stop = (
        None if value is None else _rounded_down(value * units.acceleration) if value else 0.0
        for value in (entry.line_ramp, entry.line_stop)
    )
    return ramp, stop


def _binding(entry: Entry) -> str:
    """Say in a word or two what forbids a combination."""
    if entry.status == "failed":
        return "solver"
    return entry.binding or " ".join(dict.fromkeys(name.rpartition(": ")[2] for name in entry.failed_checks))


def _rounded_down(value: float) -> float:
    """Round to seven digits, downwards: a limit that is kept is below the one that was found."""
    scale = 10.0 ** (6 - math.floor(math.log10(value)))
    return math.floor(value * scale) / scale


def _times(value: float | None, factor: float) -> float | None:
    return None if value is None else value * factor


def _released(band: tuple[tuple[float, float], ...], units: BookUnits) -> str | None:
    """Write the line speeds at which a cam passes every check, each end rounded to its inside; nothing where there are none."""
    speed = float(units.per_metre_per_second)
    parts = [(_rounded_up(speed * low), _rounded_down(speed * high)) for low, high in band]
    return "; ".join(f"{low:.7g} to {high:.7g}" for low, high in parts) or None


def _rounded_up(value: float) -> float:
    """Round to seven digits, upwards."""
    if value <= 0.0:
        return 0.0
    scale = 10.0 ** (6 - math.floor(math.log10(value)))
    return math.ceil(value * scale) / scale
