"""The registry of all targets, and which one a text was written for."""

from __future__ import annotations

import re

from camwright.profiles.errors import InputError
from camwright.profiles.tables import (
    br,
    codesys,
    csv_target,
    galil,
    isg,
    kollmorgen,
    lenze,
    linked_moves,
    logix,
    pacdrive,
    schneider_asc,
    sew,
    siemens,
    st_arrays,
    technosoft,
    trio,
    twincat,
)
from camwright.profiles.tables.cam_table import CamTable
from camwright.profiles.tables.column_words import cam_role
from camwright.profiles.tables.delimited import FEWEST_LISTED, RowError, read_sheet
from camwright.profiles.tables.plc_objects import program_text
from camwright.profiles.tables.target import Target, points_in
from camwright.profiles.tables.text import refuse

TARGETS: dict[str, Target] = {
    target.name: target
    for target in (
        codesys.TARGET,
        codesys.BUILDER,
        twincat.TARGET,
        twincat.POSITIONS,
        isg.TARGET,
        siemens.TARGET,
        siemens.POINTS,
        logix.TARGET,
        schneider_asc.TARGET,
        pacdrive.TARGET,
        br.TARGET,
        kollmorgen.TARGET,
        sew.TARGET,
        lenze.TARGET,
        technosoft.TARGET,
        trio.TARGET,
        csv_target.TARGET,
    )
}
"""All targets by name."""

LAYOUTS: dict[str, Target] = {
    **TARGETS,
    **{layout.name: layout for layout in (galil.LAYOUT, linked_moves.LAYOUT, st_arrays.LAYOUT)},
}
"""All layouts that are read, by name: those of the targets, and some that are not written."""

_SIGNS: tuple[tuple[str, str], ...] = (
    ("logix", r"<RSLogix5000Content|DataType=\"CAM(?:_PROFILE)?\""),
    ("codesys-cambuilder", r"\.Append\s{0,99}\(\s{0,99}(?:\w{1,20}\.)?Poly5"),
    ("codesys", r"SMC_CAMXYVA|SMC_CAMTable_"),
    ("br", r"mcCAMSECT|McCamSection"),
    ("pacdrive", r"astCamPoint"),
    ("s7-1500t", r"LCamHdl_typeBasicPoint|leadingValue"),
    ("s7-1500t-points", r"TO_Cam_Struct_PointData"),
    ("twincat", r"MC_MotionFunctionPoint|\.MasterPos\b"),
    ("twincat-table", r"MC_TABLETYPE_|, ?0\.\.1\] OF LREAL"),
    ("twincat-cnc", r"(?m)^[ \t]{0,99}Begintable"),
    ("kollmorgen-kas", r"(?m)^TABLE_BEGIN"),
    ("schneider-asc", r"(?m)^CamPoints\s{0,99}$"),
    ("trio", r"(?m)^[ \t]{0,99}TABLE[ \t]{0,99}\("),
    ("trio-linked-moves", linked_moves.SIGN),
    ("galil", galil.SIGN),
    ("sew", r"\A\s{0,100}[0-9]{1,5};?\s{0,100}\n[^\n;\t]{1,60}[;\t]"),
    ("lenze", r"\A\s{0,99}[-+.,0-9]{1,40}[ \t]{1,20}[-+.,0-9]{1,40}(?:[ \t]{1,20}[-+.,0-9]{1,40})?[ \t]{0,20}//"),
)


_OWN = re.compile(r"(?m)^[-+0-9., \t]{0,80}[/#(*<!-]{0,4} ?camwright \S{1,40}: cam table for (.{1,100})$")


_BESIDE = re.compile(r"camwright \S{1,40}: |MCCP\(")
"""What a text beside a table begins with."""


def target_of(name: str) -> Target:
    """Look up a target by its name, in any case.

    Raises
    ------
    InputError
        There is none.
    """
    return _named(name, TARGETS, "target")


def layout_of(name: str) -> Target:
    """Look up a layout that is read, as `target_of`."""
    return _named(name, LAYOUTS, "layout")


def _named(name: str, among: dict[str, Target], what: str) -> Target:
    found = among.get(name.lower())
    if found is None:
        raise InputError(f"there is no {what} {name[:40]!r}; the {what}s are {', '.join(among)}")
    return found


def read_table(target: Target, text: str, place: str) -> CamTable:
    """Read a table, and where its head states the number of points, make sure that they are all there.

    Raises
    ------
    InputError
        The text does not hold a table of this target, or it was cut off.
    """
    table = target.read(program_text(text, place), place)
    stated = points_in(text)
    if stated is not None and stated != table.points:
        raise refuse(place, None, f"the head states {stated} points, but the table has {table.points}")
    return table


_OTHERS = ((r"<TcSmItem\b", "an item of a TwinCAT project (.xti)"),)
"""What other files are, by words that they have: named, so that nobody looks for the option that reads them."""


def detect(text: str, place: str) -> Target:
    """Find the target whose layout a text has, judged by words that only this layout has.

    Raises
    ------
    InputError
        No layout is recognised. Two plain columns of numbers are taken for a table of positions: the drive may do
        something else with them, which a note says.
    """
    if _BESIDE.match(text):
        raise InputError(
            f"{place}: this is the text beside a table, not the table; name the file beside it that holds the points"
        )
    own = _OWN.search(text)
    for target in TARGETS.values():
        if own and own[1] == target.title:
            return target
    text = program_text(text, place)
    for name, sign in _SIGNS:
        if re.search(sign, text, re.IGNORECASE):
            return LAYOUTS[name]
    if st_arrays.is_written_so(text):
        return st_arrays.LAYOUT
    if technosoft.is_written_so(text):
        return technosoft.TARGET
    if _has_columns(text, place):
        return csv_target.TARGET
    for sign, what in _OTHERS:
        if re.search(sign, text, re.IGNORECASE | re.MULTILINE):
            raise InputError(
                f"{place}: {what}, which is not read; write the cam's points as two columns, master and slave with their units, "
                "and audit that"
            )
    raise InputError(f"{place}: the layout is not recognised; name it with --target, one of {', '.join(LAYOUTS)}")


def _has_columns(text: str, place: str) -> bool:
    """Whether a text is rows of numbers, with or without headings."""
    try:
        sheet = read_sheet(text, place, cam_role, "x [mm],y [mm]", "table")
    except InputError as error:
        return isinstance(error, RowError)  # the reader names it
    return (len(sheet.columns) > 1 and len(sheet.rows) > 1) or len(sheet.rows) >= FEWEST_LISTED
