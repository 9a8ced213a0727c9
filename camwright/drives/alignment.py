"""Where a foreign cam's cycle begins: its zeros of master and slave, found from where it is in sync."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from camwright.jobs.job import Job
from camwright.profiles.polynomial.profile import CamProfile, FloatArray

_BEGINS = 3600
_IN_ZONE = 65
"""Master positions at which the cycle is tried to begin, and places in the sync zone where it is compared."""
_PLATEAU = 0.1
"""Beginnings that miss by less than this part of the sync tolerance are as good as each other."""


def aligned(rebuilt: CamProfile, job: Job) -> tuple[CamProfile, tuple[str, ...]]:
    """Begin the cycle where it fits the job's sync zone best, and put the slave's zero where the job has it.

    Parameters
    ----------
    rebuilt
        One cycle from master 0 on, in SI units.

    Returns
    -------
    (profile, notes)
        The cycle, and where it begins in the file if that is not at the file's first point.
    """
    task, cut, machine = job.task, job.cut, job.machine
    sync = task.sync
    in_zone = np.linspace(0.0, cut.sync_zone, _IN_ZONE)
    meant = sync(in_zone)
    zone = (cut.return_start + cut.return_zone) % cut.length

    def misfit(begin: FloatArray) -> FloatArray:
        """Half the range of the slave's error in the zone, for cycles that begin at these places."""
        x = (begin[:, None] + zone + in_zone) * (rebuilt.length / cut.length)
        off = rebuilt(x, outside="repeat") - meant
        return np.asarray(0.5 * np.ptp(off, axis=1))

    lever = float(np.abs(machine.tool_ratio(task.slave_at_sync_start + meant)).max())
    notes: tuple[str, ...] = ()
    as_it_is = float(misfit(np.zeros(1))[0]) * lever
    if as_it_is > cut.sync_tolerance:
        begins = np.linspace(0.0, cut.length, _BEGINS, endpoint=False)
        found = misfit(begins) * lever
        good = found <= max(2.0 * float(found.min()), _PLATEAU * cut.sync_tolerance)
        begin = float(begins[_middle_of_run(good)])
        if float(misfit(np.array([begin]))[0]) * lever < 0.5 * as_it_is and begin > 0.0:
            rebuilt = rebuilt.roll(begin * rebuilt.length / cut.length)
            note = (
                f"the file's master zero is not the job's: the job's cycle begins {begin * 1e3:.4g} mm into the file's, "
                "where the cam fits the sync zone best ([output] origin says which zero is meant)"
            )
            notes = (note,)
    x = (zone + in_zone) * (rebuilt.length / cut.length)
    off = rebuilt(x, outside="repeat") - meant
    wanted = task.height if cut.origin == "return" else machine.pitch - float(sync(0.5 * cut.sync_zone))
    return rebuilt.shift(0.0, wanted - 0.5 * float(off.max() + off.min())), notes


def _middle_of_run(good: NDArray[np.bool_]) -> int:
    """Find the middle of the longest run of true entries of a ring."""
    if good.all():
        return 0
    turned = int(np.argmin(good))
    ring = np.roll(good, -turned)
    edges = np.diff(np.concatenate([[0], ring.astype(np.int8), [0]]))
    starts, ends = np.nonzero(edges == 1)[0], np.nonzero(edges == -1)[0]
    longest = int(np.argmax(ends - starts))
    return int((starts[longest] + ends[longest] - 1) // 2 + turned) % len(good)
