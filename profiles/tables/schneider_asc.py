"""Schneider Motion Sizer and SoMachine: the ``.asc`` cam file, a cubic spline through evenly spaced values."""

from __future__ import annotations

import numpy as np

from camwright.profiles.errors import InputError
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.tables.cam_table import CamTable, make_table
from camwright.profiles.tables.number_formats import decimals
from camwright.profiles.tables.splines import clamped_spline
from camwright.profiles.tables.target import Header, Target, companion
from camwright.profiles.tables.text import (
    check_count,
    lines_of,
    real,
    refuse,
    shown,
)

MOST_POINTS = 10_000

_KEYS = ("yfactor", "xfactor", "yoffset", "xoffset", "startslope", "endslope")


def write(table: CamTable, header: Header) -> dict[str, str]:
    """Write the file, and its head as a text beside it, for the layout allows no comment.

    Both factors are the master period: so the slopes are the same number whether meant in scaled or in physical units.

    Raises
    ------
    InputError
        The points are not evenly spaced.
    """
    steps = np.diff(table.x)
    if np.ptp(steps) > 1e-9 * table.period:
        raise InputError("the points of an .asc cam must be evenly spaced")
    period = table.period
    values = (table.y - table.y[0]) / period
    head = {
        "Header": "SoMachine Motion Builder",
        "Version": "4.2",
        "YFactor": decimals(period),
        "XFactor": decimals(period),
        "YOffset": decimals(float(table.y[0])),
        "XOffset": decimals(float(table.x[0])),
        "StartSlope": decimals(float(table.ratio[0])),
        "EndSlope": decimals(float(table.ratio[-1])),
        "InterpolationMode": "1",
    }
    lines = [*(f"{key}={value}" for key, value in head.items()), "CamPoints", *(decimals(v) for v in values)]
    name = header.identifier
    beside = companion(header.lines(TARGET.title, table), TARGET.steps)
    return {f"{name}.asc": "\r\n".join(lines) + "\r\n", f"{name}_asc.txt": beside}


def _parts(text: str, place: str) -> tuple[dict[str, tuple[str, int]], list[float]]:
    """Part a file into its head, with lines, and the values behind ``CamPoints``."""
    head: dict[str, tuple[str, int]] = {}
    values: list[float] = []
    points = False
    empty = 0
    for number, line in enumerate(lines_of(text.replace("\r\n", "\n"), place), start=1):
        if not line.strip():
            empty = empty or (number if points else 0)
            continue
        if empty:
            raise refuse(
                place, empty, "the line among the points is empty: a point is missing, or one too many follows"
            )
        if points:
            values.append(real(line, place, number))
            continue
        points = line.strip().lower() == "campoints"
        if points:
            continue
        key, sign, value = line.partition("=")
        if not sign:
            raise refuse(place, number, f"{shown(line)} is no line of the head: KEY=VALUE")
        if key.strip().lower() in head:
            raise refuse(place, number, f"{shown(key.strip())} is given twice")
        head[key.strip().lower()] = (value, number)
    if not points:
        raise refuse(place, None, "the line CamPoints is missing")
    return head, values


def read(text: str, place: str) -> CamTable:
    """Points from the values behind ``CamPoints``, scaled by the factors and offsets of the head."""
    head, values = _parts(text, place)
    missing = [key for key in _KEYS if key not in head]
    if missing:
        raise refuse(place, None, f"the head has no {missing[0]}")
    mode, line_number = head.get("interpolationmode", ("1", 1))
    if mode.strip() != "1":
        raise refuse(place, line_number, f"InterpolationMode {shown(mode.strip())} is not read; 1 is")
    y_factor, x_factor, y_offset, x_offset, start, end = (real(head[k][0], place, head[k][1]) for k in _KEYS)
    if not x_factor > 0:
        raise refuse(place, head["xfactor"][1], f"XFactor must be positive; it is {x_factor!r}")
    check_count(len(values), 2, MOST_POINTS, place)
    x = x_offset + x_factor * np.arange(len(values)) / (len(values) - 1)
    ratio = np.full(len(values), np.nan)
    ratio[0], ratio[-1] = start, end
    notes: tuple[str, ...] = ()
    if (start or end) and x_factor != y_factor:
        notes = ("whether the slopes are in scaled or in physical units is not documented; physical units are assumed",)
    return make_table(x, y_offset + y_factor * np.array(values), ratio, law="spline", notes=notes)


def rebuild(table: CamTable) -> CamProfile:
    """Rebuild the cubic spline with the slopes of the head."""
    return clamped_spline(table.x, table.y, float(table.ratio[0]), float(table.ratio[-1]))


TARGET = Target(
    name="schneider-asc",
    title="Schneider Motion Sizer and SoMachine, .asc",
    interpolation="cubic spline with given slopes at both ends, through evenly spaced values",
    law="spline",
    spacing="equidistant",
    evidence=(
        "File format with sample: Machine Expert online help, Motion Sizer File Formats; that both ends are among the "
        "values was calculated from the sample. No limit of points is documented. Whether slopes are scaled is not "
        "said; the files written here have equal factors, with which both readings agree."
    ),
    steps=(
        "Import the .asc file in the cam editor.",
        "Check period, travel and the slopes at both ends against the text beside the file.",
        "The units are those of the axes: set them as the text beside the file states.",
    ),
    endings=(".asc", "_asc.txt"),
    write=write,
    read=read,
    rebuild=rebuild,
)
