"""Structured text with two plain arrays, master and slave positions, as cam editors write them. Read, not written."""

from __future__ import annotations

import re

from camwright.profiles.tables.cam_table import CamTable, make_table
from camwright.profiles.tables.column_words import cam_role
from camwright.profiles.tables.st_program import Declaration
from camwright.profiles.tables.structured_text import parse
from camwright.profiles.tables.target import Target, units_in
from camwright.profiles.tables.text import check_points, refuse, shown

MOST_POINTS = 20_000
_REALS = frozenset({"lreal", "real"})
_ARRAY = re.compile(
    r"(?mi)^[ \t]{0,99}(\w{1,60})[ \t]{0,9}:[ \t]{0,9}ARRAY[ \t]{0,9}\[[^\[\]\n]{1,40}\][ \t]{0,9}OF[ \t]{1,9}L?REAL\b"
)


def is_written_so(text: str) -> bool:
    """Whether a text declares one array of the master and one of the slave."""
    roles = [cam_role(name) for name in _ARRAY.findall(text)]
    return roles.count("x") == 1 and roles.count("y") == 1


def read(text: str, place: str) -> CamTable:
    """Take the array that its name says is the master's, and the slave's; others are passed over.

    Raises
    ------
    InputError
        There are not just two such arrays, they differ in length, or one holds what is no number.
    """
    found: dict[str, Declaration] = {}
    for declaration in parse(text, place).declarations:
        role = cam_role(declaration.name)
        if len(declaration.bounds) != 1 or declaration.type not in _REALS or role not in ("x", "y"):
            continue
        if role in found:
            both = f"{shown(found[role].name)} and {shown(declaration.name)}"
            raise refuse(place, declaration.line, f"both {both} look like the {_WHO[role]}; leave one in the file")
        found[role] = declaration
    for role, who in _WHO.items():
        if role not in found:
            raise refuse(place, None, f"there is no array of LREAL with positions of the {who}")
    x, y = (_numbers(found[role], place) for role in _WHO)
    if len(x) != len(y):
        raise refuse(place, found["y"].line, f"there are {len(x)} master positions but {len(y)} slave positions")
    check_points(x, [found["x"].line] * len(x), place, MOST_POINTS, 3)
    note = "the text does not say what lies between the points: a cubic spline is assumed"
    return make_table(x, y, law="spline", units=units_in(text), notes=(note,))


_WHO = {"x": "master", "y": "slave"}


def _numbers(array: Declaration, place: str) -> list[float]:
    values = array.value if isinstance(array.value, list) else []
    places = array.bounds[0][1] - array.bounds[0][0] + 1
    if len(values) != places:
        raise refuse(place, array.line, f"the array {shown(array.name)} has {places} places but {len(values)} values")
    numbers = [value for value in values if isinstance(value, float)]
    if len(numbers) != len(values):
        raise refuse(place, array.line, f"the array {shown(array.name)} holds something that is no number")
    return numbers


LAYOUT = Target(
    name="st-arrays",
    title="structured text, arrays of master and slave positions",
    interpolation="cubic spline, assumed",
    law="spline",
    spacing="free",
    max_points=MOST_POINTS,
    evidence="The export of the cam editor Quintic (public source): MasterPos and SlavePos, ARRAY[1..n] OF LREAL := [...].",
    read=read,
)
