"""The watch on IPOPT's multipliers: what it ends, and a design that took minutes without it."""

from __future__ import annotations

from time import process_time

import casadi as ca
import numpy as np
import pytest

from camwright.design.optimise import solve
from camwright.design.torque.watch import MOST_MULTIPLIER, MultiplierWatch
from camwright.profiles.cut import Cut
from camwright.profiles.limits import Limits
from camwright.profiles.machines import RotaryKnife
from camwright.profiles.task import Task
from camwright.validation.motor import measure_motor


@pytest.mark.parametrize("sign", [-1.0, 1.0])
@pytest.mark.parametrize(("multiplier", "ends"), [(0.0, 0), (0.9, 0), (1.1, 1), (np.inf, 1), (np.nan, 1)])
def test_it_ends_a_programme_whose_multipliers_run_away(multiplier: float, ends: int, sign: float) -> None:
    watch = MultiplierWatch(3, 2, 4)
    inputs = {"lam_g": [0.0, sign * multiplier * MOST_MULTIPLIER], "lam_x": [1e300] * 3}
    assert int(watch(**{name: ca.DM(value) for name, value in inputs.items()})[watch.name_out(0)]) == ends


@pytest.mark.slow
def test_a_peak_that_its_mesh_cannot_reach_costs_seconds_not_minutes() -> None:
    machine = RotaryKnife(
        circumference=1.7702563642732523,
        blades=2,
        gear_ratio=3.845618943092263,
        drum_inertia=0.0015699872719735807,
        drum_friction=0.12716058443635134,
    )
    cut = Cut(8.63680627577402, 0.10093873788534083, 0.36843512812796964, 0.0736870256, 0.2947481025, 0.00736870256)
    limits = Limits(0.8205224171374588, 2.3092963721775357, 11.635234602769936, reversal=True)
    task = Task(machine, cut, limits)
    begun = process_time()
    solution = solve(task, "peak_torque")
    assert process_time() - begun < 30.0
    measured = measure_motor(solution.profile, task.with_machine(solution.machine))
    assert measured.peak_torque is not None
    assert np.isfinite(measured.peak_torque)
