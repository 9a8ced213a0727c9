"""Schneider PacDrive 3: ``ST_MultiCam`` in structured text."""

from __future__ import annotations

from itertools import pairwise

from camwright.profiles.tables.cam_table import CamTable, make_table
from camwright.profiles.tables.interpolation import by_law
from camwright.profiles.tables.number_formats import literal
from camwright.profiles.tables.st_program import Value, Word, number_of
from camwright.profiles.tables.structured_text import parse
from camwright.profiles.tables.target import (
    Header,
    Target,
    slash_comments,
    units_in,
)
from camwright.profiles.tables.text import (
    check_ascending,
    check_count,
    refuse,
    shown,
)

MOST_SEGMENTS = 32

_MEMBERS = ("lrx", "lry", "lrm", "lrk")
_KNOWN = frozenset([*_MEMBERS, "etcamtype"])


def write(table: CamTable, header: Header) -> dict[str, str]:
    """Write assignments that fill a ``ST_MultiCam``, its sections all Poly5Com."""
    name = header.identifier
    lines = []
    for k, row in enumerate(zip(table.x, table.y, table.ratio, table.ratio_slope, strict=True)):
        point = f"stMultiCam.astCamPoint[{k}]"
        lines += [
            f"{point}.{member} := {literal(value)};"
            for member, value in zip(("lrX", "lrY", "lrM", "lrK"), row, strict=True)
        ]
        lines.append(f"{point}.etCamType := PDL.ET_CamType.Poly5Com;")
    text = (
        slash_comments(header.lines(TARGET.title, table))
        + f"PROGRAM Cam_{name}\nVAR\n    stMultiCam : PDL.ST_MultiCam;\nEND_VAR\n\n"
        + "\n".join(lines)
        + f"\nstMultiCam.diNumberOfCamPoints := {table.points - 1};\nstMultiCam.lrYPeriod := 0.0;\nEND_PROGRAM\n"
    )
    return {f"{name}_pacdrive.st": text}


def read(text: str, place: str) -> CamTable:
    """Points from assignments to ``astCamPoint[…]``."""
    points, lines, count = _points(text, place)
    indices = sorted(points)
    check_count(len(indices), 2, MOST_SEGMENTS + 1, place)
    for before, index in pairwise(indices):
        if index != before + 1:
            raise refuse(place, lines[index], f"the points have a gap: {index} follows {before}")
    for index in indices[:-1]:
        law = points[index].get("etcamtype")
        if not (isinstance(law, Word) and law.last == "poly5com"):
            raise refuse(place, lines[index], "the section's etCamType is not Poly5Com; no other is read")
    if count is None:
        raise refuse(place, None, "diNumberOfCamPoints is not set")
    if count not in (len(indices), len(indices) - 1):
        raise refuse(place, None, f"diNumberOfCamPoints is {count:g}, but there are {len(indices)} points")
    columns = [[number_of(points[i].get(m), m, place, lines[i]) for i in indices] for m in _MEMBERS]
    check_ascending(columns[0], [lines[i] for i in indices], place)
    return make_table(*columns, units=units_in(text))


def _points(text: str, place: str) -> tuple[dict[int, dict[str, Value]], dict[int, int], float | None]:
    """Give the members of each point by its index, the line where it begins, and how many points there are said to be."""
    points: dict[int, dict[str, Value]] = {}
    lines: dict[int, int] = {}
    count: float | None = None
    for entry in parse(text, place).assignments:
        if entry.path[-1] == "dinumberofcampoints" and isinstance(entry.value, float):
            count = entry.value
        if len(entry.path) < 3 or not isinstance(entry.path[-2], int) or entry.path[-3] != "astcampoint":
            continue
        member, index = str(entry.path[-1]), entry.path[-2]
        if member not in _KNOWN:
            raise refuse(place, entry.line, f"the member {shown(member)} of a cam point is not read")
        if member in points.setdefault(index, {}):
            raise refuse(place, entry.line, f"{shown(member)} of point {index} is given twice")
        points[index][member] = entry.value
        lines.setdefault(index, entry.line)
    return points, lines, count


TARGET = Target(
    name="pacdrive",
    title="Schneider PacDrive 3, ST_MultiCam",
    interpolation="quintic through position, ratio and ratio slope (Poly5Com)",
    law="quintic",
    spacing="pieces",
    max_points=MOST_SEGMENTS + 1,
    number_format="float64",
    evidence=(
        "ST_MultiCam, ST_CamPoint: Machine Expert online help, PD_PacDriveLib. That lrK is d²y/dx² follows from its "
        "name, 'curvature'. diNumberOfCamPoints counts the sections in the help's example of three points; whether it "
        "must is not said."
    ),
    steps=(
        "Add the program to the project, or take its assignments over, and hand stMultiCam to FB_MultiCam.",
        "Check diNumberOfCamPoints against the help of the library's version: the file gives the number of sections.",
        (
            "Let the function block check the cam before the axis is released; compare its peak values with the head "
            "of the file."
        ),
        "The units are those of the axes: set them as the head of the file states.",
    ),
    endings=("_pacdrive.st",),
    write=write,
    read=read,
    rebuild=by_law,
)
