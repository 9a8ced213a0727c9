"""`BandLengths`: how short a piece can be cut with the axis in sync at every line speed of a job."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from camwright.design.servo_aware.axis_problem import AxisProblem
from camwright.design.servo_aware.command_basis import Command
from camwright.design.servo_aware.programme import AxisProgramme
from camwright.jobs.job import Job
from camwright.jobs.servos import servos_of
from camwright.profiles.errors import SolverError
from camwright.studies.axis_lengths import AxisLengths, in_shear_zone, shortest_return, sync_zone_of
from camwright.studies.axis_study import shares_of
from camwright.studies.least_length import AWARE_STEEP, least_length
from camwright.studies.reach import WITHIN
from camwright.validation.bounds.minimum_length import over_line_speeds

_LENGTH_RESOLUTION = 1.5e-3
"""Accuracy of a cut length, relative to the pitch."""

_LAW_SPEEDS = 13
"""Line speeds, evenly spread over the band, at which a return by a law is looked at."""


@dataclass(frozen=True)
class BandLengths:
    """Minimum cut lengths (m) with the axis within the sync tolerance at every line speed of a band.

    Parameters
    ----------
    line_speeds
        Least and greatest line speed (m/s).
    linear_return, poly_3_4_5
        With these returns, the first within the limit of speed, the second within all limits of the command.
    in_sync, shaped
        With a servo-aware command within the limits, which the axis keeps too; in sync itself in the shear zone, or shaped.

    The sync zone is the best one each time; ``None`` where no cut up to the pitch holds. The tolerance is of the position, as a check of
    the design has it; what minimises the sync error is designed there, other objectives ask for the ratio of the axis too.
    """

    line_speeds: tuple[float, float]
    linear_return: float | None
    poly_3_4_5: float | None
    in_sync: float | None
    shaped: float | None


def band_lengths(job: Job, single: AxisLengths | None, shortest: float | None = None) -> BandLengths | None:
    """Find how short a job's machine can cut with its axis in sync at all line speeds of the job.

    Parameters
    ----------
    job
        The job; the ranges of its servo count for the servo-aware commands.
    single
        The same at the job's line speed alone, where the ratio is asked for too.
    shortest
        Shortest cut (m) that the job's own design passes at, where that is known: the search begins there.

    Returns
    -------
    BandLengths or None
        ``None`` for a job without a band of line speeds, and for machines that `axis_lengths` is not about.

    Raises
    ------
    InputError
        The shear zone leaves no room for a return, or the servo is unstable.
    """
    if single is None or job.slowest == 1.0:
        return None
    task = job.task.with_cut(replace(job.cut, shaped=False))
    few = tuple(np.linspace(1.0, job.slowest, _LAW_SPEEDS).tolist())
    return BandLengths(
        line_speeds=job.line_speeds,
        linear_return=over_line_speeds(task, job.servo, "linear_return", few),
        poly_3_4_5=over_line_speeds(task, job.servo, "poly_3_4_5", few),
        in_sync=_servo_aware(job, "in_sync", single.in_sync_axis_limits, shortest),
        shaped=_servo_aware(job, "shaped", single.shaped_axis_limits, shortest),
    )


def _servo_aware(job: Job, command: Command, single: float | None, shortest: float | None) -> float | None:
    """Shortest cut of a servo-aware command, from what it is at one line speed or for the job's own design."""
    if single is None:
        return None
    cut, pitch, servos, shares = (
        replace(job.cut, shaped=False),
        job.machine.pitch,
        servos_of(job),
        shares_of(job.slowest),
    )
    shear = sync_zone_of(cut, pitch)
    programme: AxisProgramme | None = None

    def missed(length: float) -> float:
        nonlocal programme
        task = job.task.with_cut(in_shear_zone(cut, length, shear))
        try:
            programme = AxisProgramme(AxisProblem(task, command, servos, True, shares=shares), programme, own=True)
            return programme.missed(ratio=False)
        except SolverError:  # at the edge of what double precision resolves
            return np.inf

    ends = shortest_return(job, command, shear), pitch * (1.0 - _LENGTH_RESOLUTION)
    if not ends[0] < ends[1]:
        return None
    near = single if shortest is None or command != job.command else max(single, WITHIN * shortest)
    return least_length(missed, near, ends, _LENGTH_RESOLUTION, AWARE_STEEP)
