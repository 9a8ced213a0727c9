"""A cam as rows of a text: which column is what, in which unit; from camwright's own CSV to what a spreadsheet or a cam editor exports."""

from __future__ import annotations

import difflib
import math
from dataclasses import dataclass

import numpy as np

from camwright.profiles.errors import InputError
from camwright.profiles.machines.machine import SlaveUnit
from camwright.profiles.polynomial.profile import FloatArray
from camwright.profiles.tables.column_words import cam_role, is_unsized
from camwright.profiles.tables.delimited import FEWEST_LISTED, Column, Sheet, read_sheet
from camwright.profiles.tables.derivative_columns import scaled_derivatives
from camwright.profiles.tables.text import refuse

_LENGTHS: dict[str, tuple[float, float]] = {
    "m": (1, 1), "mm": (1, 1000), "cm": (1, 100), "um": (1, 1e6), "in": (127, 5000), "ft": (381, 1250)
}  # fmt: skip
_DERIVATIVES: dict[str, dict[str, tuple[float, float]]] = {
    "dy/dx": {"1": (1, 1), "m/m": (1, 1), "mm/mm": (1, 1), "rad/m": (1, 1)},
    "d2y/dx2": {"1/m": (1, 1), "1/mm": (1000, 1), "rad/m^2": (1, 1)},
    "d3y/dx3": {"1/m^2": (1, 1), "1/mm^2": (1e6, 1), "rad/m^3": (1, 1)},
}
# How a number in a unit becomes SI: multiplied by the first, divided by the second.
_TURNS = ("deg", "rev")
_TIMES = ("s", "ms", "us")
_X_UNITS = (*_LENGTHS, "rad", *_TURNS)
_Y_UNITS = (*_LENGTHS, "rad", *_TURNS)
_NAMES = ("x", "y", *_DERIVATIVES)
_EXAMPLE = "x [mm],y [mm]"
FEWEST_ROWS = 4
_FEWEST_PLAIN = 3
"""Rows of columns without names: three points make a spline."""

_CLOSEST = 1e-12
"""Least distance of two rows on the master as a part of the table's length: closer rows hold no derivatives."""


@dataclass(frozen=True, eq=False)
class CamRows:
    """Rows of a cam table.

    Parameters
    ----------
    x
        Master positions, shape ``(n,)``, increasing.
    y
        Slave positions, shape ``(n,)``.
    dy
        Ratio, shape ``(n,)``, if the table has it.
    d2y
        Ratio slope, shape ``(n,)``, if the table has it.
    slave_unit
        Whether the slave is counted in m or in rad.
    words
        Units of master and slave as the file names them, ``None`` for one that it does not name, where they are no SI
        units without a job: a degree of the master is part of a cycle. All numbers are then those of the file. With
        ``None`` they are SI: m, slave unit, slave unit per m, per m².
    notes
        What was found worth telling.
    listed
        Whether only slave positions are in the file: the last may end the cycle, or be a step before its end.
    """

    x: FloatArray
    y: FloatArray
    dy: FloatArray | None = None
    d2y: FloatArray | None = None
    slave_unit: SlaveUnit = "m"
    words: tuple[str | None, str | None] | None = None
    notes: tuple[str, ...] = ()
    listed: bool = False


def read_cam_csv(text: str, place: str) -> CamRows:
    """Read a table: whatever separates its cells, with headings in one line or several, or none.

    Parameters
    ----------
    text
        The table. Columns are known by their names (`camwright.profiles.tables.column_words`); without names the first two
        are master and slave, behind an index if there is one. ``dy/dx`` and ``d2y/dx2`` with their units are taken as they
        stand; columns of velocity and acceleration in other units are scaled so that they belong to the positions, and
        left out, with a note, where they do not.
    place
        What messages begin with.

    Raises
    ------
    InputError
        The header or a row is not as described; the message names the line.
    """
    sheet = read_sheet(text, place, cam_role, _EXAMPLE, "table")
    if len(sheet.columns) == 1 and len(sheet.rows) >= FEWEST_LISTED:
        return _listed(sheet)
    at, notes = _roles(sheet)
    x_unit, y_unit = _unit(sheet, at["x"], "x", _X_UNITS), _unit(sheet, at["y"], "y", _Y_UNITS)
    exact = _stated_derivatives(sheet, at, y_unit)
    fewest = _FEWEST_PLAIN if x_unit is None or y_unit is None else FEWEST_ROWS
    if len(sheet.rows) < fewest:
        raise InputError(
            f"{place}: {len(sheet.rows)} rows; a cam table needs {fewest} at least, from the start to the end of a cycle"
        )
    columns = {name: sheet.numbers(column) for name, column in at.items() if name in ("x", "y", "dy/dx", "d2y/dx2")}
    columns, order_notes = _in_order(columns, sheet.lines, place)
    si = x_unit in _LENGTHS and (y_unit in _LENGTHS or y_unit == "rad")
    for name, unit in (("x", x_unit), ("y", y_unit)) if si else ():
        columns[name] = _si(columns[name], _LENGTHS.get(str(unit), (1.0, 1.0)))
    y, dy, d2y, more = _derivatives(columns, exact if si else {})
    words = None if si else (x_unit, y_unit)
    return CamRows(columns["x"], y, dy, d2y, "rad" if y_unit == "rad" else "m", words, (*notes, *order_notes, *more))


def _derivatives(
    columns: dict[str, FloatArray], exact: dict[str, tuple[float, float]]
) -> tuple[FloatArray, FloatArray | None, FloatArray | None, tuple[str, ...]]:
    """Give positions, ratio and ratio slope, by what makes them SI or scaled to the positions, and what to say of it."""
    y, dy, d2y = columns["y"], columns.get("dy/dx"), columns.get("d2y/dx2")
    if dy is None or d2y is None:
        return y, None, None, ()
    if exact:
        return y, _si(dy, exact["dy/dx"]), _si(d2y, exact["d2y/dx2"]), ()
    scaled = scaled_derivatives(columns["x"], y, dy, d2y)
    if scaled is None:
        unused = "the columns of velocity and acceleration do not belong to the positions, and are not used"
        return y, None, None, (unused,)
    return *scaled, ("velocity and acceleration are scaled so that they belong to the positions",)


def _listed(sheet: Sheet) -> CamRows:
    """Take one column for slave positions, a step of the master apart."""
    y = sheet.numbers(0)
    note = f"one column of {len(y)} numbers is taken for slave positions at even steps of the master"
    return CamRows(
        np.arange(float(len(y))), y, words=(None, _unit(sheet, 0, "y", _Y_UNITS)), notes=(note,), listed=True
    )


def _si(values: FloatArray, factor: tuple[float, float]) -> FloatArray:
    return values * factor[0] / factor[1]


def _roles(sheet: Sheet) -> tuple[dict[str, int], tuple[str, ...]]:
    """Say which column is what."""
    at: dict[str, int] = {}
    for number, column in enumerate(sheet.columns):
        role = cam_role(column.name) if column.name else None
        if role in (None, "other", "index"):
            continue
        if role in at:
            first = sheet.columns[at[str(role)]].heading
            raise InputError(
                f"{sheet.where}: column {role} stands there twice; leave one out ({first[:50]!r} and {column.heading[:50]!r})"
            )
        at[str(role)] = number
    if ("x" not in at and "y" not in at) or len(sheet.columns) < 2:
        return _by_order(sheet)
    if "x" not in at:  # master positions that are called an index are all there is
        counted = [k for k, column in enumerate(sheet.columns) if cam_role(column.name) == "index"]
        at |= {"x": counted[0]} if counted else {}
    for name in ("x", "y"):
        if name not in at:
            raise _missing(sheet, name, [column for k, column in enumerate(sheet.columns) if k not in at.values()])
    if ("dy/dx" in at) != ("d2y/dx2" in at):
        only = at.pop("dy/dx", at.pop("d2y/dx2", 0))
        return at, (f"column {sheet.columns[only].heading!r} is not used: velocity and acceleration go together",)
    return at, ()


def _missing(sheet: Sheet, name: str, left: list[Column]) -> InputError:
    """Say that a column is missing, and which of those that are left it may be."""
    if name == "x" and any(column.unit in _TIMES for column in left):
        return InputError(
            f"{sheet.where}: column x is missing, a time stands there; write the master's position in its place, the line speed times that"
        )
    told = ""
    for column in left[:3]:
        close = difflib.get_close_matches(column.name[:50], _NAMES, n=1)
        told += f"there is no column {column.heading[:50]!r}; " + (f"did you mean {close[0]}?; " if close else "")
    return InputError(f"{sheet.where}: column {name} is missing; {told}write a header like {_EXAMPLE}")


def _by_order(sheet: Sheet) -> tuple[dict[str, int], tuple[str, ...]]:
    """Columns without names: master and slave, behind an index that counts the rows."""
    numeric = [k for k in range(len(sheet.columns)) if sheet.is_numeric(k)]
    if not sheet.rows or len(sheet.columns) < 2:
        example = f"write a header like {_EXAMPLE} and rows below"
        raise InputError(f"{sheet.place}: there is no table of two columns in it; {example}")
    if len(numeric) < 2:
        numeric = list(range(len(sheet.columns)))  # the cell that is none is named when it is read
    notes: tuple[str, ...] = ()
    if len(numeric) > 2:
        counted = sheet.numbers(numeric[0])
        second = sheet.numbers(numeric[1])
        if (
            len(counted) > 1
            and (np.diff(counted) == 1.0).all()
            and counted[0] in (0.0, 1.0)
            and (np.diff(second) > 0).all()
        ):
            numeric = numeric[1:]
            notes += ("the first column counts the rows",)
    if len(numeric) > 2:
        notes += (f"of {len(sheet.columns)} columns without names the first two are taken as master and slave",)
    return {"x": numeric[0], "y": numeric[1]}, notes


def _unit(sheet: Sheet, at: int, name: str, units: tuple[str, ...]) -> str | None:
    """Give a column's unit, one of those that it may have, or ``None`` if it has none."""
    column: Column = sheet.columns[at]
    if column.unit is None or is_unsized(column.unit):
        return None
    if not column.known or column.unit not in units:
        raise sheet.not_in(name, column.unit, units)
    return column.unit


def _stated_derivatives(sheet: Sheet, at: dict[str, int], y_unit: str | None) -> dict[str, tuple[float, float]]:
    """Give what makes the derivatives SI where both state a unit of theirs; nothing where they do not."""
    found: dict[str, tuple[float, float]] = {}
    for name in ("dy/dx", "d2y/dx2", "d3y/dx3"):
        if name not in at:
            continue
        unit = sheet.columns[at[name]].unit
        known = None if unit is None else _DERIVATIVES[name].get(unit)
        if known is None:
            if unit is not None and sheet.columns[at[name]].name == name:
                raise sheet.not_in(name, unit, _DERIVATIVES[name])
            continue
        turned = y_unit == "rad" or y_unit in _TURNS
        if y_unit and str(unit).startswith("rad") != turned:
            slave = "an angle" if turned else "a length"
            raise InputError(
                f"{sheet.where}: column {name} does not go with y, which is {slave}; write both in units of {slave}"
            )
        found[name] = known
    return found if {"dy/dx", "d2y/dx2"} <= set(found) else {}


def _in_order(
    columns: dict[str, FloatArray], lines: tuple[int, ...], place: str
) -> tuple[dict[str, FloatArray], tuple[str, ...]]:
    """Put rows in the order of the master; one descent is where a modulo master turns over.

    Rows that all descend are turned round, one that stands twice is dropped.
    """
    notes: tuple[str, ...] = ()
    numbers = np.array(lines)
    same = np.flatnonzero((np.diff(columns["x"]) == 0.0) & (np.diff(columns["y"]) == 0.0))
    if len(same):
        keep = np.delete(np.arange(len(numbers)), same + 1)
        columns, numbers = {name: values[keep] for name, values in columns.items()}, numbers[keep]
        notes += (f"{len(same)} rows that stand there twice are left out",)
    x = columns["x"]
    if len(x) > 1 and (np.diff(x) < 0.0).all():
        columns, numbers = {name: values[::-1] for name, values in columns.items()}, numbers[::-1]
        return columns, (*notes, "the rows run backwards along the master and were turned round")
    down = np.flatnonzero(np.diff(x) < 0.0)
    if len(down) == 1 and x[-1] <= x[0]:
        turn = int(down[0]) + 1
        last = x[-1] == x[0]
        order = np.concatenate([np.arange(turn, len(x) - (1 if last and turn < len(x) - 1 else 0)), np.arange(turn)])
        if last and turn == len(x) - 1:
            order = np.arange(turn)  # the first row again
        columns, numbers = {name: values[order] for name, values in columns.items()}, numbers[order]
        notes += (f"line {lines[turn]}: the master turns over; the rows are put in the order of the master",)
    x = columns["x"]
    steps = np.diff(x)
    close = steps <= _CLOSEST * abs(float(x[-1] - x[0]))
    if close.any():
        line = int(numbers[1 + int(np.argmax(close))])
        raise refuse(place, line, "x does not increase from the row before; rows must be sorted by x, each x once")
    if not math.isfinite(float(x[-1] - x[0])):
        raise InputError(f"{place}: the master's range is not finite")
    return columns, notes
