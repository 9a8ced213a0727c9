"""What every machine says about itself: sync in its own coordinate, drive train, inertia."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camwright.profiles.cut import Cut
from camwright.profiles.errors import InputError
from camwright.profiles.limits import Limits
from camwright.profiles.machines import (
    CrankSlider,
    LinearCarriage,
    Machine,
    RotaryKnife,
)
from camwright.profiles.returns import baseline
from camwright.profiles.task import Task
from camwright.validation.motion import sync_ratio_error

FREE = Limits(math.inf, math.inf, math.inf)
"""Nothing here asks for limits."""

CUT = Cut(0.9, 1.0, 0.1, 0.02, 0.07, 2e-4)
MACHINES = (
    RotaryKnife(0.4, blades=2, gear_ratio=5.0, drum_inertia=0.02, drum_friction=1.0),
    RotaryKnife(0.8, blades=2, gear_ratio=5.0, sync="horizontal", drum_inertia=0.02),
    LinearCarriage(0.6, home=0.2, mass=30.0, travel_per_turn=0.04),
    CrankSlider(0.15, 0.6, 0.02, 0.5, 20.0, 10.0, 1.5),
)


@pytest.mark.parametrize("machine", MACHINES, ids=lambda machine: type(machine).__name__)
@pytest.mark.parametrize("ratio", [1.0, 1.04])
def test_the_tool_moves_with_the_material_in_every_cycle(machine: Machine, ratio: float) -> None:
    for origin in ("return", "cut"):
        cut = replace(CUT, sync_ratio=ratio, origin=origin)
        cycle = baseline("poly_3_4_5", Task(machine, cut, FREE))
        assert sync_ratio_error(cycle, Task(machine, cut, FREE)).value <= 1e-9
        # by hand: the tool's travel over both ends of the zone; the next pitch is the next blade
        start, end = cut.sync_parts[-1]
        y = Task(machine, cut, FREE).slave_at_start - machine.pitch + cycle(np.linspace(start, end, 51))
        travel = machine.tool(y) - machine.tool(y[0])
        assert np.abs(travel - ratio * np.linspace(0.0, end - start, 51)).max() <= 1e-13


@pytest.mark.parametrize("machine", MACHINES, ids=lambda machine: type(machine).__name__)
def test_ratio_and_inertia_slope_are_derivatives(machine: Machine) -> None:
    step = 1e-6
    for y in np.linspace(-0.1, 0.1, 7):
        ratio = (machine.tool(y + step) - machine.tool(y - step)) / (2 * step)
        assert machine.tool_ratio(y) == pytest.approx(ratio, abs=1e-9)
        slope = (machine.inertia(y + step) - machine.inertia(y - step)) / (2 * step)
        assert machine.inertia_slope(y) == pytest.approx(slope, abs=1e-7)


def test_drive_trains() -> None:
    knife, _, carriage, crank = MACHINES
    assert knife.pitch == 0.2
    assert knife.motor_ratio * 0.4 == pytest.approx(5 * 2 * math.pi)  # one turn of the drum is five of the motor
    assert knife.inertia(0.0) == pytest.approx(0.02 / (0.4 / (2 * math.pi)) ** 2)
    assert knife.friction * 0.4 / (2 * math.pi) == pytest.approx(1.0)
    assert (carriage.pitch, carriage.turns_back) == (0.0, True)
    assert carriage.motor_ratio * 0.04 == pytest.approx(2 * math.pi)
    assert (crank.pitch, crank.motor_ratio, crank.slave_unit) == (2 * math.pi, 10.0, "rad")


@settings(deadline=None, max_examples=50)
@given(st.floats(0.1, 5.0), st.floats(0.01, 0.99), st.floats(0.9, 1.1), st.booleans())
def test_horizontal_sync_is_exact(circumference: float, share: float, ratio: float, at_cut: bool) -> None:
    knife = RotaryKnife(circumference, sync="horizontal")
    zone = knife.greatest_sync_zone(ratio) * share
    cut = Cut(zone + circumference, 1.0, zone, 0.0, 0.0, 1e-4, "cut" if at_cut else "return", ratio)
    sync = knife.sync_profile(cut)
    angle = (knife.sync_start(cut) + sync(np.linspace(0.0, zone, 201))) / knife.radius
    # the blade's horizontal speed over the line's
    assert np.abs(np.cos(angle) * sync(np.linspace(0.0, zone, 201), 1) / ratio - 1).max() <= 1e-9
    assert sync_ratio_error(baseline("poly_3_4_5", Task(knife, cut, FREE)), Task(knife, cut, FREE)).value <= 1e-9
    assert angle[-1] == pytest.approx(-angle[0], abs=1e-13)
    assert sync.advance == pytest.approx(2 * knife.radius * math.asin(ratio * zone / 2 / knife.radius), rel=1e-13)


def test_tangential_mismatch_is_what_horizontal_sync_makes_good() -> None:
    knife = RotaryKnife(0.4)
    cut = replace(CUT, sync_ratio=1.05, origin="cut")  # both machines count from the cut point
    half = 0.5 * 1.05 * 0.1 / knife.radius
    assert knife.tangential_mismatch(cut) == pytest.approx(1 - math.cos(half), rel=1e-12)
    horizontal = replace(knife, sync="horizontal")
    tangential = baseline("poly_3_4_5", Task(knife, cut, FREE))
    # judged as a horizontal knife, the tangential cycle is off by the mismatch at the ends of the zone
    assert sync_ratio_error(tangential, Task(horizontal, cut, FREE)).value == pytest.approx(
        knife.tangential_mismatch(cut), rel=1e-9
    )


def test_horizontal_sync_beyond_80_degrees_is_refused_with_the_longest_zone() -> None:
    knife = RotaryKnife(0.4, sync="horizontal")
    longest = 2 * knife.radius * math.sin(math.radians(80))
    knife.sync_start(replace(CUT, sync_zone=longest * (1 - 1e-12)))
    with pytest.raises(InputError, match=rf"beyond ±80° .* shorten it to {longest - 1e-6:.6f} m at most"):
        knife.sync_profile(replace(CUT, sync_zone=longest * 1.001))


def test_the_carriage_s_zone_lies_in_the_middle_of_the_stroke() -> None:
    carriage = LinearCarriage(0.6, home=0.2)
    cut = replace(CUT, sync_ratio=1.05)
    start = carriage.sync_start(cut)
    assert start - 0.2 == pytest.approx(0.8 - (start + 0.105), rel=1e-13)


def test_a_stroke_too_short_is_refused_with_what_is_needed() -> None:
    with pytest.raises(
        InputError,
        match=r"stroke = 0\.1 m: not above the 0\.105 m .* travels .* shorten sync zone to 0\.095238 m at most",
    ):
        LinearCarriage(0.1).sync_start(replace(CUT, sync_ratio=1.05))
