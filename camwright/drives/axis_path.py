"""Where the axis goes that follows a cam: what of a shaped command is in sync."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from camwright.jobs.job import Job
from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.validation.servo.simulation import simulate


def axis_path(
    cycle: CamProfile, job: Job, line_speed: float, stretch: float = 1.0
) -> Callable[[FloatArray], FloatArray]:
    """Give the axis of a job's servo over the master, at a line speed, as a mean over its sampling phases.

    Parameters
    ----------
    cycle
        One cycle of the cam over ``[0, x_c]``, wherever it begins (slave unit).
    job
        The job: its cut and servo.
    line_speed
        Speed of the line (m/s).
    stretch
        Length of a cycle in the file's master positions over that of the job's.

    Returns
    -------
    path
        Slave position (slave unit) at any master positions of the file (m), the cycles before and after repeated.
    """
    run = simulate(cycle, replace(job.cut, line_speed=line_speed), job.servo)
    rise, length = cycle.advance / cycle.length, cycle.length
    places = np.mod(run.master, length).ravel()
    order = np.argsort(places, kind="stable")
    at, beyond = places[order], (run.axis - rise * run.master).ravel()[order]

    def path(master: FloatArray) -> FloatArray:
        x = master / stretch
        return np.asarray(np.interp(np.mod(x, length), at, beyond, period=length) + rise * x)

    return path
