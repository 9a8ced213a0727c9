"""CODESYS SoftMotion: XYVA points in structured text, and calls of the CamBuilder."""

from __future__ import annotations

from camwright.profiles.tables.cam_table import CamTable, PieceLaw, make_table
from camwright.profiles.tables.number_formats import literal
from camwright.profiles.tables.st_program import (
    Call,
    Declaration,
    Program,
    Struct,
    Value,
    number_of,
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
    check_ascending,
    check_count,
    check_points,
    refuse,
    shown,
)

MOST_POINTS = 32_767  # nElements is an INT

_XYVA = ("dX", "dY", "dV", "dA")


def write(table: CamTable, header: Header) -> dict[str, str]:
    """Write a global variable list with the points and the ``MC_CAM_REF`` that refers to them."""
    name = header.identifier
    rows = [
        "        (" + ", ".join(f"{member} := {literal(value)}" for member, value in zip(_XYVA, row, strict=True)) + ")"
        for row in zip(table.x, table.y, table.ratio, table.ratio_slope, strict=True)
    ]
    text = (
        slash_comments(header.lines(TARGET.title, table))
        + "{attribute 'qualified_only'}\nVAR_GLOBAL\n"
        + "    // dV = dY/dX, dA = d2Y/dX2; first and last point both present\n"
        + f"    a{name} : ARRAY[0..{table.points - 1}] OF SMC_CAMXYVA := [\n"
        + ",\n".join(rows)
        + "];\n"
        + f"    cam{name} : MC_CAM_REF := (byType := SMC_CAM_TYPE.XYVA, xStart := {literal(table.x[0])}, "
        + f"xEnd := {literal(table.x[-1])}, nElements := {table.points}, nTappets := 0);\nEND_VAR\n"
        + f"// once, in code:  cam{name}.pce := ADR(a{name}[0]);\n"
    )
    return {f"{name}_codesys.st": text}


def read(text: str, place: str) -> CamTable:
    """XYVA points, XY points, or calls of the CamBuilder, whichever the text holds."""
    program = parse(text, place)
    points = program.arrays_of("SMC_CAMXYVA")
    if points:
        table = _xyva(program, only(points, "array of SMC_CAMXYVA", place), place)
    elif any(call.name == "append" for call in program.calls):
        return read_builder(text, place)
    else:
        table = _xy(program, place)
    return table if (units := units_in(text)) is None else table.with_units(units)


def _xyva(program: Program, array: Declaration, place: str) -> CamTable:
    structs = structs_of(array, place)
    known = {member.lower() for member in _XYVA}
    for struct in structs:
        for member in struct.members:
            if member not in known:
                raise refuse(place, struct.line, f"SMC_CAMXYVA has no member {shown(member)}")
    columns = numbers_of(structs, _XYVA, place)
    check_points(columns[0], [s.line for s in structs], place, MOST_POINTS)
    _check_reference(program, len(structs), columns[0], place, ("xyva", 3.0))
    return make_table(*columns)


def _check_reference(program: Program, points: int, x: list[float], place: str, kind: tuple[str, float]) -> None:
    """Refuse an ``MC_CAM_REF`` in the text that does not agree with the points."""
    for declaration in program.declarations:
        if declaration.type != "mc_cam_ref" or not isinstance(declaration.value, Struct):
            continue
        members, line = declaration.value.members, declaration.line
        stated = members.get("bytype")
        said = getattr(stated, "last", stated)
        if stated is not None and said not in kind:
            raise refuse(place, line, f"byType does not say {kind[0].upper()}, but that is what the points are")
        if "nelements" in members and members["nelements"] != float(points):
            raise refuse(place, line, f"nElements does not agree with the {points} points of the array")
        for member, end in (("xstart", x[0]), ("xend", x[-1])):
            value = members.get(member)
            if value is not None and (not isinstance(value, float) or abs(value - end) > 1e-9 * (x[-1] - x[0])):
                raise refuse(place, line, f"{member} does not agree with the points, where it is {end!r}")


def _xy(program: Program, place: str) -> CamTable:
    """Pairs of master and slave in a ``SMC_CAMTable_<type>_<n>_2``, between which the drive puts lines or a spline."""
    tables = [d for d in program.declarations if d.type.startswith("smc_camtable_") and d.type.endswith("_2")]
    tables = [d for d in tables if isinstance(d.value, Struct)]
    array = only(tables, "array of SMC_CAMXYVA, SMC_CAMTable_…_2 or CamBuilder", place)
    content = array.value.members.get("table") if isinstance(array.value, Struct) else None
    if not isinstance(content, list):
        raise refuse(place, array.line, "the member Table must be a list of pairs [master, slave]")
    x: list[float] = []
    y: list[float] = []
    for item in content:
        if not (isinstance(item, list) and len(item) == 2):
            raise refuse(place, array.line, "each entry of Table must be a pair [master, slave]")
        x.append(number_of(item[0], "a master position", place, array.line))
        y.append(number_of(item[1], "a slave position", place, array.line))
    check_points(x, [array.line] * len(x), place, MOST_POINTS)
    law: PieceLaw = "line"
    for declaration in program.declarations:
        if declaration.type == "mc_cam_ref" and isinstance(declaration.value, Struct):
            quality = declaration.value.members.get("byinterpolationquality", 1.0)
            if quality not in (1.0, 3.0):
                raise refuse(place, declaration.line, "byInterpolationQuality must be 1 (linear) or 3 (cubic)")
            law = "spline" if quality == 3.0 else "line"
    _check_reference(program, len(x), x, place, ("xy", 2.0))
    return make_table(x, y, law=law)


def write_builder(table: CamTable, header: Header) -> dict[str, str]:
    """Write calls that append one quintic a piece to a ``SMCB.CamBuilder``, and the cam into an ``MC_CAM_REF``."""
    name = header.identifier
    bounds = [
        "SMCB.Bound(" + ", ".join(literal(value) for value in row) + ")"
        for row in zip(table.x, table.y, table.ratio, table.ratio_slope, strict=True)
    ]
    lefts = [bounds[0]] + ["SMCB.BoundImplicit()"] * (table.points - 2)
    appends = [
        f"camBuilder.Append(SMCB.Poly5({left}, {right}));" for left, right in zip(lefts, bounds[1:], strict=True)
    ]
    text = (
        slash_comments(header.lines(BUILDER.title, table))
        + f"PROGRAM Build{name}\nVAR\n    camBuilder : SMCB.CamBuilder;\n    camRef : MC_CAM_REF;\n"
        + f"    aCamSegments : ARRAY[1..{table.points - 1}] OF SMC_CAM_SEGMENT;\nEND_VAR\n\n"
        + "camBuilder.Init();\n"
        + "\n".join(appends)
        + "\nSMCB.InitCamRef(camRef, ADR(aCamSegments), XSIZEOF(aCamSegments));\ncamBuilder.Write(camRef);\n"
        + "END_PROGRAM\n"
    )
    return {f"{name}_cambuilder.st": text}


def read_builder(text: str, place: str) -> CamTable:
    """Points from the ``Append`` calls of a CamBuilder."""
    calls = [call for call in parse(text, place).calls if call.name == "append"]
    check_count(len(calls) + 1, 2, MOST_POINTS, place)
    knots: list[tuple[float, ...]] = []
    for number, call in enumerate(calls):
        segment = call.arguments[0] if call.arguments else None
        if not (isinstance(segment, Call) and segment.name == "poly5" and len(segment.arguments) == 2):
            raise refuse(place, call.line, "Append is read with one SMCB.Poly5(left, right) only")
        if segment.named:
            raise refuse(
                place,
                call.line,
                "the bounds of a segment are given by name; give left and right in this order without names",
            )
        left, right = (_bound(value, place, call.line) for value in segment.arguments)
        if right is None:
            raise refuse(place, call.line, "the right bound of a segment must be a SMCB.Bound(…)")
        if number == 0:
            knots.append(left or (0.0, 0.0, 0.0, 0.0))
        elif left is not None and left != knots[-1]:
            raise refuse(place, call.line, "the segment's left bound is not the right bound of the segment before")
        knots.append(right)
    columns = [list(column) for column in zip(*knots, strict=True)]
    check_ascending(columns[0], [calls[0].line, *(call.line for call in calls)], place)
    return make_table(*columns, units=units_in(text))


def _bound(value: Value, place: str, line: int) -> tuple[float, ...] | None:
    """X, Y, V, A of a ``Bound``, what is left out being 0; ``None`` for a ``BoundImplicit``."""
    if isinstance(value, Call) and value.name == "boundimplicit" and not value.arguments:
        return None
    if not (isinstance(value, Call) and value.name == "bound" and 1 <= len(value.arguments) <= 4):
        raise refuse(place, line, "a segment's bound must be SMCB.Bound(X, Y, V, A) or SMCB.BoundImplicit()")
    if value.named:
        raise refuse(
            place, line, "the values of a bound are given by name; give X, Y, V, A in this order without names"
        )
    given = [number_of(argument, "a bound's value", place, line) for argument in value.arguments]
    return tuple(given + [0.0] * (4 - len(given)))


TARGET = Target(
    name="codesys",
    title="CODESYS SoftMotion, XYVA points",
    interpolation="quintic through position, ratio and ratio slope",
    law="quintic",
    spacing="pieces",
    max_points=MOST_POINTS,
    evidence=(
        "MC_CAM_REF, SMC_CAM_TYPE: library documentation SM3_Basic; SMC_CAMXYVA: Lenze PLC Designer SoftMotion manual, "
        "p. 105. The declaration is composed from the documented types and has been through no compiler. That at most "
        "32767 points fit follows from the type of nElements."
    ),
    steps=(
        "Add the text as a global variable list to the application.",
        (
            "In code, once before the cam is selected, run the line at the end of the file: it sets pce to the first "
            "point."
        ),
        "Select the cam with MC_CamTableSelect, Periodic := TRUE, and start it with MC_CamIn.",
        "The units are those of the axes: set them as the head of the file states.",
    ),
    endings=("_codesys.st",),
    write=write,
    read=read,
)

BUILDER = Target(
    name="codesys-cambuilder",
    title="CODESYS SoftMotion, CamBuilder (4.17 and later)",
    interpolation="quintic through position, ratio and ratio slope",
    law="quintic",
    spacing="pieces",
    max_points=MOST_POINTS,
    evidence=(
        "CODESYS SoftMotion documentation, page 'Creating Cams Programmatically', with its example. That Bound's "
        "fourth value is the ratio slope follows from the order (X, Y, V, A) in which the page lists the boundary "
        "values."
    ),
    steps=(
        "Add the program to the application and call it once from the bus task.",
        "Use camRef with MC_CamTableSelect, Periodic := TRUE, and start the cam with MC_CamIn.",
        "The units are those of the axes: set them as the head of the file states.",
    ),
    endings=("_cambuilder.st",),
    write=write_builder,
    read=read_builder,
)
