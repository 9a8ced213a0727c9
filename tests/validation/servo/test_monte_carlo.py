"""Many servos at once against the simulation of each servo by itself."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from camwright.profiles.cut import Cut
from camwright.profiles.errors import InputError
from camwright.profiles.limits import Limits
from camwright.profiles.machines import (
    CrankSlider,
    LinearCarriage,
    Machine,
    RotaryKnife,
)
from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.profiles.returns import baseline
from camwright.profiles.servo import PAPER_RANGES, Servo
from camwright.profiles.servo_tolerance import ServoTolerance
from camwright.profiles.task import Task
from camwright.validation.servo import monte_carlo
from camwright.validation.servo.monte_carlo import shear_zone_errors, worst_shear_zone_error
from camwright.validation.servo.response import servo_response

FREE = Limits(math.inf, math.inf, math.inf)
"""Nothing here asks for limits."""

KNIFE = RotaryKnife(0.4)
CUT = Cut(0.6, 80 / 60, 0.2, 0.04, 0.16, 1e-4)
PAPER = Servo(120.0, 0.7, 35.0, 0.004, 1.0)
RANGES = ServoTolerance((108.0, 132.0), (0.63, 0.77), (33.25, 36.75), (0.0038, 0.0042), (0.0, 0.002))
CRANK = CrankSlider(0.15, 0.6, 0.02, sync_at=1.2)


@pytest.mark.parametrize(
    ("machine", "cut", "law"),
    [
        (KNIFE, CUT, "poly_3_4_5"),
        (KNIFE, replace(CUT, origin="cut"), "linear_return"),
        (KNIFE, replace(CUT, shear_zone=0.0, shear_zone_at=0.13), "cycloid"),
        (KNIFE, replace(CUT, shear_zone=0.2, shear_zone_at=0.0), "modified_sine"),
        (RotaryKnife(0.8, blades=2, sync="horizontal"), replace(CUT, length=0.5), "poly_3_4_5"),
        (LinearCarriage(0.8), CUT, "poly_3_4_5"),
        (CRANK, replace(CUT, length=0.9, sync_zone=0.1, shear_zone_at=0.05), "poly_3_4_5"),
    ],
)
def test_errors_are_those_of_each_servo_by_itself(machine: Machine, cut: Cut, law: str) -> None:
    profile = baseline(law, Task(machine, cut, FREE))
    servo = replace(PAPER, velocity_feedforward=0.9, lead_time=0.003)
    drawn = RANGES.draw(servo, 20, 4)
    found = shear_zone_errors(profile, Task(machine, cut, FREE), drawn)
    alone = [servo_response(profile, Task(machine, cut, FREE), each).shear_zone_error for each in drawn]
    assert found.shape == (20,)
    assert np.abs(found - alone).max() <= 1e-9
    assert found.max() > 1e-6


def test_servos_of_all_the_published_ranges_go_together() -> None:
    ranges = ServoTolerance(**PAPER_RANGES, dead_time=(0.0, 0.02))
    drawn = ranges.draw(PAPER, 30, 11)
    profile = baseline("poly_3_4_5", Task(KNIFE, CUT, FREE))
    alone = [servo_response(profile, Task(KNIFE, CUT, FREE), each).shear_zone_error for each in drawn]
    assert np.abs(shear_zone_errors(profile, Task(KNIFE, CUT, FREE), drawn) - alone).max() <= 1e-9


def test_one_grid_for_all_is_as_good_as_one_for_each() -> None:
    profile = baseline("poly_3_4_5", Task(KNIFE, CUT, FREE))
    same = replace(RANGES, sample_time=(0.004, 0.004), dead_time=(0.001, 0.001)).draw(PAPER, 10, 2)
    together = shear_zone_errors(profile, Task(KNIFE, CUT, FREE), same)
    among = shear_zone_errors(profile, Task(KNIFE, CUT, FREE), [*same, replace(PAPER, sample_time=0.0037)])
    assert np.abs(together - among[:-1]).max() <= 1e-13


def test_how_they_are_grouped_changes_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    profile = baseline("cycloid", Task(KNIFE, CUT, FREE))
    drawn = RANGES.draw(PAPER, 12, 3)
    whole = shear_zone_errors(profile, Task(KNIFE, CUT, FREE), drawn)
    monkeypatch.setattr(monte_carlo, "_VALUES", 1)
    assert np.abs(shear_zone_errors(profile, Task(KNIFE, CUT, FREE), drawn) - whole).max() <= 1e-13


def test_a_servo_that_is_unstable_is_infinitely_far_off() -> None:
    profile = baseline("cycloid", Task(KNIFE, CUT, FREE))
    found = shear_zone_errors(profile, Task(KNIFE, CUT, FREE), [PAPER, replace(PAPER, position_gain=300.0), PAPER])
    assert math.isinf(found[1])
    assert (
        found[0]
        == found[2]
        == pytest.approx(servo_response(profile, Task(KNIFE, CUT, FREE), PAPER).shear_zone_error, abs=1e-12)
    )


def test_no_servos_have_no_errors() -> None:
    assert shear_zone_errors(baseline("cycloid", Task(KNIFE, CUT, FREE)), Task(KNIFE, CUT, FREE), []).shape == (0,)


def test_a_servo_that_hardly_forgets_is_refused() -> None:
    with pytest.raises(InputError, match=r"remembers \d+ samples .* cannot follow; raise the position gain"):
        shear_zone_errors(
            baseline("cycloid", Task(KNIFE, CUT, FREE)), Task(KNIFE, CUT, FREE), [replace(PAPER, position_gain=0.01)]
        )


def test_a_profile_of_another_cut_is_refused() -> None:
    with pytest.raises(InputError, match="but one cycle of this cut runs"):
        shear_zone_errors(
            baseline("cycloid", Task(KNIFE, CUT, FREE)), Task(KNIFE, replace(CUT, length=0.5), FREE), [PAPER]
        )


def test_the_worst_servo_is_that_of_all_phases(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(monte_carlo, "_LOOKED", 8)
    task = Task(KNIFE, CUT, FREE)
    for law in ("linear_return", "poly_3_4_5"):
        profile, drawn = baseline(law, task), RANGES.draw(PAPER, 300, 4)
        every = shear_zone_errors(profile, task, drawn)
        assert worst_shear_zone_error(profile, task, drawn) == pytest.approx(every.max(), rel=1e-12)
    assert worst_shear_zone_error(profile, task, (replace(PAPER, position_gain=1e4), *drawn)) == math.inf


@pytest.mark.parametrize(
    ("machine", "cut", "spread", "seed", "before", "run"),
    [
        (KNIFE, CUT, 1e-2, 1, 0, 1),  # the worst is the one that is so roughly
        (KNIFE, CUT, 3e-3, 2, 1, 3),  # it is the second
        (CRANK, replace(CUT, length=0.9, sync_zone=0.1, shear_zone_at=0.05), 1e-3, 1, 13, 100),  # all are alike
    ],
)
def test_servos_that_are_run_roughly_first_have_the_worst_of_all(
    machine: Machine, cut: Cut, spread: float, seed: int, before: int, run: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The naive twin runs each in full, by itself. A servo that looks less bad roughly than others may be the worst in full."""
    bandwidth, damping, gain, sample = (
        (each * (1 - spread), each * (1 + spread)) for each in (120.0, 0.7, 35.0, 0.004)
    )
    about = ServoTolerance(bandwidth, damping, gain, sample, (0.0, 0.0))
    task = Task(machine, cut, FREE)
    profile, drawn = baseline("linear_return", task), about.draw(PAPER, 100, seed)
    every = np.array([servo_response(profile, task, each).shear_zone_error for each in drawn])
    roughly = monte_carlo._greatest_errors(profile, task, drawn, *monte_carlo._ROUGHLY)
    assert int((roughly > roughly[every.argmax()]).sum()) == before
    looked: list[Servo] = []

    def full(profile: CamProfile, task: Task, servos: Sequence[Servo]) -> FloatArray:
        looked.extend(servos)
        return shear_zone_errors(profile, task, servos)

    monkeypatch.setattr(monte_carlo, "shear_zone_errors", full)
    monkeypatch.setattr(monte_carlo, "_LOOKED", 1)
    assert worst_shear_zone_error(profile, task, drawn) == pytest.approx(every.max(), rel=1e-9)
    assert len(looked) == run


@pytest.mark.parametrize(
    ("machine", "law", "line_speed", "ahead"),
    [
        (KNIFE, "linear_return", 0.02, 0.0),
        (KNIFE, "poly_3_4_5", 1e-4, 0.06),
        (RotaryKnife(0.8, blades=2, sync="horizontal"), "poly_3_4_5", 1e-3, 0.0),
        (LinearCarriage(0.8), "cycloid", 0.02, 0.06),
        (CRANK, "poly_3_4_5", 0.02, 0.0),
    ],
)
def test_the_worst_servo_on_a_slow_line_is_found_at_a_few_places(
    machine: Machine, law: str, line_speed: float, ahead: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It was looked for in the whole shear zone of each of ten thousand servos: minutes at 0.1 mm/s."""
    monkeypatch.setattr(monte_carlo, "_LOOKED_SLOW", 4)
    cut = replace(CUT, length=0.7, line_speed=line_speed, sync_zone=0.1, shear_zone=0.04, shear_zone_at=ahead)
    task = Task(machine, cut, FREE)
    profile = baseline(law, task)
    drawn = replace(RANGES, sample_time=(0.001, 0.002)).draw(replace(PAPER, velocity_feedforward=0.9), 24, 4)
    assert len(monte_carlo._shown_parts(profile, task, drawn)) > 1
    every = shear_zone_errors(profile, task, drawn)
    assert worst_shear_zone_error(profile, task, drawn) == pytest.approx(every.max(), rel=1e-6, abs=1e-11)


def test_a_slow_line_with_an_unstable_servo_has_no_bound() -> None:
    task = Task(KNIFE, replace(CUT, line_speed=1e-4), FREE)
    unstable = replace(PAPER, position_gain=300.0)
    assert math.isinf(worst_shear_zone_error(baseline("cycloid", task), task, [unstable, PAPER]))
    assert math.isinf(worst_shear_zone_error(baseline("cycloid", task), task, [unstable]))
