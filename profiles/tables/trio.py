"""Trio Motion Coordinator: ``TABLE`` lines for ``CAMBOX``."""

from __future__ import annotations

import re

import numpy as np

from camwright.profiles.errors import InputError
from camwright.profiles.tables.cam_table import CamTable, make_table
from camwright.profiles.tables.interpolation import counted_chords, in_format
from camwright.profiles.tables.target import Header, Target, companion
from camwright.profiles.tables.text import (
    check_count,
    integer,
    lines_of,
    real,
    refuse,
    shown,
)

MOST_POINTS = 16_000

_LINE = re.compile(r"TABLE\s*\(([^()]*)\)", re.IGNORECASE)


def write(table: CamTable, header: Header) -> dict[str, str]:
    """``TABLE(i, …)`` lines, and the head with the CAMBOX call as a text beside them.

    Raises
    ------
    InputError
        The points are not evenly spaced.
    """
    if np.ptp(np.diff(table.x)) > 1e-9 * table.period:
        raise InputError("the points of a CAMBOX table must be evenly spaced")
    stored = in_format(table, "int32")
    y = [int(value) for value in stored.y - stored.y[0]]
    rows = [f"TABLE({k}, {', '.join(map(str, y[k : k + 8]))})" for k in range(0, len(y), 8)]
    name = header.identifier
    beside = companion(header.lines(TARGET.title, table), TARGET.steps)
    link = f"\nCAMBOX(0, {table.points - 1}, 1, <link distance>, <link axis>, 4)\n"
    return {f"{name}_trio.bas": "\n".join(rows) + "\n", f"{name}_trio.txt": beside + link}


def read(text: str, place: str) -> CamTable:
    """Values of all ``TABLE`` lines; master positions are counted in steps, for the link distance stands elsewhere."""
    values: dict[int, float] = {}
    for number, line in enumerate(lines_of(text, place), start=1):
        if not line.strip() or line.lstrip().startswith("'"):
            continue
        found = _LINE.fullmatch(line.strip())
        if not found:
            raise refuse(place, number, f"{shown(line.strip())} is not of the form TABLE(address, value, …)")
        first, *cells = found[1].split(",")
        address = integer(first, place, number)
        for offset, cell in enumerate(cells):
            if address + offset in values:
                raise refuse(place, number, f"the address {address + offset} is filled twice")
            values[address + offset] = real(cell, place, number)
    check_count(len(values), 2, MOST_POINTS, place)
    addresses = sorted(values)
    if addresses[-1] - addresses[0] + 1 != len(values):
        raise refuse(place, None, "the addresses of the table have a gap")
    note = "master positions are counted in steps of the table: the link distance is not in the file"
    return make_table(range(len(values)), [values[a] for a in addresses], law="line", notes=(note,))


TARGET = Target(
    name="trio",
    title="Trio Motion Coordinator, TABLE for CAMBOX",
    interpolation="straight lines",
    law="line",
    spacing="equidistant",
    max_points=MOST_POINTS,
    number_format="int32",
    evidence=(
        "CAMBOX and TABLE: Trio technical reference, p. 8-19 (MC206). The manual says that the controller "
        "'interpolates between the values in the table'; that it does so by straight lines is inferred."
    ),
    steps=(
        "Run the TABLE lines once; they fill the addresses from 0 on.",
        (
            "Call CAMBOX as the text beside the file shows: link distance is the master period in user units of the "
            "link axis."
        ),
        "Table values are encoder edges from the start of the cycle: the text beside the file states how long one is.",
    ),
    endings=("_trio.bas", "_trio.txt"),
    write=write,
    read=read,
    rebuild=counted_chords,
)
