"""What an answer says of the objective."""

from __future__ import annotations

import math
from dataclasses import asdict
from typing import Any

from camwright.jobs.job import Job
from camwright.profiles.objective import OBJECTIVES
from camwright.studies.design import Design


def objective_unit(job: Job) -> str:
    """Name the unit of a job's objective."""
    return OBJECTIVES[job.objective].unit(job.machine.slave_unit)


def objective_answer(design: Design) -> dict[str, Any]:
    """Write the objective of a design: name, value, unit, lower bound and gap, null where there is no bound."""
    return {
        "name": design.job.objective,
        "value": design.objective,
        "unit": objective_unit(design.job),
        "lower_bound": None if math.isnan(design.bound.value) else design.bound.value,
        "gap": design.gap,
    }


def agreement_answer(design: Design) -> dict[str, Any] | None:
    """Write what several starts agree on; null where one was enough because the problem is convex."""
    return None if design.solution.agreement is None else asdict(design.solution.agreement)
