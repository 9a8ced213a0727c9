"""The house's own CSV as a target: every knot with its derivatives and units, for spreadsheets and scripts."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from camwright.profiles.errors import InputError
from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.profiles.tables.cam_csv import rebuild as rebuild_rows
from camwright.profiles.tables.cam_rows import read_cam_csv
from camwright.profiles.tables.cam_table import (
    CamTable,
    PieceLaw,
    TableUnits,
    Unit,
    make_table,
)
from camwright.profiles.tables.splines import cyclic_spline
from camwright.profiles.tables.target import Header, Target
from camwright.profiles.tables.text import check_count, lines_of

MOST_POINTS = 32_767

CSV_LENGTHS = {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "um": 1e-6, "in": 0.0254, "ft": 0.3048}
"""Units that a user may name for this table: metres by name."""

_TURNED = "x [mm],y [rad],dy/dx [rad/m],d2y/dx2 [rad/m^2]"


def write(table: CamTable, header: Header) -> dict[str, str]:
    """Comment lines, a header with units, one row a knot.

    Raises
    ------
    InputError
        The table's units are not known, so that its numbers cannot be turned into millimetres.
    """
    if table.units is None:
        raise InputError("a CSV table states millimetres: say what the units of this table are")
    master, slave = table.units.master.size, table.units.slave.size
    turned = table.units.slave.si == "rad"
    x, y, shown = table.x, table.y, table.units
    if not {shown.master.symbol, shown.slave.symbol} <= CSV_LENGTHS.keys():
        x, y = _millimetres(x * master), y * slave if turned else _millimetres(y * slave)
        shown = TableUnits(Unit("mm", 1e-3), Unit("rad", 1.0, "rad") if turned else Unit("mm", 1e-3))
    written = CamTable(
        x, y, table.ratio * (slave / master), table.ratio_slope * (slave / master**2), table.laws, shown, table.periodic
    )
    columns = (written.x, written.y, written.ratio, written.ratio_slope)
    rows = [",".join(map(repr, row)) for row in zip(*((column + 0.0).tolist() for column in columns), strict=True)]
    title = f"x [{shown.master.symbol}],y [{shown.slave.symbol}],dy/dx [1],d2y/dx2 [1/m]"
    lines = [*(f"# {line}" for line in header.lines(TARGET.title, written)), _TURNED if turned else title, *rows]
    return {f"{header.identifier}_cam.csv": "\n".join(lines) + "\n"}


def read(text: str, place: str) -> CamTable:
    """Rows with or without derivatives: in metres where the file names both units, else in its own."""
    lines_of(text, place)
    rows = read_cam_csv(text, place)
    check_count(len(rows.x), 2, MOST_POINTS, place)
    law: PieceLaw = "spline" if rows.dy is None else "quintic"
    if rows.words is None:
        units = TableUnits(Unit("m", 1.0), Unit(rows.slave_unit, 1.0, rows.slave_unit))
        return make_table(rows.x, rows.y, rows.dy, rows.d2y, law=law, units=units, notes=rows.notes)
    notes = (
        rows.notes if rows.dy is not None else (*rows.notes, "no derivatives in the file: a cubic spline is assumed")
    )
    return replace(
        make_table(rows.x, rows.y, rows.dy, rows.d2y, law=law, notes=notes), words=rows.words, listed=rows.listed
    )


def _millimetres(metres: FloatArray) -> FloatArray:
    """Give millimetres of which the reader's thousandth part is as near as can be: the same bits if any number's is."""
    value = metres * 1e3
    for near in (np.nextafter(value, -np.inf), np.nextafter(value, np.inf)):
        value = np.where((value / 1e3 != metres) & (near / 1e3 == metres), near, value)
    return value


def rebuild(table: CamTable) -> CamProfile:
    """Quintics through position, ratio and ratio slope, in millimetres of the file; without derivatives a cyclic spline."""
    if np.isnan(table.ratio).any():
        return cyclic_spline(table.x, table.y)
    x, y = table.x, table.y
    if table.units is not None:
        master, slave = table.units.master.size, table.units.slave.size
        x = _millimetres(x * master) / (1e3 * master)
        y = y if table.units.slave.si == "rad" else _millimetres(y * slave) / (1e3 * slave)
    return rebuild_rows(x, y, table.ratio, table.ratio_slope)


TARGET = Target(
    name="csv",
    title="CSV with positions and derivatives",
    interpolation="quintic through position, ratio and ratio slope",
    law="quintic",
    spacing="pieces",
    max_points=MOST_POINTS,
    evidence="camwright's own layout; no drive imports it as it stands.",
    steps=(
        "Read the file with a script or a spreadsheet: the header names columns and units.",
        "Between two rows the cam is the quintic through position, ratio and ratio slope of both.",
    ),
    endings=("_cam.csv",),
    write=write,
    read=read,
    rebuild=rebuild,
    min_points=4,
)
