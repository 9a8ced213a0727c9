"""What the cross-cutter's cam from three lengths is like, and its file."""

from __future__ import annotations

from camwright.house.numbers import with_unit
from camwright.house.provenance import camwright_version
from camwright.house.units import quantity
from camwright.profiles.cross_cutter import CrossCut
from camwright.profiles.errors import InputError
from camwright.profiles.tables.cam_csv import write_cam_csv

POINTS = 361
"""Rows of cam.csv, as many as a job file has by default."""

_CASES = {
    1: "1: the knife runs faster than the line",
    2: "2: the knife runs with the line throughout",
    3: "3: the knife runs slower than the line",
}


def quick_answer(cut: CrossCut) -> dict[str, int | float | bool]:
    """Answer of ``camwright quick``.

    Examples
    --------
    >>> quick_answer(CrossCut(0.4, 0.2, 0.65))["completed"]
    True
    """
    return {
        "case": cut.case,
        "critical_length_mm": cut.critical_length * 1e3,
        "min_ratio": cut.least_ratio,
        "standstill_mm": cut.standstill * 1e3,
        "completed": cut.completed,
    }


def quick_rows(cut: CrossCut) -> list[tuple[str, str]]:
    """Give the rows that people read: what, and its value with the unit."""
    if cut.completed:
        curve = "quartic ratio, completed: the patent defines no curve for this cut length"
    elif cut.case == 2:
        curve = "straight line"
    elif cut.least_ratio > 0.0:
        curve = "quintic"
    else:
        curve = "decelerate, stand, accelerate"
    return [
        ("case", _CASES[cut.case]),
        ("return", curve),
        ("critical length", with_unit(cut.critical_length, "m", 6)),
        ("least ratio", f"{cut.least_ratio:.6g}"),
        ("standstill", f"{with_unit(cut.standstill, 'm', 6)} of material"),
    ]


def read_cross_cut(circumference: str, sync: str, length: str) -> CrossCut:
    """Read the three lengths as the options of ``camwright quick`` hold them: a number and a unit.

    Raises
    ------
    InputError
        A text is no length, or the lengths do not fit together. All faults are told.

    Examples
    --------
    >>> read_cross_cut("400 mm", "20 cm", "0.6m")
    CrossCut(circumference=0.4, sync_zone=0.2, cut_length=0.6)
    """
    values: list[float] = []
    faults: list[str] = []
    for option, text in (("--circumference", circumference), ("--sync", sync), ("--length", length)):
        try:
            values.append(quantity(text, "length"))
        except InputError as error:
            faults += [f"{option} {fault}" for fault in error.faults]
    if faults:
        raise InputError(*faults)
    return CrossCut(*values)


def quick_cam_text(cut: CrossCut) -> str:
    """Write the cycle of a cut as the text of a cam.csv: the three lengths in comment lines, then the table."""
    comments = [
        f"camwright: {camwright_version()}",
        f"circumference: {cut.circumference * 1e3!r} mm",
        f"sync_zone: {cut.sync_zone * 1e3!r} mm",
        f"length: {cut.cut_length * 1e3!r} mm",
        "origin: cut",
        f"completed: {str(cut.completed).lower()}",
    ]
    return write_cam_csv(cut.cycle(), POINTS, comments)
