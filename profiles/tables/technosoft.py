"""Technosoft EasyMotion Studio: two columns of integers, evenly spaced by a power of two."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from camwright.profiles.errors import InputError
from camwright.profiles.tables.cam_table import CamTable, make_table
from camwright.profiles.tables.interpolation import chords, in_format
from camwright.profiles.tables.target import Header, Target, companion
from camwright.profiles.tables.text import (
    check_count,
    integer,
    lines_of,
    refuse,
)

MOST_POINTS = 8192
STEPS = (1, 2, 4, 8, 16, 32, 64, 128)

_LARGEST = 2**31 - 1
_ENOUGH = 4
"""Rows that tell the layout."""


def write(table: CamTable, header: Header) -> dict[str, str]:
    """Write the file, and its head as a text beside it, for the layout allows no comment.

    Raises
    ------
    InputError
        Master positions that are negative or not evenly spaced by one of `STEPS`, or positions beyond 32 bits.
    """
    stored = in_format(table, "int32")
    steps = {int(step) for step in np.diff(stored.x)}
    if stored.x[0] < 0 or len(steps) != 1 or not steps <= set(STEPS):
        raise InputError(
            "the master positions of this drive are whole internal units from 0 on, evenly spaced by "
            f"{', '.join(map(str, STEPS))}; these are spaced by {sorted(steps)[:3]}"
        )
    if max(np.abs(stored.x).max(), np.abs(stored.y).max()) > _LARGEST:
        raise InputError(f"a position exceeds the 32 bits of this drive ({_LARGEST}); choose coarser units")
    rows = [f"{int(x)}\t{int(y)}" for x, y in zip(stored.x, stored.y, strict=True)]
    name = header.identifier
    beside = companion(header.lines(TARGET.title, table), TARGET.steps)
    return {f"{name}_technosoft.txt": "\n".join(rows) + "\n", f"{name}_technosoft_head.txt": beside}


def read(text: str, place: str) -> CamTable:
    """Two columns of integers."""
    x: list[int] = []
    y: list[int] = []
    for number, line in enumerate(lines_of(text, place), start=1):
        cells = line.split()
        if not cells:
            continue
        if len(cells) != 2:
            raise refuse(place, number, f"the line has {len(cells)} values, not two")
        values = [integer(cell, place, number) for cell in cells]
        if max(map(abs, values)) > _LARGEST or values[0] < 0:
            raise refuse(place, number, "a position lies outside 32 bits, or the master's is negative")
        if x and (values[0] - x[-1] not in STEPS or (len(x) > 1 and values[0] - x[-1] != x[-1] - x[-2])):
            raise refuse(place, number, f"the master positions must be evenly spaced by {', '.join(map(str, STEPS))}")
        x.append(values[0])
        y.append(values[1])
    check_count(len(x), 2, MOST_POINTS, place)
    note = (
        "two columns of whole numbers, evenly spaced, are taken for Technosoft's, straight lines between them "
        "(--target csv reads them as a spline)"
    )
    return make_table(x, y, law="line", notes=(note,))


def is_written_so(text: str) -> bool:
    """Whether a text begins like a file of this drive: two columns of whole numbers, the first from 0 on in one of `STEPS`."""
    rows = [line.split() for line in text[:2000].split("\n")[:20] if line.strip()]
    whole = all(len(row) == 2 and row[0].isdigit() and row[1].lstrip("-").isdigit() for row in rows)
    if not whole or len(rows) < _ENOUGH:
        return False
    steps = {int(after[0][:19]) - int(before[0][:19]) for before, after in pairwise(rows)}
    return int(rows[0][0][:19]) == 0 and len(steps) == 1 and steps <= set(STEPS)


TARGET = Target(
    name="technosoft",
    title="Technosoft EasyMotion Studio",
    interpolation="straight lines",
    law="line",
    spacing="equidistant",
    max_points=MOST_POINTS,
    number_format="int32",
    evidence=(
        "File format and limits: EasyMotion Studio help, 'CAM Tables View'. That the drive puts straight lines is "
        "inferred."
    ),
    steps=(
        "Import the file in the CAM tables view of the application.",
        (
            "Positions are internal units of master and slave: the text beside the file states how long one is; scale "
            "both axes so."
        ),
    ),
    endings=("_technosoft.txt", "_technosoft_head.txt"),
    write=write,
    read=read,
    rebuild=chords,
    master_steps=STEPS,
)
