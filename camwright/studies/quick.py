"""`QuickAnswer`: what the cross-cutter's cam from three lengths is like; its file."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

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


@dataclass(frozen=True)
class QuickAnswer:
    """What is known of a cross-cutter's cam.

    Parameters
    ----------
    case
        Case of S2: 1 the knife runs faster than the line, 2 neither, 3 slower.
    critical_length
        Cut length above which the quintic would reverse (m).
    least_ratio
        Least ratio of the cycle.
    standstill
        Length of material that passes while the knife stands still (m).
    completed
        Whether S2 defines no curve for this cut, so that a completion stands in.
    """

    case: Literal[1, 2, 3]
    critical_length: float
    least_ratio: float
    standstill: float
    completed: bool

    def to_dict(self) -> dict[str, int | float | bool]:
        """Give the object that ``--json`` prints."""
        return {
            "case": self.case,
            "critical_length_mm": self.critical_length * 1e3,
            "min_ratio": self.least_ratio,
            "standstill_mm": self.standstill * 1e3,
            "completed": self.completed,
        }

    def rows(self) -> list[tuple[str, str]]:
        """Give the rows that people read: what, and its value with the unit."""
        if self.completed:
            curve = "quartic ratio, completed: the patent defines no curve for this cut length"
        elif self.case == 2:
            curve = "straight line"
        elif self.least_ratio > 0.0:
            curve = "quintic"
        else:
            curve = "decelerate, stand, accelerate"
        return [
            ("case", _CASES[self.case]),
            ("return", curve),
            ("critical length", with_unit(self.critical_length, "m", 6)),
            ("least ratio", f"{self.least_ratio:.6g}"),
            ("standstill", f"{with_unit(self.standstill, 'm', 6)} of material"),
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


def quick_answer(cut: CrossCut) -> QuickAnswer:
    """Say what the cam of a cut is like.

    Examples
    --------
    >>> quick_answer(CrossCut(0.4, 0.2, 0.65)).completed
    True
    """
    return QuickAnswer(cut.case, cut.critical_length, cut.least_ratio, cut.standstill, cut.completed)


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
