"""The watch on IPOPT's multipliers: what it ends, and a design that took minutes without it."""

from __future__ import annotations

from time import process_time

import casadi as ca
import numpy as np
import pytest

from camwright.design.optimise import solve
from camwright.design.torque.watch import MOST_AT_FIRST, MOST_MULTIPLIER, MultiplierWatch
from camwright.profiles.cut import Cut
from camwright.profiles.limits import Limits
from camwright.profiles.machines import RotaryKnife
from camwright.profiles.task import Task
from camwright.validation.motor import measure_motor
from tests.pace import in_time


@pytest.mark.parametrize("sign", [-1.0, 1.0])
@pytest.mark.parametrize(("multiplier", "ends"), [(0.0, 0), (0.9, 0), (1.1, 1), (np.inf, 1), (np.nan, 1)])
def test_it_ends_a_programme_whose_multipliers_run_away(multiplier: float, ends: int, sign: float) -> None:
    watch = MultiplierWatch(3, 2, 4)
    inputs = {"lam_g": [0.0, sign * multiplier * MOST_MULTIPLIER], "lam_x": [1e300] * 3}
    assert int(watch(**{name: ca.DM(value) for name, value in inputs.items()})[watch.name_out(0)]) == ends


def test_a_first_look_is_ended_earlier() -> None:
    watch = MultiplierWatch(3, 2, 4)
    watch.most = MOST_AT_FIRST
    inputs = {"lam_g": ca.DM([0.0, 1.1 * MOST_AT_FIRST]), "lam_x": ca.DM.zeros(3)}
    assert int(watch(**inputs)[watch.name_out(0)]) == 1


@pytest.mark.slow
def test_a_way_out_that_leaves_no_room_is_designed_in_seconds() -> None:
    """Its first looks have no answer; the factorisations of one took minutes."""
    machine = RotaryKnife(
        circumference=0.5186767199462826,
        blades=3,
        gear_ratio=3.28669212117626,
        sync="horizontal",
        drum_inertia=0.09413180623452044,
        drum_friction=8.537646141961217,
    )
    cut = Cut(0.35175965310136115, 23.4 / 60, 0.10613035710055264, 0.021226, 0.084904, 0.002122607, "return")
    limits = Limits(0.8028154754380027, 3.1305399977212267, 219.61729090575534, reversal=True)
    begun = process_time()
    solution = solve(Task(machine, cut, limits), "peak_torque")
    assert in_time(process_time() - begun, 20.0)
    assert np.isfinite(solution.minimised)


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
    assert in_time(process_time() - begun, 8.0)
    measured = measure_motor(solution.profile, task.with_machine(solution.machine))
    assert measured.peak_torque is not None
    assert np.isfinite(measured.peak_torque)
