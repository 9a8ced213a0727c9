"""SEW MOVI-C: a text file with the number of points and pairs of positions."""

from __future__ import annotations

from camwright.profiles.tables.cam_table import CamTable, make_table
from camwright.profiles.tables.number_formats import decimals
from camwright.profiles.tables.target import Header, Target, companion
from camwright.profiles.tables.text import (
    check_points,
    integer,
    lines_of,
    real,
    refuse,
)

MOST_SPLINE = 64
MOST_READ = 16_383


def write(table: CamTable, header: Header) -> dict[str, str]:
    """Write the file, and its head as a text beside it, for the layout allows no comment."""
    rows = [f"{decimals(x)}\t{decimals(y)}" for x, y in zip(table.x, table.y, strict=True)]
    name = header.identifier
    text = "\n".join([str(table.points), *rows]) + "\n"
    return {f"{name}_sew.txt": text, f"{name}_sew_head.txt": companion(header.lines(TARGET.title, table), TARGET.steps)}


def read(text: str, place: str) -> CamTable:
    """Read the count, then pairs separated by a tab or a semicolon, with decimal point or comma."""
    x: list[float] = []
    y: list[float] = []
    numbers: list[int] = []
    count: int | None = None
    for number, line in enumerate(lines_of(text, place), start=1):
        if not line.strip():
            continue
        if count is None:
            count = integer(line.strip().rstrip(";"), place, number)
            continue
        cells = line.strip().split(";" if ";" in line else "\t")
        if len(cells) != 2:
            raise refuse(
                place, number, f"the line has {len(cells)} values, not master and slave with a tab or ';' between"
            )
        x.append(real(cells[0], place, number, comma=True))
        y.append(real(cells[1], place, number, comma=True))
        numbers.append(number)
    if count != len(x):
        raise refuse(place, None, f"the first line says {count} points, but {len(x)} follow")
    check_points(x, numbers, place, MOST_READ)
    return make_table(x, y, law="spline")


TARGET = Target(
    name="sew",
    title="SEW MOVI-C, points list with spline interpolation",
    interpolation="cubic spline, taken as cyclic",
    law="spline",
    spacing="free",
    max_points=MOST_SPLINE,
    evidence=(
        "SEW online documentation 59467761163 (file, limits) and 57491440523 (interpolation). What closes the spline "
        "at its ends is not said; cyclic is inferred. Its cubic interpolation of up to 16383 points is not written: "
        "the acceleration jumps at every point."
    ),
    steps=(
        "Copy the file to the folder /DATA/Camming of the axis.",
        (
            "Load it into a points list of the type ST_PointsListSpline and choose spline interpolation in the "
            "segment: with linear or cubic interpolation the same points make a different motion."
        ),
        "The positions are user units of both axes: set them as the text beside the file states.",
    ),
    endings=("_sew.txt", "_sew_head.txt"),
    write=write,
    read=read,
)
