"""The bands of line speeds of a family of cams: the fewest that together cover a servo-aware job's, each held by one cam."""

from __future__ import annotations

from dataclasses import dataclass, replace

from camwright.design.servo_aware.axis_problem import AxisProblem
from camwright.design.servo_aware.programme import AxisProgramme
from camwright.jobs.job import Job
from camwright.jobs.servos import servos_of
from camwright.jobs.wording import in_job_words
from camwright.profiles.errors import SolverError
from camwright.studies.axis_study import shares_of, solve_job
from camwright.studies.covering import Covering, Holds, Overlap, Uncovered, cover

OVERLAP = 0.05
"""Overlap of neighbouring bands, a share of the line speed, if none is asked for."""

ROOM = 2e-2
"""Share of the sync tolerance that bands leave to the change from cam to cam."""

CYCLES = 2
"""Cycles from the switching speed to the end of a change: what is left of the one that runs, and that of the transition."""


@dataclass(frozen=True)
class FamilyBands:
    """Bands of line speeds that one cam each holds, and which together cover those of a job.

    Parameters
    ----------
    overlap
        How neighbours overlap.
    holds_line
        Whether the line must keep its speed until a change is over: the job does not say how hard it ramps, or its ramps would leave the
        bands.
    """

    covering: Covering
    overlap: Overlap
    holds_line: bool


def family_bands(job: Job, share: float = OVERLAP, *, hold: bool = False) -> FamilyBands | Uncovered:
    """Cover a job's line speeds with the fewest bands that one cam each holds.

    Where the line ramps, a change may begin at the end of a cycle and takes another one: the overlap is as much wider as the line's speed
    changes meanwhile. An emergency stop is no ramp of this kind.

    Parameters
    ----------
    job
        A servo-aware job for a range of line speeds, its sync zone placed.
    share
        Share of the line speed by which neighbours overlap at least.
    hold
        Whether the line is to keep its speed until a change is over, whatever its ramps.
    """
    low, high = job.line_speeds
    length, ramp = CYCLES * job.cut.length, 0.0 if hold else job.line.speeding
    steady = Overlap(share, length, 0.0)
    holds, excludes = asking(job)
    with in_job_words(job.units):
        ramping = cover(holds, excludes, low, high, Overlap(share, length, ramp)) if ramp else None
        if isinstance(ramping, Covering):
            return FamilyBands(ramping, Overlap(share, length, ramp), False)
        found = cover(holds, excludes, low, high, steady)
    return found if isinstance(found, Uncovered) else FamilyBands(found, steady, True)


def placed_for_all(job: Job) -> Job:
    """Put the sync zone of a machine that leaves its place open where the cam of the full line speed alone has it: all cams share it.

    Raises
    ------
    InfeasibleError, SolverError
        There is no such cam.
    """
    return (
        job if job.machine.placed else replace(job, machine=solve_job(replace(job, slowest=1.0), suggest=False).machine)
    )


def band_job(job: Job, low: float, top: float) -> Job:
    """Give the job of one cam: a line speed of ``top``, in sync from ``low`` on (m/s)."""
    return replace(job, cut=replace(job.cut, line_speed=top), slowest=min(1.0, low / top))


def within(job: Job, share: float) -> Job:
    """Ask a job for a share of its sync tolerance."""
    return replace(job, cut=replace(job.cut, sync_tolerance=share * job.cut.sync_tolerance))


def asking(job: Job) -> tuple[Holds, Holds]:
    """Tell of bands whether a cam holds them with room for the changes, and whether none can at all; each band asked once."""
    known: dict[tuple[float, float], bool] = {}

    def holds(low: float, top: float) -> bool:
        if (low, top) not in known:
            programme = _programme(job, low, top, 1.0 - ROOM)
            try:
                known[low, top] = programme.keeps() if job.objective == "sync_error" else bool(programme.reaches())
            except SolverError:  # at the edge of what double precision resolves
                known[low, top] = False
        return known[low, top]

    def excludes(low: float, top: float) -> bool:
        try:
            return _programme(job, low, top, 1.0).excludes()
        except SolverError:
            return False

    return holds, excludes


def _programme(job: Job, low: float, top: float, share: float) -> AxisProgramme:
    """Ask for a cam over a band of line speeds (m/s), within a share of the sync tolerance, the axis within its limits."""
    one = within(band_job(job, low, top), share)
    return AxisProgramme(AxisProblem(one.task, one.command, servos_of(one), True, shares=shares_of(one.slowest)))
