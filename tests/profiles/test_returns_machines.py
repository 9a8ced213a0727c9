"""Baselines of every machine: the quintic between the ends of any sync zone, the tabulated crank of S3, the cycle's closure."""

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
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.returns import (
    BASELINES,
    baseline,
    baseline_names,
    quintic_between,
    tabulate_crank,
)
from camwright.profiles.task import Task

FREE = Limits(math.inf, math.inf, math.inf)
"""Nothing here asks for limits."""

CUT = Cut(0.9, 1.0, 0.1, 0.02, 0.07, 2e-4)
KNIFE, HORIZONTAL = RotaryKnife(0.8, blades=2), RotaryKnife(0.8, blades=2, sync="horizontal")
CARRIAGE, CRANK = LinearCarriage(0.6), CrankSlider(0.15, 0.6, sync_at=1.5)


@settings(deadline=None, max_examples=60)
@given(
    st.lists(st.floats(-3.0, 3.0), min_size=2, max_size=6),
    st.floats(0.01, 2.0),
    st.floats(0.01, 2.0),
    st.floats(-5.0, 5.0),
)
def test_quintic_meets_both_ends(powers: list[float], zone: float, length: float, height: float) -> None:
    sync = CamProfile.from_arrays([0.0, zone], [[0.0, *powers]])
    back = quintic_between(sync, length, height)
    size = (
        max(1.0, abs(height), *(abs(e.value) for order in range(3) for e in sync.extrema(order)))
        / min(1.0, length) ** 2
    )
    assert (back.pieces, back.degree) == (1, 5)
    assert float(back(0.0)) == 0.0
    assert float(back(length)) == pytest.approx(height, abs=1e-13 * size)
    for order in (1, 2):
        assert float(back(0.0, order)) == pytest.approx(float(sync(zone, order)), abs=1e-12 * size)
        assert float(back(length, order)) == pytest.approx(float(sync(0.0, order)), abs=1e-11 * size)


def test_quintic_between_straight_ends_is_the_law() -> None:
    sync = KNIFE.sync_profile(CUT)
    back = quintic_between(sync, 0.8, 0.3)
    law = baseline("poly_3_4_5", Task(KNIFE, CUT, FREE)).restrict(0.0, 0.8)
    x = np.linspace(0.0, 0.8, 101)
    assert np.abs(back(x) - law(x)).max() <= 1e-14


def test_which_machines_have_which_baselines() -> None:
    assert (Task(KNIFE, CUT, FREE).straight, Task(CARRIAGE, CUT, FREE).straight) == (True, True)
    assert (Task(HORIZONTAL, CUT, FREE).straight, Task(CRANK, CUT, FREE).straight) == (False, False)
    assert baseline_names(Task(KNIFE, CUT, FREE)) == BASELINES
    assert baseline_names(Task(HORIZONTAL, CUT, FREE)) == ("linear_return", "poly_3_4_5")
    assert baseline_names(Task(CRANK, CUT, FREE)) == ("linear_return", "poly_3_4_5", "crank_tabulated")
    with pytest.raises(
        InputError, match=r"no baseline 'cycloid' for this machine; the baselines are linear_return, poly_3_4_5$"
    ):
        baseline("cycloid", Task(HORIZONTAL, CUT, FREE))


@pytest.mark.parametrize(
    "machine", [KNIFE, HORIZONTAL, CARRIAGE, CRANK], ids=["tangential", "horizontal", "carriage", "crank"]
)
@pytest.mark.parametrize("origin", ["return", "cut"])
def test_every_baseline_closes(machine: Machine, origin: str) -> None:
    cut = replace(CUT, origin=origin, sync_ratio=1.02)
    for name in baseline_names(Task(machine, cut, FREE)):
        cycle = baseline(name, Task(machine, cut, FREE))
        assert (cycle.start, cycle.end) == (0.0, cut.length)
        assert cycle.advance == pytest.approx(machine.pitch, abs=1e-13)
        assert np.abs(cycle.jumps(0)).max() <= 1e-13
        if name != "linear_return":
            assert np.abs(cycle.jumps(1)).max() <= 1e-11
        assert np.diff(cycle.breaks).min() > 1e-9  # rounding leaves no sliver


@pytest.mark.parametrize("points", [360, 720])
def test_tabulated_crank_closes_runs_forwards_and_is_near_its_curve(points: int) -> None:
    quintic = baseline("poly_3_4_5", Task(CRANK, CUT, FREE))
    table = tabulate_crank(quintic, points)
    x = np.linspace(0.0, CUT.length, 5001)
    assert table.advance == pytest.approx(2 * math.pi, rel=1e-13)
    assert table.extrema(1)[0].value > 0.0
    assert np.abs(table.jumps(0)).max() <= 1e-13
    assert np.abs(table.jumps(1)).max() <= 1e-11  # the speed is interpolated
    # second order in the step of the table
    step = 2 * math.pi / points
    assert np.abs(table(x) - quintic(x)).max() <= step**2
    assert np.abs(table(x, 1) - quintic(x, 1)).max() <= 0.01 * quintic.extrema(1)[1].value


def test_tabulated_crank_gets_nearer_with_more_points() -> None:
    quintic = baseline("poly_3_4_5", Task(CRANK, CUT, FREE))
    x = np.linspace(0.0, CUT.length, 5001)
    errors = [np.abs(tabulate_crank(quintic, points)(x) - quintic(x)).max() for points in (360, 720, 1440)]
    assert errors[1] < 0.4 * errors[0]
    assert errors[2] < 0.4 * errors[1]
