"""What is promised of every designed cam, on the job whose optimum is a formula."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from camwright import Design, load_job, optimise
from camwright.design.place import place_sync
from camwright.profiles.cut import Cut
from camwright.profiles.limits import Limits
from camwright.profiles.machines import CrankSlider
from camwright.profiles.task import Task

FREE = Limits(math.inf, math.inf, math.inf)
"""Nothing here asks for limits."""


@pytest.fixture(scope="module")
def design() -> Design:
    return optimise(load_job())


def test_the_objective_is_the_optimum_to_a_millionth(design: Design) -> None:
    # from rest to rest over h in T, jerk J, the acceleration a trapezoid: h = A (T/2 - A/J) T/2
    height, time, jerk = 0.2, 0.4 / (80 / 60), 3000.0
    optimum = jerk / 2 * (time / 2 - math.sqrt(time**2 / 4 - 8 * height / (time * jerk)))
    assert design.objective == pytest.approx(optimum, rel=1e-6)
    assert design.bound.value <= optimum * (1 + 1e-12)
    assert design.gap >= -1e-9


def test_limits_are_drawn_in(design: Design) -> None:
    peak = design.report.motion.peak_jerk
    assert peak is not None
    assert 1 - 3e-10 < peak / 3000.0 < 1 - 1e-10


def test_sync_travel_and_joins(design: Design) -> None:
    profile = design.profile
    in_sync = profile(np.linspace(0.4, 0.6, 2001), 1)
    assert np.abs(in_sync - 1.0).max() <= 1e-12
    assert abs(profile.advance - 0.4) <= 1e-12 * 0.4
    inner = profile.breaks[1:-1]
    before, after = np.nextafter(inner, 0.0), inner
    peak = float(np.abs(profile(np.linspace(0.0, 0.6, 6001), 2)).max())
    for order, allowed in ((0, 1e-12 * 0.6), (1, 1e-9), (2, 1e-9 * peak)):
        jumps = np.abs(profile(after, order) - profile(before, order))
        seam = abs(float(profile(profile.end, order) - profile(profile.start, order)))
        assert jumps.max() <= allowed
        assert order == 0 or seam <= allowed


def test_the_sync_zone_is_looked_for_at_nine_places_and_found_to_two_thousandths() -> None:
    """A cost with a narrow valley between the first and the second of nine places, which fewer places do not lead to."""
    machine, cut = CrankSlider(0.15, 0.6), Cut(0.9, 0.5, 0.1, 0.04, 0.0, 1e-4)
    least, greatest = machine.place_range(cut)
    margin = 0.02 * (greatest - least)
    places = np.linspace(least + margin, greatest - margin, 9)
    asked: list[float] = []
    valley = places[1]

    def cost(task: Task) -> float:
        placed = task.machine
        assert isinstance(placed, CrankSlider)
        asked.append(placed.sync_at)
        off = abs(placed.sync_at - valley)
        return off if off < 0.4 * (places[1] - places[0]) else 10.0 - 0.1 * abs(placed.sync_at - places[5])

    found = place_sync(Task(machine, cut, FREE), cost)
    assert found is not None
    assert isinstance(found.task.machine, CrankSlider)
    assert asked[:9] == pytest.approx(list(places), abs=1e-12)
    assert abs(found.task.machine.sync_at - valley) <= 2e-3


def test_a_servo_aware_design_predicts_the_simulated_error(tmp_path: Path) -> None:
    file = tmp_path / "aware.toml"
    aware = '[objective]\nservo_aware = true\ncommand = "shaped"'
    file.write_text(load_job().text.replace("[objective]", aware), encoding="utf-8")
    found = optimise(load_job(file)).axis
    assert found is not None
    assert found.phases == 16
    assert abs(found.designed_error - found.simulated_error) <= 1e-9
