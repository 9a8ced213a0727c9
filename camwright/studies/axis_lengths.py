"""`AxisLengths`: how short a piece can be cut with the axis, not only its command, in sync."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from camwright.design.servo_aware.axis_problem import AxisProblem
from camwright.design.servo_aware.command_basis import Command
from camwright.design.servo_aware.programme import AxisProgramme
from camwright.jobs.job import Job
from camwright.jobs.servos import servos_of
from camwright.profiles.cut import Cut
from camwright.profiles.errors import SolverError
from camwright.validation.bounds import minimum_length as least
from camwright.validation.bounds.zone_search import ZoneSearch

_FINE, _LENGTH_RESOLUTION, _ZONE_RESOLUTION = 8, 2e-4, 4e-3
"""How finely sync zones and cut lengths are searched; see `camwright.validation.bounds.zone_search.ZoneSearch`."""


@dataclass(frozen=True)
class AxisLengths:
    """Minimum cut lengths (m) with the axis within the sync tolerance throughout the shear zone, at every sampling phase.

    Parameters
    ----------
    linear_return, poly_3_4_5
        With these returns, the first within the limit of speed, the second within all limits of the command.
    in_sync, shaped
        With a servo-aware command within the limits, in sync itself in the whole sync zone, or shaped.
    in_sync_axis_limits, shaped_axis_limits
        The same if the axis, too, keeps the limits of speed and acceleration; in sync with the sync zone that is best without.

    The sync zone is the best one each time; ``None`` where no cut up to the pitch holds.
    """

    linear_return: float
    poly_3_4_5: float
    in_sync: float | None
    shaped: float | None
    in_sync_axis_limits: float | None
    shaped_axis_limits: float | None


def axis_lengths(job: Job) -> AxisLengths | None:
    """Find how short a job's machine can cut with its axis in sync.

    For a rotary knife whose edge runs at line speed in the sync zone; ``None`` for other machines, as
    `camwright.studies.cut_lengths.cut_lengths`.
    The ranges of ``[servo.tolerance]`` count for the servo-aware commands of a servo-aware job.

    Raises
    ------
    InputError
        The shear zone leaves no room for a return, or the servo is unstable.
    """
    machine, cut, limits = job.machine, replace(job.cut, shaped=False), job.limits
    if not machine.published or cut.sync_ratio != 1.0:
        return None
    servos = servos_of(job) if job.servo_aware else (job.servo,)
    pitch = machine.pitch
    shear = max(
        cut.shear_zone, _ZONE_RESOLUTION * pitch
    )  # of a shaped command the sync zone is the shear zone; it has some width

    def search(command: Command, *, axis_limits: bool) -> ZoneSearch:
        def excess(shape: Cut) -> float:
            try:
                holds = AxisProgramme(AxisProblem(job.task.with_cut(shape), command, servos, axis_limits)).reaches()
            except SolverError:  # at the edge of what double precision resolves
                return math.inf
            return -math.inf if holds else math.inf

        def lower(sync_zone: float) -> float:
            if command == "shaped":  # a mean speed beyond the limit is all that forbids it
                return max(shear, pitch * cut.line_speed / limits.speed) * (1 + _LENGTH_RESOLUTION)
            return least.fastest_cut(pitch, cut.line_speed, limits, sync_zone)

        return ZoneSearch(cut, pitch, lower, excess, _FINE, _LENGTH_RESOLUTION, _ZONE_RESOLUTION)

    best, zone = search("in_sync", axis_limits=False).find()
    found = zone < pitch
    return AxisLengths(
        linear_return=least.linear_return_to_tolerance(job.task.with_cut(cut), job.servo).length,
        poly_3_4_5=least.quintic_to_tolerance(job.task.with_cut(cut), job.servo).length,
        in_sync=best if found else None,
        shaped=search("shaped", axis_limits=False).shorter(shear, pitch),
        in_sync_axis_limits=search("in_sync", axis_limits=True).shorter(zone, pitch) if found else None,
        shaped_axis_limits=search("shaped", axis_limits=True).shorter(shear, pitch),
    )
