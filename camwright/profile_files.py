"""Files that hold a profile: cam.csv with its head, and reading any of them."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from camwright.design_file import MOST_BYTES, parse_design
from camwright.files import read_text
from camwright.job import Job
from camwright.provenance import provenance
from profiles.errors import InputError
from profiles.polynomial import CamProfile
from profiles.tables.cam_csv import read_cam_csv, rebuild, write_cam_csv

if TYPE_CHECKING:
    from camwright.results import Design

_ROUNDING = 1e-6
"""What a table's ends may miss those of the cycle by, as a part of the cut length: tables are rounded."""


def cam_text(design: Design) -> str:
    """Write a design as the text of a cam.csv: its origin in comment lines, then the table.

    Raises
    ------
    InputError
        The job asks for fewer points than the profile has ends of pieces.
    """
    origin = provenance(design.job.sha256)
    libraries = origin.pop("libraries")
    entries = {"job": design.job.name, **origin, **(libraries if isinstance(libraries, dict) else {})}
    comments = [f"{name}: {value}" for name, value in entries.items()]
    return write_cam_csv(design.profile, design.job.output.points, comments)


def read_profile(path: Path, job: Job) -> CamProfile:
    """Read one cycle from a design.json or a table, told apart by the first character.

    Parameters
    ----------
    path
        The file. A table has the columns that `profiles.tables.cam_csv.read_cam_csv` describes; it runs over one cycle
        of the job, from master position 0 to the cut length, both to a millionth of the cut length. The slave may begin
        anywhere.
    job
        The job that the cycle is judged by.

    Raises
    ------
    InputError
        The file cannot be read, holds no profile, or one of another cut length.
    """
    text = read_text(path, "profile file", MOST_BYTES)
    if text.removeprefix("\ufeff").lstrip().startswith("{"):
        profile = parse_design(text, str(path)).profile
    else:
        rows = read_cam_csv(text, str(path))
        profile = rebuild(rows.x, rows.y, rows.dy, rows.d2y)
    return _one_cycle(profile, job.cut.length, str(path))


def _one_cycle(profile: CamProfile, length: float, place: str) -> CamProfile:
    """Put the ends of a cycle where they belong; refuse a profile that is not one cycle."""
    allowed = _ROUNDING * length
    if abs(profile.start) > allowed or abs(profile.end - length) > allowed:
        raise InputError(
            f"{place}: runs over the master from {profile.start * 1e3:.10g} mm to {profile.end * 1e3:.10g} mm, "
            f"but a cycle of the job from 0 mm to {length * 1e3:.10g} mm ([cut] length); "
            "name the job that the file was made for"
        )
    breaks = np.array(profile.breaks)
    breaks[0], breaks[-1] = 0.0, length
    return CamProfile(breaks, profile.coefficients.copy())
