"""A draft keeps the limits, is no better than the optimum and near it, and says so where it is the optimum."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from camwright.design.draft import draft
from camwright.design.optimise import solve
from camwright.jobs.job import load_job
from camwright.profiles.errors import InfeasibleError
from camwright.profiles.objective import MotionObjective
from camwright.profiles.task import Task

EXAMPLES = Path(__file__).parents[2] / "examples"


def task_of(name: str, length: float = 1.0) -> Task:
    job = load_job(EXAMPLES / f"{name}.toml")
    task = job.task.with_limits(replace(job.limits, motor=None))
    task = task.with_length(length * task.cut.length)
    return task if task.machine.placed else task.placed_midway()


@pytest.mark.parametrize("objective", ["peak_acceleration", "rms_acceleration", "peak_jerk", "rms_jerk"])
@pytest.mark.parametrize("name", ["paper-600", "thick-product", "flying-saw", "chasing-shear"])
def test_a_draft_is_near_the_optimum_and_keeps_the_limits(name: str, objective: MotionObjective) -> None:
    task = task_of(name)
    found, best = draft(task, objective), solve(task, objective)
    assert best.minimised * (1 - 1e-6) <= found.value <= best.minimised * 1.02
    if found.exact:
        assert found.value == pytest.approx(best.minimised, rel=1e-6)
    v, limits = task.cut.line_speed, task.limits
    for order, limit in ((1, limits.speed), (2, limits.acceleration), (3, limits.jerk)):
        assert found.profile.peak(order) * v**order <= limit * (1 + 1e-9)


def test_an_impossible_job_has_no_draft() -> None:
    with pytest.raises(InfeasibleError):
        draft(task_of("paper-600", 0.5), "peak_acceleration")
