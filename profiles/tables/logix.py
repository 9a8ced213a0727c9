"""Rockwell Logix: a CAM tag in L5X with the slopes for MCCP, run as a clamped cubic spline."""

from __future__ import annotations

import re
import struct
from dataclasses import dataclass, field, replace
from xml.parsers import expat

import numpy as np

from camwright.profiles.errors import InputError
from camwright.profiles.polynomial.profile import CamProfile, join
from camwright.profiles.tables.cam_table import CamTable, PieceLaw, make_table
from camwright.profiles.tables.interpolation import in_float32, quintics
from camwright.profiles.tables.number_formats import decimals
from camwright.profiles.tables.splines import clamped_spline
from camwright.profiles.tables.target import Header, Target, units_in
from camwright.profiles.tables.text import (
    check_points,
    integer,
    real,
    refuse,
    shown,
)

MOST_POINTS = 10_000  # read; no limit is documented, and float32 asks for far fewer

_ROW = re.compile(r"\[([^\[\]]{0,400})\]")
_LINEAR, _CUBIC = 0, 1
_PROFILE_INTEGERS = 14


def write(table: CamTable, header: Header) -> dict[str, str]:
    """Write the CAM tag and two REAL tags with the slopes, to be imported as tags, and the MCCP call as a text."""
    name = f"{header.identifier}_Cam"
    x, y = ([decimals(value, "float32") for value in column] for column in (table.x, table.y))
    kinds = [_LINEAR if law == "line" else _CUBIC for law in table.laws]
    kinds.append(kinds[-1])
    rows = list(zip(x, y, kinds, strict=True))
    elements = "\n".join(
        f'<Element Index="[{k}]"><Structure DataType="CAM">'
        f'<DataValueMember Name="Master" DataType="REAL" Radix="Float" Value="{master}"/>'
        f'<DataValueMember Name="Slave" DataType="REAL" Radix="Float" Value="{slave}"/>'
        f'<DataValueMember Name="SegmentType" DataType="DINT" Radix="Decimal" Value="{kind}"/>'
        "</Structure></Element>"
        for k, (master, slave, kind) in enumerate(rows)
    )
    compact = ",".join(f"[{master},{slave},{kind}]" for master, slave, kind in rows)
    slopes = {f"{name}_{end}Slope": table.ratio[at] for end, at in (("Start", 0), ("End", -1))}
    comment = "\n".join(line.replace("--", "- -").rstrip("-") for line in header.lines(TARGET.title, table))
    text = (
        '<?xml version="1.0" encoding="UTF-8" standalone="yes"?>\n'
        f"<!--\n{comment}\n-->\n"
        f'<RSLogix5000Content SchemaRevision="1.0" SoftwareRevision="30.00" TargetName="{name}" TargetType="Tag" '
        'ContainsContext="true" ExportOptions="References NoRawData L5KData DecoratedData Context Dependencies '
        'ForceProtectedEncoding AllProjDocTrans">\n'
        '<Controller Use="Context" Name="Controller">\n<Tags Use="Context">\n'
        f'<Tag Use="Target" Name="{name}" TagType="Base" DataType="CAM" Dimensions="{table.points}" Constant="false" '
        'ExternalAccess="Read/Write">\n'
        f'<Data Format="L5K"><![CDATA[[{compact}]]]></Data>\n'
        f'<Data Format="Decorated"><Array DataType="CAM" Dimensions="{table.points}">\n{elements}\n</Array></Data>\n'
        "</Tag>\n"
        + "".join(_slope_tag(tag, decimals(value, "float32")) for tag, value in slopes.items())
        + "</Tags>\n</Controller>\n</RSLogix5000Content>\n"
    )
    call = (
        f"MCCP(MotionControl, {name}[0], {table.points}, {name}_StartSlope, {name}_EndSlope, CamProfile[0]);\n\n"
        f"CamProfile is an array of CAM_PROFILE with {table.points} elements.\n"
        + "".join(f"{tag} = {decimals(value, 'float32')}\n" for tag, value in slopes.items())
    )
    return {f"{name}.L5X": text, f"{name}_mccp.txt": call}


def _slope_tag(name: str, value: str) -> str:
    return (
        f'<Tag Use="Context" Name="{name}" TagType="Base" DataType="REAL" Radix="Float" Constant="false" '
        f'ExternalAccess="Read/Write">\n<Data Format="L5K"><![CDATA[{value}]]></Data>\n'
        f'<Data Format="Decorated"><DataValue DataType="REAL" Radix="Float" Value="{value}"/></Data>\n</Tag>\n'
    )


_COPIED = 2e-6
"""What the two copies of a number may differ by, relative to it: float32 is written with so many digits."""


@dataclass
class _Tag:
    """A tag as it stands in the file."""

    name: str
    type: str
    line: int
    compact: list[str] = field(default_factory=list)
    elements: list[dict[str, tuple[str, int]]] = field(default_factory=list)
    value: str | None = None


class _Collector:
    """Gathers the tags of a file while the parser runs through it."""

    def __init__(self, place: str) -> None:
        self.place = place
        self.tags: list[_Tag] = []
        self.tag: _Tag | None = None
        self.compact = False
        self.parser = expat.ParserCreate()
        self.parser.buffer_text = True
        self.parser.StartElementHandler = self.start
        self.parser.EndElementHandler = self.end
        self.parser.CharacterDataHandler = self.characters
        self.parser.StartDoctypeDeclHandler = self.doctype

    def doctype(self, *_: object) -> None:
        """No file of the engineering tool declares a document type."""
        raise refuse(
            self.place, self.parser.CurrentLineNumber, "the file declares a document type; an L5X file has none"
        )

    def start(self, name: str, attributes: dict[str, str]) -> None:
        """Take up the beginning of an element."""
        line = self.parser.CurrentLineNumber
        if name == "Tag":
            self.tag = _Tag(attributes.get("Name", ""), attributes.get("DataType", ""), line)
            self.tags.append(self.tag)
        elif self.tag is None:
            return
        elif name == "Data":
            self.compact = attributes.get("Format") == "L5K"
        elif name == "Element":
            self.tag.elements.append({})
        elif name == "DataValueMember" and self.tag.elements:
            member = attributes.get("Name", "")
            if member in self.tag.elements[-1]:
                raise refuse(self.place, line, f"the member {shown(member)} is given twice")
            self.tag.elements[-1][member] = (attributes.get("Value", ""), line)
        elif name == "DataValue":
            self.tag.value = attributes.get("Value")

    def end(self, name: str) -> None:
        """Take up the end of an element."""
        if name == "Tag":
            self.tag = None
        elif name == "Data":
            self.compact = False

    def characters(self, text: str) -> None:
        """Text inside an element."""
        if self.tag is not None and self.compact:
            self.tag.compact.append(text)


def read(text: str, place: str) -> CamTable:
    """Read the one CAM tag of a file, with the slopes of its tags or the CAM_PROFILE that was computed from it.

    Where there is no CAM tag the coefficients in the one CAM_PROFILE are read. A CAM without slopes keeps NaN at its
    ends: MCCP is given them in the program.
    """
    collector = _Collector(place)
    try:
        collector.parser.Parse(text, True)
    except expat.ExpatError as error:
        raise refuse(place, error.lineno, f"the file is no XML: {expat.errors.messages[error.code]}") from error
    except (UnicodeEncodeError, ValueError) as error:
        raise refuse(place, None, "the file is no XML: it holds a character that cannot be encoded") from error
    cams = [tag for tag in collector.tags if tag.type == "CAM"]
    profiles = [tag for tag in collector.tags if tag.type == "CAM_PROFILE"]
    found = cams or profiles
    if not found:
        raise refuse(place, None, "there is no tag of the type CAM or CAM_PROFILE")
    if len(found) > 1:
        names = ", ".join(shown(tag.name) for tag in found[:5])
        raise refuse(place, found[1].line, f"there is more than one cam: {names}; leave one in the file")
    if not cams:
        return _profile(profiles[0], text, place)
    cam = _cam(cams[0], collector.tags, text, place)
    return cam if np.isfinite(cam.ratio[[0, -1]]).all() else _calculated(cam, cams[0], profiles, text, place)


def _calculated(cam: CamTable, tag: _Tag, profiles: list[_Tag], text: str, place: str) -> CamTable:
    """Give the calculated profile whose knots are those of a cam without slopes; the cam itself if there is none."""
    for profile in profiles:
        if _never_calculated(profile):
            continue
        found = _profile(profile, text, place)
        same = found.points == cam.points and all(
            np.allclose(a, b, rtol=1e-6, atol=1e-6 * float(np.ptp(b))) for a, b in ((found.x, cam.x), (found.y, cam.y))
        )
        if same:
            note = f"the profile {shown(profile.name)} has the points of {shown(tag.name)}: its coefficients are judged"
            return replace(found, notes=(*found.notes, note))
    return cam


def _cam(tag: _Tag, tags: list[_Tag], text: str, place: str) -> CamTable:
    rows = _decorated(tag, place) if tag.elements else _compact(tag, place)
    if tag.elements and "".join(tag.compact).strip():
        _require_same(tag, _used(rows), _used(_compact(tag, place)), place)
    used = _used(rows)
    x, y = [row[0] for row in used], [row[1] for row in used]
    check_points(x, [row[3] for row in used], place, MOST_POINTS)
    laws: list[PieceLaw] = ["line" if row[2] == _LINEAR else "spline" for row in used[:-1]]
    ratio = np.full(len(x), np.nan)
    for at, end in ((0, "Start"), (-1, "End")):
        wanted = f"{tag.name}_{end}Slope"
        for other in tags:
            if other.name == wanted:
                ratio[at] = _slope(other, place)
    return make_table(x, y, ratio, law=tuple(laws), units=units_in(text))


def _slope(tag: _Tag, place: str) -> float:
    """Read a tag of one number from its copies, which must agree; NaN where it has none."""
    copies = [copy for copy in (tag.value, "".join(tag.compact).strip()) if copy]
    values = [real(copy, place, tag.line) for copy in copies]
    if values and abs(values[0] - values[-1]) > _COPIED * max(map(abs, values)):
        raise refuse(
            place,
            tag.line,
            f"the two copies of {shown(tag.name)} (L5K and Decorated) differ: {copies[1]} and {copies[0]}; one was edited: "
            "export the tag again",
        )
    return values[0] if values else np.nan


def _require_same(
    tag: _Tag, first: list[tuple[float, float, int, int]], second: list[tuple[float, float, int, int]], place: str
) -> None:
    """Refuse a tag whose two copies of its data differ by more than what float32 is written with."""
    if len(first) != len(second):
        raise refuse(
            place,
            tag.line,
            f"the two copies of {shown(tag.name)} have {len(first)} and {len(second)} rows; export it again",
        )
    for k, (one, other) in enumerate(zip(first, second, strict=True)):
        if one[2] != other[2] or any(
            abs(a - b) > _COPIED * max(abs(a), abs(b)) for a, b in zip(one[:2], other[:2], strict=True)
        ):
            raise refuse(
                place,
                one[3],
                f"the two copies of {shown(tag.name)} (L5K and Decorated) differ in row {k}: {one[:3]} and {other[:3]}; "
                "one was edited: export the tag again",
            )


def _decorated(tag: _Tag, place: str) -> list[tuple[float, float, int, int]]:
    rows = []
    for k, element in enumerate(tag.elements):
        missing = [name for name in ("Master", "Slave", "SegmentType") if name not in element]
        if missing:
            raise refuse(place, tag.line, f"element {k} of {shown(tag.name)} has no {missing[0]}")
        (master, line), (slave, _), (kind, _) = (element[name] for name in ("Master", "Slave", "SegmentType"))
        rows.append((real(master, place, line), real(slave, place, line), _kind(kind, place, line), line))
    return rows


def _compact(tag: _Tag, place: str) -> list[tuple[float, float, int, int]]:
    rows = []
    for k, found in enumerate(_ROW.finditer("".join(tag.compact))):
        cells = found[1].split(",")
        if len(cells) != 3:
            raise refuse(
                place, tag.line, f"row {k} of {shown(tag.name)} has {len(cells)} values, not master, slave and type"
            )
        line = tag.line
        rows.append((real(cells[0], place, line), real(cells[1], place, line), _kind(cells[2], place, line), line))
    return rows


def _kind(text: str, place: str, line: int) -> int:
    kind = integer(text, place, line)
    if kind not in (_LINEAR, _CUBIC):
        raise refuse(place, line, f"the SegmentType is {kind}; 0 (linear) and 1 (cubic) are known")
    return kind


def _used(rows: list[tuple[float, float, int, int]]) -> list[tuple[float, float, int, int]]:
    """Drop the zeros at the end of an array that is longer than its cam."""
    count = len(rows)
    while count > 2 and rows[count - 1][:2] == (0.0, 0.0):
        count -= 1
    return rows[:count]


def _profile(tag: _Tag, text: str, place: str) -> CamTable:
    """Knots from the coefficients C0 … C3 that a CAM_PROFILE holds as pairs of integers, high word first."""
    if _never_calculated(tag):
        raise refuse(
            place,
            tag.line,
            f"the profile {shown(tag.name)} was never calculated (Status 0): run MCCP in the controller and export it again, "
            "or export the CAM tag that it is made from",
        )
    knots: list[tuple[float, ...]] = []
    last: list[float] = []
    for k, found in enumerate(_ROW.finditer("".join(tag.compact))):
        words = [integer(cell, place, tag.line) for cell in found[1].split(",")]
        if len(words) != _PROFILE_INTEGERS or any(abs(word) > 2**31 for word in words):
            raise refuse(
                place, tag.line, f"row {k} of {shown(tag.name)} does not hold {_PROFILE_INTEGERS} integers of 32 bits"
            )
        pairs = [_double(words[i], words[i + 1]) for i in (1, 3, 6, 8, 10, 12)]
        if not all(abs(value) <= 1e12 for value in pairs):
            raise refuse(place, tag.line, f"row {k} of {shown(tag.name)} holds a value beyond 1e+12")
        master, slave, _, c1, c2, c3 = pairs
        if last and k and last[0] < master and (c1, c2, c3) == (0.0, 0.0, 0.0):  # the last row holds no polynomial
            h = master - last[0]
            c1, c2 = last[1] + 2 * last[2] * h + 3 * last[3] * h**2, last[2] + 3 * last[3] * h
        knots.append((master, slave, c1, 2 * c2))
        last = [master, c1, c2, c3]
    while len(knots) > 2 and knots[-1][:2] == (0.0, 0.0):
        knots.pop()
    columns = [list(column) for column in zip(*knots, strict=True)]
    check_points(columns[0] if knots else [], [tag.line] * len(knots), place, MOST_POINTS)
    note = "read from the coefficients that the controller computed"
    return make_table(*columns, units=units_in(text), notes=(note,))


def _never_calculated(tag: _Tag) -> bool:
    """Whether the controller has not computed a profile: the Status of its rows is 0, in either copy."""
    rows = [found[1].split(",") for found in _ROW.finditer("".join(tag.compact))]
    stored = any(row[0].strip() not in ("0", "") for row in rows)
    shown_status = [element["Status"][0].strip() for element in tag.elements if "Status" in element]
    return not stored or (bool(shown_status) and all(status == "0" for status in shown_status))


def _double(high: int, low: int) -> float:
    return float(struct.unpack(">d", struct.pack(">II", high & 0xFFFFFFFF, low & 0xFFFFFFFF))[0])


def rebuild(table: CamTable) -> CamProfile:
    """Points in float32; between them, in float64, chords on linear segments and clamped splines on runs of cubic ones.

    A run that borders on a linear segment takes that segment's slope; a cam from a CAM_PROFILE is run as it stands.
    """
    if "quintic" in table.laws:
        return quintics(table)
    stored = in_float32(table)
    x, y = stored.x, stored.y
    chord = np.diff(y) / np.diff(x)
    parts: list[CamProfile] = []
    first = 0
    while first < len(chord):
        if stored.laws[first] == "line":
            parts.append(CamProfile(x[first : first + 2].copy(), np.array([[y[first], chord[first]]])))
            first += 1
            continue
        last = first
        while last < len(chord) and stored.laws[last] != "line":
            last += 1
        start = stored.ratio[0] if first == 0 else chord[first - 1]
        end = stored.ratio[-1] if last == len(chord) else chord[last]
        if not (np.isfinite(start) and np.isfinite(end)):
            raise InputError(
                "the slopes that MCCP is given are not in the file, and the cam depends on them: say them with "
                "--slopes START,END (ratios, as in the MCCP instruction), or export the calculated CAM_PROFILE too"
            )
        parts.append(clamped_spline(x[first : last + 1], y[first : last + 1], float(start), float(end)))
        first = last
    return join(*parts)


TARGET = Target(
    name="logix",
    title="Rockwell Logix, CAM tag and MCCP",
    interpolation="clamped cubic spline, smooth to the ratio slope, with the start and end slopes given to MCCP",
    law="spline",
    spacing="free",
    number_format="float32",
    evidence=(
        "CAM, CAM_PROFILE_EXTENDED: Studio 5000 documentation; MCCP: MOTION-RM002; form of the tag and of its import: "
        "public generators and importers; the interpolation was decoded from a captured CAM_PROFILE. No limit of "
        "points is documented; in float32 more points make the acceleration worse."
    ),
    steps=(
        "Import the L5X file as tags (Controller Tags, Import Tags): the CAM array and two REAL tags with the slopes.",
        "Create an array of CAM_PROFILE with as many elements as there are points, and a MOTION_INSTRUCTION tag.",
        (
            "Run MCCP as the text file beside the L5X shows, with both slopes: without them the cam starts and ends at "
            "ratio 0."
        ),
        "Start the cam with MAPC, execution mode Continuous, once the Status of the profile's first element is 2.",
        "The values have no units: set the scaling of the axes as the head of the file states.",
    ),
    endings=("_Cam.L5X", "_Cam_mccp.txt"),
    write=write,
    read=read,
    rebuild=rebuild,
)
