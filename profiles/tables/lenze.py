"""Lenze Global Drive Cam Loader: a text file of points."""

from __future__ import annotations

from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.tables.cam_table import CamTable, make_table
from camwright.profiles.tables.interpolation import chords
from camwright.profiles.tables.number_formats import decimals
from camwright.profiles.tables.target import Header, Target, units_in
from camwright.profiles.tables.text import (
    check_points,
    lines_of,
    real,
    refuse,
)

MOST_POINTS = 10_000


def write(table: CamTable, header: Header) -> dict[str, str]:
    """Lines ``x y``; the head stands in the comments behind the first points, where the layout has its comments."""
    comments = header.lines(TARGET.title, table)
    beside = comments[: table.points] + [""] * max(0, table.points - len(comments))
    rest = " | ".join(comments[table.points :])
    beside[-1] = " | ".join(part for part in (beside[-1], rest) if part)
    rows = [
        f"{decimals(x)} {decimals(y)}" + (f" // {comment}" if comment else "")
        for x, y, comment in zip(table.x, table.y, beside, strict=True)
    ]
    return {f"{header.identifier}_lenze.txt": "\n".join(rows) + "\n"}


def read(text: str, place: str) -> CamTable:
    """Lines ``x y`` or ``x y acceleration``, separated by blanks or tabs, with decimal point or comma."""
    x: list[float] = []
    y: list[float] = []
    numbers: list[int] = []
    forward = False
    for number, raw in enumerate(lines_of(text, place), start=1):
        cells = raw.partition("//")[0].split()
        if not cells:
            continue
        if len(cells) not in (2, 3):
            raise refuse(place, number, f"the line has {len(cells)} values, not x, y and at most an acceleration")
        if x and forward is not (len(cells) == 3):
            raise refuse(place, number, f"the line has {len(cells)} values, those above it {3 if forward else 2}")
        values = [real(cell, place, number, comma=True) for cell in cells]
        forward = len(values) == 3
        x.append(values[0])
        y.append(values[1])
        numbers.append(number)
    check_points(x, numbers, place, MOST_POINTS)
    notes = ("the third column (acceleration feed-forward) is not judged",) if forward else ()
    return make_table(x, y, law="line", units=units_in(text), notes=notes)


def rebuild(table: CamTable) -> CamProfile:
    """Straight lines, the least that a drive can do between points."""
    return chords(table)


TARGET = Target(
    name="lenze",
    title="Lenze Global Drive Cam Loader",
    interpolation="not documented; judged as straight lines",
    law="line",
    spacing="free",
    evidence=(
        "File format with sample: Lenze manual 566345, p. 14. The interpolation and a limit of points are not given "
        "there; straight lines are assumed for the judgement."
    ),
    steps=(
        "Load the file with the Cam Loader.",
        "The positions are the user units of both axes: set them as the comments in the file state.",
        "Record the first cycles at low speed: how the drive interpolates is not documented.",
    ),
    endings=("_lenze.txt",),
    write=write,
    read=read,
    rebuild=rebuild,
)
