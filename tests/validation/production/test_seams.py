"""Steps where one cam ends and another begins."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from camwright.design.optimise import solve
from camwright.jobs.job import load_job
from camwright.profiles.limits import Limits
from camwright.profiles.machines import CrankSlider, RotaryKnife
from camwright.profiles.polynomial.profile import CamProfile, join
from camwright.profiles.returns import baseline
from camwright.profiles.task import Task
from camwright.validation.production.seams import SeamJump, seam_jump
from camwright.validation.production.transition import judge_transition

V = 80 / 60


def test_cams_in_sync_meet_to_rounding_on_every_knife() -> None:
    task = load_job().task
    for machine in (task.machine, RotaryKnife(0.4, sync="horizontal")):
        there = task.with_machine(machine).with_cut(
            replace(task.cut, sync_zone=0.05, shear_zone=0.02, shear_zone_at=0.02)
        )
        cams = [solve(there.with_length(length), "peak_acceleration", suggest=False).profile for length in (0.6, 0.9)]
        jump = seam_jump(cams[0], there.slave_at_start, cams[1], there.slave_at_start, there, V)
        assert jump.position < 1e-12
        assert jump.velocity < 1e-9
        assert jump.acceleration < 1e-6


def test_what_a_seam_steps_by_is_what_was_put_in() -> None:
    """Steps of position, ratio and ratio slope that are known, on 200 random pairs: none is missed."""
    draw = np.random.default_rng(7)
    job = load_job()
    task = job.task
    one = baseline("poly_3_4_5", task)
    for _ in range(200):
        place, ratio, slope = draw.uniform(-1, 1, 3) * np.array([1e-3, 0.05, 2.0])
        other = CamProfile.from_arrays([0.0, 0.5], [[place, 1.0 + ratio, slope / 2, draw.uniform(-1, 1)]])
        jump = seam_jump(one, 0.0, other, 0.0, task, V)
        assert jump.position == pytest.approx(abs(place), abs=1e-12)
        assert jump.velocity == pytest.approx(abs(ratio) * V, abs=1e-12)
        assert jump.acceleration == pytest.approx(abs(slope) * V**2, abs=1e-9)


def test_a_seam_outside_the_sync_zone_is_felt() -> None:
    task = load_job().task
    cams = [baseline("poly_3_4_5", task.with_length(length)).roll(0.2) for length in (0.5, 0.6)]
    jump = seam_jump(cams[0], 0.0, cams[1], 0.0, task, V)
    assert jump.velocity > 0.01
    assert jump.acceleration > 0.1


def test_a_crank_that_is_elsewhere_steps_at_the_carriage() -> None:
    crank = CrankSlider(0.15, 0.6)
    task = Task(
        crank.placed_at(1.7), replace(load_job().cut, sync_zone=0.15, shear_zone=0.04), Limits(30.0, 400.0, 2e4)
    )
    moved = task.placed_at(1.71)
    cams = [baseline("poly_3_4_5", each.with_length(0.9)) for each in (task, moved)]
    jump = seam_jump(cams[0], task.slave_at_start, cams[1], moved.slave_at_start, moved, 0.5)
    tool = float(crank.tool(moved.slave_at_sync_end)) - float(crank.tool(task.slave_at_sync_end))
    assert jump.position == pytest.approx(abs(tool), rel=1e-9)
    assert jump.position > 1e-3


def test_the_worst_of_two_is_taken_one_by_one() -> None:
    assert SeamJump(1.0, 2.0, 3.0).worst(SeamJump(2.0, 1.0, 4.0)) == SeamJump(2.0, 2.0, 4.0)


def test_a_transition_that_breaks_anything_fails() -> None:
    task = load_job().task
    good = solve(task, "peak_acceleration").profile
    assert all(check.passed for check in judge_transition(good, 0.0, task))
    for limits, name in (
        (replace(task.limits, speed=1.0), "speed"),
        (replace(task.limits, acceleration=9.0), "acceleration"),
        (replace(task.limits, jerk=2990.0), "jerk"),
    ):
        failed = [check.name for check in judge_transition(good, 0.0, task.with_limits(limits)) if not check.passed]
        assert failed == [name]
    left, right = good.restrict(0.0, 0.3), good.restrict(0.3, 0.6).shift(slave=1e-5)
    failed = [check.name for check in judge_transition(join(left, right), 0.0, task) if not check.passed]
    assert failed == ["position_step"]
    back = CamProfile.from_arrays([0.0, 0.6], [[0.0, -0.1]])
    assert "reversal" in [check.name for check in judge_transition(back, 0.0, task) if not check.passed]
