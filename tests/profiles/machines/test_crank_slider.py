"""The crank-slider: its map against automatic differentiation, its inverse, its sync zone and its designs."""

from __future__ import annotations

import math
from dataclasses import replace

import casadi as ca
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from camwright.design.optimise import solve
from camwright.profiles.cut import Cut
from camwright.profiles.errors import InputError
from camwright.profiles.limits import Limits
from camwright.profiles.machines import CrankSlider
from camwright.profiles.returns import baseline
from camwright.profiles.task import Task
from camwright.validation.motion import sync_ratio_error
from camwright.validation.motor import measure_motor

ca.GlobalOptions.setNumpyMode(1)

CRANK = CrankSlider(crank=0.15, rod=0.6, crank_inertia=0.5, carriage_mass=20.0)
CUT = Cut(0.9, 1.0, 0.1, 0.02, 0.07, 2e-4)
LIMITS = Limits(300 * math.pi / 30, 2000.0, 50_000.0)
TURN = np.linspace(-math.pi, 2 * math.pi, 1001)


def any_crank(rng: np.random.Generator) -> tuple[CrankSlider, Cut]:
    """Draw a crank with its sync zone placed anywhere between the dead centres, with offset and sync ratio."""
    crank = float(rng.uniform(0.05, 0.4))
    offset = crank * float(rng.uniform(-0.9, 0.9))
    machine = CrankSlider(crank, (crank + abs(offset)) * float(rng.uniform(1.1, 6.0)), offset)
    ratio = float(rng.uniform(0.9, 1.1))
    zone = machine.stroke / ratio * float(rng.uniform(0.02, 0.8))
    origin = ("return", "cut")[int(rng.integers(2))]
    cut = Cut(zone * float(rng.uniform(1.3, 10.0)), 1.0, zone, 0.0, 0.5 * zone, 1e-4, origin, ratio)
    least, greatest = machine.place_range(cut)
    return replace(machine, sync_at=least + (greatest - least) * float(rng.uniform(0.05, 0.95))), cut


@pytest.mark.parametrize("offset", [0.0, 0.04, -0.3])
def test_map_and_derivatives_against_automatic_differentiation(offset: float) -> None:
    crank = replace(CRANK, offset=offset, rod=0.6)
    angle = ca.SX.sym("angle")
    position = crank.tool(angle)
    slope = ca.jacobian(position, angle)
    bend = ca.jacobian(slope, angle)
    truth = ca.Function("crank", [angle], [position, slope, bend])
    for a in TURN:
        x, dx, ddx = (float(part) for part in truth(a))
        assert crank.tool(a) == pytest.approx(x, abs=1e-12)
        assert crank.tool_ratio(a) == pytest.approx(dx, abs=1e-12)
        assert crank.tool_curvature(a) == pytest.approx(ddx, abs=1e-12)


def test_inertia_and_its_slope_against_automatic_differentiation() -> None:
    angle = ca.SX.sym("angle")
    inertia = CRANK.inertia(angle)
    truth = ca.Function("inertia", [angle], [inertia, ca.jacobian(inertia, angle)])
    for a in TURN[::10]:
        value, slope = (float(part) for part in truth(a))
        assert CRANK.inertia(a) == pytest.approx(value, abs=1e-12)
        assert CRANK.inertia_slope(a) == pytest.approx(slope, abs=1e-12)


def test_map_is_the_rod_s_length() -> None:
    """Naive twin: crank pin and carriage are one rod's length apart."""
    crank = replace(CRANK, offset=0.04)
    pin = np.stack([-crank.crank * np.cos(TURN), crank.crank * np.sin(TURN) - crank.offset])
    carriage = np.stack([crank.tool(TURN), np.zeros_like(TURN)])
    assert np.abs(np.hypot(*(carriage - pin)) - crank.rod).max() <= 1e-15


@pytest.mark.parametrize("offset", [0.0, 0.04, -0.2])
def test_dead_centres_are_where_the_carriage_turns(offset: float) -> None:
    crank = replace(CRANK, offset=offset)
    back, front = crank.dead_centres
    assert abs(crank.tool_ratio(back)) <= 1e-15
    assert abs(crank.tool_ratio(front)) <= 1e-15
    assert crank.tool(back) == pytest.approx(math.sqrt((crank.rod - crank.crank) ** 2 - offset**2), rel=1e-14)
    assert crank.tool(front) == pytest.approx(math.sqrt((crank.rod + crank.crank) ** 2 - offset**2), rel=1e-14)
    assert crank.stroke == pytest.approx(np.ptp(crank.tool(np.linspace(0, 2 * math.pi, 100_001))), rel=1e-8)
    assert (crank.tool_ratio(np.linspace(back, front, 1001)[1:-1]) > 0).all()


@settings(deadline=None, max_examples=60)
@given(st.integers(0, 2**31))
def test_angle_at_is_the_inverse_of_the_map(seed: int) -> None:
    crank, _ = any_crank(np.random.default_rng(seed))
    back, front = crank.dead_centres
    angle = np.linspace(back, front, 101)[1:-1]
    found = crank.angle_at(crank.tool(angle))
    assert ((back < found) & (found < front)).all()
    assert np.abs(crank.tool(found) - crank.tool(angle)).max() <= 1e-15
    assert np.abs((found - angle) * crank.tool_ratio(angle)).max() <= 1e-15


@pytest.mark.parametrize("shape", [(0.15, 0.6, 0.0), (0.15, 0.6, 0.05), (0.2, 0.35, -0.1), (0.3, 0.5, 0.15)])
def test_the_inverse_map_takes_few_steps(shape: tuple[float, float, float], monkeypatch: pytest.MonkeyPatch) -> None:
    crank, asked = CrankSlider(*shape), []
    back, front = crank.dead_centres
    angle = back + (front - back) * np.linspace(1e-3, 1 - 1e-3, 4001)
    position, forward = crank.tool(angle), CrankSlider.tool

    def counted(machine: CrankSlider, y: np.ndarray) -> np.ndarray:
        asked.append(y)
        return np.asarray(forward(machine, y))

    monkeypatch.setattr(CrankSlider, "tool", counted)
    found = crank.angle_at(position)
    assert np.abs(forward(crank, found) - position).max() <= 1e-15
    assert len(asked) <= 5


def test_the_inverse_map_ends_at_a_dead_centre_for_positions_out_of_reach() -> None:
    crank = CrankSlider(0.2, 0.35, -0.1)
    back, front = crank.dead_centres
    reach = np.array([float(crank.tool(back)), float(crank.tool(front))])
    found = crank.angle_at(np.array([0.0, reach[0] - 1e-3, reach[1] + 1e-3, 10.0]))
    np.testing.assert_allclose(found, [back, back, front, front], rtol=0, atol=1e-12)


def test_carriage_moves_with_the_material_on_200_random_cranks() -> None:
    rng = np.random.default_rng(3)
    for _ in range(200):
        crank, cut = any_crank(rng)
        cycle = baseline("poly_3_4_5", Task(crank, cut, LIMITS))
        # independent road: the carriage's position by the map itself, and its ratio by the map's derivative
        start = crank.sync_start(cut)
        sync = crank.sync_profile(cut)
        x = np.linspace(0.0, cut.sync_zone, 101)
        angle = start + sync(x)
        assert np.abs(crank.tool(angle) - crank.tool(start) - cut.sync_ratio * x).max() <= 1e-12 * crank.stroke
        assert np.abs(crank.tool_ratio(angle) * sync(x, 1) / cut.sync_ratio - 1).max() <= 1e-9
        assert sync_ratio_error(cycle, Task(crank, cut, LIMITS)).value <= 1e-9
        # the middle of the zone is where it was asked for
        middle = crank.tool(start) + 0.5 * cut.sync_ratio * cut.sync_zone
        assert crank.tool(crank.sync_at) == pytest.approx(middle, abs=1e-12)


def test_a_sync_zone_at_the_wrong_place_is_found_out() -> None:
    crank = replace(CRANK, sync_at=1.4)
    cycle = baseline("poly_3_4_5", Task(crank, CUT, LIMITS))
    assert sync_ratio_error(cycle, Task(crank, CUT, LIMITS)).value <= 1e-12
    assert sync_ratio_error(cycle, Task(replace(crank, sync_at=1.5), CUT, LIMITS)).value > 1e-3


def test_cycles_of_both_origins_are_the_same_motion() -> None:
    crank = replace(CRANK, sync_at=1.5)
    other = replace(CUT, origin="cut")
    here, there = baseline("poly_3_4_5", Task(crank, CUT, LIMITS)), baseline("poly_3_4_5", Task(crank, other, LIMITS))
    x = np.linspace(0.0, 0.8, 50)
    position = crank.tool(Task(crank, CUT, LIMITS).slave_at_start + here(x))
    assert np.abs(crank.tool(Task(crank, other, LIMITS).slave_at_start + there(x + 0.05)) - position).max() <= 1e-14


@pytest.mark.parametrize("objective", ["rms_jerk", "rms_torque"])
def test_the_designed_crank_never_turns_back_and_is_in_sync(objective: str) -> None:
    found = solve(Task(CRANK, CUT, LIMITS), objective)
    assert isinstance(found.machine, CrankSlider)
    least, greatest = CRANK.place_range(CUT)
    assert least < found.machine.sync_at < greatest
    assert found.profile.extrema(1)[0].value >= 0.0
    assert found.profile.advance == pytest.approx(2 * math.pi, rel=1e-13)
    assert sync_ratio_error(found.profile, Task(found.machine, CUT, LIMITS)).value <= 1e-9
    if objective == "rms_torque":  # at least 15 % below the table of S3 made from a quintic return
        table = measure_motor(
            baseline("crank_tabulated", Task(found.machine, CUT, LIMITS)), Task(found.machine, CUT, LIMITS)
        )
        assert measure_motor(found.profile, Task(found.machine, CUT, LIMITS)).rms_torque <= 0.85 * table.rms_torque


def test_a_place_not_chosen_yet_is_refused() -> None:
    with pytest.raises(InputError, match=r"not chosen yet; design the job first, or give sync at"):
        CRANK.sync_start(CUT)


def test_a_sync_zone_longer_than_the_stroke_is_refused_with_the_longest() -> None:
    crank = replace(CRANK, sync_at=1.5)
    with pytest.raises(
        InputError, match=r"sync zone = 0.31 m: .* stroke of 0.3 m; shorten the sync zone to 0.299999 m at most"
    ):
        crank.sync_start(replace(CUT, sync_zone=0.31))


def test_a_place_too_near_a_dead_centre_is_refused_with_the_range() -> None:
    with pytest.raises(
        InputError, match=r"sync at = 0\.1 rad: leaves no room .* between 0\.94797 rad and 2\.38356 rad"
    ):
        replace(CRANK, sync_at=0.1).sync_start(CUT)
