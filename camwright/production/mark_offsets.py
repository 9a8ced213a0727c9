"""The dead time of a sensor, from offsets of its marks measured at several line speeds: ``offset = c + v t``."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from camwright.production.columns import column_in_si, columns, read_table_text, role
from camwright.profiles.errors import InputError
from camwright.profiles.tables.delimited import read_sheet

LEAST_SPEEDS = 3
"""Line speeds that a fit needs: with two every line is as good."""

OFFSETS_HEADER = "speed [m/min],offset [mm]"

_MOST_BYTES = 1 << 20
_MOST_FAULTS = 10
_GREATEST = 1e6
"""Greatest line speed (m/s) and offset (m)."""


@dataclass(frozen=True)
class DeadTime:
    """What measured offsets say of a sensor.

    Parameters
    ----------
    time
        Dead time (s): how much later than it was the mark is known; negative where it is made up for too much.
    constant
        Offset of a line that stands (m).
    residual
        Greatest distance of a measurement from the line (m).
    time_error
        Standard error of the dead time (s).
    points
        Measurements.
    """

    time: float
    constant: float
    residual: float
    time_error: float
    points: int


def dead_time(path: Path) -> DeadTime:
    """Fit a line to measured offsets over the line speed, by least squares.

    Parameters
    ----------
    path
        Table with a column of line speeds and one of offsets, each with its unit in the heading: ``speed [m/min],offset [mm]``, or
        ``line_speed_m_per_min,offset_mm``; in English, German or Chinese.

    Raises
    ------
    InputError
        The file has faults, or fewer than three line speeds.
    """
    speeds, offsets = _read(path)
    if len(set(speeds)) < LEAST_SPEEDS:
        raise InputError(
            f"{path}: {len(set(speeds))} line speeds; measure offsets at {LEAST_SPEEDS} at least, the slowest and the fastest among them"
        )
    v, y = np.array(speeds), np.array(offsets)
    middle = v.mean()
    spread = float(((v - middle) ** 2).sum())
    time = float(((v - middle) * y).sum()) / spread
    constant = float(y.mean() - time * middle)
    off = y - constant - time * v
    error = math.sqrt(float((off**2).sum()) / (len(v) - 2) / spread)
    return DeadTime(time, constant, float(np.abs(off).max()), error, len(v))


def _read(path: Path) -> tuple[list[float], list[float]]:
    """Read line speeds (m/s) and offsets (m)."""
    text = read_table_text(path, "file of offsets", _MOST_BYTES)
    sheet = read_sheet(text, str(path), role, OFFSETS_HEADER, "file of offsets")
    at = columns(sheet, ("speed", "offset"), needed=2, header=OFFSETS_HEADER)
    speeds, offsets = (
        column_in_si(sheet, at[name], name, kind, OFFSETS_HEADER)
        for name, kind in (("speed", "speed"), ("offset", "length"))
    )
    wrong = (speeds < 0) | (speeds >= _GREATEST) | (np.abs(offsets) >= _GREATEST)
    faults = [
        f"{path}, line {sheet.lines[row]}: a line speed of {speeds[row]:.6g} m/s and an offset of {offsets[row]:.6g} m; the speed is not "
        f"below zero, and both are below {_GREATEST:g}"
        for row in np.flatnonzero(wrong)[:_MOST_FAULTS].tolist()
    ]
    if faults:
        raise InputError(*faults)
    return speeds.tolist(), offsets.tolist()
