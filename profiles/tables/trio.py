"""Trio Motion Coordinator: ``TABLE`` lines for ``CAMBOX``."""

from __future__ import annotations

import re
from collections.abc import Iterator

import numpy as np

from camwright.profiles.errors import InputError
from camwright.profiles.tables.cam_table import CamTable, make_table
from camwright.profiles.tables.interpolation import chords, in_format
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
_TABLE = re.compile(r"TABLE\s*\(", re.IGNORECASE)
_CAMBOX = re.compile(r"CAMBOX\s*\(([^()]*)\)(?:\s*AXIS\s*\([^()]*\))?", re.IGNORECASE)
_GIVEN = re.compile(r"([A-Za-z]\w{0,59})\s*=(.*)")
_PLAIN = re.compile(r"[-+.0-9eE]{1,40}")


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

    Variables that the program gives one number are known. Other statements are passed over. Without a ``CAMBOX`` line of
    numbers all values are the table, and master positions are counted in its steps.
    """
    values: dict[int, float] = {}
    calls: list[tuple[list[str], int]] = []
    known = known_numbers(text, place)
    for number, statement in numbered_statements(text, place):
        call = _CAMBOX.fullmatch(statement)
        if call:
            calls.append(([cell.strip() for cell in call[1].split(",")], number))
        elif _TABLE.match(statement):
            _fill(values, statement, place, number)
    if not values:
        raise refuse(place, None, "there is no line TABLE(address, value, …) in it")
    check_count(len(values), 2, MOST_POINTS, place)
    calls = [([known.get(cell.lower()) or cell for cell in cells], number) for cells, number in calls]
    plain = [(cells, number) for cells, number in calls if len(cells) >= 4 and all(map(_PLAIN.fullmatch, cells[:4]))]
    if len({tuple(cells[:4]) for cells, _ in plain}) > 1:
        raise refuse(place, plain[1][1], "there is more than one CAMBOX; leave the one that is meant in the file")
    if plain:
        return _called(values, *plain[0], place)
    addresses = sorted(values)
    if addresses[-1] - addresses[0] + 1 != len(values):
        raise refuse(place, None, "the addresses of the table have a gap")
    note = "master positions are counted in steps of the table: the link distance is not in the file"
    if calls:
        note += " as a number"
    return make_table(range(len(values)), [values[a] for a in addresses], law="line", notes=(note,))


def numbered_statements(text: str, place: str) -> Iterator[tuple[int, str]]:
    """Go through a program's statements, each with the number of its line: cut at colons, without what stands behind an apostrophe."""
    for number, line in enumerate(lines_of(text, place), start=1):
        yield from ((number, part.strip()) for part in line.partition("'")[0].split(":") if part.strip())


def known_numbers(text: str, place: str) -> dict[str, str | None]:
    """Find the variables of a program, names in small letters: the one number that it gives each, ``None`` where it gives anything else."""
    known: dict[str, str | None] = {}
    for _, statement in numbered_statements(text, place):
        given = _GIVEN.fullmatch(statement)
        if given:
            name, value = given[1].lower(), given[2].strip()
            known[name] = value if known.setdefault(name, value) == value and _PLAIN.fullmatch(value) else None
    return known


def _fill(values: dict[int, float], statement: str, place: str, number: int) -> None:
    """Take the values of one ``TABLE`` line."""
    found = _LINE.fullmatch(statement)
    if not found:
        raise refuse(place, number, f"{shown(statement)} is not of the form TABLE(address, value, …)")
    first, *cells = found[1].split(",")
    address = integer(first, place, number)
    for offset, cell in enumerate(cells):
        if address + offset in values:
            raise refuse(place, number, f"the address {address + offset} is filled twice")
        values[address + offset] = real(cell, place, number)


def _called(values: dict[int, float], cells: list[str], number: int, place: str) -> CamTable:
    """Take the part of the table that a ``CAMBOX(start, end, multiplier, link distance, …)`` runs."""
    start, end = (integer(cell, place, number) for cell in cells[:2])
    multiplier, distance = (real(cell, place, number) for cell in cells[2:4])
    if not 0 < end - start <= MOST_POINTS:
        raise refuse(place, number, f"CAMBOX runs from {start} to {end}, which is no part of a table")
    missing = [address for address in range(start, end + 1) if address not in values]
    if missing:
        raise refuse(place, number, f"CAMBOX runs over the address {missing[0]}, which no TABLE line fills")
    if not (distance > 0.0 and multiplier != 0.0):
        raise refuse(place, number, f"the link distance {distance:g} and the multiplier {multiplier:g} make no motion")
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
