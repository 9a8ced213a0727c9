"""The speed of the line over a cut list: what each cam may run at, and the fastest plan."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from camwright.design.production.line_plan import fastest_plan
from camwright.design.production.smooth_line import smooth_line
from camwright.house.numbers import with_unit
from camwright.jobs.job import Job
from camwright.production.cams import ramping_speed
from camwright.profiles.errors import InfeasibleError
from camwright.profiles.line import Line
from camwright.profiles.line_run import LineRun
from camwright.profiles.polynomial.profile import FloatArray

_STEADY = 1e-9
"""Share by which the line's speed may change within a piece that counts as steady."""

_COMPARED = 200
"""Changes of the cam over which two plans are compared."""


def plan_line(line: Line, lengths: FloatArray, highest: FloatArray, steady: NDArray[np.bool_]) -> LineRun:
    """Plan the fastest speed of a line over pieces, within its ramp and, where that is known, its jerk.

    Parameters
    ----------
    lengths, highest
        Lengths of the pieces (m) and highest speeds on them (m/s), shape ``(pieces,)``.
    steady
        Pieces whose cam bears no ramp, shape ``(pieces,)``: a plan with a jerk keeps its speed there. One without ramps nowhere below a
        piece's highest speed but where it must.
    """
    ramp = line.acceleration or 0.0
    if line.jerk is None:
        return fastest_plan(lengths, highest, ramp)
    return smooth_line(lengths, highest, ramp, line.jerk, steady)


def line_speed_tops(
    job: Job, gaps: FloatArray, lengths: FloatArray, of: NDArray[np.intp], tops: FloatArray
) -> tuple[FloatArray, NDArray[np.bool_]]:
    """Find the line speed that each cam is designed for, and whether it is to bear the line's ramps there.

    A cam that runs while the line ramps may run no faster than what bears it, which may make others ramp. One that runs at a steady line
    only need not bear its ramps. Where the line's jerk is limited it may be faster to let all of them bear its ramps, a little slower: then
    the line brakes and speeds up inside slow pieces, too. Both are planned, and the quicker is taken.

    Parameters
    ----------
    gaps, of
        The list, and which cam makes each piece.
    lengths
        Lengths of the cams (m).
    tops
        Their line speeds on a line that keeps its speed (m/s).

    Returns
    -------
    (tops, bears)
        Shapes ``(cams,)``.

    Raises
    ------
    InfeasibleError
        A cam that runs while the line ramps bears it at no line speed.
    """
    found = _ramping_speeds(job, lengths, tops)
    bears = found == tops
    slower = _ramping(job, gaps, lengths, of, np.stack([tops, found]))
    steadily = np.where(slower, found, tops), bears | slower
    if job.line.jerk is None or steadily[1].all() or (found <= 0.0).any():
        return steadily
    options = (steadily, (found, np.ones(len(tops), dtype=bool)))
    some = slice(_until(of, _COMPARED))
    times = [plan_line(job.line, gaps[some], speeds[of[some]], ~kept[of[some]]).time for speeds, kept in options]
    return options[int(np.argmin(times))]


def given_line_tops(
    job: Job, lengths: FloatArray, tops: FloatArray, fastest: FloatArray
) -> tuple[FloatArray, NDArray[np.bool_]]:
    """Find the same for a line whose speed is given: every cam that can is to bear the job's ramps at the speeds that it will see.

    Parameters
    ----------
    job, lengths
        As of `line_speed_tops`.
    tops
        Line speeds a little above those that the cams will see, as far as they can (m/s).
    fastest
        The greatest that they will see (m/s).
    """
    bears = (_ramping_speeds(job, lengths, tops) == tops) & job.line.ramps
    exactly = ~bears & (fastest < tops) & job.line.ramps
    if exactly.any():
        exactly[exactly] = _ramping_speeds(job, lengths[exactly], fastest[exactly]) == fastest[exactly]
    return np.where(exactly, fastest, tops), bears | exactly


def _ramping_speeds(job: Job, lengths: FloatArray, tops: FloatArray) -> FloatArray:
    """Give the highest line speeds up to given ones at which cams bear the line's ramps (m/s)."""
    return np.array(
        [ramping_speed(job, length, top) for length, top in zip(lengths.tolist(), tops.tolist(), strict=True)]
    )


def _ramping(
    job: Job, gaps: FloatArray, lengths: FloatArray, of: NDArray[np.intp], speeds: FloatArray
) -> NDArray[np.bool_]:
    """Find the cams that must be slower, as they run while the line ramps and bear that at a lower speed only.

    Parameters
    ----------
    job, gaps, lengths, of
        As of `line_speed_tops`.
    speeds
        Line speeds of the cams on a steady line and on one that ramps (m/s), shape ``(2, cams)``.
    """
    tops, found = speeds
    ramp = job.line.acceleration or 0.0
    ends = np.concatenate([[0.0], np.cumsum(gaps)])
    places = np.stack([ends[:-1], 0.5 * (ends[:-1] + ends[1:]), ends[1:]])
    slower = np.zeros(len(tops), dtype=bool)
    while True:
        plan = fastest_plan(gaps, np.where(slower, found, tops)[of], ramp)
        at = plan.speed(plan.when(places))
        ramping = np.zeros(len(tops), dtype=bool)
        ramping[np.unique(of[at.max(axis=0) > at.min(axis=0) * (1.0 + _STEADY)])] = True
        more = ramping & (found < tops) & ~slower
        if not more.any():
            return slower
        if (found[more] <= 0.0).any():
            length = float(lengths[more][found[more] <= 0.0][0])
            raise InfeasibleError(
                f"no cam of {with_unit(length, 'm', 4, job.units)} bears the line's ramp of "
                f"{with_unit(ramp, 'm/s^2', 4, job.units)}; let it ramp more gently",
                "line.acceleration",
                None,
                "m/s^2",
                (),
            )
        slower |= more


def _until(of: NDArray[np.intp], changes: int) -> int:
    """Count the pieces up to a change of the cam."""
    at = np.flatnonzero(np.diff(of))
    return len(of) if len(at) < changes else int(at[changes - 1]) + 1
