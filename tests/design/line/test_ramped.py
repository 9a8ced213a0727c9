"""Designs that bear the ramps of their line: what they cost, that they are the best, and the line simulated in time."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from camwright import load_job
from camwright.design.line.forms import greatest_form, keeps_ramp, ramp_forms
from camwright.design.line.refusal import can_ramp
from camwright.design.optimise import Solution, solve
from camwright.profiles.cut import Cut
from camwright.profiles.errors import InfeasibleError
from camwright.profiles.limits import Limits
from camwright.profiles.line import STEADY, Line
from camwright.profiles.machines import LinearCarriage
from camwright.profiles.objective import CommandObjective, of_command
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.servo import Servo
from camwright.profiles.task import Task
from camwright.validation.bounds.optimality import lower_bound
from camwright.validation.bounds.ramped import ramped_bound
from camwright.validation.production.line_ramp import line_ramp
from camwright.validation.report import judge

EXAMPLES = Path(__file__).parents[3] / "examples"
MACHINES = ("paper-600", "flying-saw", "chasing-shear", "cross-cutter", "thick-product")


def paper(length: float, line: Line) -> Task:
    """Give the paper's job at a cut length, on a line."""
    return load_job().task.with_length(length).with_line(line)


def solved(name: str, line: Line, objective: CommandObjective | None = None) -> tuple[Solution, Task]:
    """Design an example on a line that ramps, for another objective if one is given."""
    job = load_job(EXAMPLES / f"{name}.toml")
    solution = solve(job.task.with_line(line), objective or of_command(job.objective))
    return solution, job.task.with_machine(solution.machine).with_line(line)


def ramp_in_time(
    profile: CamProfile, task: Task, low: float, high: float, way: float, phases: int = 200
) -> tuple[float, float]:
    """Run the line from one speed to another as hard as it may, with its jerk, from many phases: the slave's greatest acceleration, jerk.

    The line's motion is integrated in time: acceleration comes, stays, and goes again.
    """
    line = task.line
    a, j = (line.speeding if way > 0 else line.braking), line.known_jerk
    if j and a**2 / j > high - low:
        a = float(np.sqrt((high - low) * j))
    corner = a / j if j else 0.0
    duration = (high - low) / a + corner
    t = np.linspace(0.0, duration, 801)
    rate = np.clip(np.minimum(t, duration - t) * j, 0.0, a) if j else np.full(len(t), a)
    if j:
        early, late = np.minimum(t, corner), np.maximum(0.0, t - (duration - corner))
        gained = (
            0.5 * j * early**2
            + a * np.maximum(0.0, np.minimum(t, duration - corner) - corner)
            + a * late
            - 0.5 * j * late**2
        )
    else:
        gained = a * t
    speed = low + gained if way > 0 else high - gained
    travel = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * np.diff(t))])
    turn = np.where(t < corner, j, np.where(t > duration - corner, -j, 0.0)) if j else np.zeros(len(t))
    x = (np.arange(phases)[:, None] / phases * task.cut.length + travel) % task.cut.length
    ratio, bend, third = (profile(x, order) for order in (1, 2, 3))
    acceleration = bend * speed**2 + ratio * way * rate
    jerk = third * speed**3 + 3 * bend * speed * way * rate + ratio * way * turn
    return float(np.abs(acceleration).max()), float(np.abs(jerk).max())


@pytest.mark.parametrize(
    ("length", "line", "programme", "most"),
    [
        (0.6, Line(1.0, jerk=5.0), 9.0900 / 9.0891, 1.0015),
        (0.6, Line(5.0, jerk=50.0), 9.0945 / 9.0891, 1.0015),
        (0.35, Line(1.0, jerk=5.0), 17.673 / 17.656, 1.015),
        (0.35, Line(5.0, jerk=50.0), 17.760 / 17.656, 1.015),
    ],
)
def test_the_ramp_costs_what_a_linear_programme_found_before(
    length: float, line: Line, programme: float, most: float
) -> None:
    task = paper(length, line)
    ramped, steady = solve(task, "peak_acceleration"), solve(task.with_line(STEADY), "peak_acceleration")
    assert 1.0 < ramped.minimised / steady.minimised <= most
    assert ramped.minimised / steady.minimised == pytest.approx(programme, abs=2e-4)  # that of 160 even intervals
    assert keeps_ramp(ramped.profile, task)
    assert not keeps_ramp(steady.profile, task)
    bound = lower_bound(ramped.profile, task, "peak_acceleration").value
    assert 0.0 <= 1.0 - bound / ramped.minimised <= 5e-4
    assert bound > lower_bound(steady.profile, task.with_line(STEADY), "peak_acceleration").value


@pytest.mark.parametrize("name", MACHINES)
@pytest.mark.parametrize("objective", ["peak_acceleration", "rms_acceleration", "peak_jerk", "rms_jerk"])
def test_every_machine_and_objective_of_the_motion_is_within_a_thousandth_of_its_bound(
    name: str, objective: CommandObjective
) -> None:
    solution, task = solved(name, Line(2.0, 4.0, 40.0), objective)
    assert keeps_ramp(solution.profile, task)
    allowed = line_ramp(solution.profile, task)
    assert allowed.speeding.value >= 2.0 * (1 - 1e-9)
    assert allowed.braking.value >= 4.0 * (1 - 1e-9)
    bound = lower_bound(solution.profile, task, objective).value
    assert bound <= solution.minimised * (1 + 1e-9)
    assert 1.0 - bound / solution.minimised <= 1e-3


@pytest.mark.parametrize(
    "name", [each if each == "paper-600" else pytest.param(each, marks=pytest.mark.slow) for each in MACHINES]
)
@pytest.mark.parametrize("line", [Line(2.0, jerk=20.0), Line(3.0), Line(0.5, 5.0, 50.0)])
def test_no_ramp_in_time_leaves_the_limits(name: str, line: Line) -> None:
    solution, task = solved(name, line, "peak_acceleration")
    v = task.cut.line_speed
    for high in v * np.arange(1, 21) / 20:
        for low in (0.0, 0.5 * high):
            for way in (1.0, -1.0):
                acceleration, jerk = ramp_in_time(
                    solution.profile, task, low, float(high), way, 200 if low == 0.0 else 40
                )
                assert acceleration <= task.limits.acceleration * (1 + 1e-6)
                assert jerk <= task.limits.jerk * (1 + 1e-6)


@pytest.mark.parametrize("objective", ["rms_torque", "peak_torque", "energy"])
@pytest.mark.slow
def test_objectives_of_the_motor_bear_the_ramp(objective: CommandObjective) -> None:
    job = load_job(EXAMPLES / "chasing-shear.toml")
    at = solve(job.task, "peak_acceleration").machine
    task = (
        job.task.with_machine(at)
        .with_limits(replace(job.limits, jerk=0.35 * job.limits.jerk))
        .with_line(Line(1.0, 2.0, 10.0))
    )
    solution = solve(task, objective)
    assert keeps_ramp(solution.profile, task)
    checks = {check.name: check for check in judge(solution.profile, task, job.servo).checks}
    assert checks["line_ramp"].passed
    assert checks["jerk"].passed


def test_a_line_whose_ramps_the_best_cam_bears_costs_nothing() -> None:
    job = load_job()
    task = job.task.with_limits(replace(job.limits, jerk=1e6)).with_line(Line(0.5))
    steady = solve(task.with_line(STEADY), "rms_jerk")
    assert solve(task, "rms_jerk").profile.to_dict() == steady.profile.to_dict()


def test_a_ramp_that_no_cam_bears_is_refused_with_what_works() -> None:
    job = load_job()
    task = job.task.with_line(Line(35.0))  # above the limit of the knife itself, which follows the material in sync
    with pytest.raises(InfeasibleError, match="while the line ramps") as caught:
        solve(task, "peak_acceleration")
    error = caught.value
    assert (error.exit_code, error.binding) == (3, "line.acceleration")
    offered = {each.change: each for each in error.suggestions}
    assert {"line.acceleration", "acceleration"} <= set(offered)
    gentler = offered["line.acceleration"]
    assert 15.0 < gentler.value < 30.0
    for each in (gentler.value, 0.9 * gentler.value):
        solve(task.with_line(Line(each)), "peak_acceleration")
    assert not can_ramp(task.with_line(Line(1.05 * gentler.value)))
    higher = replace(job.limits, acceleration=offered["acceleration"].value)
    solve(task.with_limits(higher), "peak_acceleration")


def test_a_stop_far_beyond_the_limits_is_told_a_gentler_one() -> None:
    task = load_job().task.with_line(Line(1.0, 1000.0))
    with pytest.raises(InfeasibleError, match="while the line ramps") as caught:
        solve(task, "peak_acceleration")
    error = caught.value
    gentler = next(each.value for each in error.suggestions if each.change == "line.stop")
    assert (error.binding, error.excess) == ("line.stop", pytest.approx(1000.0 - gentler))
    assert can_ramp(task.with_line(Line(1.0, gentler)))
    assert not can_ramp(task.with_line(Line(1.0, 1.05 * gentler)))


def test_a_ramp_that_comes_too_fast_is_refused_by_its_jerk() -> None:
    job = load_job()
    task = job.task.with_line(Line(5.0, None, 3000.0))
    with pytest.raises(InfeasibleError, match="while the line ramps") as caught:
        solve(task, "peak_acceleration")
    error = caught.value
    softer = next(each.value for each in error.suggestions if each.change == "line.jerk")
    assert (error.binding, error.unit, error.excess) == ("line.jerk", "m/s^3", pytest.approx(3000.0 - softer))
    assert can_ramp(task.with_line(Line(5.0, None, softer)))


SAW = load_job(EXAMPLES / "flying-saw.toml").task.with_line(Line(1.0, 5.0, 50.0))


@pytest.mark.parametrize("line_speed", [1e-4, 1e-3, 0.01 / 60])
def test_a_slow_line_needs_neither_a_mesh_nor_a_programme_for_its_bound(
    line_speed: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    for module in ("camwright.design.optimise.ramped_return", "camwright.validation.bounds.optimality.ramped_bound"):
        monkeypatch.setattr(module, None)
    task = SAW.at_speed(line_speed)
    for objective in ("peak_acceleration", "rms_acceleration", "peak_jerk"):
        found = solve(task, objective)
        bound = lower_bound(found.profile, task, objective).value
        assert keeps_ramp(found.profile, task)
        assert bound <= found.minimised <= bound * (1.0 + 1e-6)


@pytest.mark.slow
def test_what_bears_the_ramps_of_a_line_is_designed_on_a_slower_one() -> None:
    # all that the ramps ask grows with the line's speed: the cam of 30 m/min bears them at 5; no mesh had one there
    task, quick = SAW.at_speed(5.0 / 60.0), SAW.at_speed(0.5)
    other = solve(quick, "peak_acceleration", thorough=False).profile
    assert keeps_ramp(other, quick)
    assert keeps_ramp(other, task)
    found = solve(task, "peak_acceleration", thorough=False)
    assert keeps_ramp(found.profile, task)
    bound = lower_bound(found.profile, task, "peak_acceleration").value
    assert bound <= found.minimised <= 1.01 * bound


def test_a_bound_is_told_of_a_sync_zone_that_bears_no_ramps() -> None:
    steady = solve(SAW.with_line(STEADY), "peak_acceleration")
    assert 0.0 < lower_bound(steady.profile, SAW.with_line(Line(10.0)), "peak_acceleration").value <= steady.minimised


def test_a_wide_gap_is_looked_at_on_a_finer_mesh_and_to_a_vertex(monkeypatch: pytest.MonkeyPatch) -> None:
    task = paper(0.6, Line(3.0, 6.0))
    found = solve(task, "peak_jerk")
    bounds = []
    for coarse, finer in ((24, 24), (24, 160)):
        monkeypatch.setattr("camwright.validation.bounds.ramped.INTERVALS", coarse)
        monkeypatch.setattr("camwright.validation.bounds.ramped.FINER", finer)
        for like in (1.0, 0.0):  # by the interior point alone; and to a vertex whatever the gap
            monkeypatch.setattr("camwright.validation.bounds.ramped.LIKE", like)
            monkeypatch.setattr("camwright.validation.bounds.ramped.WIDE", 0.0)
            bounds.append(ramped_bound(found.profile, task, "peak_jerk").value)
    assert bounds[0] == pytest.approx(bounds[1], rel=1e-3)
    assert bounds[2] == pytest.approx(bounds[3], rel=1e-3)
    assert bounds[0] < bounds[3] <= found.minimised * (1 + 1e-9)
    assert found.minimised < bounds[3] * (1 + 2e-3)


def test_the_bound_of_a_steady_line_is_not_above_the_closed_form() -> None:
    task = paper(0.6, STEADY)
    for objective in ("peak_acceleration", "rms_acceleration", "peak_jerk", "rms_jerk"):
        solution = solve(task, objective)
        found = ramped_bound(solution.profile, task, objective).value
        assert found <= solution.minimised
        assert found == pytest.approx(solution.minimised, rel=3e-4)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("stroke", "cut", "limits"),
    [
        (
            0.8196,
            Cut(
                1.64111977873834, 0.15036957368181714, 0.7324993979239748, 0.14649987958479496, 0.5859995183391798, 0.01
            ),
            Limits(0.346423969612781, 0.39630321922625855, 1.9517596964182553, reversal=True),
        ),
        (
            0.19246126003209418,
            Cut(0.30333091037399107, 42.44 / 60, 0.18637138296284728, 0.037274276592569454, 0.14909710637027782, 4e-3),
            Limits(12.413833034032242, 5554.889837454408, 34038.58710892522, reversal=True),
        ),
    ],
)
def test_a_carriage_that_is_left_hardly_any_return_keeps_its_limits_to_rounding(
    stroke: float, cut: Cut, limits: Limits
) -> None:
    """The mesh of the second opinion exceeded the jerk by 3e-8 where its programme could not be solved to the end."""
    task = Task(LinearCarriage(stroke=stroke, home=0.0), cut, limits)
    time = cut.sync_zone / cut.line_speed
    report = judge(
        solve(task, "rms_jerk").profile,
        task,
        Servo(200.0 / time, 0.8, 40.0 / time, time / 1000, velocity_feedforward=1.0),
    )
    assert report.passed


@pytest.mark.parametrize("name", MACHINES)
def test_the_forms_are_the_worst_of_all_that_the_line_may_do(name: str) -> None:
    """Hold the greatest form against ramps drawn at random: never less, and reached."""
    job = load_job(EXAMPLES / f"{name}.toml")
    solution = solve(job.task, of_command(job.objective))
    task = job.task.with_machine(solution.machine).with_line(Line(1.0, 3.0, 20.0))
    profile, line, limits = solution.profile, task.line, task.limits
    rng = np.random.default_rng(3)
    x = rng.uniform(0.0, task.cut.length, 200_000)
    v = task.cut.line_speed * np.minimum(1.0, rng.uniform(0.0, 1.3, len(x)))
    a = np.clip(rng.uniform(-4.0, 1.5, len(x)), -line.braking, line.speeding)
    j = np.clip(rng.uniform(-40.0, 40.0, len(x)), -line.known_jerk, line.known_jerk)
    ratio, bend, third = (profile(x, order) for order in (1, 2, 3))
    share = np.maximum(
        np.abs(bend * v**2 + ratio * a) / limits.acceleration,
        np.abs(third * v**3 + 3 * bend * v * a + ratio * j) / limits.jerk,
    )
    worst = greatest_form(profile, task)
    assert share.max() <= worst * (1 + 1e-12)
    assert share.max() >= 0.9 * worst


def test_forms_are_few_where_the_line_brakes_as_it_speeds_up() -> None:
    assert len(ramp_forms(paper(0.6, Line(1.0)))) == 7
    assert len(ramp_forms(paper(0.6, Line(1.0, 5.0)))) == 11
