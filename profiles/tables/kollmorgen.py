"""Kollmorgen KAS IDE: the CSV cam profile, spline segments only."""

from __future__ import annotations

from camwright.profiles.errors import InputError
from camwright.profiles.tables.cam_table import CamTable, make_table
from camwright.profiles.tables.number_formats import decimals
from camwright.profiles.tables.target import Header, Target, companion
from camwright.profiles.tables.text import (
    check_count,
    check_points,
    lines_of,
    real,
    refuse,
    shown,
)

LEAST_POINTS = 5  # four segments
MOST_POINTS = 10_000


def write(table: CamTable, header: Header) -> dict[str, str]:
    """Write the file, and its head as a text beside it, for the layout allows no comment.

    Raises
    ------
    InputError
        The cam does not begin at zero or runs below it: the IDE scales by the greatest values of the file.
    """
    if table.x[0] != 0.0 or table.y[0] != 0.0 or (table.y < 0.0).any() or table.y.max() != table.y[-1]:
        raise InputError(
            "the IDE scales a cam by the greatest values of its file: it must begin at 0, stay above 0 and end at its "
            "greatest value"
        )
    check_count(table.points, LEAST_POINTS, None, "the table")
    rows = [f"{decimals(x)};{decimals(y)};SPLINE" for x, y in zip(table.x, table.y, strict=True)]
    cyclic = "YES" if table.periodic else "NO"
    name = header.identifier
    text = "\n".join([f"CYCLIC;{cyclic};", "TABLE_BEGIN;;", *rows, "TABLE_END;;"]) + "\n"
    return {f"{name}_kas.csv": text, f"{name}_kas.txt": companion(header.lines(TARGET.title, table), TARGET.steps)}


def read(text: str, place: str) -> CamTable:
    """Points between ``TABLE_BEGIN`` and ``TABLE_END``, as they stand in the file, before any scaling."""
    x: list[float] = []
    y: list[float] = []
    numbers: list[int] = []
    cyclic: bool | None = None
    state = 0
    for number, line in enumerate(lines_of(text, place), start=1):
        if not line.strip():
            continue
        cells = [cell.strip() for cell in line.split(";")]
        first = cells[0].upper()
        if state == 0 and first == "CYCLIC" and len(cells) >= 2 and cells[1].upper() in ("YES", "NO"):
            cyclic = cells[1].upper() == "YES"
        elif state == 0 and first == "TABLE_BEGIN":
            state = 1
        elif state == 1 and first == "TABLE_END":
            state = 2
        elif state == 1:
            if [cell.upper() for cell in cells[2:3]] != ["SPLINE"]:
                raise refuse(place, number, f"{shown(line.strip())} is no row of the form x;y;SPLINE")
            x.append(real(cells[0], place, number, comma=True))
            y.append(real(cells[1], place, number, comma=True))
            numbers.append(number)
        else:
            raise refuse(place, number, f"{shown(line.strip())} is not expected here")
    if state != 2:
        raise refuse(place, None, f"the line {('TABLE_BEGIN', 'TABLE_END')[state]} is missing")
    if cyclic is None:
        raise refuse(place, None, "the line CYCLIC;YES; or CYCLIC;NO; is missing")
    check_points(x, numbers, place, MOST_POINTS, LEAST_POINTS)
    return make_table(x, y, law="spline", periodic=cyclic)


TARGET = Target(
    name="kollmorgen-kas",
    title="Kollmorgen KAS IDE, CSV",
    interpolation="cubic spline, taken as cyclic",
    law="spline",
    spacing="free",
    evidence=(
        "KAS online help, pages 'Import Cam Profile' (complete sample), 'Cam Profile Segments', 'Cam Table'. That "
        "SPLINE is cubic and that a cyclic cam is smooth to the second derivative across its seam is inferred from the "
        "cyclic rules. No limit of points is documented."
    ),
    steps=(
        "Import the CSV file as a cam profile in the KAS IDE.",
        (
            "The IDE scales the profile by its greatest values: set master and slave scale to the period and the "
            "travel that the text beside the file states, both offsets to 0."
        ),
        "Check that the profile is cyclic and its first and last velocity agree.",
    ),
    endings=("_kas.csv", "_kas.txt"),
    write=write,
    read=read,
    min_points=LEAST_POINTS,
)
