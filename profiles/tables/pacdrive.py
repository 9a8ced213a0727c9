"""Schneider PacDrive 3: ``ST_MultiCam`` in structured text."""

from __future__ import annotations

from camwright.profiles.tables.cam_table import CamTable, make_table
from camwright.profiles.tables.number_formats import literal
from camwright.profiles.tables.st_program import Word, assigned_to, in_turn, numbers_of
from camwright.profiles.tables.structured_text import parse
from camwright.profiles.tables.target import (
    Header,
    Target,
    slash_comments,
    units_in,
)
from camwright.profiles.tables.text import (
    check_points,
    refuse,
)

MOST_SEGMENTS = 32

_MEMBERS = ("lrx", "lry", "lrm", "lrk")
_KNOWN = frozenset([*_MEMBERS, "etcamtype"])
_UNREAD = "the member {} of a cam point is not read"


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
    program = parse(text, place)
    counts = [entry.value for entry in program.assignments if entry.path[-1] == "dinumberofcampoints"]
    points = in_turn(assigned_to(program, _KNOWN, place, "astcampoint", unread=_UNREAD), place)
    for point in points[:-1]:
        law = point.members.get("etcamtype")
        if not (isinstance(law, Word) and law.last == "poly5com"):
            raise refuse(place, point.line, "the section's etCamType is not Poly5Com; no other is read")
    count = next((value for value in reversed(counts) if isinstance(value, float)), None)
    columns = numbers_of(points, _MEMBERS, place)
    check_points(columns[0], [point.line for point in points], place, MOST_SEGMENTS + 1)
    if count is None:
        raise refuse(place, None, "diNumberOfCamPoints is not set")
    if count not in (len(points), len(points) - 1):
        raise refuse(place, None, f"diNumberOfCamPoints is {count:g}, but there are {len(points)} points")
    return make_table(*columns, units=units_in(text))


TARGET = Target(
    name="pacdrive",
    title="Schneider PacDrive 3, ST_MultiCam",
    interpolation="quintic through position, ratio and ratio slope (Poly5Com)",
    law="quintic",
    spacing="pieces",
    max_points=MOST_SEGMENTS + 1,
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
)
