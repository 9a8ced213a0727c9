"""The table of the shear zone: its rows against the axis' own, its judgement against the simulation of the profile."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from camwright.design.servo_aware.axis_response import Axis
from camwright.design.servo_aware.command_basis import Command, command_basis
from camwright.design.servo_aware.zone_points import zone_points
from camwright.design.servo_aware.zone_table import Tried, ZoneTable
from camwright.profiles.cut import Cut
from camwright.profiles.limits import Limits
from camwright.profiles.machines import CrankSlider, LinearCarriage, Machine, RotaryKnife
from camwright.profiles.servo import Servo
from camwright.profiles.task import Task

PAPER = Servo(120.0, 0.7, 35.0, 0.004, 1.0)
LATE = replace(PAPER, velocity_feedforward=0.9, dead_time=0.0037, lead_time=0.0021)
FREE = Limits(float("inf"), float("inf"), float("inf"))
CUT = Cut(0.6, 80 / 60, 0.2, 0.04, 0.13, 1e-4)
MACHINES: dict[str, tuple[Machine, Cut]] = {
    "tangential": (RotaryKnife(0.4), CUT),
    "horizontal": (RotaryKnife(0.8, blades=2, sync="horizontal"), replace(CUT, length=0.5, sync_ratio=1.02)),
    "carriage": (LinearCarriage(0.9, home=-0.3), CUT),
    "crank": (CrankSlider(0.15, 0.6, 0.02, sync_at=1.2), replace(CUT, length=0.9, sync_zone=0.1, shear_zone_at=0.05)),
    "no width": (RotaryKnife(0.4), replace(CUT, shear_zone=0.0, shear_zone_at=0.11)),
}


def table(name: str, command: Command, share: float, *, robust: bool = False) -> tuple[ZoneTable, np.ndarray]:
    """Make a table, and unknowns of a command near the motion of even speed."""
    machine, cut = MACHINES[name]
    basis = command_basis(Task(machine, cut, FREE), command, robust=robust)
    travel = machine.pitch or cut.sync_zone
    unknowns = np.random.default_rng(4).normal(0.0, 0.01 * travel, size=(basis.matrix.shape[1],))
    axis = Axis(Task(machine, cut, FREE), LATE.at_speed(share), share)
    return ZoneTable(axis, basis, 0, zone_points(axis, basis.step)), unknowns


@pytest.mark.parametrize("name", MACHINES)
@pytest.mark.parametrize("command", ["in_sync", "shaped"])
@pytest.mark.parametrize("share", [1.0, 0.13, 0.002])
@pytest.mark.parametrize("robust", [False, True])
def test_rows_and_profile_are_judged_alike(name: str, command: Command, share: float, *, robust: bool) -> None:
    found, unknowns = table(name, command, share, robust=robust)
    profile = found._basis.profile(unknowns)
    points = np.arange(0, len(found.points.places), 5)
    rows = found.band_rows(points)
    slave = found.axis.ideal(found.points.places[points])[2]
    tool = found.axis.task.machine.tool
    errors = tool(slave + rows.matrix @ unknowns + rows.constant) - tool(slave)
    for tried in (Tried(profile), Tried(profile, unknowns)):  # of the profile, and of the rows
        assert np.abs(errors - found.errors(tried)[points]).max() <= 1e-11
        assert found.peak(tried) == found.last == np.abs(found.errors(tried)).max()


@pytest.mark.parametrize("name", MACHINES)
@pytest.mark.parametrize("command", ["in_sync", "shaped"])
def test_at_full_speed_its_points_are_those_of_all_phases(name: str, command: Command) -> None:
    found, unknowns = table(name, command, 1.0)
    profile = found._basis.profile(unknowns)
    places, times, errors = found.axis.zone_errors(profile)
    assert float(np.abs(found.errors(Tried(profile))).max()) == pytest.approx(float(np.abs(errors).max()), abs=1e-12)
    theirs = {(round(x, 9), round(t, 9)) for x, t in zip(places, times, strict=True)}
    assert {(round(x, 9), round(t, 9)) for x, t in zip(found.points.places, found.points.times, strict=True)} == theirs


@pytest.mark.parametrize("command", ["in_sync", "shaped"])
@pytest.mark.parametrize("robust", [False, True])
def test_a_slow_line_is_looked_at_where_it_matters(command: Command, *, robust: bool) -> None:
    found, unknowns = table("tangential", command, 0.1, robust=robust)
    profile = found._basis.profile(unknowns)
    every = float(np.abs(found.axis.zone_errors(profile)[2]).max())
    seen = float(np.abs(found.errors(Tried(profile))).max())
    assert len(found.points.places) < 0.2 * len(found.axis.zone_errors(profile)[0])
    assert 0.99 * every <= seen <= every * (1 + 1e-9)


@pytest.mark.parametrize("name", MACHINES)
@pytest.mark.parametrize("command", ["in_sync", "shaped"])
@pytest.mark.parametrize("robust", [False, True])
def test_rows_are_the_axis(name: str, command: Command, *, robust: bool) -> None:
    found, unknowns = table(name, command, 0.4, robust=robust)
    points = np.arange(0, len(found.points.places), 7)
    rows = found.band_rows(points)
    matrix, constant = found.axis.rows(found._basis.rows, found.points.places[points], found.points.times[points])
    ideal = found.axis.ideal(found.points.places[points])[0]
    assert np.abs(rows.matrix @ unknowns + rows.constant - (matrix @ unknowns + constant - ideal)).max() <= 1e-11
    low, high = found.axis.band(found.points.places[points], found.axis.task.cut.sync_tolerance)
    np.testing.assert_allclose(rows.low, low)
    np.testing.assert_allclose(rows.high, high)
    assert found.begun
    if found.axis.task.cut.shear_zone:
        slopes = found.ratio_rows(points)
        matrix, constant = found.axis.rows(
            found._basis.rows, found.points.places[points], found.points.times[points], 1
        )
        off = matrix @ unknowns + constant - found.axis.ideal(found.points.places[points])[1]
        assert np.abs(slopes.matrix @ unknowns + slopes.constant - off).max() <= 1e-9


def test_first_points_are_the_ends_and_places_between() -> None:
    found, _ = table("tangential", "shaped", 1.0)
    start, end = found.axis.shear_zone
    points = found.points.spread(6, 2)
    places = found.points.places[points]
    assert places.min() == start
    assert places.max() == end
    assert 12 <= len(points) <= 24
