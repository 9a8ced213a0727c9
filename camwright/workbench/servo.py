"""What the servo makes of a design at a line speed, at every sampling phase: the page's servo view."""

from __future__ import annotations

import math
from dataclasses import asdict
from typing import Any

import numpy as np

from camwright.jobs.servos import servos_of
from camwright.profiles.errors import InputError
from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.profiles.servo import spectral_radius
from camwright.profiles.task import Task
from camwright.stored.design_file import parse_design
from camwright.validation.servo.axis_run import ServoRun
from camwright.validation.servo.line_speeds import line_speed_errors
from camwright.validation.servo.response import servo_response, sync_error
from camwright.validation.servo.simulation import simulate
from camwright.workbench.sampling import rounded

MOST_SHARE = 2.0
"""Greatest line speed that is simulated, as a share of the job's."""

_SPEEDS = 61
"""Line speeds of the curve of errors."""

_SLOWEST = 0.02
"""Share of the highest line speed at which the curve begins."""

_POINTS = 240
"""Points of a phase that are sent; what is greatest is found among all of them before."""


def servo_view(text: str, share: float = 1.0, *, curve: bool = False) -> dict[str, Any]:
    """Run the servo of a design on its cam.

    Parameters
    ----------
    text
        The text of a design.json.
    share
        Line speed over that of the job, above 0 and at most `MOST_SHARE`.
    curve
        Whether to tell the sync error over the line speed too, up to the greater of `share` and 1.15.

    Returns
    -------
    dict
        ``line_speed_m_per_s``, ``sync_tolerance_m``; ``sync_zone_m`` and ``shear_zone_m`` from the start of the sync zone;
        ``response`` (`camwright.validation.servo.response.ServoResponse`); ``phases``, each with ``x_m`` from the start of the sync zone
        and ``error_m``, tool minus material; ``meeting``, each phase's tool (m) about that start beside ``command_m`` and the ideal line,
        which is ``x_m`` times ``sync_ratio``. With `curve` also ``over_line_speed``: ``line_speed_m_per_s``, ``error_m`` of the job's servo
        and ``worst_error_m`` over its ranges.

    Raises
    ------
    InputError
        The text is no design.json, the share is out of range, or the servo is unstable.
    """
    if not 0.0 < share <= MOST_SHARE:
        raise InputError(
            f'"share" is {share:g}; it is a line speed over that of the job, above 0 and at most {MOST_SHARE:g}'
        )
    stored = parse_design(text, "design")
    job, profile = stored.job, stored.profile
    task = job.task.at_speed(share * job.cut.line_speed)
    run, start = simulate(profile, task.cut, job.servo), task.cut.return_start + task.cut.return_zone
    master, error, _ = sync_error(run, profile, task, start, start + task.cut.sync_zone)
    found = {
        "job": job.name,
        "line_speed_m_per_s": task.cut.line_speed,
        "sync_tolerance_m": task.cut.sync_tolerance,
        "sync_ratio": task.cut.sync_ratio,
        "sync_zone_m": task.cut.sync_zone,
        "shear_zone_m": [task.cut.shear_zone_at, task.cut.shear_zone_at + task.cut.shear_zone],
        "response": asdict(servo_response(profile, task, job.servo)),
        "phases": [_thinned({"x_m": x - start, "error_m": off}) for x, off in zip(master, error, strict=True)],
        "meeting": _meeting(run, profile, task, start),
    }
    if curve:
        top = max(share, 1.15) * job.cut.line_speed
        speeds = np.unique([*np.linspace(_SLOWEST * top, top, _SPEEDS), job.cut.line_speed])
        servos = [servo for servo in servos_of(job) if spectral_radius(servo) < 1.0]
        errors = line_speed_errors(profile, job.task, servos, speeds)
        columns = {"error_m": errors[0], "worst_error_m": errors.max(axis=0)}
        found["over_line_speed"] = {"line_speed_m_per_s": speeds.tolist(), **rounded(columns)}
    return found


def _meeting(run: ServoRun, profile: CamProfile, task: Task, start: float) -> list[dict[str, list[float]]]:
    """Tool and command about the start of the sync zone, from the material's point there (m), for each phase."""
    cut, machine = task.cut, task.machine
    first, last = start + max(-0.15 * cut.sync_zone, -cut.return_zone), start + 0.6 * cut.sync_zone
    origin, there = float(profile(start, outside="repeat")), task.slave_at_sync_start

    def tool(slave: FloatArray) -> FloatArray:
        return np.asarray(machine.tool(there + slave - origin) - machine.tool(there))

    found = []
    for x, axis, command in zip(run.master, run.axis, run.command, strict=True):
        seen = (x >= first) & (x <= last)
        found.append(_thinned({"x_m": x[seen] - start, "axis_m": tool(axis[seen]), "command_m": tool(command[seen])}))
    return found


def _thinned(columns: dict[str, FloatArray]) -> dict[str, list[float]]:
    """Take as many points as a screen shows, the last one always."""
    count = len(columns["x_m"])
    if count == 0:
        return {name: [] for name in columns}
    kept = np.unique(np.append(np.arange(0, count, math.ceil(count / _POINTS)), count - 1))
    return rounded({name: values[kept] for name, values in columns.items()})
