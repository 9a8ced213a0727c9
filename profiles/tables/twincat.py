"""Beckhoff TwinCAT 3 NC camming (TF5050): motion functions and position tables in structured text."""

from __future__ import annotations

import numpy as np

from camwright.profiles.tables.cam_table import CamTable, PieceLaw, make_table
from camwright.profiles.tables.number_formats import literal
from camwright.profiles.tables.st_program import (
    Program,
    Struct,
    Value,
    Word,
    number_of,
)
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

MOST_ROWS = 16_777_216
MOST_READ = 20_000  # rows; far above any sensible table

_FUNCTIONS = {"polynom1": 1, "polynom3": 3, "polynom5": 5, "polynom5_mm": 15}
_LAWS: dict[int, PieceLaw] = {1: "line", 3: "cubic", 5: "quintic", 15: "quintic"}
_AT_REST = {3: "a POLYNOM3", 5: "a POLYNOM5"}
"""Functions that lead from rest to rest."""

_MEMBERS = frozenset(
    (
        "pointindex",
        "functiontype",
        "pointtype",
        "relindexnextpoint",
        "masterpos",
        "slavepos",
        "slavevelo",
        "slaveacc",
        "slavejerk",
    )
)
_MOTION_MEMBERS = ("masterpos", "slavepos", "slavevelo", "slaveacc")
_IGNORE = 0


def write(table: CamTable, header: Header) -> dict[str, str]:
    """Write a program that fills an array of ``MC_MotionFunctionPoint`` and its ``MC_CAM_REF``."""
    name, last = header.identifier, table.points
    codes = ["POLYNOM1" if law == "line" else "POLYNOM5_MM" for law in table.laws]
    lines = []
    for k in range(last):
        point = f"camPoints[{k + 1}]"
        kind = "ACTIVATION" if k == 0 else "MOTION"
        values = {
            "PointIndex": str(k + 1),
            "FunctionType": f"MC_MotionFunctionType.MOTIONFUNCTYPE_{[*codes, 'POLYNOM5_MM'][k]}",
            "PointType": f"MC_MotionPointType.MOTIONPOINTTYPE_{kind}",
            "RelIndexNextPoint": "1" if k + 1 < last else "0",
            "MasterPos": literal(table.x[k]),
            "SlavePos": literal(table.y[k]),
            "SlaveVelo": literal(table.ratio[k]),
            "SlaveAcc": literal(table.ratio_slope[k]),
            "SlaveJerk": "0.0",
        }
        lines += [f"{point}.{member} := {value};" for member, value in values.items()]
    text = (
        slash_comments(header.lines(TARGET.title, table))
        + f"PROGRAM Cam_{name}\nVAR\n    camPoints : ARRAY[1..{last}] OF MC_MotionFunctionPoint;\n"
        + "    camRef : MC_CAM_REF;\nEND_VAR\n\n"
        + "\n".join(lines)
        + f"\n\ncamRef.NoOfColumns := 1;\ncamRef.NoOfRows := {last};\n"
        + "camRef.TableType := MC_TableType.MC_TABLETYPE_MOTIONFUNCTION;\n"
        + "camRef.ArraySize := SIZEOF(camPoints);\ncamRef.pArray := ADR(camPoints);\nEND_PROGRAM\n"
    )
    return {f"{name}_twincat.st": text}


def read(text: str, place: str) -> CamTable:
    """Motion-function points, or a position table, whichever the text holds."""
    program = parse(text, place)
    points = _gather(program, place)
    if not points:
        return _positions(program, text, place)
    check_count(len(points), 2, MOST_READ, place)
    previous = 0
    kept: list[tuple[dict[str, Value], int, int]] = []
    for index, (members, line) in sorted(points.items()):
        if previous and index != previous + 1:
            raise refuse(place, line, f"the points have a gap: {index} follows {previous}")
        previous = index
        for name in (*_MOTION_MEMBERS, "slavejerk"):
            number_of(members.get(name), name, place, line)
        if members.get("relindexnextpoint", 1.0) not in (0.0, 1.0):
            raise refuse(
                place, line, "RelIndexNextPoint must be 1: points that are not run in their order are not read"
            )
        stated = members.get("pointindex", float(index))
        if stated != float(index):
            raise refuse(place, line, f"PointIndex must be {index} at the point with this index")
        if _point_type(members.get("pointtype"), place, line) != _IGNORE:
            kept.append((members, line, _function(members.get("functiontype"), place, line)))
    _check_rows(program, len(points), place)
    check_count(len(kept), 2, None, place)
    return _table(kept, text, place)


def _check_rows(program: Program, rows: int, place: str) -> None:
    """Refuse a text that fills fewer rows than it says: one that was cut off."""
    stated = [entry for entry in program.assignments if entry.path[-1] == "noofrows" and isinstance(entry.value, float)]
    for entry in stated:
        if entry.value != float(rows):
            raise refuse(place, entry.line, f"NoOfRows does not agree with the {rows} rows that the text fills")
    for declaration in program.declarations:
        two = len(declaration.bounds) == 2 and declaration.type == "lreal"
        if stated or not (declaration.type == "mc_motionfunctionpoint" or two) or not declaration.bounds:
            continue
        places = declaration.bounds[0][1] - declaration.bounds[0][0] + 1
        if places != rows:
            reason = f"the array has {places} rows, but the text fills {rows} and sets no NoOfRows"
            raise refuse(place, declaration.line, reason)


def _table(kept: list[tuple[dict[str, Value], int, int]], text: str, place: str) -> CamTable:
    """Knots and laws; a rest-to-rest quintic needs rest at both of its knots."""
    columns = [[number_of(m.get(name), name, place, line) for m, line, _ in kept] for name in _MOTION_MEMBERS]
    lines = [line for _, line, _ in kept]
    check_ascending(columns[0], lines, place)
    laws: list[PieceLaw] = []
    for k, (_, line, function) in enumerate(kept[:-1]):
        laws.append(_LAWS[function])
        rest = all(columns[c][j] == 0.0 for c in (2, 3) for j in (k, k + 1))
        if function in _AT_REST and not rest:
            what = f"{_AT_REST[function]} leads from rest to rest, but a point of it has a velocity or acceleration"
            raise refuse(place, line, what)
    return make_table(*columns, law=tuple(laws), units=units_in(text))


def _gather(program: Program, place: str) -> dict[int, tuple[dict[str, Value], int]]:
    """Points by their index, from assignments and initial values."""
    arrays: set[tuple[str | int, ...]] = {
        (array.name.lower(),) for array in program.arrays_of("MC_MotionFunctionPoint")
    }
    points = _initial(program, place)
    loose = [(str(entry.path[0]), entry.line) for entry in program.assignments if len(entry.path) == 1]
    for name, line in (*program.unplaced, *loose):
        if name in _MOTION_MEMBERS:
            raise refuse(
                place,
                line,
                f"{shown(name)} is given a value, but of which point is not known: write its index as a number",
            )
    filled = [entry for entry in program.assignments if len(entry.path) > 2 and isinstance(entry.path[-2], int)]
    known = arrays | {entry.path[:-2] for entry in filled if entry.path[-1] in _MEMBERS}
    for entry in filled:
        if entry.path[-1] not in _MEMBERS:
            if entry.path[:-2] in known:
                raise refuse(place, entry.line, f"a point has no member {shown(str(entry.path[-1]))}")
            continue
        arrays.add(entry.path[:-2])
        if len(arrays) > 1:
            raise refuse(place, entry.line, "the text fills more than one array of points; leave one in the file")
        member, index = str(entry.path[-1]), int(entry.path[-2])
        members, line = points.setdefault(index, ({}, entry.line))
        if member in members and members[member] != entry.value:
            raise refuse(place, entry.line, f"{shown(member)} of point {index} is given twice, with different values")
        members[member] = entry.value
        if len(points) > MOST_READ:
            raise refuse(place, line, f"there are more than {MOST_READ} points")
    return points


def _initial(program: Program, place: str) -> dict[int, tuple[dict[str, Value], int]]:
    """Points by their index, from initial values."""
    points: dict[int, tuple[dict[str, Value], int]] = {}
    for array in program.arrays_of("MC_MotionFunctionPoint"):
        for offset, item in enumerate(array.value if isinstance(array.value, list) else []):
            if not isinstance(item, Struct):
                raise refuse(place, array.line, "a point must be a list of ( member := value )")
            points[array.bounds[0][0] + offset] = (dict(item.members), item.line)
    return points


def _function(value: Value | None, place: str, line: int) -> int:
    """Find the number of a motion function, from a number or a name with or without its prefix."""
    if value is None:
        raise refuse(place, line, "the point has no FunctionType")
    if isinstance(value, Word):
        name = value.last.removeprefix("motionfunctype_")
        number = float(_FUNCTIONS.get(name, -1))
    else:
        name, number = str(value), value if isinstance(value, float) else -1.0
    if number not in _LAWS:
        raise refuse(
            place,
            line,
            f"the motion function {shown(name)} is not read; POLYNOM1, POLYNOM3, POLYNOM5 and POLYNOM5_MM are: export the cam as a "
            "table of positions and audit that",
        )
    return int(number)


def _point_type(value: Value | None, place: str, line: int) -> int:
    """Find the number of a point type; what is left out is a motion point."""
    if value is None:
        return 8
    if isinstance(value, Word):
        return _IGNORE if value.last.removeprefix("motionpointtype_") == "ignore" else 8
    if isinstance(value, float):
        return int(value)
    raise refuse(place, line, "PointType must be a number or a name")


def write_positions(table: CamTable, header: Header) -> dict[str, str]:
    """Write a program that fills an ``ARRAY[0..n-1, 0..1] OF LREAL`` and its ``MC_CAM_REF``."""
    name = header.identifier
    lines = [
        f"camTable[{k}, 0] := {literal(x)}; camTable[{k}, 1] := {literal(y)};"
        for k, (x, y) in enumerate(zip(table.x, table.y, strict=True))
    ]
    steps = np.diff(table.x)
    even = np.ptp(steps) <= 1e-9 * table.period
    text = (
        slash_comments(header.lines(POSITIONS.title, table))
        + f"PROGRAM CamTable_{name}\nVAR\n    camTable : ARRAY[0..{table.points - 1}, 0..1] OF LREAL;\n"
        + "    camRef : MC_CAM_REF;\nEND_VAR\n\n"
        + "\n".join(lines)
        + f"\n\ncamRef.NoOfColumns := 2;\ncamRef.NoOfRows := {table.points};\n"
        + f"camRef.TableType := MC_TableType.MC_TABLETYPE_{'' if even else 'NON'}EQUIDISTANT;\n"
        + "camRef.ArraySize := SIZEOF(camTable);\ncamRef.pArray := ADR(camTable);\nEND_PROGRAM\n"
    )
    return {f"{name}_twincat_table.st": text}


def _positions(program: Program, text: str, place: str) -> CamTable:
    """Read an n × 2 table from assignments ``name[row, 0]`` and ``name[row, 1]`` or a flat initial value."""
    cells, names = _filled_cells(program, place)
    if not cells:
        raise refuse(place, None, "there are neither points of a motion function nor a position table")
    if len(names) > 1:
        raise refuse(place, None, "the text fills more than one position table; leave one in the file")
    first = min(row for row, _ in cells)
    count = len(cells) // 2
    if count > MOST_READ:
        raise refuse(place, None, f"there are more than {MOST_READ} rows")
    columns: list[list[float]] = [[], []]
    lines: list[int] = []
    for row in range(first, first + count):
        for column in (0, 1):
            if (row, column) not in cells:
                raise refuse(place, None, f"the cell [{row}, {column}] of the position table is missing")
            columns[column].append(cells[row, column][0])
        lines.append(cells[row, 0][1])
    if len(cells) % 2:
        raise refuse(place, None, "the position table has a row with one cell only")
    _check_rows(program, count, place)
    check_count(count, 2, None, place)
    check_ascending(columns[0], lines, place)
    return make_table(*columns, law="spline", units=units_in(text))


def _filled_cells(
    program: Program, place: str
) -> tuple[dict[tuple[int, int], tuple[float, int]], set[tuple[str | int, ...]]]:
    """Find the cells that a program fills, by row and column with value and line, and the names of the arrays that it fills."""
    cells: dict[tuple[int, int], tuple[float, int]] = {}
    names: set[tuple[str | int, ...]] = set()
    for array in program.declarations:
        two = len(array.bounds) == 2 and array.bounds[1][1] - array.bounds[1][0] == 1
        if not (two and array.type == "lreal" and isinstance(array.value, list)):
            continue
        names.add((array.name.lower(),))
        for k, item in enumerate(array.value):
            cells[array.bounds[0][0] + k // 2, k % 2] = (number_of(item, "a cell", place, array.line), array.line)
    for entry in program.assignments:
        path = entry.path
        if len(path) < 3 or not (isinstance(path[-1], int) and isinstance(path[-2], int)):
            continue
        names.add(path[:-2])
        if path[-1] not in (0, 1):
            raise refuse(place, entry.line, f"a position table has the columns 0 and 1, not {path[-1]}")
        cells[path[-2], path[-1]] = (number_of(entry.value, "a cell", place, entry.line), entry.line)
    return cells, names


TARGET = Target(
    name="twincat",
    title="Beckhoff TwinCAT 3 NC camming (TF5050), motion function",
    interpolation="line (POLYNOM1) or quintic through position, ratio and ratio slope (POLYNOM5_MM), point by point",
    law="quintic",
    spacing="pieces",
    max_points=MOST_ROWS,
    evidence=(
        "MC_MotionFunctionPoint, MC_MotionFunctionType, MC_MotionPointType, MC_CAM_REF: infosys TF5050 (1003721995, "
        "1003744011, 1003586955); greatest number of rows: ADS specification (713131531); form of the assignments: a "
        "public generator. The meaning of the point types is not agreed upon in the field: check the cam in the "
        "engineering tool."
    ),
    steps=(
        "Add the program to the PLC project and call it once before the cam is selected.",
        "Select camRef with MC_CamTableSelect, Periodic := TRUE, and couple with MC_CamIn.",
        "Read the cam back in the engineering tool and compare its peak values with the head of the file.",
        "The units are those of the axes: set them as the head of the file states.",
    ),
    adds_scaled=(
        "MC_CamIn_V2 runs several superimposed cam plates, MC_CamAdd adds one, MC_CamScaling_V2 changes SlaveScaling during motion: "
        "infosys TF5050 (1002620683, 1002674827, 460415883, scaling modes 1003655819); slave = cam times SlaveScaling plus SlaveOffset, "
        "and set points of single couplings are added: infosys TF5550 (21872062987, 21872092811)"
    ),
    endings=("_twincat.st",),
    write=write,
    read=read,
    states_laws=True,
)

POSITIONS = Target(
    name="twincat-table",
    title="Beckhoff TwinCAT 3 NC camming (TF5050), position table",
    interpolation="cubic spline (MC_INTERPOLATIONTYPE SPLINE, 2), taken as cyclic",
    law="spline",
    spacing="free",
    max_points=MOST_ROWS,
    evidence=(
        "MC_CAM_REF with an n × 2 array, MC_InterpolationType: infosys TF5050 (1003586955, 1003709323). The "
        "documentation says 'tangential or cyclic depending on table'; that a repeated cam becomes cyclic is inferred."
    ),
    steps=(
        "Add the program to the PLC project and call it once before the cam is selected.",
        "Select camRef with MC_CamTableSelect, Periodic := TRUE.",
        "Couple with MC_CamIn, Options.InterpolationType set to SPLINE: linear interpolation is a different motion.",
        "The units are those of the axes: set them as the head of the file states.",
    ),
    endings=("_twincat_table.st",),
    write=write_positions,
    read=read,
)
