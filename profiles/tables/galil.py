"""Galil: the ``ET`` table of a program that runs an electronic cam. Read, not written."""

from __future__ import annotations

import re

from camwright.profiles.errors import InputError
from camwright.profiles.tables.cam_table import CamTable, make_table
from camwright.profiles.tables.interpolation import chords
from camwright.profiles.tables.target import Target
from camwright.profiles.tables.text import check_count, integer, lines_of, real, refuse, shown

MOST_POINTS = 16_000
_MOST_AXES = 8

SIGN = r"(?m)^[ \t:]{0,99}ET[ \t]{0,9}\["
"""What a text with such a table has."""

_ENTRY = re.compile(r"ET\s{0,9}\[([^\[\]]*)\]\s{0,9}=(.*)", re.IGNORECASE)
_INTERVAL = re.compile(r"EP\s{0,9}([0-9]{1,9})\s{0,9}(?:,.*)?", re.IGNORECASE)
_WIDENED = re.compile(r"EW\s{0,9}[0-9A-Z]", re.IGNORECASE)
_REMARK = re.compile(r"(?:'|NO\b|REM\b)", re.IGNORECASE)


def read(text: str, place: str) -> CamTable:
    """Slave positions of the ``ET`` lines, at even steps of the master of the ``EP`` line; other commands are passed over.

    Raises
    ------
    InputError
        An entry is no number, is given twice or missing, there are entries of two slaves, or segments are widened.
    """
    values, intervals = _entries(text, place)
    if not values:
        raise refuse(place, None, "there is no line ET[0]=position in it")
    check_count(len(values), 2, MOST_POINTS, place)
    missing = next((k for k in range(max(values) + 1) if k not in values), None) if max(values) < MOST_POINTS else 0
    if missing is not None:
        raise refuse(place, None, f"ET[{missing}] is missing: the entries run from ET[0] to ET[{max(values)}]")
    if len(intervals) > 1:
        raise refuse(
            place, max(intervals.values()), "EP gives more than one master interval; leave the one that is meant"
        )
    step = next(iter(intervals), 0)
    if intervals and not step:
        raise refuse(place, intervals[step], "EP 0 is no master interval")
    note = (
        f"EP sets the points {step} counts of the master apart"
        if step
        else "master positions are counted in steps of the table: EP, the master interval, is not in the file"
    )
    x = [float(k * (step or 1)) for k in range(len(values))]
    return make_table(x, [values[k][0] for k in range(len(values))], law="line", notes=(note,))


def _entries(text: str, place: str) -> tuple[dict[int, tuple[float, int]], dict[int, int]]:
    """Give the entries by their numbers, each with its line, and the master intervals with the lines where they are first given."""
    values: dict[int, tuple[float, int]] = {}
    axes: set[int] = set()
    intervals: dict[int, int] = {}
    for number, line in enumerate(lines_of(text, place), start=1):
        for command in (part.strip(" \t:") for part in line.split(";")):
            if _REMARK.match(command):
                break
            entry, interval = _ENTRY.fullmatch(command), _INTERVAL.fullmatch(command)
            if entry:
                axes.add(_fill(values, entry, place, number))
            elif interval:
                intervals.setdefault(int(interval[1]), number)
            elif _WIDENED.match(command):
                raise refuse(
                    place, number, "EW widens segments of the table, which is not read; write all points evenly spaced"
                )
            if len(axes) > 1:
                raise refuse(place, number, "ET gives positions of more than one slave; leave those of one in the file")
    return values, intervals


def _fill(values: dict[int, tuple[float, int]], entry: re.Match[str], place: str, number: int) -> int:
    """Take an entry; tell which axis it is of."""
    if not entry[1].strip().isdigit() or not entry[1].isascii():
        raise refuse(
            place,
            number,
            f"ET[{shown(entry[1])}] is filled by the program as it runs, which is not read; upload the table and audit that",
        )
    index = integer(entry[1], place, number)
    cells = [cell.strip() for cell in entry[2].split(",")]
    given = [k for k, cell in enumerate(cells) if cell]
    if len(given) != 1 or len(cells) > _MOST_AXES:
        raise refuse(place, number, f"ET[{index}] must give the position of one slave; it gives {len(given)}")
    if index in values:
        raise refuse(place, number, f"ET[{index}] is given twice")
    try:
        values[index] = real(cells[given[0]], place, number), number
    except InputError as error:
        raise InputError(*(f"{fault}; write the positions as numbers" for fault in error.faults)) from error
    return given[0]


LAYOUT = Target(
    name="galil",
    title="Galil DMC, ECAM table",
    interpolation="straight lines",
    law="line",
    spacing="equidistant",
    max_points=MOST_POINTS,
    evidence=(
        "EP (master interval): Optima command reference, p. 82. ET[n] by index, one entry an interval: application note 2311. "
        "Even spacing, straight lines between the points, EW: application note 2444."
    ),
    read=read,
    rebuild=chords,
)
