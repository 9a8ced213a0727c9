"""The cam as CSV text: rows of master and slave position and derivatives over the master; and back to a profile."""

from __future__ import annotations

import difflib
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from camwright.profiles.errors import InputError
from camwright.profiles.machines.machine import SlaveUnit
from camwright.profiles.message import Message
from camwright.profiles.polynomial.profile import CamProfile, FloatArray

_LENGTHS: dict[str, tuple[float, float]] = {
    "m": (1, 1), "mm": (1, 1000), "cm": (1, 100), "um": (1, 1e6), "µm": (1, 1e6), "in": (127, 5000), "ft": (381, 1250)
}  # fmt: skip
_COLUMNS: dict[str, dict[str, tuple[float, float]]] = {
    "x": _LENGTHS,
    "y": {**_LENGTHS, "rad": (1, 1), "deg": (math.pi, 180)},
    "dy/dx": {"1": (1, 1), "m/m": (1, 1), "mm/mm": (1, 1), "rad/m": (1, 1)},
    "d2y/dx2": {"1/m": (1, 1), "1/mm": (1000, 1), "rad/m^2": (1, 1)},
    "d3y/dx3": {"1/m^2": (1, 1), "1/mm^2": (1e6, 1), "rad/m^3": (1, 1)},
}
# Columns, their units, and how a number in that unit becomes SI: multiplied by the first, divided by the second.

_HEADERS: dict[SlaveUnit, tuple[str, ...]] = {
    "m": ("x [mm]", "y [mm]", "dy/dx [1]", "d2y/dx2 [1/m]", "d3y/dx3 [1/m^2]"),
    "rad": ("x [mm]", "y [rad]", "dy/dx [rad/m]", "d2y/dx2 [rad/m^2]", "d3y/dx3 [rad/m^3]"),
}
_CELL = re.compile(r"\s*([^\s\[\](){}_]+)(?:\s*\[([^\[\]]+)\]|\s*\(([^()]+)\)|_(\S+))?\s*")
_NUMBER = re.compile(r"\s*[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]{1,4})?\s*")
_GREATEST = 1e12
_FEWEST_ROWS = 4

_CLOSEST = 1e-12
"""Least distance of two rows on the master as a part of the table's length: closer rows hold no derivatives."""

_ROUNDING = 8 * np.finfo(np.float64).eps
"""Residuals below this part of the values that they come from are rounding."""


@dataclass(frozen=True, eq=False)
class CamRows:
    """Rows of a cam table in SI units.

    Parameters
    ----------
    x
        Master positions (m), shape ``(n,)``, increasing.
    y
        Slave positions (slave unit), shape ``(n,)``.
    dy
        Ratio, shape ``(n,)``, if the table has it.
    d2y
        Ratio slope (slave unit per m²), shape ``(n,)``, if the table has it.
    slave_unit
        Whether the slave is counted in m or in rad.
    """

    x: FloatArray
    y: FloatArray
    dy: FloatArray | None = None
    d2y: FloatArray | None = None
    slave_unit: SlaveUnit = "m"


def table_positions(profile: CamProfile, points: int) -> FloatArray:
    """Choose master positions for a table: equidistant, but with the nearest one moved onto each break of the profile.

    So pieces begin and end at rows, and the table holds the profile and not only samples of it. Where two breaks have
    the same nearest position, one of them gets the next free one.

    Parameters
    ----------
    profile
        One cycle.
    points
        Number of positions, both ends of the cycle included.

    Returns
    -------
    ndarray
        Shape ``(points,)``, increasing (m).

    Raises
    ------
    InputError
        There are more breaks than points.
    """
    breaks = profile.breaks
    if points < len(breaks):
        raise InputError(
            Message(
                f"{{@points}} = {points}: too few to hold the {len(breaks)} ends of the profile's pieces; "
                f"write points = {len(breaks)} or more"
            )
        )
    x = np.linspace(profile.start, profile.end, points)
    nearest = np.rint((breaks - profile.start) * ((points - 1) / profile.length))
    rank = np.arange(len(breaks))
    # Each break a position of its own, in order: first push up past the one before, then down from the last position.
    taken = np.maximum.accumulate(nearest - rank) + rank
    down = points - 1 - (len(breaks) - 1 - rank)
    taken = np.minimum(taken, down)
    x[taken.astype(np.int64)] = breaks
    return x


def write_cam_csv(profile: CamProfile, points: int, comments: Sequence[str], slave_unit: SlaveUnit = "m") -> str:
    """Write a profile as a table: comment lines, a header with units, one row a position.

    Parameters
    ----------
    profile
        One cycle.
    points
        Number of rows.
    comments
        Texts that are put before the header, one a line.
    slave_unit
        Unit of the profile's slave: m is written in mm, rad as it is.

    Returns
    -------
    str
        Numbers have as many digits as they need to be read back bit by bit. At a break the derivatives are those of the
        piece that begins there.

    Raises
    ------
    InputError
        There are more breaks than points.
    """
    x = table_positions(profile, points)
    scale = 1e3 if slave_unit == "m" else 1.0
    columns = [x * 1e3, profile(x) * scale, profile(x, 1), profile(x, 2), profile(x, 3)]
    lines = ["# " + " ".join(comment.splitlines()) for comment in comments]
    lines.append(",".join(_HEADERS[slave_unit]))
    lines.extend(",".join(map(repr, row)) for row in zip(*((column + 0.0).tolist() for column in columns), strict=True))
    return "\n".join(lines) + "\n"


def read_cam_csv(text: str, place: str) -> CamRows:
    """Read a table: comment lines begin with ``#``, the header names columns and units, rows follow.

    Parameters
    ----------
    text
        The table. Columns: ``x`` and ``y``, and ``dy/dx`` with ``d2y/dx2`` if known; ``d3y/dx3`` is allowed and not
        used. A unit stands in brackets or after an underscore: ``x [mm]``, ``x_mm``.
    place
        What messages begin with.

    Raises
    ------
    InputError
        The header or a row is not as described; the message names the line.
    """
    numbered = [
        (number, line)
        for number, line in enumerate(text.removeprefix("\ufeff").replace("\r\n", "\n").split("\n"), start=1)
        if line.strip() and not line.lstrip().startswith("#")
    ]
    if not numbered:
        raise InputError(f"{place}: there is no table in it; write a header like x [mm],y [mm] and rows below")
    columns, slave_unit = _header(numbered[0][1], f"{place}, line {numbered[0][0]}")
    if len(numbered) - 1 < _FEWEST_ROWS:
        raise InputError(
            f"{place}: {len(numbered) - 1} rows; a cam table needs {_FEWEST_ROWS} at least, "
            "from the start to the end of a cycle"
        )
    rows = np.array([_row(line, len(columns), f"{place}, line {number}") for number, line in numbered[1:]])
    data = {}
    for position, (name, (factor, divisor)) in enumerate(columns):
        data[name] = rows[:, position] * factor / divisor
    steps = np.diff(data["x"])
    close = steps <= _CLOSEST * abs(float(data["x"][-1] - data["x"][0]))
    if close.any():
        line = numbered[2 + int(np.argmax(close))][0]
        raise InputError(
            f"{place}, line {line}: x does not increase from the row before; rows must be sorted by x, each x once"
        )
    return CamRows(data["x"], data["y"], data.get("dy/dx"), data.get("d2y/dx2"), slave_unit)


def _header(line: str, place: str) -> tuple[list[tuple[str, tuple[float, float]]], SlaveUnit]:
    """Read the header: for each column its name and what makes its numbers SI, and the unit of the slave."""
    columns: list[tuple[str, tuple[float, float]]] = []
    turning: dict[str, bool] = {}
    for cell in line.split(","):
        found = _CELL.fullmatch(cell)
        name = found.group(1) if found else cell.strip()
        if found is None or name not in _COLUMNS:
            near = difflib.get_close_matches(name[:50], _COLUMNS, n=1)
            advice = f"did you mean {near[0]}?" if near else f"columns are {', '.join(_COLUMNS)};"
            raise InputError(
                f"{place}: there is no column {cell.strip()[:50]!r}; {advice} write a header like x [mm],y [mm]"
            )
        units = _COLUMNS[name]
        unit = next((group for group in found.groups()[1:] if group is not None), None)
        if unit is None:
            example = "mm" if "mm" in units else next(iter(units))
            raise InputError(f"{place}: column {name} has no unit; write it in brackets, e.g. {name} [{example}]")
        if unit.strip() not in units:
            raise InputError(
                f"{place}: column {name} cannot be in {unit[:50]!r}; its unit is one of {', '.join(units)}"
            )
        if name in (earlier for earlier, _ in columns):
            raise InputError(f"{place}: column {name} stands there twice; leave one out")
        columns.append((name, units[unit.strip()]))
        turning[name] = unit.strip().startswith(("rad", "deg"))
    names = {name for name, _ in columns}
    missing = [name for name in ("x", "y") if name not in names]
    if missing:
        raise InputError(f"{place}: column {' and '.join(missing)} is missing; write a header like x [mm],y [mm]")
    if ("dy/dx" in names) != ("d2y/dx2" in names):
        raise InputError(f"{place}: dy/dx and d2y/dx2 go together; give both or neither")
    for name in turning.keys() - {"x"}:
        if turning[name] != turning["y"]:
            slave = "an angle" if turning["y"] else "a length"
            raise InputError(
                f"{place}: column {name} does not go with y, which is {slave}; write both in units of {slave}"
            )
    return columns, "rad" if turning["y"] else "m"


def _row(line: str, count: int, place: str) -> list[float]:
    """Read one row of numbers."""
    cells = line.split(",")
    if len(cells) != count:
        raise InputError(
            f"{place}: {len(cells)} cells where the header has {count}; numbers have a decimal point, no comma"
        )
    values = []
    for cell in cells:
        if _NUMBER.fullmatch(cell) is None or abs(float(cell)) > _GREATEST:
            raise InputError(
                f"{place}: {cell.strip()[:50]!r} is not a finite number of at most {_GREATEST:g}; "
                "write it like 12.5 or 1.25e1"
            )
        values.append(float(cell))
    return values


def rebuild(x: FloatArray, y: FloatArray, dy: FloatArray | None = None, d2y: FloatArray | None = None) -> CamProfile:
    """Make the profile that a table stands for.

    With ratio and ratio slope: on each interval the quintic through both ends' values. It is made as the cubic of
    linear acceleration plus a correction by what that cubic misses at the right end,

        ``y = y0 + d0 s + a0 s²/2 + (a1 - a0)/(6 h) s³ + r0 P(s/h) + r1 h Q(s/h)``,
        ``P = 10 u³ - 15 u⁴ + 6 u⁵``, ``Q = -4 u³ + 7 u⁴ - 3 u⁵``,

    with the residuals ``r1`` of the ratio and ``r0`` of the position. Residuals at rounding level count as zero: a
    table of cubic pieces gives those cubics, without the noise that differences of positions would put on the jerk.

    With positions only: the cubic spline of continuous ratio and ratio slope, also at the seam of the repeated cycle.

    Parameters
    ----------
    x, y
        Master and slave positions (m), shape ``(n,)``; ``x`` increases.
    dy, d2y
        Ratio, and ratio slope (1/m), both or neither.

    Raises
    ------
    InputError
        The arrays differ in length, or only one of the derivatives is given.
    """
    if (dy is None) != (d2y is None) or len({len(column) for column in (x, y, dy, d2y) if column is not None}) != 1:
        raise InputError("a table needs x and y, with both or none of dy/dx and d2y/dx2, all of one length")
    if dy is None or d2y is None:
        return _spline(x, y)
    h = np.diff(x)
    y0, y1, d0, d1, a0, a1 = y[:-1], y[1:], dy[:-1], dy[1:], d2y[:-1], d2y[1:]
    third = (a1 - a0) / (6 * h)
    r1 = d1 - (d0 + 0.5 * h * (a0 + a1))
    r0 = y1 - (y0 + d0 * h + h * h * (2 * a0 + a1) / 6)
    # What rounding of the table's own numbers can do: h is a difference of x, so x's last digit counts with the slope.
    reach = np.abs(x[:-1]) + np.abs(x[1:])
    bend, slope = np.abs(a0) + np.abs(a1), np.abs(d0) + np.abs(d1)
    r1 = np.where(np.abs(r1) <= _ROUNDING * (slope + bend * reach), 0.0, r1)
    r0 = np.where(np.abs(r0) <= _ROUNDING * (np.abs(y0) + np.abs(y1) + slope * reach + bend * h * reach), 0.0, r0)
    r1 = r1 * h
    table = np.stack(
        [
            y0,
            d0,
            0.5 * a0,
            third + (10 * r0 - 4 * r1) / h**3,
            (-15 * r0 + 7 * r1) / h**4,
            (6 * r0 - 3 * r1) / h**5,
        ],
        axis=1,
    )
    return CamProfile(x.copy(), table)


def _spline(x: FloatArray, y: FloatArray) -> CamProfile:
    """Make the periodic cubic spline through the rows, the slave advancing by the same amount each cycle."""
    from scipy.interpolate import CubicSpline

    slope = (y[-1] - y[0]) / (x[-1] - x[0])
    rest = y - y[0] - slope * (x - x[0])
    rest[-1] = rest[0]  # equal but for rounding
    table = CubicSpline(x, rest, bc_type="periodic").c[::-1].T.copy()
    table[:, 0] = y[:-1]
    table[:, 1] += slope
    return CamProfile(x.copy(), table)
