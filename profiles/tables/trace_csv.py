"""A drive's recording as text: time, command and actual position, each with its unit, as scopes and spreadsheets write them.

The position of the master may stand beside them.
"""

from __future__ import annotations

import math

import numpy as np

from camwright.profiles.errors import InputError
from camwright.profiles.machines.machine import SlaveUnit
from camwright.profiles.polynomial.profile import FloatArray
from camwright.profiles.tables.column_words import trace_role
from camwright.profiles.tables.delimited import Sheet, read_sheet
from camwright.profiles.tables.numbers import is_stamp
from camwright.profiles.tables.scope_csv import is_scope, read_scope, used_rows
from camwright.profiles.tables.trace_columns import columns_by_name, columns_chosen
from camwright.profiles.trace import Trace

MOST_ROWS = 10_000

_LENGTHS = {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "um": 1e-6, "in": 0.0254, "ft": 0.3048}
_ANGLES = {"rad": 1.0, "deg": math.pi / 180, "rev": 2 * math.pi}
_UNITS: dict[str, dict[str, float]] = {
    "time": {"s": 1.0, "ms": 1e-3, "us": 1e-6},
    "command": {**_LENGTHS, **_ANGLES},
    "actual": {**_LENGTHS, **_ANGLES},
    "lag": {**_LENGTHS, **_ANGLES},
    "master": {**_LENGTHS, **_ANGLES},
}
_POSITIONS = ("command", "actual", "lag")
_HEADER = "time [ms],command [mm],actual [mm]"
_WITH_MASTER = "time [ms],master [mm],command [mm],actual [mm]"

_LAG = "command or actual position is made of the other and the lag, which is taken for the command less the actual position"

_UNEQUAL = 0.01
"""What a step of the time may differ from the others, as a part of it: times are rounded."""

_GAP = 1.5
"""Steps, of a usual length each, from which on rows are missing."""


def read_trace_csv(
    text: str, place: str, *, most_rows: int = MOST_ROWS, master: bool = False, columns: str | None = None
) -> Trace:
    """Read a recording: whatever separates its cells, with headings in one line or several.

    Parameters
    ----------
    text
        The recording. Columns of time, command and actual position are known by their names
        (`camwright.profiles.tables.column_words.trace_role`), in any order; other columns are not read. A scope may give each channel a
        column of times; they must be one and the same. Where one of command and actual is missing, the lag of the axis behind its
        command may stand in its place.
    place
        What messages begin with.
    most_rows
        The most rows that are taken.
    master
        Whether the position of the master is read too, where it was recorded; a turn of it is one cycle.
    columns
        Which columns are command and actual, or time, command and actual, where their names do not tell: headings or numbers,
        separated by commas, each with its unit in brackets where the file has none.

    Raises
    ------
    InputError
        The header or a row is not as described, or the rows are not equally spaced in time; the message names the line.
    """
    scope = is_scope(text)
    sheet = (
        read_scope(text, place)
        if scope
        else read_sheet(text, place, trace_role, _WITH_MASTER if master else _HEADER, "recording")
    )
    if columns is None:
        at = columns_by_name(sheet, master, _HEADER)
    else:
        sheet, at = columns_chosen(sheet, columns, master)
    if scope:
        sheet = used_rows(sheet, [k for found in at.values() for k in found])
    factors, unit, notes = _factors(sheet, at)
    rows = len(sheet.rows)
    if rows < 2:
        raise InputError(f"{place}: {rows} rows below the header; a recording has hundreds")
    if rows > most_rows:
        raise InputError(
            f"{place}: {rows} rows, the limit is {most_rows}; cut out a part with lively motion, 2 s at 1 kHz are enough"
        )
    signals = {name: sheet.numbers(found[-1], name) * factors[name] for name, found in at.items()}
    if "lag" in signals:
        lag, notes = signals.pop("lag"), (*notes, _LAG)
        if "command" in signals:
            signals["actual"] = signals["command"] - lag
        else:
            signals["command"] = signals["actual"] + lag
    time = signals["time"]
    step = (time[-1] - time[0]) / (rows - 1)
    for other in at["time"][:-1]:
        if not np.abs(sheet.numbers(other, "time") * factors["time"] - time).max() <= _UNEQUAL * abs(step):
            raise InputError(
                f"{place}: the channels have times of their own, which differ; record all channels at one rate, or export "
                "them interpolated to one"
            )
    _require_equal_steps(time, list(sheet.lines), place)
    return Trace(
        start=float(time[0]),
        step=float(step),
        command=signals["command"],
        actual=signals["actual"],
        unit=unit,
        notes=notes,
        master=signals.get("master"),
        master_unit="rad" if "master" in at and sheet.columns[at["master"][-1]].unit in _ANGLES else "m",
    )


def _factors(sheet: Sheet, at: dict[str, list[int]]) -> tuple[dict[str, float], SlaveUnit, tuple[str, ...]]:
    """Give what makes the columns SI, and the unit of positions; a servo does not depend on how long that is."""
    columns = {name: sheet.columns[found[-1]] for name, found in at.items()}
    positions = [name for name in _POSITIONS if name in columns]
    bare = all(columns[name].unit is None for name in positions)
    factors = {name: 1e-3 if bare and name in positions else _factor(sheet, name, at[name][-1]) for name in columns}
    kinds = {columns[name].unit in _ANGLES for name in positions}
    if len(kinds) > 1:
        raise InputError(
            f"{sheet.where}: {positions[0]} and {positions[1]} are a length and an angle; give both as they are at one axis"
        )
    note = "the positions have no unit in the file: mm is taken, on which the servo's parameters do not depend (name it in the header)"
    return factors, "rad" if kinds.pop() else "m", (note,) if bare else ()


def _factor(sheet: Sheet, name: str, at: int) -> float:
    """Give what makes a column SI that must say its unit."""
    column, units = sheet.columns[at], _UNITS[name]
    if column.unit is not None:
        if not column.known or column.unit not in units:
            raise sheet.not_in(name, column.unit, units)
        return units[column.unit]
    if name == "time" and sheet.rows and is_stamp(sheet.rows[0][at]):
        raise InputError(
            f"{sheet.place}, line {sheet.lines[0]}: {sheet.rows[0][at].strip()[:40]!r} is a time of day; export the time "
            "since the start of the recording, e.g. time [ms]"
        )
    example = f"{name} [{'ms' if name == 'time' else 'mm'}]"
    raise InputError(f"{sheet.where}: column {name} has no unit; write it in brackets, e.g. {example}")


def _require_equal_steps(time: FloatArray, lines: list[int], place: str) -> None:
    """Refuse times that do not increase, that leave some out, or that are not equally spaced."""
    steps = np.diff(time)
    if not (steps > 0.0).all():
        raise InputError(
            f"{place}, line {lines[1 + int(np.argmin(steps > 0.0))]}: the time does not increase from the row before; sort the rows by "
            "time, each time once"
        )
    usual = float(np.median(steps))
    gaps = np.flatnonzero(steps > _GAP * usual)
    if len(gaps):
        raise InputError(
            f"{place}, line {lines[1 + int(gaps[0])]}: a gap of {steps[gaps[0]] * 1e3:.4g} ms where rows are {usual * 1e3:.4g} ms apart"
            + (f", the first of {len(gaps)}" if len(gaps) > 1 else "")
            + "; record again, or cut out a part without gaps"
        )
    off = np.abs(steps - usual)
    if off.max() > _UNEQUAL * usual:
        worst = int(off.argmax())
        raise InputError(
            f"{place}, line {lines[1 + worst]}: {steps[worst] * 1e3:.4g} ms after the row before where rows are {usual * 1e3:.4g} ms "
            "apart; the sampling must be equal: record at a fixed rate"
        )
