"""Looks at redesigns: what a cam tells of other line speeds, holes, and checks that bind before the sync error."""

from __future__ import annotations

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from camwright.design.feasible.extremes import fastest_line
from camwright.jobs.job import Job, load_job
from camwright.profiles.task import Task
from camwright.studies import look as looks
from camwright.studies.axis_study import solve_job
from camwright.studies.look import Look, failure_name, look
from camwright.studies.reach import ACCURACY, highest_speed, stand_in, verdict

KNIFE, SEALER = load_job("examples/paper-600.toml"), load_job("examples/thick-product.toml")


def at_edge(job: Job) -> tuple[float, Look]:
    """Give the perfect axis' highest line speed (m/s), and a look at it."""
    top, _ = fastest_line(job.task)
    assert top is not None
    return top, look(job, job.task.designed_at(top * (1 - 1e-6)), stand_in(job))


@pytest.mark.parametrize("job", [KNIFE, SEALER], ids=["knife", "sealer"])
def test_a_cam_tells_at_which_line_speed_it_keeps_the_tolerance(job: Job) -> None:
    top, seen = at_edge(job)
    assert seen.missed > 0.5
    assert seen.missed_at is not None
    share, falls = seen.slower()
    beside = top * share * np.array([0.97, 1.0, 1.03])
    below, there, above = seen.missed_at(beside)
    assert below < 0.0 < above
    assert abs(there) < 0.1
    assert falls == pytest.approx((above - below) / 0.06, rel=0.6)


def test_a_cam_that_never_keeps_it_tells_nothing() -> None:
    nothing = Look(KNIFE.task, "settling", 1.0, lambda speeds: np.ones(len(speeds)))
    assert nothing.slower() == (0.0, 0.0)
    assert Look(KNIFE.task, "jerk", math.inf).slower() == (0.0, 0.0)


@pytest.mark.parametrize(("known", "most"), [(False, 6), (True, 3)])
def test_a_search_makes_few_designs(monkeypatch: pytest.MonkeyPatch, known: bool, most: int) -> None:
    asked: list[float] = []

    def counted(job: Job, task: Task, objective: str, **options: bool) -> Look:
        asked.append(task.cut.line_speed)
        return look(job, task, objective, **options)  # type: ignore[arg-type]

    monkeypatch.setattr(looks, "look", counted)
    cam = solve_job(SEALER, suggest=False).profile if known else None
    found, failed = highest_speed(SEALER, fastest_line(SEALER.task)[0], cam=cam)
    assert len(asked) == len(set(asked)) <= most
    assert found == pytest.approx(0.64766, rel=2 * ACCURACY)
    assert failed == "settling"


def test_line_speeds_above_a_hole_count() -> None:
    """Of this knife line speeds between 1.83 and 2.43 m/s miss the tolerance, those from there to 2.58 m/s keep it."""
    job = replace(
        KNIFE,
        cut=replace(KNIFE.cut, length=0.66034787, sync_tolerance=3.225577e-05),
        limits=replace(KNIFE.limits, acceleration=60.2842716, jerk=8043.12534),
        servo=replace(KNIFE.servo, position_gain=29.0185844),
        objective="peak_jerk",
    )
    found, failed = highest_speed(job, fastest_line(job.task)[0])
    assert found == pytest.approx(2.5835, abs=2e-3)
    assert failed == "crossing"
    passes = [
        not failure_name(verdict(job, job.task.designed_at(speed), stand_in(job))[0]) for speed in (1.8, 2.1, 2.5)
    ]
    assert passes == [True, False, True]


def test_another_check_may_bind_before_the_sync_error(monkeypatch: pytest.MonkeyPatch) -> None:
    judge = looks.judge

    def judged(profile: object, task: Task, servo: object) -> SimpleNamespace:
        torque = SimpleNamespace(name="motor_torque", passed=task.cut.line_speed <= 1.5)
        return SimpleNamespace(checks=[torque, *judge(profile, task, servo).checks])  # type: ignore[arg-type]

    monkeypatch.setattr(looks, "judge", judged)
    found, failed = highest_speed(KNIFE, fastest_line(KNIFE.task)[0])
    assert found is not None
    assert 1.5 / (1 + ACCURACY) <= found <= 1.5
    assert failed == "motor_torque"
