"""The ramp that a cam allows its line: published values, the line simulated in time, and what each limit binds."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from camwright import load_job
from camwright.design.optimise import solve
from camwright.jobs.job import Job
from camwright.profiles.line import Line
from camwright.profiles.machines import RotaryKnife
from camwright.profiles.motor import MotorCurve
from camwright.profiles.objective import of_command
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.returns import baseline
from camwright.profiles.task import Task
from camwright.validation.production.line_ramp import by_acceleration_alone, line_ramp, ramp_curve
from camwright.validation.report import judge

EXAMPLES = Path(__file__).parents[3] / "examples"


@cache
def designed(name: str) -> tuple[CamProfile, Job]:
    """Design an example without a line's ramp: its cam, and the job with the zone placed."""
    job = load_job(EXAMPLES / f"{name}.toml")
    solution = solve(job.task, of_command(job.objective))
    return solution.profile, replace(job, machine=solution.machine)


@pytest.mark.parametrize(
    ("metres_per_minute", "allowed"),
    [(4, 30.0), (20, 29.74), (40, 28.02), (60, 25.16), (80, 21.15), (100, 15.99), (120, 9.69)],
)
def test_the_paper_s_knife_allows_by_acceleration_alone_what_was_computed_before(
    metres_per_minute: float, allowed: float
) -> None:
    profile, job = designed("paper-600")
    found = by_acceleration_alone(profile, job.task.at_speed(metres_per_minute / 60))
    assert found.value == pytest.approx(allowed, abs=0.005)
    assert found.binds == "acceleration"


def test_a_cam_that_uses_its_jerk_limit_up_leaves_no_room_for_a_ramp() -> None:
    profile, job = designed("paper-600")
    found = line_ramp(profile, job.task)
    assert found.ramp.value < 1e-6
    assert found.ramp.binds == "jerk"
    judged = {check.name: check for check in judge(profile, job.task.with_line(Line(1.0)), job.servo).checks}
    assert not judged["line_ramp"].passed
    assert (judged["line_ramp"].value, judged["line_ramp"].unit) == (1.0, "m/s^2")
    assert "line_ramp" not in {check.name for check in judge(profile, job.task, job.servo).checks}


@pytest.mark.parametrize(
    ("braking", "acceleration", "jerk"), [(1.0, 10.05, 3020), (5.0, 13.97, 3101), (20.0, 28.67, 3405)]
)
def test_braking_on_the_paper_s_cam_gives_the_peaks_computed_before(
    braking: float, acceleration: float, jerk: float
) -> None:
    profile, job = designed("paper-600")
    peaks = ramped_peaks(profile, job.task, -braking, phases=200)
    assert peaks[0] == pytest.approx(acceleration, abs=0.02)
    assert peaks[1] == pytest.approx(jerk, abs=5)


def ramped_peaks(
    profile: CamProfile, task: Task, a: float, phases: int, samples: int = 3000
) -> tuple[float, float, float]:
    """Run a constant ramp between standstill and the line speed in time, from many phases; greatest acceleration, jerk, torque share.

    Nothing of the chain rule's quotients is used: speed and place of the line are integrated, the slave's motion follows from the cam.
    """
    v, length = task.cut.line_speed, task.cut.length
    duration = v / abs(a)
    t = np.linspace(0.0, duration, samples)
    speed = v + a * t if a < 0 else a * t
    way = v * t + 0.5 * a * t**2 if a < 0 else 0.5 * a * t**2
    x = (np.arange(phases)[:, None] / phases * length + way) % length
    ratio, bend, third = (profile(x, order) for order in (1, 2, 3))
    acceleration = bend * speed**2 + ratio * a
    jerk = third * speed**3 + 3 * bend * speed * a
    load = 0.0
    if task.limits.motor is not None:
        machine, place = task.machine, task.slave_zero(profile) + profile(x)
        force = machine.inertia(place) * acceleration + 0.5 * machine.inertia_slope(place) * (ratio * speed) ** 2
        force = force + machine.friction * np.sign(ratio)
        gives = task.limits.motor.torque(ratio * speed * machine.motor_ratio) * machine.motor_ratio
        load = float((np.abs(force) / np.maximum(gives, 1e-300)).max())
    return float(np.abs(acceleration).max()), float(np.abs(jerk).max()), load


def tight(task: Task, **looser: float) -> Task:
    """Give a task limits that its designed cam leaves room in."""
    limits = task.limits
    return task.with_limits(
        replace(
            limits,
            acceleration=looser.get("acceleration", 1.3) * limits.acceleration,
            jerk=looser.get("jerk", 1.3) * limits.jerk,
        )
    )


@pytest.mark.parametrize("name", ["paper-600", "flying-saw", "chasing-shear", "cross-cutter", "thick-product"])
@pytest.mark.parametrize("looser", [{"jerk": 1e3}, {"jerk": 1.2}, {"jerk": 3.0, "acceleration": 1.01}])
def test_the_time_simulation_of_ramps_agrees_on_every_machine(name: str, looser: dict[str, float]) -> None:
    profile, job = designed(name)
    task = tight(job.task, **looser)
    found = line_ramp(profile, task)
    reached = []
    for way, allowed in ((1.0, found.speeding), (-1.0, found.braking)):
        assert 0.0 < allowed.value < math.inf
        for share in (0.5, 1.0):
            acceleration, jerk, _ = ramped_peaks(profile, task, way * share * allowed.value, phases=150)
            assert acceleration <= task.limits.acceleration * (1 + 1e-9)
            assert jerk <= task.limits.jerk * (1 + 1e-9)
        harder = ramped_peaks(profile, task, way * 1.1 * allowed.value, phases=700, samples=1200)
        reached.append(harder[0] > task.limits.acceleration or harder[1] > task.limits.jerk)
    assert all(reached)  # a tenth more is too much: the bound is no smaller than it must be


def test_a_slower_line_may_ramp_as_hard_at_least() -> None:
    profile, job = designed("paper-600")
    curve = [each.ramp.value for each in ramp_curve(profile, tight(job.task))]
    up_to = [
        line_ramp(profile, tight(job.task).at_speed(share * job.cut.line_speed)).ramp.value
        for share in np.linspace(0.05, 1, 20)
    ]
    assert up_to == sorted(up_to, reverse=True)
    assert up_to == pytest.approx(np.minimum.accumulate(curve), rel=1e-9)


def test_the_line_s_jerk_takes_its_part() -> None:
    profile, job = designed("paper-600")
    task = tight(job.task, jerk=1.1)
    calm = line_ramp(profile, task.with_line(Line(1.0))).ramp
    jerky = line_ramp(profile, task.with_line(Line(1.0, jerk=100.0))).ramp
    assert calm.binds == jerky.binds == "jerk"
    # in the hold of the acceleration, where y' is greatest: (J - y' j) / (3 y'' v)
    assert jerky.value < calm.value
    assert line_ramp(profile, task.with_line(Line(1.0, jerk=1e5))).ramp.value == 0.0


def test_the_motor_binds_where_its_torque_is_small() -> None:
    profile, job = designed("paper-600")
    knife = RotaryKnife(0.4, drum_inertia=0.05, gear_ratio=1.0)
    curve = MotorCurve(((0.0, 9.0), (300.0, 8.0)))
    loose = replace(job.limits, jerk=1e6, motor=curve)
    task = Task(knife, job.cut, loose)
    found = line_ramp(profile, task)
    assert found.ramp.binds == "torque"
    for way, allowed in ((1.0, found.speeding), (-1.0, found.braking)):
        assert ramped_peaks(profile, task, way * allowed.value, phases=200)[2] <= 1 + 1e-9
        assert ramped_peaks(profile, task, way * 1.02 * allowed.value, phases=200)[2] > 1


def test_a_cam_that_jumps_allows_no_ramp() -> None:
    job = load_job()
    jumping = line_ramp(baseline("linear_return", job.task), job.task).ramp
    assert (jumping.value, jumping.binds) == (0.0, "acceleration")
    bent = line_ramp(baseline("parabolic", job.task), job.task).ramp
    assert (bent.value, bent.binds) == (0.0, "jerk")
