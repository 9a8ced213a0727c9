"""Trio Motion Coordinator: ``TABLE`` lines for ``CAMBOX``."""

from __future__ import annotations

import re

import numpy as np

from camwright.profiles.errors import InputError
from camwright.profiles.tables.cam_table import CamTable, make_table
from camwright.profiles.tables.interpolation import chords, in_format
from camwright.profiles.tables.target import Header, Target, companion
from camwright.profiles.tables.text import check_count, refuse, shown
from camwright.profiles.tables.trio_program import Numbers, run

MOST_POINTS = 16_000

_LINE = re.compile(r"TABLE\s*\((.*)\)", re.IGNORECASE)
_TABLE = re.compile(r"TABLE\s*\(", re.IGNORECASE)
_CAMBOX = re.compile(r"CAMBOX\s*\(([^()]*)\)(?:\s*AXIS\s*\([^()]*\))?", re.IGNORECASE)
_INNER = re.compile(r".*\bTABLE\s*\([^()]*,.*", re.IGNORECASE)
_PATTERN = 1 << 3
"""Option of CAMBOX: the multiplier is the address of a list of multipliers."""


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
    link = f"\nCAMBOX(0, {table.points - 1}, 1, {header.link or '<link distance>'}, <link axis>, 4)\n"
    return {f"{name}_trio.bas": "\n".join(rows) + "\n", f"{name}_trio.txt": beside + link}


def read(text: str, place: str) -> CamTable:
    """Values of the ``TABLE`` lines of a program; from its ``CAMBOX`` line which of them, the multiplier and the link distance.

    Expressions of variables that the program gives one number are computed, loops are run. Other statements are passed over. Without a
    ``CAMBOX`` line of numbers all values are the table, and master positions are counted in its steps.
    """
    values: dict[int, float] = {}
    calls: dict[int, list[str]] = {}
    numbers = Numbers.of(text, place)
    for line, statement, known in run(text, place, numbers):
        call = _CAMBOX.fullmatch(statement)
        if call:
            calls[line] = [cell.strip() for cell in call[1].split(",")]
        elif _TABLE.match(statement):
            _fill(values, statement, known, place, line)
        elif _INNER.fullmatch(statement):
            raise refuse(
                place,
                line,
                f"{shown(statement)} fills the table on a condition or behind something else; leave the lines that are meant in the file",
            )
    if not values:
        raise refuse(place, None, "there is no line TABLE(address, value, …) in it")
    check_count(len(values), 2, MOST_POINTS, place)
    plain = [found for line, cells in calls.items() if (found := _call(cells, numbers, place, line))]
    if len({found[:4] for found in plain}) > 1:
        raise refuse(place, plain[1][4], "there is more than one CAMBOX; leave the one that is meant in the file")
    if plain:
        return _called(values, plain[0], place)
    addresses = sorted(values)
    if addresses[-1] - addresses[0] + 1 != len(values):
        raise refuse(place, None, "the addresses of the table have a gap")
    note = "master positions are counted in steps of the table: the link distance is not in the file"
    if calls:
        note += " as a number"
    return make_table(range(len(values)), [values[a] for a in addresses], law="line", notes=(note,))


def _fill(values: dict[int, float], statement: str, numbers: Numbers, place: str, line: int) -> None:
    """Take the values of one ``TABLE`` line."""
    found = _LINE.fullmatch(statement)
    if not found or "," not in found[1]:
        raise refuse(place, line, f"{shown(statement)} is not of the form TABLE(address, value, …)")
    first, *cells = found[1].split(",")
    address = numbers.whole(first, place, line)
    for offset, cell in enumerate(cells):
        if address + offset in values:
            raise refuse(place, line, f"the address {address + offset} is filled twice")
        values[address + offset] = numbers.value(cell, place, line)
    if len(values) > MOST_POINTS:
        raise refuse(place, line, f"the table has more than {MOST_POINTS} values")


_Call = tuple[int, int, float, float, int]
"""Start, end, multiplier and link distance of a ``CAMBOX``, and its line."""


def _call(cells: list[str], numbers: Numbers, place: str, line: int) -> _Call | None:
    """Compute the arguments of a ``CAMBOX``; ``None`` where they are not known."""
    if len(cells) < 4:
        return None
    try:
        start, end, multiplier, distance = (numbers.value(cell, place, line) for cell in cells[:4])
    except InputError:
        return None
    if start != round(start) or end != round(end):
        raise refuse(place, line, f"CAMBOX runs from {start:g} to {end:g}, which are no addresses")
    if len(cells) > 5 and numbers.whole(cells[5], place, line) & _PATTERN:
        raise refuse(
            place,
            line,
            "CAMBOX takes its multipliers from a list (option 8), a cycle is none of them; leave the option out",
        )
    return round(start), round(end), multiplier, distance, line


def _called(values: dict[int, float], call: _Call, place: str) -> CamTable:
    """Take the part of the table that a ``CAMBOX(start, end, multiplier, link distance, …)`` runs."""
    start, end, multiplier, distance, line = call
    if not 0 < end - start <= MOST_POINTS:
        raise refuse(place, line, f"CAMBOX runs from {start} to {end}, which is no part of a table")
    missing = [address for address in range(start, end + 1) if address not in values]
    if missing:
        raise refuse(place, line, f"CAMBOX runs over the address {missing[0]}, which no TABLE line fills")
    if not (distance > 0.0 and multiplier != 0.0):
        raise refuse(place, line, f"the link distance {distance:g} and the multiplier {multiplier:g} make no motion")
    count = end - start
    y = [values[start + k] * multiplier for k in range(count + 1)]
    note = f"CAMBOX runs {count + 1} values of the table, times {multiplier:g}, over a link distance of {distance:g}"
    return make_table([distance * k / count for k in range(count + 1)], y, law="line", notes=(note,))


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
            "link axis, a number where --units named these."
        ),
        "Table values are encoder edges from the start of the cycle: the text beside the file states how long one is.",
    ),
    endings=("_trio.bas", "_trio.txt"),
    write=write,
    read=read,
    rebuild=chords,
)
