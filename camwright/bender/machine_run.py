"""What the bender does in a program, wherever its outline lies: collisions, time tables, and how its axes settle."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from camwright.bender.job import BenderJob
from camwright.design.bender.moves import (
    Dwell,
    TimeTable,
    overlapped_table,
    sequential_table,
)
from camwright.profiles.bender.motion import Moves, double_s_moves, trapezoid_moves
from camwright.profiles.bender.plan import BendPlan
from camwright.profiles.bender.program import NcProgram
from camwright.profiles.polynomial.profile import FloatArray
from camwright.validation.bender.arrival import arrivals
from camwright.validation.bender.collision import Collision, collisions
from camwright.validation.bender.virtual_bender import BendingProof

_SETTLED = 200


@dataclass(frozen=True, eq=False)
class MachineRun:
    """What the machine does in a program, wherever its outline lies.

    Parameters
    ----------
    collisions
        Where the bent part meets the mould or the rule to come.
    times, paper_times
        Optimised moves with overlaps, and sequential trapezoidal moves.
    feed_overshoot, mould_overshoot
        Greatest overshoot of either axis in the discrete servo, and what is allowed (m, rad).
    """

    collisions: tuple[Collision, ...]
    times: TimeTable
    paper_times: TimeTable
    feed_overshoot: tuple[float, float]
    mould_overshoot: tuple[float, float]


def machine_run(read: NcProgram, plan: BendPlan, proof: BendingProof, job: BenderJob) -> MachineRun:
    """Run a program in the machine."""
    drive = job.drive
    feeds = np.asarray(read.feeds * 1e-6, dtype=np.float64)
    moulds = np.asarray(np.radians(read.bends / 1e3), dtype=np.float64)
    feed = _worst(double_s_moves(_spread(feeds), drive.feed), job, job.feed.window)
    mould = _worst(double_s_moves(_spread(np.abs(moulds)), drive.mould), job, job.mould.window)
    paper_feed = _worst(trapezoid_moves(_spread(feeds), drive.feed), job, job.feed.window)
    paper_mould = _worst(trapezoid_moves(_spread(np.abs(moulds)), drive.mould), job, job.mould.window)
    return MachineRun(
        collisions(proof.points, moulds, job.envelope),
        overlapped_table(feeds, moulds, plan.turns, drive, Dwell(feed[0], mould[0])),
        sequential_table(feeds, moulds, drive, Dwell(paper_feed[0], paper_mould[0])),
        (feed[1], job.feed.window),
        (mould[1], job.mould.window),
    )


def _spread(distances: FloatArray) -> FloatArray:
    """Different distances of moves, from the least to the greatest; some of them if there are many."""
    unique = np.unique(distances)
    return (
        unique[np.unique(np.linspace(0, len(unique) - 1, min(len(unique), _SETTLED)).astype(int))]
        if len(unique)
        else unique
    )


def _worst(moves: Moves, job: BenderJob, window: float) -> tuple[float, float]:
    """Longest settling time (s) and greatest overshoot (m or rad) of an axis among its moves."""
    if not len(moves.time):
        return 0.0, 0.0
    found = arrivals(moves, job.servo, window)
    return float(found.settling.max()), float(found.overshoot.max())
