"""A drive's recording as CSV text: time, command and actual position, each with its unit."""

from __future__ import annotations

import difflib
import math
import re

import numpy as np

from camwright.profiles.errors import InputError
from camwright.profiles.machines.machine import SlaveUnit
from camwright.profiles.polynomial.profile import FloatArray
from camwright.profiles.trace import Trace

MOST_ROWS = 10_000

_LENGTHS = {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "um": 1e-6, "µm": 1e-6, "in": 0.0254, "ft": 0.3048}
_ANGLES = {"rad": 1.0, "deg": math.pi / 180, "rev": 2 * math.pi}
_UNITS: dict[str, dict[str, float]] = {
    "time": {"s": 1.0, "ms": 1e-3, "us": 1e-6, "µs": 1e-6},
    "command": {**_LENGTHS, **_ANGLES},
    "actual": {**_LENGTHS, **_ANGLES},
}
_HEADER = "time [ms],command [mm],actual [mm]"
_CELL = re.compile(r"\s*([^\[\]()]*[^\s\[\]()])\s*(?:\[([^\[\]]*)\]|\(([^()]*)\))?\s*")
_NUMBER = re.compile(r"\s*[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]{1,4})?\s*")
_GREATEST = 1e12

_UNEQUAL = 0.01
"""What a step of the time may differ from the others, as a part of it: times are rounded."""

_GAP = 1.5
"""Steps, of a usual length each, from which on rows are missing."""


def read_trace_csv(text: str, place: str) -> Trace:
    """Read a recording: comment lines begin with ``#``, the header names columns and units, rows follow.

    Parameters
    ----------
    text
        The recording. Columns ``time``, ``command`` and ``actual`` with their units in brackets, ``time [ms]``, in any order; other
        columns are not read.
    place
        What messages begin with.

    Raises
    ------
    InputError
        The header or a row is not as described, or the rows are not equally spaced in time; the message names the line.
    """
    numbered = [
        (number, line)
        for number, line in enumerate(text.removeprefix("\ufeff").replace("\r\n", "\n").split("\n"), start=1)
        if line.strip() and not line.lstrip().startswith("#")
    ]
    if not numbered:
        raise InputError(f"{place}: there is no recording in it; write a header like {_HEADER} and rows below")
    where = f"{place}, line {numbered[0][0]}"
    columns, count, unit = _header(numbered[0][1], where)
    rows = numbered[1:]
    if len(rows) < 2:
        raise InputError(f"{place}: {len(rows)} rows below the header; a recording has hundreds")
    if len(rows) > MOST_ROWS:
        raise InputError(
            f"{place}: {len(rows)} rows, the limit is {MOST_ROWS}; cut out a part with lively motion, 2 s at 1 kHz are enough"
        )
    data = np.array([_row(line, count, columns, f"{place}, line {number}") for number, line in rows])
    time, command, actual = (data.T[i] * factor for i, (_, factor) in enumerate(columns.values()))
    lines = [number for number, _ in rows]
    _require_equal_steps(time, lines, place)
    step = (time[-1] - time[0]) / (len(time) - 1)
    return Trace(float(time[0]), float(step), command, actual, unit)


def _header(line: str, place: str) -> tuple[dict[str, tuple[int, float]], int, SlaveUnit]:
    """Read the header: place and SI factor of the three columns in their order, the number of cells, and the unit of positions."""
    cells = line.split(",")
    if len(cells) == 1 and re.search(r"[;\t]", line):
        raise InputError(
            f"{place}: there is no comma; separate the columns by commas, and write numbers with a decimal point"
        )
    found: dict[str, tuple[int, float]] = {}
    names: list[str] = []
    kinds: dict[str, bool] = {}
    for number, cell in enumerate(cells):
        parts = _CELL.fullmatch(cell)
        name = (parts.group(1) if parts else cell.strip()).lower()
        names.append(name)
        if parts is None or name not in _UNITS:
            continue
        if name in found:
            raise InputError(f"{place}: column {name} stands there twice; leave one out")
        units, written = _UNITS[name], next((group for group in parts.groups()[1:] if group is not None), None)
        example = next(iter(cell for cell in _HEADER.split(",") if cell.startswith(name)))
        if written is None:
            raise InputError(f"{place}: column {name} has no unit; write it in brackets, e.g. {example}")
        unit = written.strip()
        if unit not in units:
            raise InputError(
                f"{place}: column {name} cannot be in {unit[:50]!r}; its unit is one of {', '.join(units)}"
            )
        found[name] = number, units[unit]
        kinds[name] = unit in _ANGLES
    for name in _UNITS:
        if name not in found:
            near = difflib.get_close_matches(name, [other[:50] for other in names], n=1)
            advice = f"is it {near[0]!r}? " if near else ""
            raise InputError(f"{place}: there is no column {name}; {advice}write a header like {_HEADER}")
    if kinds["command"] != kinds["actual"]:
        raise InputError(f"{place}: command and actual are a length and an angle; give both as they are at one axis")
    return {name: found[name] for name in _UNITS}, len(cells), "rad" if kinds["command"] else "m"


def _row(line: str, count: int, columns: dict[str, tuple[int, float]], place: str) -> list[float]:
    """Read the three numbers of one row."""
    cells = line.split(",")
    if len(cells) != count:
        raise InputError(
            f"{place}: {len(cells)} cells where the header has {count}; numbers have a decimal point, no comma"
        )
    values = []
    for name, (number, _) in columns.items():
        cell = cells[number]
        if _NUMBER.fullmatch(cell) is None or abs(float(cell)) > _GREATEST:
            raise InputError(
                f"{place}: {name} {cell.strip()[:50]!r} is not a finite number of at most {_GREATEST:g}; write it like 12.5 or 1.25e1"
            )
        values.append(float(cell))
    return values


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
