"""B&R mapp Motion: ``McCamSectionsType`` in structured text, REAL throughout, with whole periods."""

from __future__ import annotations

from camwright.profiles.errors import InputError
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.tables.cam_table import CamTable, PieceLaw, make_table
from camwright.profiles.tables.interpolation import in_float32, quintics
from camwright.profiles.tables.number_formats import literal
from camwright.profiles.tables.st_program import Struct, Value, Word, assigned_to, numbers_of
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

MOST_SECTIONS = 130
LEAST_STEP = 1e-4
"""Least width of a section as a part of the period: in a narrower one the rounding of REAL is most of the motion."""
LARGEST_WHOLE = 2**24
"""Above this, REAL does not hold every whole number."""

_MEMBERS = ("MasterPoint", "SlavePoint", "FirstDerivative", "SecondDerivative")
_LAWS = {"last_point": 0, "straight_line": 1, "5th_order_polynom": 4}
_LAST, _LINE, _QUINTIC = 0, 1, 4


def write(table: CamTable, header: Header) -> dict[str, str]:
    """Write assignments that fill a ``McCamSectionsType``: quintic sections, and the last point as terminator.

    Raises
    ------
    InputError
        The master period or the slave's travel is not a whole number: the drive keeps both as DINT.
    """
    check_periods(table)
    name = header.identifier
    lines = []
    for k, row in enumerate(zip(table.x, table.y, table.ratio, table.ratio_slope, strict=True)):
        section = f"CamSections.Section[{k}]"
        law = "5TH_ORDER_POLYNOM" if k < table.points - 1 else "LAST_POINT"
        lines += [
            f"{section}.{member} := {literal(value, 'float32')};" for member, value in zip(_MEMBERS, row, strict=True)
        ]
        lines += [f"{section}.Mode := mcCAMSECTREF_ABSOLUTE;", f"{section}.Type := mcCAMSECTLAW_{law};"]
    text = (
        slash_comments(header.lines(TARGET.title, table))
        + f"PROGRAM _INIT\n    // VAR CamSections : McCamSectionsType; END_VAR   (cam {name})\n"
        + "\n".join(f"    {line}" for line in lines)
        + "\nEND_PROGRAM\n"
    )
    return {f"{name}_br.st": text}


def check_periods(table: CamTable) -> None:
    """Refuse periods that are no whole numbers or too large for REAL."""
    for what, value in (("master period", table.period), ("slave's travel per cycle", table.advance)):
        if abs(value - round(value)) > 1e-9 * max(1.0, abs(value)) or abs(value) > LARGEST_WHOLE:
            raise InputError(
                f"the {what} is {value!r} units; this drive takes a whole number up to {LARGEST_WHOLE}: choose a finer "
                "unit"
            )


def read(text: str, place: str) -> CamTable:
    """Sections from assignments to ``Section[…]``, up to the last point."""
    known = {member.lower() for member in _MEMBERS} | {"mode", "type", "inflectionpoint"}
    unread = "McCamSectionType has no member {}"
    sections = assigned_to(parse(text, place), known, place, "section", "section", unread)
    kept: list[Struct] = []
    laws: list[int] = []
    for position, (index, section) in enumerate(sections.items()):
        if index != position:
            raise refuse(place, section.line, f"section {position} is missing")
        if not _is(section.members.get("mode"), "mccamsectref_absolute", 0):
            raise refuse(place, section.line, "sections are read with absolute positions only (mcCAMSECTREF_ABSOLUTE)")
        kept.append(section)
        laws.append(_law(section.members.get("type"), place, section.line))
        if laws[-1] == _LAST:
            break
    if kept and laws[-1] != _LAST:
        raise refuse(place, kept[-1].line, "the terminator is missing: a section of the type mcCAMSECTLAW_LAST_POINT")
    columns = numbers_of(kept, _MEMBERS, place)
    check_points(columns[0], [section.line for section in kept], place, MOST_SECTIONS)
    pieces: list[PieceLaw] = ["line" if law == _LINE else "quintic" for law in laws[:-1]]
    return make_table(*columns, law=tuple(pieces), units=units_in(text))


def _is(value: Value | None, name: str, number: int) -> bool:
    return value is None or value == float(number) or (isinstance(value, Word) and value.last == name)


def _law(value: Value | None, place: str, line: int) -> int:
    if value is None:
        raise refuse(place, line, "the section has no Type")
    if isinstance(value, Word):
        number: float = _LAWS.get(value.last.removeprefix("mccamsectlaw_"), -1)
    else:
        number = value if isinstance(value, float) else -1
    if number not in (_LAST, _LINE, _QUINTIC):
        raise refuse(place, line, "the section's Type is not read; LAST_POINT, STRAIGHT_LINE and 5TH_ORDER_POLYNOM are")
    return int(number)


def rebuild(table: CamTable) -> CamProfile:
    """Points in float32, between them quintics (or lines) in float64."""
    return quintics(in_float32(table))


TARGET = Target(
    name="br",
    title="B&R mapp Motion, McCamSectionsType",
    interpolation="quintic through position, ratio and ratio slope (5TH_ORDER_POLYNOM)",
    law="quintic",
    spacing="pieces",
    max_points=MOST_SECTIONS,
    number_format="float32",
    evidence=(
        "McCamSectionType, McCamSectionsType, McCamSectLawOfMotionEnum, MC_BR_CalcCamFromSections: type and header "
        "files of the library McAxis in public projects. Periods are whole numbers (McCamDataType). That the "
        "terminator carries the last position is inferred."
    ),
    steps=(
        (
            "Declare CamSections : McCamSectionsType and CamData : McCamDataType, and take the assignments over into "
            "the init part."
        ),
        "Call MC_BR_CalcCamFromSections with CamSectionsAddress and CamDataAddress.",
        "Hand CamData to MC_BR_CamPrepare, then couple with MC_BR_CamIn or the cam automat.",
        "Positions are whole units of the axes; the head of the file states which.",
    ),
    endings=("_br.st",),
    write=write,
    read=read,
    rebuild=rebuild,
    least_step=LEAST_STEP,
)
