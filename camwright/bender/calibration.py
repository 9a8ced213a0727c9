"""A springback table from test bends."""

from __future__ import annotations

import csv
import io
import math
from collections import defaultdict
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from camwright.bender.job import BenderJob
from camwright.house.files import read_text
from camwright.profiles.bender.springback import PAPER_STEP, Springback
from camwright.profiles.errors import InputError

_MOST_BYTES = 1 << 20
_MOST_FAULTS = 20
_COLUMNS = ("mould_deg", "workpiece_deg", "radius_mm")


@dataclass(frozen=True)
class MeasuredBend:
    """One test bend: the mould was turned by an angle, the bend came out at another.

    Parameters
    ----------
    row
        Its row in the file, the header being row 1.
    mould, workpiece
        Angles (degrees).
    radius
        Radius of the arc bent with such bends (mm), ``None`` for a corner.
    """

    row: int
    mould: float
    workpiece: float
    radius: float | None


@dataclass(frozen=True, eq=False)
class Calibration:
    """A table and how far it is from the test bends.

    Parameters
    ----------
    residuals
        Workpiece angle by the table minus the one measured (degrees), one a test bend.
    text
        The table as a TOML file.
    """

    springback: Springback
    bends: tuple[MeasuredBend, ...]
    residuals: tuple[float, ...]
    text: str


def calibrate(path: Path, job: BenderJob) -> Calibration:
    """Make a table from measurements: one row for each mould angle, the mean of its test bends.

    Test bends of an arc, with a radius, make the radius table: the factor from workpiece to mould angle, averaged for
    each radius and written for the paper's step of 14.4°.

    Parameters
    ----------
    path
        CSV with the columns ``mould_deg, workpiece_deg`` and, if arcs were measured, ``radius_mm``.
    job
        Says which rule was bent.

    Raises
    ------
    InputError
        The file has faults, or its bends make no table that can be used.
    """
    bends = _read(path)
    corners: dict[float, list[float]] = defaultdict(list)
    arcs: dict[float, list[float]] = defaultdict(list)
    for bend in bends:
        if bend.radius is None:
            corners[bend.mould].append(bend.workpiece)
        else:
            arcs[bend.radius].append(bend.mould / bend.workpiece)
    rows = sorted((sum(found) / len(found), mould) for mould, found in corners.items())
    radii = [(radius, sum(found) / len(found) * math.degrees(PAPER_STEP)) for radius, found in sorted(arcs.items())]
    angle, radius = np.array(rows).reshape(-1, 2), np.array(radii).reshape(-1, 2)
    table = Springback(
        path.stem,
        np.radians(angle[:, 0]),
        np.radians(angle[:, 1]),
        radius[:, 0] * 1e-3,
        np.radians(radius[:, 1]),
        PAPER_STEP,
        job.springback.interpolation,
    )
    residuals = []
    for bend in bends:
        factor = math.nan if bend.radius is None else float(table.factor(np.array([bend.radius * 1e-3]))[0])
        residuals.append(math.degrees(table.workpiece_angle(math.radians(bend.mould), factor)) - bend.workpiece)
    return Calibration(table, bends, tuple(residuals), _toml(path, rows, radii, job))


def residuals_text(result: Calibration) -> str:
    """Write the test bends with their residuals as CSV."""
    lines = ["row,radius_mm,mould_deg,workpiece_deg,residual_deg"]
    lines += [
        f"{bend.row},{'' if bend.radius is None else f'{bend.radius:g}'},{bend.mould:g},{bend.workpiece:g},"
        f"{residual:.4f}"
        for bend, residual in zip(result.bends, result.residuals, strict=True)
    ]
    return "\n".join(lines) + "\n"


def _read(path: Path) -> tuple[MeasuredBend, ...]:
    rows = list(csv.reader(io.StringIO(read_text(path, "measurement file", _MOST_BYTES))))
    header = [name.strip() for name in rows[0]]
    if tuple(header) not in (_COLUMNS, _COLUMNS[:2]):
        raise InputError(
            f"{path}, row 1: the columns are {', '.join(header)[:80]}; write {', '.join(_COLUMNS)}, the last only "
            "if arcs were bent"
        )
    bends, faults = [], []
    for number, row in enumerate(rows[1:], start=2):
        if not any(cell.strip() for cell in row):
            continue
        try:
            values = [float(cell) for cell in row[: len(header)] if cell.strip()]
        except ValueError:
            faults.append(f"{path}, row {number}: {','.join(row)[:60]!r} is not numbers; write e.g. 16.8,15.0")
            continue
        if len(row) != len(header) or len(values) < 2 or not all(0 < v < math.inf for v in values):
            faults.append(f"{path}, row {number}: {','.join(row)[:60]!r}: give {len(header)} numbers above zero")
        elif max(values[:2]) >= 180:
            faults.append(f"{path}, row {number}: an angle of {max(values[:2]):g}°; bends lie below 180°")
        else:
            bends.append(MeasuredBend(number, values[0], values[1], values[2] if len(values) == 3 else None))
    if faults:
        raise InputError(*faults[:_MOST_FAULTS])
    return tuple(bends)


def _toml(path: Path, rows: list[tuple[float, float]], radii: list[tuple[float, float]], job: BenderJob) -> str:
    lines = [f'name = "{_plain(path.stem)}"', "", "[[rule]]", f'thickness = "{1e3 * job.rule.thickness:g} mm"']
    lines += [f'hardness = "{_plain(job.rule.hardness)}"', "angles = [   # workpiece angle, mould angle"]
    lines += [f'  ["{workpiece:.4f} deg", "{mould:.4f} deg"],' for workpiece, mould in rows]
    lines.append("]")
    if radii:
        lines += [f'radius_step = "{math.degrees(PAPER_STEP):g} deg"', "radii = [   # radius, mould angle"]
        lines += [f'  ["{radius:.4f} mm", "{mould:.4f} deg"],' for radius, mould in radii]
        lines.append("]")
    return "\n".join(lines) + "\n"


def _plain(text: str) -> str:
    return "".join(letter if letter.isprintable() and letter not in '"\\' else "-" for letter in text)[:100]
