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
from camwright.studies.cut_lengths import CutLengths
from camwright.studies.least_length import AWARE_STEEP, least_length
from camwright.validation.bounds import minimum_length as least

_LENGTH_RESOLUTION = 2e-4
"""Accuracy of a cut length, relative to the pitch."""

_LEAST_ZONE = 4e-3
"""Sync zone of a cut without a width, relative to the pitch."""

_SOONER, _SHAPED, _STRICTER = 0.95, 0.8, 1.05
"""Where lengths are expected: in sync, as a share of the linear return's; shaped, as a share of that; and the limits on the axis too."""


@dataclass(frozen=True)
class AxisLengths:
    """Minimum cut lengths (m) with the axis within the sync tolerance throughout the shear zone, at every sampling phase.

    Parameters
    ----------
    linear_return, poly_3_4_5
        With these returns, the first within the limit of speed, the second within all limits of the command.
    in_sync, shaped
        With a servo-aware command within the limits, in sync itself in the shear zone, or shaped.
    in_sync_axis_limits, shaped_axis_limits
        The same if the axis, too, keeps the limits of speed and acceleration.

    The sync zone is the best one each time; ``None`` where no cut up to the pitch holds. Of a servo-aware command that is the shear zone:
    what is in sync in a longer zone is so there, too.
    """

    linear_return: float
    poly_3_4_5: float
    in_sync: float | None
    shaped: float | None
    in_sync_axis_limits: float | None
    shaped_axis_limits: float | None


def axis_lengths(job: Job, lengths: CutLengths | None = None) -> AxisLengths | None:
    """Find how short a job's machine can cut with its axis in sync.

    For a rotary knife whose edge runs at line speed in the sync zone; ``None`` for other machines, as
    `camwright.studies.cut_lengths.cut_lengths`.
    The ranges of ``[servo.tolerance]`` count for the servo-aware commands of a servo-aware job.

    Parameters
    ----------
    job
        The job.
    lengths
        Its minimum cut lengths by the published equations, where they are known.

    Raises
    ------
    InputError
        The shear zone leaves no room for a return, or the servo is unstable.
    """
    machine, cut = job.machine, replace(job.cut, shaped=False)
    if not machine.published or cut.sync_ratio != 1.0:
        return None
    servos = servos_of(job) if job.servo_aware else (job.servo,)
    pitch = machine.pitch
    shear = sync_zone_of(cut, pitch)
    last: dict[Command, AxisProgramme] = {}

    def shortest(
        command: Command, near: float, least_of_all: float = 0.0, *, axis_limits: bool = False
    ) -> float | None:
        def missed(length: float) -> float:
            try:
                task = job.task.with_cut(in_shear_zone(cut, length, shear))
                last[command] = AxisProgramme(
                    AxisProblem(task, command, servos, axis_limits), last.get(command), own=True
                )
                return last[command].missed(ratio=True)
            except SolverError:  # at the edge of what double precision resolves
                return math.inf

        ends = max(shortest_return(job, command, shear), least_of_all), pitch * (1.0 - _LENGTH_RESOLUTION)
        return least_length(missed, near, ends, _LENGTH_RESOLUTION, AWARE_STEEP) if ends[0] < ends[1] else None

    task = job.task.with_cut(cut)
    linear = (lengths.linear_return if lengths else least.to_tolerance(task, job.servo, "linear_return")).length
    in_sync = shortest("in_sync", _SOONER * linear)
    shaped = shortest("shaped", _SHAPED * (in_sync or pitch))
    strictly = _STRICTER * (in_sync or pitch), _STRICTER * (shaped or pitch)
    return AxisLengths(
        linear_return=linear,
        poly_3_4_5=least.to_tolerance(task, job.servo, "poly_3_4_5").length,
        in_sync=in_sync,
        shaped=shaped,
        in_sync_axis_limits=shortest("in_sync", strictly[0], in_sync, axis_limits=True) if in_sync else None,
        shaped_axis_limits=shortest("shaped", strictly[1], shaped, axis_limits=True) if shaped else None,
    )


def sync_zone_of(cut: Cut, pitch: float) -> float:
    """Sync zone of a servo-aware command that can be shortest (m): the shear zone, which has some width."""
    return max(cut.shear_zone, _LEAST_ZONE * pitch)


def in_shear_zone(cut: Cut, length: float, shear: float) -> Cut:
    """Cut of a length whose sync zone is its shear zone (m), which no longer one is better than."""
    return replace(cut, length=length, sync_zone=shear, shear_zone_at=shear - cut.shear_zone, origin="return")


def shortest_return(job: Job, command: Command, shear: float) -> float:
    """Shortest cut length that the limits of a command allow at all beside a shear zone (m)."""
    pitch, line_speed, limits = job.machine.pitch, job.cut.line_speed, job.limits
    if command == "shaped":  # a mean speed beyond the limit is all that forbids it
        return max(shear, pitch * line_speed / limits.speed) * (1 + _LENGTH_RESOLUTION)
    return least.fastest_cut(pitch, line_speed, limits, shear)
