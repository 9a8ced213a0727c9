"""A table or a recording that was dropped on the page, as a cycle beside the one that is drawn."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from camwright.drives.running_cam import running_cam
from camwright.jobs.job import parse_job
from camwright.profiles.errors import InputError
from camwright.profiles.polynomial.profile import FloatArray
from camwright.profiles.tables.text import decode
from camwright.profiles.tables.trace_csv import read_trace_csv
from camwright.stored.design_file import StoredDesign, parse_design
from camwright.studies.recording import RecordedRun, recorded_run
from camwright.workbench.sampling import POINTS, Samples, rounded, samples

_REACH = 4
"""Samples to either side over which the speed of a recording is a difference: else its rounding would be all that is seen."""

_MOST_ROWS = 200_000
"""Rows of a recording."""


def overlay(text: str, data: bytes, name: str, units: str | None = None, design: str | None = None) -> dict[str, Any]:
    """Read a dropped file as a cam of a job: as a recording if it has columns of one, else as a table in the layout of any target.

    Parameters
    ----------
    text
        The job file's text.
    name
        What the file is called in messages.
    units
        Units of master and slave, as ``camwright audit --units``.
    design
        The text of a design.json: what a recording is laid over, as ``camwright trace`` does.

    Returns
    -------
    dict
        ``kind`` (``table`` or ``trace``), ``target`` of a table, ``notes``, ``samples`` as of a preview; of a trace positions, ratio and
        speed of the command (``samples``) and of the axis (``actual``) in the last whole cycle.

    Raises
    ------
    InputError
        The file is neither, or is no cycle of this job, or a recording came without a design.
    """
    content = decode(data, name)
    try:
        read_trace_csv(content, name, most_rows=_MOST_ROWS, master=True)
    except InputError:  # no recording: then a table, and what is wrong with that is told
        found = running_cam(content, name, parse_job(text, "job"), units=units)
        cycle = samples(found.cycle, found.job.task)
        return {"kind": "table", "target": found.target.name, "notes": list(found.notes), "samples": cycle}
    if design is None:
        raise InputError(f'{name}: a recording is laid over a design; send its design.json as "design"')
    stored = parse_design(design, "design")
    return {"kind": "trace", **_of_run(recorded_run(data, name, stored.job, stored.profile), stored, name)}


def _of_run(found: RecordedRun, stored: StoredDesign, name: str) -> dict[str, Any]:
    """Take the last whole cycle of a recorded run.

    Raises
    ------
    InputError
        It holds none.
    """
    run, length = found.run, stored.job.cut.length
    number = math.floor(float(run.master[-1]) / length) - 1
    if number * length < run.master[0]:
        raise InputError(f"{name}: no whole cycle of {1e3 * length:.6g} mm from master zero on is recorded; record two")
    x = np.linspace(0.0, length, POINTS)
    y = [
        np.interp(number * length + x, run.master, each) - number * stored.profile.advance
        for each in (run.command, run.axis)
    ]
    command, axis = (_columns(x, each, run.line_speed) for each in y)
    return {"notes": list(found.notes), "samples": command, "actual": axis}


def _columns(x: FloatArray, y: FloatArray, line_speed: float) -> Samples:
    """Give samples of a recorded cycle: positions, and their differences."""
    wide = np.concatenate([y[-_REACH - 1 : -1] - (y[-1] - y[0]), y, y[1 : _REACH + 1] + (y[-1] - y[0])])
    ratio = (wide[2 * _REACH :] - wide[: -2 * _REACH]) / (2 * _REACH * (x[1] - x[0]))
    return {"x_m": x.tolist(), **rounded({"y": y, "ratio": ratio, "speed": ratio * line_speed})}
