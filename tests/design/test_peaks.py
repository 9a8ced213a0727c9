"""Peaks that the sync zone has, structures that could not be polished, and long cuts."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from camwright.design.optimise import solve
from camwright.profiles.cut import Cut
from camwright.profiles.limits import Limits
from camwright.profiles.machines import CrankSlider, LinearCarriage, RotaryKnife
from camwright.profiles.returns import assemble, quintic_between
from camwright.profiles.task import Task
from camwright.validation.bounds.optimality import lower_bound
from camwright.validation.motion import greatest_magnitude
from camwright.validation.motor import measure_motor

KNIFE = RotaryKnife(circumference=0.5, sync="horizontal")
THICK = Cut(0.52, 80 / 60, 0.5 / math.pi * math.sin(math.radians(20)), 0.01, 0.01, 1e-4)
CRANK = CrankSlider(
    crank=0.15, rod=0.6, crank_inertia=0.6, carriage_mass=60.0, gear_ratio=10.0, sync_at=math.radians(98)
)
SHEAR = Cut(0.9, 0.5, 0.15, 0.04, 0.08, 2e-4)


@pytest.mark.parametrize("objective", ["peak_acceleration", "peak_jerk"])
@pytest.mark.parametrize(("machine", "cut"), [(KNIFE, THICK), (CRANK, SHEAR)], ids=["knife", "crank"])
def test_a_peak_is_that_of_the_cycle(machine: RotaryKnife | CrankSlider, cut: Cut, objective: str) -> None:
    """One value everywhere: the zone's own, where that is the greatest."""
    task = Task(machine, cut, Limits(31.4, 400.0, 20_000.0))
    found = solve(task, objective)
    order = 2 if objective == "peak_acceleration" else 3
    assert found.minimised == pytest.approx(
        greatest_magnitude(found.profile, order).value * cut.line_speed**order, rel=1e-9
    )


def test_among_equal_peaks_the_motion_of_least_rms_acceleration_is_taken() -> None:
    """The zone is the peak; the quintic has the same and is 2.5 times as rough."""
    task = Task(KNIFE, THICK, Limits(200 / 60, 30.0, 3000.0))
    found = solve(task, "peak_acceleration")
    quintic = assemble(quintic_between(task.sync, THICK.return_zone, task.height), task)
    least = solve(task, "rms_acceleration").back
    assert found.back.mean_square(2) < 0.2 * quintic.restrict(0.0, THICK.return_zone).mean_square(2)
    assert found.back.mean_square(2) == pytest.approx(least.mean_square(2), rel=1e-2)


def test_a_carriage_whose_acceleration_and_stroke_bind_has_little_jerk() -> None:
    saw = LinearCarriage(stroke=1.668)
    cut = Cut(7.5865, 1.387, 0.6407, 0.1, 0.3, 1e-3)
    found = solve(Task(saw, cut, Limits(2.219, 1.9318, 78_642.0)), "rms_jerk")
    assert found.minimised < 8.3  # polished arcs alone end at 112
    assert found.minimised <= lower_bound(
        found.profile, Task(saw, cut, Limits(2.219, 1.9318, 78_642.0)), "rms_jerk"
    ).value * (1 + 4e-4)
    position = found.profile(np.linspace(0.0, cut.length, 20_001))
    assert position.max() - position.min() <= 1.668 * (1 + 1e-9)


def test_a_cut_of_12_m_is_measured_on_every_motion() -> None:
    """The quintic of such a cut turns round and round, and on one piece: its torque is smooth all the same."""
    task = Task(CRANK, replace(SHEAR, length=12.0), Limits(31.4, 400.0, 20_000.0))
    quintic = assemble(quintic_between(task.sync, task.cut.return_zone, task.height), task)
    motor = measure_motor(quintic, task)
    x = np.linspace(0.0, 12.0, 400_001)
    y = task.slave_at_start + quintic(x)
    torque = 0.25 * (CRANK.inertia(y) * quintic(x, 2) + CRANK.inertia_slope(y) * quintic(x, 1) ** 2 / 2) / 10.0
    assert motor.peak_torque == pytest.approx(np.abs(torque).max(), rel=1e-4)


@pytest.mark.parametrize("line_speed", [1e-4, 1e-2])
@pytest.mark.parametrize(
    ("machine", "cut"), [(RotaryKnife(0.376, blades=2, sync="horizontal"), None), (KNIFE, THICK), (CRANK, SHEAR)]
)
def test_a_least_peak_on_a_slow_line_joins_the_zone(
    machine: RotaryKnife | CrankSlider, cut: Cut | None, line_speed: float
) -> None:
    """Ramps as short as a jerk limit of powers of ten above the motion allows left the slope of the zone by more than rounding."""
    cut = cut or Cut(0.25, 0.6, 0.0409347, 0.015, 0.0259, 2e-4)
    task = Task(machine, replace(cut, line_speed=line_speed), Limits(31.4, 400.0, 20_000.0))
    found = solve(task, "peak_acceleration")
    jumps = np.abs(found.profile.jumps(2)).max()
    assert jumps <= 1e-10 * greatest_magnitude(found.profile, 2).value  # a tenth of what the check allows
    assert found.minimised <= lower_bound(found.profile, task, "peak_acceleration").value * (1 + 2e-5)
