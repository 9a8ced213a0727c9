"""The figures of machines other than the tangential knife: units, tool, stroke, and the crank's maps."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from camwright.design.optimise import solve
from camwright.figures.comparison import bars_figure
from camwright.figures.crank import STYLES, crank_figure
from camwright.figures.profile import profile_figure
from camwright.figures.servo import AXES, servo_figure
from camwright.figures.strokes import BLACK
from camwright.house.numbers import number
from camwright.house.pictures import DrawnLine, Frame, Note
from camwright.jobs.job import load_job
from camwright.profiles.machines import CrankSlider, LinearCarriage
from camwright.profiles.objective import ObjectiveName
from camwright.studies.comparison import Comparison, compare
from camwright.validation.servo.simulation import simulate

EXAMPLES = Path(__file__).parents[2] / "examples"


def comparison_of(name: str) -> Comparison:
    """Compare an example's cheapest optimum with the baselines that are drawn."""
    job = load_job(EXAMPLES / f"{name}.toml")
    if isinstance(job.machine, CrankSlider):
        job = replace(job, machine=replace(job.machine, sync_at=math.radians(98.0)))
    optimum = solve(job.task, "rms_acceleration")
    drawn = ["linear_return", "poly_3_4_5", *(["crank_tabulated"] if name == "chasing-shear" else [])]
    return compare(job, optimum.profile, drawn)


@pytest.fixture(scope="module")
def crank() -> Comparison:
    return comparison_of("chasing-shear")


@pytest.fixture(scope="module")
def saw() -> Comparison:
    return comparison_of("flying-saw")


@pytest.fixture(scope="module")
def thick() -> Comparison:
    return comparison_of("thick-product")


def curve_of(frame: Frame, name: str) -> tuple[np.ndarray, np.ndarray]:
    colour = STYLES[name].colour if name in STYLES else name
    lines = [item.points for item in frame.items if isinstance(item, DrawnLine) and item.colour == colour]
    points = max(lines, key=len)
    return points[:, 0], points[:, 1]


def heights(frame: Frame) -> list[float]:
    points = [item.points for item in frame.items if isinstance(item, DrawnLine) and len(item.points) == 2]
    return [float(ends[0, 1]) for ends in points if ends[0, 1] == ends[1, 1]]


def test_units_of_a_crank_are_angles(crank: Comparison) -> None:
    labels = [frame.ylabel for frame in profile_figure(crank).frames]
    assert labels == ["y − even turn (°)", "ratio dy/dx (rad/m)", "acceleration (rad/s²)", "jerk (rad/s³)"]
    titles = [frame.title for frame in bars_figure(crank).frames]
    assert [title.split("\n")[1] for title in titles] == [
        "(rad/s²)",
        "(rad/s²)",
        "(N·m)",
        "(rad/s³)",
        "(rad/s³)",
        "(mm)",
    ]


@pytest.mark.parametrize(
    ("objective", "heading"),
    [("energy", "energy\n(J)"), ("peak_torque", "peak torque\n(N·m)"), ("peak_jerk", "RMS torque\n(N·m)")],
)
def test_what_a_job_of_the_motor_makes_least_is_among_the_bars(
    crank: Comparison, objective: ObjectiveName, heading: str
) -> None:
    frame = bars_figure(replace(crank, job=replace(crank.job, objective=objective))).frames[2]
    assert frame.title == heading
    shown = [row.value("rms_torque" if objective == "peak_jerk" else objective) for row in crank.rows]
    assert [item.text for item in frame.items if isinstance(item, Note)] == [
        "unbounded" if value is None else number(value, 4) for value in shown
    ]


def test_a_crank_s_turn_is_drawn_against_an_even_one(crank: Comparison) -> None:
    x, y = curve_of(profile_figure(crank).frames[0], "optimised")
    profile, length = crank["optimised"].profile, crank.job.cut.length
    assert y == pytest.approx(
        np.degrees(profile(np.clip(x * 1e-3, 0, length)) - 2 * np.pi * x * 1e-3 / length), abs=1e-9
    )
    assert y[0] == pytest.approx(y[-1], abs=1e-9)


def test_a_carriage_is_drawn_in_its_stroke(saw: Comparison) -> None:
    travel, ratio = profile_figure(saw).frames[:2]
    machine, limits, v = saw.job.machine, saw.job.limits, saw.job.cut.line_speed
    assert isinstance(machine, LinearCarriage)
    assert heights(travel) == pytest.approx([0.0, machine.stroke * 1e3])
    assert heights(ratio) == pytest.approx(
        [-limits.speed / v, limits.speed / v]
    )  # it comes back, so backwards is allowed
    _, y = curve_of(travel, "optimised")
    assert 0.0 <= y.min() <= y.max() <= machine.stroke * 1e3
    # the sync zone lies in the middle of the stroke
    assert y[0] == pytest.approx(0.5 * (machine.stroke + saw.job.cut.sync_zone) * 1e3)


@pytest.mark.parametrize("name", ["crank", "thick", "saw"])
def test_the_tool_meets_the_material(name: str, request: pytest.FixtureRequest) -> None:
    comparison = request.getfixturevalue(name)
    job = comparison.job
    runs = {each: simulate(comparison[each].profile, job.cut, job.servo) for each in AXES}
    meeting = servo_figure(comparison, runs).frames[1]
    assert meeting.ylabel == ""
    x, y = curve_of(meeting, "optimised")
    in_sync = x > 0.4 * job.cut.sync_zone * 1e3
    # the tool runs along the material's line, but for what the servo leaves
    assert np.abs(y - x)[in_sync].max() < 1.5 * comparison["optimised"].response.peak_following_error * 1e3


def test_the_crank_s_turn_is_its_formula(crank: Comparison) -> None:
    turn = crank_figure(crank).frames[0]
    x, y = curve_of(turn, BLACK)
    machine = crank.job.machine
    assert isinstance(machine, CrankSlider)
    r, rod = machine.crank * 1e3, machine.rod * 1e3
    alpha = np.radians(x)
    assert y == pytest.approx(-r * np.cos(alpha) + np.sqrt(rod**2 - (r * np.sin(alpha)) ** 2) - (rod - r), abs=1e-9)
    first, last = machine.sync_start(crank.job.cut) + machine.sync_profile(crank.job.cut)(np.array([0.0, 0.15]))
    assert f"sync zone {math.degrees(first):.1f}° to {math.degrees(last):.1f}°" in turn.xlabel


def test_master_and_carriage_move_alike_in_the_sync_zone(crank: Comparison) -> None:
    travel = crank_figure(crank).frames[1]
    cut = crank.job.cut
    x, y = curve_of(travel, "optimised")
    in_sync = x >= cut.return_zone * 1e3
    assert np.diff(y[in_sync]) == pytest.approx(np.diff(x[in_sync]), abs=1e-8)
    assert 0.0 <= y.min() < 1.0
    assert y.max() == pytest.approx(300.0, abs=1.0)


def test_the_servo_curve_is_the_motor_s_and_never_turns_back(crank: Comparison) -> None:
    _, _, speed, acceleration = crank_figure(crank).frames
    for name in STYLES:
        row = crank[name]
        _, rpm = curve_of(speed, name)
        _, slope = curve_of(acceleration, name)
        gear = crank.job.machine.motor_ratio
        assert rpm.max() * math.pi / 30 == pytest.approx(row.motor.peak_speed, rel=1e-3)
        assert rpm.min() >= 0.0
        assert np.abs(slope).max() == pytest.approx(gear * row.motion.peak_acceleration, rel=2e-2)


def test_the_crank_figure_is_about_cranks(saw: Comparison) -> None:
    with pytest.raises(TypeError, match="not a linear_carriage"):
        crank_figure(saw)


@pytest.mark.parametrize("origin", ["return", "cut"])
def test_maps_hold_with_either_origin(origin: str, crank: Comparison) -> None:
    job = replace(crank.job, cut=replace(crank.job.cut, origin=origin))
    optimum = solve(job.task, "rms_acceleration")
    travel = crank_figure(compare(job, optimum.profile, ["crank_tabulated"])).frames[1]
    _, y = curve_of(travel, "optimised")
    start = job.task.slave_at_start
    assert y[0] == pytest.approx((job.machine.tool(start) - job.machine.tool(0.0)) * 1e3)
    assert y[0] == pytest.approx(y[-1], abs=1e-6)
