"""The dead time of a sensor, from offsets of its marks measured at several line speeds: ``offset = c + v t``."""

from __future__ import annotations

import csv
import io
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from camwright.house.files import read_text
from camwright.profiles.errors import InputError

LEAST_SPEEDS = 3
"""Line speeds that a fit needs: with two every line is as good."""

_MOST_BYTES = 1 << 20
_MOST_FAULTS = 10
_SPEEDS = {"line_speed_m_per_min": 1 / 60, "line_speed_m_per_s": 1.0, "line_speed_ft_per_min": 0.3048 / 60}
_OFFSETS = {"offset_mm": 1e-3, "offset_m": 1.0, "offset_in": 0.0254}


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
        CSV with a column ``line_speed_m_per_min`` (or ``…_m_per_s``, ``…_ft_per_min``) and a column ``offset_mm`` (or ``…_m``, ``…_in``).

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
    rows = list(csv.reader(io.StringIO(read_text(path, "file of offsets", _MOST_BYTES).removeprefix("\ufeff"))))
    header = [name.strip() for name in rows[0]]
    speed = next((name for name in header if name in _SPEEDS), None)
    offset = next((name for name in header if name in _OFFSETS), None)
    if speed is None or offset is None:
        raise InputError(
            f"{path}, row 1: the columns are {', '.join(header)[:80]}; one of {', '.join(_SPEEDS)} and one of "
            f"{', '.join(_OFFSETS)} are needed"
        )
    at, factors = (header.index(speed), header.index(offset)), (_SPEEDS[speed], _OFFSETS[offset])
    speeds: list[float] = []
    offsets: list[float] = []
    faults: list[str] = []
    for number, row in enumerate(rows[1:], start=2):
        if not any(cell.strip() for cell in row):
            continue
        try:
            v, y = (float(row[place]) * factor for place, factor in zip(at, factors, strict=True))
        except (ValueError, IndexError):
            faults.append(f"{path}, row {number}: {','.join(row)[:60]!r} is not numbers; write e.g. 80,1.35")
            continue
        if not (0 <= v < 1e6 and abs(y) < 1e6):
            faults.append(
                f"{path}, row {number}: {','.join(row)[:60]!r}: a line speed is not below zero, and both are below 1e6 m/s and m"
            )
        speeds.append(v)
        offsets.append(y)
    if faults:
        raise InputError(*faults[:_MOST_FAULTS])
    return speeds, offsets
