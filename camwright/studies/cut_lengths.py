"""`CutLengths`: how short a piece can be cut on a job's machine, by the published equations and in truth."""

from __future__ import annotations

from dataclasses import dataclass

from camwright.jobs.job import Job
from camwright.profiles.returns import baseline
from camwright.validation.bounds import minimum_length as least
from camwright.validation.bounds.minimum_length import MinimumCutLength
from camwright.validation.servo.response import servo_response


@dataclass(frozen=True)
class CutLengths:
    """Minimum cut lengths (m) at a job's line speed, servo and shear zone.

    Parameters
    ----------
    crossing, settling
        Transition length of the linear return in the job's own cycle (m): by the paper's crossing, and until the axis
        stays within the sync tolerance. ``None`` if that does not happen in the sync zone.
    eq9, eq10
        S1, eqs. 9 and 10, with the crossing.
    eq10_settling
        S1, eq. 10, with the settling length.
    physical
        Bound of a perfect axis under the limits of speed, acceleration and jerk.
    linear_return, optimised
        Shortest cut with the axis within the sync tolerance throughout the shear zone: with the linear return, and with
        the return of least peak acceleration within the limits.
    """

    crossing: float | None
    settling: float | None
    eq9: float | None
    eq10: float | None
    eq10_settling: float | None
    physical: MinimumCutLength
    linear_return: MinimumCutLength
    optimised: MinimumCutLength

    @property
    def binding(self) -> str:
        """Name of the limit that binds the physical bound."""
        return self.physical.binding


def cut_lengths(job: Job) -> CutLengths | None:
    """Find the minimum cut lengths of a job.

    They are those of a rotary knife whose edge runs at line speed in the sync zone, as the published equations have it; ``None``
    for other machines, for horizontal sync, and for a sync ratio other than 1.

    Raises
    ------
    InputError
        The shear zone leaves no room for a return.

    Examples
    --------
    >>> from camwright import load_job
    >>> lengths = cut_lengths(load_job())
    >>> round(lengths.eq9, 3), lengths.physical.length < lengths.optimised.length
    (0.209, True)
    """
    machine, cut, task, servo = job.machine, job.cut, job.task, job.servo
    if not machine.published or cut.sync_ratio != 1.0:
        return None
    response = servo_response(baseline("linear_return", task), task, servo)

    def eq10(transition: float | None, shear_zone: float) -> float | None:
        if transition is None:
            return None
        return least.cut_length_eq10(transition, shear_zone, machine.pitch, cut.line_speed, task.limits.speed)

    return CutLengths(
        crossing=response.crossing,
        settling=response.settling,
        eq9=eq10(response.crossing, 0.0),
        eq10=eq10(response.crossing, cut.shear_zone),
        eq10_settling=eq10(response.settling, cut.shear_zone),
        physical=least.physical(task),
        linear_return=least.to_tolerance(task, servo, "linear_return"),
        optimised=least.to_tolerance(task, servo, "least_acceleration"),
    )
