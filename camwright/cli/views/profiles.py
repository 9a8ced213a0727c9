"""Profiles side by side."""

from __future__ import annotations

from collections.abc import Sequence

from camwright.cli.views.parts import View, fitting, new_table, new_text, stacked
from camwright.cli.views.whole_table import WholeTable
from camwright.house.numbers import Shown, number, shown, unit_shown, with_unit
from camwright.jobs.job import Job
from camwright.profiles.objective import OBJECTIVES
from camwright.studies.comparison import Comparison

_WIDE = 130
"""Columns of a terminal from which all measures stand in one table."""

_MOST = 4
"""Columns beside the name that a terminal of 80 columns shows."""

_BROKEN, _BEYOND = "†", "‡"


def profiles_view(comparison: Comparison) -> View:
    """Show profiles side by side by the job's objective, what breaks a limit marked and last; on a narrow terminal in several tables."""
    groups = [_motion(comparison), _motor(comparison), _servo(comparison)]
    wide = _table(comparison, [column for group in groups for column in group])
    narrow = stacked(*(_table(comparison, part) for group in groups for part in _parts(group)))
    notes = []
    if any(not row.within_limits for row in comparison.rows):
        notes.append(new_text(f"{_BROKEN} breaks a limit of the job"))
    if any(_BEYOND in cell for _, cells in groups[-1] for cell in cells):
        tolerance = with_unit(comparison.job.cut.sync_tolerance, "m", units=comparison.job.units)
        notes.append(new_text(f"{_BEYOND} beyond the sync tolerance of {tolerance}"))
    if comparison.screw is not None:
        notes.append(new_text(comparison.screw.sentence))
    return stacked(fitting(wide, narrow, _WIDE), *notes)


Column = tuple[str, list[str]]
"""Heading of two lines, and a cell for each profile."""


def _parts(columns: list[Column]) -> list[list[Column]]:
    """Divide columns into tables of at most `_MOST`, the later columns together."""
    if len(columns) <= _MOST:
        return [columns] if columns else []
    half = (len(columns) + 1) // 2
    return [columns[:half], columns[half:]]


def _table(comparison: Comparison, columns: Sequence[Column]) -> WholeTable:
    """Lay out some columns."""
    what = OBJECTIVES[comparison.job.objective].words
    heads = ("profile", *(heading for heading, _ in columns))
    table = new_table(f"Profiles, by {what}", heads, heads[:1], heads)
    for number_of, row in enumerate(comparison.rows):
        name = row.name if row.within_limits else f"{row.name} {_BROKEN}"
        cells = [cells[number_of] for _, cells in columns]
        table.add_row(name, *cells, style="bold" if row.name == "optimised" else "")
    return table


def _motion(comparison: Comparison) -> list[Column]:
    """Measures of the slave's motion; the job's objective among them."""
    unit, units, rows = comparison.job.machine.slave_unit, comparison.job.units, comparison.rows
    speed, acceleration, jerk = (units.measure(unit + power) for power in ("/s", "/s^2", "/s^3"))
    columns = [
        (f"peak speed\n{speed.printed}", [_in(row.motion.peak_speed, speed) for row in rows]),
        (f"peak acc.\n{acceleration.printed}", [_in(row.motion.peak_acceleration, acceleration) for row in rows]),
        (f"RMS acc.\n{acceleration.printed}", [_in(row.motion.rms_acceleration, acceleration) for row in rows]),
        (f"peak jerk\n{jerk.printed}", [_in(row.motion.peak_jerk, jerk) for row in rows]),
    ]
    if comparison.job.objective == "rms_jerk":
        columns[3] = (f"RMS jerk\n{jerk.printed}", [_in(row.motion.rms_jerk, jerk) for row in rows])
    return columns


def _motor(comparison: Comparison) -> list[Column]:
    """Measures of the motor, where the job says what it moves."""
    motors = [row.motor for row in comparison.rows]
    if comparison["optimised"].motor.rms_torque is None:
        return []
    return [
        ("peak torque\nN m", [number(motor.peak_torque, without="unbounded") for motor in motors]),
        ("RMS torque\nN m", [number(motor.rms_torque, without="unbounded") for motor in motors]),
        ("energy\nJ", [number(motor.energy, without="unbounded") for motor in motors]),
    ]


def _servo(comparison: Comparison) -> list[Column]:
    """List what the axis makes of it; its worst over the ranges of the servo too, where the job gives some."""
    units, rows = comparison.job.units, comparison.rows
    unit = unit_shown("m", units)
    columns = [
        (f"crossing\n{unit}", [shown(row.response.crossing, "m", 4, units) for row in rows]),
        (f"settling\n{unit}", [shown(row.response.settling, "m", 4, units) for row in rows]),
        (f"following\n{unit}", [shown(row.response.peak_following_error, "m", 4, units) for row in rows]),
        (f"sync error\n{unit}", [_error(row.response.shear_zone_error, comparison.job) for row in rows]),
    ]
    if any(row.worst_error is not None for row in rows):
        columns.append((f"worst servo\n{unit}", [_error(row.worst_error, comparison.job) for row in rows]))
    return columns


def _error(error: float | None, job: Job) -> str:
    """Write a sync error in the shear zone, marked if it is beyond the tolerance."""
    beyond = error is not None and error > job.cut.sync_tolerance
    return shown(error, "m", 4, job.units) + (f" {_BEYOND}" if beyond else "")


def _in(value: float | None, unit: Shown) -> str:
    """Write a measure in a unit."""
    return number(None if value is None else value * unit.factor, without="unbounded")
