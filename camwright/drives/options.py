"""The option that names targets."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from camwright.jobs.job import Job
from camwright.profiles.errors import InputError
from camwright.profiles.tables.cam_table import CamTable
from camwright.profiles.tables.targets import TARGETS, target_of

_MOST_NAMES = 50


def parse_targets(text: str) -> list[str]:
    """Read ``codesys,logix`` or ``all`` into names of targets.

    Raises
    ------
    InputError
        An unknown name, or none.
    """
    if text.strip() == "all":
        return list(TARGETS)
    names = [name.strip() for name in text.split(",") if name.strip()]
    if not names or len(names) > _MOST_NAMES:
        raise InputError(
            f"--to names one or more targets, separated by commas, or all; the targets are {', '.join(TARGETS)}"
        )
    return [target_of(name).name for name in names]


def chosen_targets(text: str | None, job: Job) -> list[str]:
    """Give the targets that an option names, else those of the job, else CSV.

    Raises
    ------
    InputError
        As `parse_targets`.
    """
    return list(job.output.targets or ("csv",)) if text is None else parse_targets(text)


def with_slopes(table: CamTable, slopes: str | None) -> CamTable:
    """Give a table of splines the ratios at its ends, as ``--slopes 1,1`` names them.

    Raises
    ------
    InputError
        Not two numbers, or a table that has its slopes or needs none.
    """
    if slopes is None:
        return table
    if set(table.laws) == {"line"} or "quintic" in table.laws or not np.isnan(table.ratio[[0, -1]]).any():
        raise InputError("--slopes: this table has its slopes, or needs none; leave the option out")
    try:
        start, end = (float(part) for part in slopes.split(","))
    except ValueError as error:
        raise InputError(
            f"--slopes takes the start slope and the end slope, for example 1,1; got {slopes[:40]!r}"
        ) from error
    if not (abs(start) < 1e6 and abs(end) < 1e6):
        raise InputError(f"--slopes: {slopes[:40]!r} are no ratios; write them like 1,1")
    ratio = table.ratio.copy()
    ratio[0], ratio[-1] = start, end
    return replace(table, ratio=ratio)
