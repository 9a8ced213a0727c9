"""The energy of a carriage without friction is that of its speeds."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import pytest

from camwright import load_job, optimise
from camwright.profiles.machines import LinearCarriage

SAW = Path(__file__).parents[2] / "examples" / "flying-saw.toml"


def test_a_carriage_draws_the_energy_of_its_two_runs_from_rest() -> None:
    job = replace(load_job(SAW), objective="peak_acceleration")
    assert isinstance(job.machine, LinearCarriage)
    design = optimise(job)
    motor = design.comparison["optimised"].motor
    assert motor.energy is not None
    assert motor.peak_speed is not None
    back = motor.peak_speed * job.machine.travel_per_turn / (2 * math.pi)
    drawn = 0.5 * job.machine.mass * (back**2 + job.cut.line_speed**2)
    assert motor.energy == pytest.approx(drawn, rel=1e-12)
    assert motor.regenerated == pytest.approx(drawn, rel=1e-12)
