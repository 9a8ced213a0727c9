"""The registry of all targets, and which one a text was written for."""

from __future__ import annotations

import re

from camwright.profiles.errors import InputError
from camwright.profiles.tables import (
    br,
    codesys,
    csv_target,
    isg,
    kollmorgen,
    lenze,
    logix,
    pacdrive,
    schneider_asc,
    sew,
    siemens,
    technosoft,
    trio,
    twincat,
)
from camwright.profiles.tables.cam_table import CamTable
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

_HEADING = r"(?:#[^\n]*\n){0,50}(?:[^\n\[\](),;\t]{1,60}[,;][^\n\[\](),;\t]{1,60}\n)?"
_NUMBER = r"[-+.0-9][-+.0-9eE]{0,40}"
_WITH_COMMA = r"[-+.,0-9][-+.,0-9eE]{0,40}"

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
    ("csv", r"(?m)^x ?[\[(_]"),
    ("csv", rf"\A{_HEADING}\s{{0,9}}{_NUMBER}\s{{0,9}},\s{{0,9}}{_NUMBER}\s{{0,9}}\n"),
    ("csv", rf"\A{_HEADING}\s{{0,9}}{_WITH_COMMA}\s{{0,9}};\s{{0,9}}{_WITH_COMMA}\s{{0,9}}\n"),
    ("sew", r"\A\s{0,100}[0-9]{1,5};?\s*\n"),
)


_OWN = re.compile(r"(?m)^[-+0-9., \t]{0,80}[/#(*<!-]{0,4} ?camwright \S{1,40}: cam table for (.{1,100})$")


def target_of(name: str) -> Target:
    """Look up a target by its name, in any case.

    Raises
    ------
    InputError
        There is none.
    """
    found = TARGETS.get(name.lower())
    if found is None:
        raise InputError(f"there is no target {name[:40]!r}; the targets are {', '.join(TARGETS)}")
    return found


def read_table(target: Target, text: str, place: str) -> CamTable:
    """Read a table, and where its head states the number of points, make sure that they are all there.

    Raises
    ------
    InputError
        The text does not hold a table of this target, or it was cut off.
    """
    table = target.read(text, place)
    stated = points_in(text)
    if stated is not None and stated != table.points:
        raise refuse(place, None, f"the head states {stated} points, but the table has {table.points}")
    return table


def detect(text: str, place: str) -> Target:
    """Find the target whose layout a text has, judged by words that only this layout has.

    Raises
    ------
    InputError
        No layout is recognised; two plain columns of numbers, for one, could be Lenze's, Technosoft's or anyone's.
    """
    own = _OWN.search(text)
    for target in TARGETS.values():
        if own and own[1] == target.title:
            return target
    for name, sign in _SIGNS:
        if re.search(sign, text, re.IGNORECASE):
            return TARGETS[name]
    raise InputError(f"{place}: the layout is not recognised; name it with --target, one of {', '.join(TARGETS)}")
