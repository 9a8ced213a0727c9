"""Siemens S7-1500T: basic points of LCamHdl (quintics) and point data of the technology object (cubic spline)."""

from __future__ import annotations

from camwright.profiles.tables.cam_table import CamTable, make_table
from camwright.profiles.tables.number_formats import literal
from camwright.profiles.tables.st_program import (
    Program,
    Struct,
    assigned_to,
    in_turn,
    numbers_of,
    only,
    structs_of,
)
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
    shown,
)

MOST_BASIC = 51
MOST_POINTS = 10_000

_BASIC = ("leadingValue", "followingValue", "velocityRatio", "accelerationRatio")
_POINT = ("x", "y")


def _configuration(name: str, variable: str, type_name: str, rows: list[str], head: list[str]) -> str:
    """Write one global array in a configuration, the form of the library's own sample."""
    return (
        slash_comments(head)
        + "USING Siemens.Simatic.S71500.MotionControl.Native;\n\n"
        + f"CONFIGURATION {name}Configuration\n    VAR_GLOBAL\n"
        + f"        {variable} : ARRAY[1..{len(rows)}] OF {type_name} := [\n"
        + ",\n".join(f"            {row}" for row in rows)
        + "\n        ];\n    END_VAR\nEND_CONFIGURATION\n"
    )


def _rows(members: tuple[str, ...], columns: tuple[object, ...]) -> list[str]:
    return [
        "(" + ", ".join(f"{member} := {literal(float(v))}" for member, v in zip(members, row, strict=True)) + ")"
        for row in zip(*columns, strict=True)
    ]


def write(table: CamTable, header: Header) -> dict[str, str]:
    """Write an array of ``LCamHdl_typeBasicPoint``."""
    rows = _rows(_BASIC, (table.x, table.y, table.ratio, table.ratio_slope))
    name = header.identifier
    head = header.lines(TARGET.title, table)
    return {f"{name}_lcamhdl.st": _configuration(name, "profileBasic", "LCamHdl_typeBasicPoint", rows, head)}


def write_points(table: CamTable, header: Header) -> dict[str, str]:
    """Write an array of ``TO_Cam_Struct_PointData``."""
    rows = _rows(_POINT, (table.x, table.y))
    name = header.identifier
    head = header.lines(POINTS.title, table)
    return {f"{name}_to_cam.st": _configuration(name, "profileXY", "TO_Cam_Struct_PointData", rows, head)}


def read(text: str, place: str) -> CamTable:
    """Read basic points, or point data, whichever the text holds, as initial values or as assignments."""
    program = parse(text, place)
    structs = _structs(program, "LCamHdl_typeBasicPoint", _BASIC, place)
    basic = bool(structs)
    if not basic:
        structs = _structs(program, "TO_Cam_Struct_PointData", _POINT, place)
    if not structs:
        raise refuse(place, None, "there are neither basic points of LCamHdl nor points of a cam with a value")
    members = _BASIC if basic else _POINT
    columns = numbers_of(structs, members, place)
    check_points(columns[0], [s.line for s in structs], place, MOST_BASIC if basic else MOST_POINTS)
    return make_table(*columns, law="quintic" if basic else "spline", units=units_in(text))


def _structs(program: Program, type_name: str, members: tuple[str, ...], place: str) -> list[Struct]:
    """Gather the points of a type: the initial value of one array, or assignments to its elements."""
    known = {member.lower() for member in members}
    arrays = program.arrays_of(type_name)
    if arrays:
        structs = structs_of(only(arrays, f"array of {type_name}", place), place)
        for struct in structs:
            for member in struct.members:
                if member not in known:
                    raise refuse(place, struct.line, f"{type_name} has no member {shown(member)}")
        return structs
    return in_turn(assigned_to(program, known, place), place)


_LOADING = (
    (
        "In operation: select with MC_CamIn, ApplicationMode 1 (cyclic) for a cam that comes back, 2 (cyclic "
        "appending) for a knife."
    ),
    "Technology objects carry no units: the values are those of the axes, as the head of the file states.",
)

TARGET = Target(
    name="s7-1500t",
    title="Siemens S7-1500T, LCamHdl basic points",
    interpolation="quintic through position, ratio and ratio slope",
    law="quintic",
    spacing="pieces",
    max_points=MOST_BASIC,
    evidence=(
        "LCamHdl_typeBasicPoint, the limit of 51 points and the form of the array: documentation of the repository "
        "simatic-ax/lcamhdl. The array is in the form of SIMATIC AX; the form of TIA Portal's external sources was not "
        "seen."
    ),
    steps=(
        "Install the library LCamHdl (AX: apax add @simatic-ax/lcamhdl; TIA Portal: support entry 105644659).",
        "Add the configuration, or take its values over into an array of the library's type.",
        "Call LCamHdl_CreateCamBasic with the array and the TO_Cam; wait for its status 16#0000.",
        *_LOADING,
    ),
    endings=("_lcamhdl.st",),
    write=write,
    read=read,
)

POINTS = Target(
    name="s7-1500t-points",
    title="Siemens S7-1500T, points of TO_Cam (1000) or TO_Cam_10k (10000)",
    interpolation="cubic spline (InterpolationMode 1), equal end slopes (BoundaryConditions 1), taken as cyclic",
    law="spline",
    spacing="free",
    max_points=MOST_POINTS,
    evidence=(
        "TO_Cam_Struct_PointData, InterpolationSettings, limits: TIA Portal information system, 'Using "
        "S7-1500/S7-1500T Synchronous operation functions'; form of the array: sample of simatic-ax/lcamhdl. That "
        "equal slopes go with equal second derivatives is inferred."
    ),
    steps=(
        (
            "Add the configuration, or take its values over into an array of TO_Cam_Struct_PointData. Above 1000 "
            "points use TO_Cam_10k."
        ),
        "Set InterpolationSettings.InterpolationMode to 1 and BoundaryConditions to 1.",
        "Call LCamHdl_CreateCamBasedOnXYPoints, or MC_CopyCamData followed by MC_InterpolateCam.",
        *_LOADING,
    ),
    endings=("_to_cam.st",),
    write=write_points,
    read=read,
)
