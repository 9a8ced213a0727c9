"""A job whose sync zone lies at one place for all its lengths."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from camwright.design.production.common_place import CommonPlace, common_place
from camwright.jobs.job import Job
from camwright.jobs.wording import in_job_words
from camwright.production.cams import highest_for_gap, list_job, ramping_speed
from camwright.profiles.cut_list import CutList
from camwright.profiles.objective import of_command
from camwright.profiles.task import Task


@dataclass(frozen=True)
class PlacedAlike:
    """A job with the one place of its sync zone.

    Parameters
    ----------
    found
        The place and its cost; ``None`` where there was nothing to place: all lengths share a place already.
    """

    job: Job
    found: CommonPlace | None

    def answer(self) -> dict[str, Any]:
        """Answer of ``--json``; nulls where there was nothing to place."""
        unit = self.job.machine.slave_unit
        found = self.found
        return {
            f"place_{unit}": None if found is None else found.place,
            "cost_share": 0.0 if found is None else found.cost,
            "cost_at_mm": None if found is None else found.at_length * 1e3,
            "compared": 0 if found is None else found.compared,
        }

    def words(self) -> str:
        """Say it in a sentence."""
        if self.found is None:
            return "the sync zone lies at one place for all lengths already"
        return (
            f"one place of the sync zone for all lengths: {self.found.place:.6g} {self.job.machine.slave_unit}, which costs at most "
            f"{100 * self.found.cost:.3g} % of the objective ({self.found.compared} lengths designed at both places, most at "
            f"{self.found.at_length * 1e3:.6g} mm)"
        )


def placed_for(job: Job, tasks: Sequence[Task]) -> PlacedAlike:
    """Place the sync zone of a job at one place for tasks of its machine, if its place is free."""
    if job.machine.placed:
        return PlacedAlike(job, None)
    objective = of_command("rms_acceleration" if job.objective == "sync_error" else job.objective)
    with in_job_words(job.units):
        found = common_place(tasks, objective)
    # the text of a file that leaves the place free would do so again
    return PlacedAlike(replace(job, machine=job.machine.placed_at(found.place), source=None), found)


def placed_alike(job: Job, asked: CutList) -> PlacedAlike:
    """Place the sync zone of a job at one place for all lengths of a list, each at the line speed that it may run at."""
    if job.machine.placed:
        return PlacedAlike(job, None)
    job, tasks = list_job(job), []
    for length in np.unique(asked.gaps).tolist():
        speed = min(job.cut.line_speed, max(highest_for_gap(job, length), 1e-9))
        tasks.append(job.task.from_return().with_length(length).at_speed(ramping_speed(job, length, speed)))
    return placed_for(job, tasks)
