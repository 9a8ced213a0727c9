"""`MachineLimits`: how fast and how short the machine of a job can cut, and what binds."""

from __future__ import annotations

from dataclasses import dataclass

from camwright.design.feasible.extremes import Extremes, extremes, placed_fastest
from camwright.house.progress import Step, ignore
from camwright.house.threads import one_thread
from camwright.jobs.job import Job
from camwright.studies.axis_lengths import AxisLengths, axis_lengths
from camwright.studies.band_lengths import BandLengths, band_lengths
from camwright.studies.cut_lengths import CutLengths, cut_lengths
from camwright.studies.line_ramps import LineRamps, designed_ramps
from camwright.studies.reach import Reach, placed_as, reach

LIMITS_STEPS = 6
"""Steps that `limits` tells."""


@dataclass(frozen=True, eq=False)
class MachineLimits:
    """How fast and how short a machine can cut.

    Parameters
    ----------
    far
        Highest line speed at the job's cut length and shortest cut at its line speed that the limits of the command allow, and which
        limit binds there. The axis is not looked at.
    within
        The same with the axis in tolerance: what `design` would pass, designed anew at each line speed and cut length. A crank whose sync
        zone is free has it where the line can run fastest.
    lengths
        Published minimum cut lengths, by which the axis settles; ``None`` for machines that the equations are not about.
    axis
        Minimum cut lengths with the axis in the sync tolerance at the job's line speed; ``None`` for such machines.
    over_band
        The same at every line speed of the job; ``None`` for such machines, and for jobs of one line speed.
    ramps
        How hard the line may ramp on the cam that the job's design is; ``None`` where there is none.
    """

    job: Job
    far: Extremes
    within: Reach
    lengths: CutLengths | None
    axis: AxisLengths | None
    over_band: BandLengths | None
    ramps: LineRamps | None


def limits(job: Job, step: Step = ignore) -> MachineLimits:
    """Say how fast and how short the machine of a job can cut, and which limit binds.

    Examples
    --------
    >>> from camwright import limits, load_job
    >>> found = limits(load_job())
    >>> round(found.far.max_line_speed * 60, 1), found.far.line_speed_binding     # m/min
    (138.2, 'acceleration')
    >>> round(found.within.max_line_speed * 60, 1), found.within.line_speed_binding
    (116.7, 'settling')
    >>> round(found.lengths.eq10 * 1e3, 1)                                        # mm
    232.9
    """
    with one_thread():
        return _found(job, step)


def _found(job: Job, step: Step) -> MachineLimits:
    """Find them, as `limits` says."""
    step("finding how hard the line may ramp")
    ramps = designed_ramps(job)  # first, for it refuses at once what is too slow a line for a servo-aware design
    step("finding the highest line speed and the shortest cut")
    far = extremes(job.task)
    step("finding them with the axis in tolerance")
    within = reach(placed_as(job, placed_fastest(job.task)), far)
    step("finding minimum cut lengths")
    lengths = cut_lengths(job)
    step("finding minimum cut lengths with the axis in sync")
    axis = axis_lengths(job, lengths)
    step("finding them over the band of line speeds")
    over_band = band_lengths(job, axis, within.min_cut_length if job.servo_aware else None)
    return MachineLimits(job, far, within, lengths, axis, over_band, ramps)
