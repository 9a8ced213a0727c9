"""The axis of a servo-aware design: its rows and its grid against the validation's own simulation."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from camwright.design.servo_aware.axis_response import Axis
from camwright.design.servo_aware.command_basis import Command, command_basis
from camwright.profiles.cut import Cut
from camwright.profiles.limits import Limits
from camwright.profiles.machines import (
    CrankSlider,
    LinearCarriage,
    Machine,
    RotaryKnife,
)
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.returns import baseline
from camwright.profiles.servo import Servo
from camwright.profiles.task import Task
from camwright.validation.servo.response import shear_zone_error
from camwright.validation.servo.simulation import simulate

PAPER = Servo(120.0, 0.7, 35.0, 0.004, 1.0)
LATE = replace(PAPER, velocity_feedforward=0.9, dead_time=0.0037, lead_time=0.0021)
FREE = Limits(float("inf"), float("inf"), float("inf"))  # nothing here asks for limits
CUT = Cut(0.6, 80 / 60, 0.2, 0.04, 0.13, 1e-4)
MACHINES: dict[str, tuple[Machine, Cut]] = {
    "tangential": (RotaryKnife(0.4), CUT),
    "horizontal": (RotaryKnife(0.8, blades=2, sync="horizontal"), replace(CUT, length=0.5, sync_ratio=1.02)),
    "carriage": (LinearCarriage(0.9, home=-0.3), CUT),
    "crank": (CrankSlider(0.15, 0.6, 0.02, sync_at=1.2), replace(CUT, length=0.9, sync_zone=0.1, shear_zone_at=0.05)),
}
EVERY = pytest.mark.parametrize("name", MACHINES)
BOTH = pytest.mark.parametrize("command", ["in_sync", "shaped"])
SERVOS = pytest.mark.parametrize("servo", [PAPER, LATE], ids=["paper", "late"])


def some_command(machine: Machine, cut: Cut, command: Command) -> CamProfile:
    """Return a command near the motion of even speed, bent at random."""
    basis = command_basis(Task(machine, cut, FREE), command)
    travel = machine.pitch or cut.sync_zone
    return basis.profile(np.random.default_rng(4).normal(0.0, 0.01 * travel, size=(basis.matrix.shape[1],)))


def from_mid_sync(profile: CamProfile, machine: Machine, cut: Cut) -> CamProfile:
    """Count the same command from mid sync zone, its slave from the machine in sync there."""
    at = cut.length - 0.5 * cut.sync_zone
    sync = machine.sync_profile(cut)
    behind = float(sync(sync.end)) - float(sync(0.5 * cut.sync_zone))
    return profile.roll(at).shift(slave=float(profile(at)) - (machine.pitch - behind))


@EVERY
@BOTH
@SERVOS
def test_errors_in_the_shear_zone_are_those_of_the_simulation(name: str, command: Command, servo: Servo) -> None:
    machine, cut = MACHINES[name]
    cut = replace(cut, shaped=command == "shaped")
    profile = some_command(machine, cut, command)
    places, times, errors = Axis(Task(machine, cut, FREE), servo).zone_errors(profile)
    found = np.abs(errors).max()
    assert found > 1e-4
    for origin in ("return", "cut"):
        placed = replace(cut, origin=origin)
        own = profile if origin == "return" else from_mid_sync(profile, machine, cut)
        run = simulate(own, placed, servo)
        simulated = np.abs(shear_zone_error(run, own, Task(machine, placed, FREE))[1]).max()
        # a spline bent at random: the simulation's cubics between its points add to what is in common
        assert found == pytest.approx(simulated, abs=2e-7 if origin == "cut" else 2e-8)
    assert len(places) == len(times) == len(errors)
    assert places.min() == pytest.approx(cut.return_zone + cut.shear_zone_at)
    assert places.max() == pytest.approx(cut.return_zone + cut.shear_zone_at + cut.shear_zone)


@EVERY
@BOTH
def test_the_grid_is_the_simulation_point_by_point(name: str, command: Command) -> None:
    machine, cut = MACHINES[name]
    cut = replace(cut, shaped=command == "shaped")
    profile = some_command(machine, cut, command)
    axis = Axis(Task(machine, cut, FREE), LATE)
    run = simulate(profile, cut, LATE)
    grid = axis.on_grid(profile, 0, 400)
    slopes = axis.on_grid(profile, 0, 400, 1)
    step = axis.sample / 16
    compared = 0
    for phase in range(16):
        for point in range(0, run.master.shape[1], 7):
            place = round(run.master[phase, point] / step)
            if 0 <= place < 400:
                assert run.master[phase, point] == pytest.approx(place * step, abs=1e-12)
                assert grid[point % 8, place] == pytest.approx(run.axis[phase, point], abs=1e-11)
                assert slopes[point % 8, place] == pytest.approx(run.axis_ratio[phase, point], abs=1e-8)
                compared += 1
    assert compared > 150


@pytest.mark.parametrize("servo", [PAPER, LATE, replace(PAPER, dead_time=11.0)], ids=["paper", "late", "later"])
@pytest.mark.parametrize("order", [1, 2])
def test_what_is_not_loud_keeps_its_limits_at_every_step(servo: Servo, order: int) -> None:
    """Of a cycle of 2 500 samples, as the grid over all of it says; a command in sync is quiet in its sync zone."""
    cut = replace(CUT, line_speed=0.06)
    task = Task(RotaryKnife(0.4), cut, FREE)
    axis, cam = Axis(task, servo), baseline("double_s", task)
    every = axis.on_grid(cam, 0, 40_000, order)
    low = 0.5 * float(every.min()) + 0.25 * (2 - order)
    stretches = axis.loud(cam, order, low, 1e3)
    quiet = np.ones(40_000, dtype=bool)
    for first, count in stretches:
        quiet[first : first + count] = False
    assert 0.1 < quiet.mean() < 0.9
    assert (every[:, quiet] >= low - 1e-8).all()
    assert axis.loud(cam, order, -1e6, 1e6) == []


@EVERY
@BOTH
@pytest.mark.parametrize("order", [0, 1, 2])
def test_rows_are_the_response(name: str, command: Command, order: int) -> None:
    machine, cut = MACHINES[name]
    basis = command_basis(Task(machine, cut, FREE), command)
    axis = Axis(Task(machine, cut, FREE), LATE)
    unknowns = np.random.default_rng(5).normal(0.0, 0.1, size=(basis.matrix.shape[1],))
    response = axis.on_grid(basis.profile(unknowns), 0, 60, order)
    steps = np.tile(np.arange(60.0), 8)
    subs = np.repeat(np.arange(8.0), 60)
    matrix, constant = axis.rows(
        basis.rows, np.multiply(steps, axis.sample / 16), np.multiply(subs, LATE.sample_time / 8), order
    )
    size = np.abs(response).max()
    assert matrix @ unknowns + constant == pytest.approx(response.ravel(), abs=1e-10 * size)


@EVERY
def test_the_band_is_where_the_tool_leaves_the_tolerance(name: str) -> None:
    machine, cut = MACHINES[name]
    axis = Axis(Task(machine, cut, FREE), PAPER)
    places = np.linspace(*axis.shear_zone, 9)
    low, high = axis.band(places, 3e-4)
    coordinate = axis.ideal(places)[2]
    for edge, sign in ((low, -1), (high, 1)):
        moved = np.asarray(machine.tool(coordinate + edge) - machine.tool(coordinate))
        assert moved == pytest.approx(np.full(9, sign * 3e-4), abs=1e-15)
    assert np.all((low < 0) & (high > 0))


@EVERY
def test_the_ideal_axis_ends_a_cycle_where_the_next_begins(name: str) -> None:
    machine, cut = MACHINES[name]
    axis = Axis(Task(machine, cut, FREE), PAPER)
    travel, ratio, coordinate = axis.ideal(np.array([cut.return_zone, cut.length]))
    assert travel[1] == pytest.approx(machine.pitch, abs=1e-14)
    sync = machine.sync_profile(cut)
    assert travel[0] == pytest.approx(machine.pitch - sync.advance, abs=1e-14)
    assert np.asarray(machine.tool_ratio(coordinate)) * ratio == pytest.approx([cut.sync_ratio] * 2, rel=1e-9)
    tool = np.asarray(machine.tool(coordinate))
    assert tool[1] - tool[0] == pytest.approx(cut.sync_ratio * cut.sync_zone, rel=1e-9)


def test_a_shear_zone_between_two_steps_of_the_grid_is_seen_at_its_ends() -> None:
    machine, cut = MACHINES["tangential"]
    step = PAPER.sample_time * cut.line_speed / 16
    cut = replace(cut, shear_zone=0.2 * step, shear_zone_at=0.13)
    axis = Axis(Task(machine, cut, FREE), PAPER)
    profile = some_command(machine, cut, "shaped")
    places, times, errors = axis.zone_errors(profile)
    assert len(errors) >= 32
    assert np.unique(places).size <= 3
    shaped = replace(cut, shaped=True)
    simulated = shear_zone_error(simulate(profile, shaped, PAPER), profile, Task(machine, shaped, FREE))[1]
    assert np.abs(errors).max() == pytest.approx(np.abs(simulated).max(), abs=2e-8)
    assert np.all((times >= 0) & (times < PAPER.sample_time))
