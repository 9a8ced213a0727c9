"""The published returns, and how a return and a sync zone make a cycle."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from camwright.profiles.cut import Cut
from camwright.profiles.errors import InputError
from camwright.profiles.laws import LAWS, law
from camwright.profiles.limits import Limits
from camwright.profiles.machines import RotaryKnife
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.returns import (
    BASELINES,
    assemble,
    baseline,
    law_return,
)
from camwright.profiles.task import Task

FREE = Limits(math.inf, math.inf, math.inf)
"""Nothing here asks for limits."""

KNIFE = RotaryKnife(0.4)
CUT = Cut(0.6, 80 / 60, 0.2, 0.04, 0.16, 1e-4)


@st.composite
def jobs(draw: st.DrawFn) -> tuple[RotaryKnife, Cut]:
    circumference = draw(st.floats(0.1, 2.0))
    length = circumference * draw(st.floats(0.4, 3.0))
    sync = min(length, circumference) * draw(st.floats(0.05, 0.9))
    origin = draw(st.sampled_from(["return", "cut"]))
    return RotaryKnife(circumference), Cut(length, 1.0, sync, 0.0, 0.0, 1e-4, origin)


def test_baselines_are_the_linear_return_and_all_laws() -> None:
    assert set(BASELINES) == {"linear_return"} | set(LAWS) - {"linear"}


@pytest.mark.parametrize("name", LAWS)
@given(st.floats(0.05, 5), st.floats(0.05, 5), st.floats(0.2, 2))
def test_placed_law_is_the_line_and_the_law(name: str, length: float, height: float, ratio: float) -> None:
    back = law_return(name, length, height, ratio)
    x = np.linspace(0.0, length, 201)
    expected = ratio * x + (height - ratio * length) * law(name)(np.clip(x / length, 0.0, 1.0))
    assert back.end == length
    assert np.abs(back(x) - expected).max() <= 1e-12 * (height + ratio * length)
    assert back.advance == pytest.approx(height, rel=1e-12, abs=1e-12 * ratio * length)


def test_linear_return_is_that_of_the_paper() -> None:
    """``Y = k X`` with ``k = (y_c - l_s) / (x_c - l_s)``, then ``Y = X - x_c + y_c``; cycle after cycle."""
    cycle = baseline("linear_return", Task(KNIFE, CUT, FREE))
    for n in range(3):
        t = np.linspace(0.0, 0.6, 601)
        y = np.where(t <= 0.4, 0.5 * t, t - 0.6 + 0.4) + 0.4 * n
        assert np.abs(cycle(t + 0.6 * n, outside="repeat") - y).max() <= 1e-14
    assert cycle.jumps(1) == pytest.approx([0.5, -0.5], abs=1e-14)


@pytest.mark.parametrize("name", BASELINES)
@given(jobs())
def test_every_baseline_is_a_closed_cycle_in_sync(name: str, job: tuple[RotaryKnife, Cut]) -> None:
    machine, cut = job
    cycle = baseline(name, Task(machine, cut, FREE))
    assert (cycle.start, cycle.end) == (0.0, pytest.approx(cut.length, rel=1e-12))
    assert float(cycle(0.0)) == 0.0
    assert cycle.advance == pytest.approx(machine.pitch, rel=1e-12)
    assert np.abs(cycle.jumps(0)).max() <= 1e-12
    if name != "linear_return":
        assert np.abs(cycle.jumps(1)).max() <= 1e-10
    for start, end in cut.sync_parts:
        x = np.linspace(start, end, 50)[1:-1]
        assert np.abs(cycle(x, 1) - 1.0).max() <= 1e-12
        assert np.abs(cycle(x, 2)).max() == 0.0


@pytest.mark.parametrize("name", BASELINES)
def test_the_origin_only_moves_the_cycle(name: str) -> None:
    """From mid sync zone, the cycle is the one from the start of the return, 0.1 m later."""
    from_return, from_cut = (
        baseline(name, Task(KNIFE, CUT, FREE)),
        baseline(name, Task(KNIFE, replace(CUT, origin="cut"), FREE)),
    )
    x = np.linspace(0.0, 0.6, 601)[1:-1]
    moved = from_return(x + 0.5, outside="repeat") - float(from_return(0.5))
    assert np.abs(from_cut(x) - moved).max() <= 1e-13


def test_a_return_and_the_sync_zone_make_the_cycle() -> None:
    back = CamProfile.from_arrays([0.0, 0.1, 0.4], [[0.0, 1.0], [0.1, 1.0 / 3.0]])
    cycle = assemble(back, Task(KNIFE, CUT, FREE))
    assert cycle.breaks.tolist() == [0.0, 0.1, 0.4, 0.6]
    x = np.linspace(0.0, 0.4, 101)
    assert np.abs(cycle(x) - back(x)).max() <= 1e-16
    assert cycle.advance == pytest.approx(0.4, rel=1e-15)


def test_unknown_baseline_is_refused() -> None:
    with pytest.raises(InputError, match=r"no baseline 'linear'.*; the baselines are linear_return, parabolic"):
        baseline("linear", Task(KNIFE, CUT, FREE))
