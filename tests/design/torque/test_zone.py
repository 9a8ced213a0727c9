"""The sync zone that is placed: what it costs by itself, and the points of the return beside it."""

from __future__ import annotations

import math

import numpy as np
import pytest

from camwright.design.returns.problem import return_problem
from camwright.design.torque.layout import Layout
from camwright.design.torque.numbers import TorqueForm
from camwright.design.torque.parts import greatest_share, zone_floors
from camwright.design.torque.search import zone_peak
from camwright.design.torque.task import Aim, TorqueTask
from camwright.design.torque.zone import Zone
from camwright.profiles.cut import Cut
from camwright.profiles.limits import Limits
from camwright.profiles.machines import CrankSlider
from camwright.profiles.task import Task

CRANK = CrankSlider(crank=0.15, rod=0.6, crank_inertia=0.6, carriage_mass=60.0, sync_at=1.9)
TASK = Task(CRANK, Cut(0.9, 0.5, 0.15, 0.04, 0.08, 2.5e-4), Limits(30.0, 400.0, 20_000.0, reversal=False))
ENDS = TASK.slave_at_sync_start, TASK.slave_at_sync_end
ZONE = Zone((ENDS, ENDS))


def asked(aim: Aim) -> TorqueTask:
    """Give the task an aim."""
    return TorqueTask(TASK, return_problem(TASK, "peak_acceleration"), aim)


def _floor(aim: Aim) -> float:
    return float(zone_floors(asked(aim), ZONE, np.array([ENDS[0]]), np.array([ENDS[1]]))[0])


def zone_torque() -> tuple[np.ndarray, np.ndarray]:
    """Torque and speed of the sync zone over time, by the profile that the return joins."""
    x = np.linspace(TASK.sync.start, TASK.sync.end, 20_001)
    v, y = TASK.cut.line_speed, TASK.slave_at_sync_start + TASK.sync(x)
    ratio = TASK.sync(x, 1)
    return v**2 * (CRANK.inertia(y) * TASK.sync(x, 2) + CRANK.inertia_slope(y) * ratio**2 / 2), v * ratio


def test_a_zone_costs_what_its_own_profile_says() -> None:
    torque, speed = zone_torque()
    x = np.linspace(0.0, TASK.cut.sync_zone, len(torque))
    back = TASK.cut.return_zone
    square = np.trapezoid(torque**2, x) / (TASK.cut.sync_zone + back)
    drawn = np.trapezoid(np.maximum(torque * speed, 0.0), x) / back
    assert _floor("peak_torque") == pytest.approx(zone_peak(TASK), rel=1e-6)
    assert _floor("rms_torque") == pytest.approx(math.sqrt(square), rel=1e-6)
    assert _floor("energy") == pytest.approx(drawn, rel=0.05)  # the power's corner lies between points
    assert _floor("peak_jerk") == 0.0


def test_the_share_of_a_limit_is_that_of_the_zones_own_profile() -> None:
    v, limits = TASK.cut.line_speed, TASK.limits
    shares = [
        TASK.sync.peak(order) * v**order / limit
        for order, limit in ((1, limits.speed), (2, limits.acceleration), (3, limits.jerk))
    ]
    found = greatest_share(asked("energy"), ZONE, np.array(ENDS[:1]), np.array(ENDS[1:]))
    assert found[0] == pytest.approx(max(shares), rel=1e-3)


def test_weights_of_points_add_up_to_their_phases() -> None:
    layout = Layout(("forth", "rest", "back"), (3, 2), 0, TorqueForm.of(asked("energy")))
    mesh = np.array([0.2, 0.5, 0.3, 0.6, 0.4])
    weights, phase = layout.weights(mesh), layout.phase[layout.owner]
    assert weights[phase == 0].sum() == pytest.approx(1.0)
    assert weights[phase == 2].sum() == pytest.approx(1.0)
    assert layout.points == 3 * 5 + 2  # neighbours share a point, phases do not
    assert layout.signs.tolist() == [1.0] * 10 + [-1.0] * 7


@pytest.mark.parametrize("aim", ["rms_torque", "peak_torque", "energy"])
def test_zones_that_are_looked_at_together_cost_what_each_does(aim: Aim) -> None:
    places = [TASK.placed_at(place) for place in (1.6, 1.9, 2.1)]
    starts = np.array([place.slave_at_sync_start for place in places])
    ends = np.array([place.slave_at_sync_end for place in places])
    together = zone_floors(asked(aim), ZONE, starts, ends)
    alone = [zone_floors(asked(aim), ZONE, starts[[k]], ends[[k]])[0] for k in range(3)]
    assert together == pytest.approx(alone, rel=1e-14)
    assert np.ptp(together) > 0.1 * together.max()


def test_no_zones_need_nothing() -> None:
    """Where none of the places keeps the limits, none is left to look at."""
    none = np.empty(0)
    assert zone_floors(asked("rms_torque"), ZONE, none, none).shape == (0,)
    assert greatest_share(asked("rms_torque"), ZONE, none, none).shape == (0,)
