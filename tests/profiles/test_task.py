"""What follows from a machine, a cut and limits: closed forms, and the machine's own words."""

from __future__ import annotations

import math
from dataclasses import FrozenInstanceError, replace

import pytest

from camwright.profiles.cut import Cut
from camwright.profiles.errors import InputError
from camwright.profiles.limits import Limits
from camwright.profiles.machines import CrankSlider, LinearCarriage, RotaryKnife
from camwright.profiles.returns import baseline
from camwright.profiles.task import Task

LIMITS = Limits(3.0, 30.0, 3000.0)
CUT = Cut(0.6, 1.5, 0.2, 0.04, 0.13, 1e-4)
KNIFE = Task(RotaryKnife(0.8, blades=2), replace(CUT, sync_ratio=1.02), LIMITS)
SAW = Task(LinearCarriage(0.9, home=-0.3), CUT, LIMITS)
CRANK = Task(
    CrankSlider(0.15, 0.6, 0.02, sync_at=1.2), replace(CUT, length=0.9, sync_zone=0.1, shear_zone_at=0.05), LIMITS
)
FREE = CRANK.with_machine(CrankSlider(0.15, 0.6, 0.02))
ALL = pytest.mark.parametrize("task", [KNIFE, SAW, CRANK], ids=["knife", "saw", "crank"])


def test_a_task_cannot_be_changed_and_equals_its_like() -> None:
    with pytest.raises(FrozenInstanceError):
        KNIFE.cut = CUT  # type: ignore[misc]
    other = Task(RotaryKnife(0.8, blades=2), replace(CUT, sync_ratio=1.02), Limits(3.0, 30.0, 3000.0))
    assert KNIFE.sync.advance == pytest.approx(1.02 * 0.2)  # what is kept has no part in it
    assert other == KNIFE
    assert hash(other) == hash(KNIFE)
    assert other.at_speed(1.0) != KNIFE


def test_height_is_what_the_sync_zone_leaves_of_the_pitch() -> None:
    assert KNIFE.height == pytest.approx(0.4 - 1.02 * 0.2, abs=1e-15)
    assert SAW.height == pytest.approx(-0.2, abs=1e-15)  # it comes back
    assert CRANK.height == pytest.approx(2 * math.pi - CRANK.machine.sync_profile(CRANK.cut).advance, abs=1e-14)


def test_the_ratio_of_a_crank_alone_changes_in_sync() -> None:
    assert KNIFE.straight
    assert SAW.straight
    assert not CRANK.straight
    assert not Task(RotaryKnife(0.8, sync="horizontal"), CUT, LIMITS).straight


@ALL
def test_the_return_starts_where_the_sync_zone_ends(task: Task) -> None:
    machine, cut = task.machine, task.cut
    along = float(machine.tool(task.slave_at_sync_end)) - float(machine.tool(task.slave_at_sync_start))
    assert along == pytest.approx(cut.sync_ratio * cut.sync_zone, abs=1e-10)
    assert task.from_return().slave_at_start == task.slave_at_sync_end


@ALL
def test_a_cycle_from_the_cut_starts_at_mid_sync_zone(task: Task) -> None:
    machine, cut = task.machine, replace(task.cut, origin="cut")
    along = float(machine.tool(task.with_cut(cut).slave_at_start)) - float(machine.tool(task.slave_at_sync_start))
    assert along == pytest.approx(0.5 * cut.sync_ratio * cut.sync_zone, abs=1e-10)


@ALL
def test_slave_zero_does_not_depend_on_what_the_profile_counts_from(task: Task) -> None:
    cycle = baseline("poly_3_4_5", task)
    assert task.slave_zero(cycle) == task.slave_at_start
    assert task.slave_zero(cycle.shift(slave=0.25)) == pytest.approx(task.slave_at_start - 0.25, abs=1e-15)
    shaped = task.with_cut(replace(task.cut, shaped=True))
    assert shaped.slave_zero(cycle.shift(slave=0.25)) == task.slave_at_start


def test_least_velocity_depends_on_reversal_and_on_a_machine_that_comes_back() -> None:
    assert (KNIFE.reverses, KNIFE.least_velocity) == (False, 0.0)
    swinging = KNIFE.with_limits(replace(LIMITS, reversal=True))
    assert (swinging.reverses, swinging.least_velocity) == (True, -3.0)
    assert (SAW.reverses, SAW.least_velocity) == (True, -3.0)


@pytest.mark.parametrize("speed", [0.1, 1.5, 20.0])
def test_limits_over_the_master_are_those_over_time_by_powers_of_the_line_speed(speed: float) -> None:
    task = SAW.at_speed(speed)
    assert task.least_ratio * speed == pytest.approx(-3.0)
    assert task.greatest_ratio * speed == pytest.approx(3.0)
    assert task.greatest_slope * speed**2 == pytest.approx(30.0)
    assert task.greatest_jerk * speed**3 == pytest.approx(3000.0)


def test_each_change_leaves_the_rest() -> None:
    assert KNIFE.at_speed(2.0) == replace(KNIFE, cut=replace(KNIFE.cut, line_speed=2.0))
    assert KNIFE.with_length(0.5) == replace(KNIFE, cut=replace(KNIFE.cut, length=0.5))
    assert KNIFE.with_machine(SAW.machine) == Task(SAW.machine, KNIFE.cut, LIMITS)
    assert KNIFE.with_cut(CUT) == Task(KNIFE.machine, CUT, LIMITS)
    tight = Limits(2.0, 20.0, 2000.0)
    assert KNIFE.with_limits(tight) == Task(KNIFE.machine, KNIFE.cut, tight)
    from_cut = KNIFE.with_cut(replace(KNIFE.cut, origin="cut"))
    assert from_cut.from_return() == KNIFE
    assert KNIFE.with_length(0.5).sync == KNIFE.sync  # nothing of another cut is kept
    assert KNIFE.with_cut(replace(CUT, sync_zone=0.1)).sync.advance == pytest.approx(0.1)


def test_a_free_sync_zone_is_placed_in_the_middle_or_where_it_is_told() -> None:
    least, greatest = FREE.machine.place_range(FREE.cut)
    assert FREE.placed_midway().machine == CrankSlider(0.15, 0.6, 0.02, sync_at=0.5 * (least + greatest))
    assert FREE.placed_at(1.2) == CRANK
    with pytest.raises(InputError):
        _ = FREE.slave_at_sync_start
    long = FREE.with_cut(replace(FREE.cut, sync_zone=0.4))
    with pytest.raises(InputError):
        long.placed_midway()
