"""A table or a recording that was dropped on the page, as a cycle beside the one that is drawn."""

from __future__ import annotations

from typing import Any

import numpy as np

from camwright.drives.audit import running_cam
from camwright.jobs.job import Job, parse_job
from camwright.profiles.errors import InputError
from camwright.profiles.polynomial.profile import FloatArray
from camwright.profiles.tables.text import decode
from camwright.profiles.tables.trace_csv import read_trace_csv
from camwright.profiles.trace import Trace
from camwright.validation.identify.preparation import unwrapped
from camwright.workbench.sampling import POINTS, Samples, rounded, samples

_REACH = 4
"""Samples to either side over which the speed of a recording is a difference: else its rounding would be all that is seen."""

_IN_ZONE = 65
"""Places in the sync zone where a recording is compared with the material."""


def overlay(text: str, data: bytes, name: str, units: str | None = None) -> dict[str, Any]:
    """Read a dropped file as a cam of a job: first as a recording, then as a table in the layout of any target.

    Parameters
    ----------
    text
        The job file's text.
    data
        The file.
    name
        What the file is called in messages.
    units
        Units of master and slave, as ``camwright audit --units``.

    Returns
    -------
    dict
        ``kind`` (``table`` or ``trace``), ``target`` of a table, ``notes``, ``samples`` as of a preview; of a trace positions, ratio and
        speed of the command (``samples``) and of the axis (``actual``).

    Raises
    ------
    InputError
        The file is neither, or is no cycle of this job.
    """
    job, content = parse_job(text, "job"), decode(data, name)
    try:
        trace = unwrapped(read_trace_csv(content, name), name)
    except InputError:  # no recording: then a table, and what is wrong with that is told
        found = running_cam(content, name, job, units=units)
        cycle = samples(found.cycle, found.job.task)
        return {"kind": "table", "target": found.target.name, "notes": list(found.notes), "samples": cycle}
    return {"kind": "trace", **_of_trace(trace, job, name)}


def _of_trace(trace: Trace, job: Job, name: str) -> dict[str, Any]:
    """Take the last whole cycle of a recording, begun where its command fits the sync zone best.

    Raises
    ------
    InputError
        It holds no whole cycle of the job, or motion of another kind.
    """
    cut, machine = job.cut, job.machine
    if not machine.placed:
        raise InputError(f"{name}: a recording needs a sync zone with a place; give [machine] {machine.place_name}")
    if trace.unit != machine.slave_unit:
        raise InputError(f"{name}: positions in {trace.unit}; the slave of this job is counted in {machine.slave_unit}")
    along = (trace.times - trace.start) * cut.line_speed
    if along[-1] < cut.length:
        raise InputError(
            f"{name}: {1e3 * (trace.times[-1] - trace.start):.6g} ms are recorded, a cycle of this job takes "
            f"{1e3 * cut.period:.6g} ms; record a whole one at the job's line speed"
        )
    x = np.linspace(0.0, cut.length, POINTS)
    command, actual = (np.interp(along[-1] - cut.length + x, along, each) for each in (trace.command, trace.actual))
    advance = float(command[-1] - command[0])
    begin = _begin(x, command - command[0], advance, job)
    start = float(_repeated(x, command - command[0], advance, np.array([begin]))[0])
    cycles = (_repeated(x, each - command[0], advance, begin + x) - start for each in (command, actual))
    found = dict(zip(("samples", "actual"), (_columns(x, y, job) for y in cycles), strict=True))
    return {"notes": list(trace.notes), **found}


def _begin(x: FloatArray, travel: FloatArray, advance: float, job: Job) -> float:
    """Find the place in a recorded cycle (m) where the job's cycle begins: the one whose sync zone moves with the material best."""
    cut = job.cut
    inside = np.linspace(0.0, cut.sync_zone, _IN_ZONE)
    zone = cut.return_start + cut.return_zone
    off = _repeated(x, travel, advance, x[:-1, None] + zone + inside) - job.task.sync(inside)
    return float(x[np.argmin(np.ptp(off, axis=1))])


def _repeated(x: FloatArray, travel: FloatArray, advance: float, at: FloatArray) -> FloatArray:
    """Positions of a cycle that repeats itself for ever; it begins at 0 and moves on by the advance."""
    length = float(x[-1])
    return np.asarray(np.interp(at % length, x, travel - advance / length * x) + advance / length * at)


def _columns(x: FloatArray, y: FloatArray, job: Job) -> Samples:
    """Give samples of a recorded cycle: positions, and their differences."""
    wide = np.concatenate([y[-_REACH - 1 : -1] - (y[-1] - y[0]), y, y[1 : _REACH + 1] + (y[-1] - y[0])])
    ratio = (wide[2 * _REACH :] - wide[: -2 * _REACH]) / (2 * _REACH * (x[1] - x[0]))
    return {"x_m": x.tolist(), **rounded({"y": y, "ratio": ratio, "speed": ratio * job.cut.line_speed})}
