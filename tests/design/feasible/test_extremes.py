"""How fast and how short: edges of what is possible, against Ruckig and against solving on both sides."""

import math
from dataclasses import replace

import numpy as np
import pytest
import ruckig

from camwright.design.feasible.envelope import envelope, linear_speed, quintic_speed
from camwright.design.feasible.extremes import extremes, max_line_speed, min_cut_length
from camwright.design.feasible.feasibility import is_feasible, margin
from camwright.profiles.cross_cutter import quintic_return
from camwright.profiles.cut import Cut
from camwright.profiles.errors import InputError
from camwright.profiles.limits import Limits
from camwright.profiles.machines import (
    CrankSlider,
    LinearCarriage,
    Machine,
    RotaryKnife,
)
from camwright.profiles.returns import assemble
from camwright.profiles.task import Task

FREE = Limits(math.inf, math.inf, math.inf)
"""Nothing here asks for limits."""

KNIFE = (RotaryKnife(0.4), Cut(0.35, 80 / 60, 0.1, 0.04, 0.06, 1e-4), Limits(200 / 60, 30.0, 3000.0))
CARRIAGE = (
    LinearCarriage(1.2, mass=50.0, travel_per_turn=0.02),
    Cut(1.5, 1.0, 0.3, 0.1, 0.2, 1e-4),
    Limits(2.0, 12.0, 300.0),
)
THICK = (RotaryKnife(0.4, sync="horizontal"), Cut(0.6, 1.0, 0.08, 0.04, 0.04, 1e-4), Limits(200 / 60, 200.0, 20000.0))
CRANK = (
    CrankSlider(0.15, 0.6, 0.0, 0.5, 20.0, 5.0, 1.75),
    Cut(0.9, 1.0, 0.1, 0.04, 0.06, 1e-4),
    Limits(30.0, 200.0, 20000.0),
)
ALL = [
    pytest.param(*case, id=name)
    for name, case in zip(("knife", "carriage", "thick", "crank"), (KNIFE, CARRIAGE, THICK, CRANK), strict=True)
]


def ruckig_time(height: float, ratio_start: float, limits: Limits, backwards: bool) -> float:
    """Shortest time of a return at line speed ``ratio_start`` over ``height``, by Ruckig."""
    task = ruckig.InputParameter(1)
    task.current_velocity, task.target_velocity, task.target_position = [ratio_start], [ratio_start], [height]
    task.max_velocity, task.max_acceleration, task.max_jerk = [limits.speed], [limits.acceleration], [limits.jerk]
    task.min_velocity = [-limits.speed if backwards else -1e-9]
    answer = ruckig.Trajectory(1)
    assert ruckig.Ruckig(1).calculate(task, answer) == ruckig.Result.Working
    return float(answer.duration)


@pytest.mark.parametrize(("machine", "cut", "limits"), ALL)
def test_an_edge_works_and_a_step_beyond_does_not(machine: Machine, cut: Cut, limits: Limits) -> None:
    found = extremes(Task(machine, cut, limits))
    assert found.max_line_speed is not None
    assert found.min_cut_length is not None
    share = 1e-5
    assert is_feasible(Task(machine, replace(cut, line_speed=found.max_line_speed * (1 - share)), limits))
    assert not is_feasible(Task(machine, replace(cut, line_speed=found.max_line_speed * (1 + share)), limits))
    assert is_feasible(Task(machine, replace(cut, length=found.min_cut_length * (1 + share)), limits))
    assert not is_feasible(Task(machine, replace(cut, length=found.min_cut_length * (1 - share)), limits))
    assert found.line_speed_binding in {"speed", "acceleration", "jerk", "reversal", "stroke"}
    assert found.cut_length_binding in {"speed", "acceleration", "jerk", "reversal", "stroke", "sync_zone"}


@pytest.mark.parametrize("speed", [40 / 60, 80 / 60, 120 / 60])
def test_shortest_cut_of_a_knife_against_ruckig(speed: float) -> None:
    machine, cut, limits = KNIFE
    length = min_cut_length(Task(machine, replace(cut, line_speed=speed), limits))
    assert length is not None
    time = ruckig_time(machine.pitch - cut.sync_zone, speed, limits, backwards=False)
    assert length == pytest.approx(cut.sync_zone + speed * time, rel=1e-6)


@pytest.mark.parametrize("speed", [0.6, 1.0, 1.4])
def test_shortest_cut_of_a_carriage_against_ruckig(speed: float) -> None:
    machine, cut, limits = CARRIAGE
    length = min_cut_length(Task(machine, replace(cut, line_speed=speed), limits))
    assert length is not None
    assert length == pytest.approx(
        cut.sync_zone + speed * ruckig_time(-cut.sync_zone, speed, limits, backwards=True), rel=1e-6
    )


def test_margin_is_one_at_an_edge() -> None:
    machine, cut, limits = THICK
    speed = max_line_speed(Task(machine, cut, limits))
    assert speed is not None
    assert margin(Task(machine, replace(cut, line_speed=speed), limits)) == pytest.approx(1.0, abs=1e-6)


def test_quintic_speed_is_where_its_own_extrema_meet_a_limit() -> None:
    machine, cut, limits = KNIFE
    speed = quintic_speed(Task(machine, cut, limits))
    assert speed is not None
    cycle = assemble(quintic_return(cut.return_zone, machine.pitch - cut.sync_zone), Task(machine, cut, FREE))
    shares = [
        cycle.extrema(1)[1].value * speed / limits.speed,
        cycle.extrema(2)[1].value * speed**2 / limits.acceleration,
        cycle.peak(3) * speed**3 / limits.jerk,
    ]
    assert max(shares) == pytest.approx(1.0, rel=1e-12)


def test_linear_speed_is_equation_8() -> None:
    machine, cut, limits = KNIFE
    speed = linear_speed(Task(machine, cut, limits))
    assert speed is not None
    assert (machine.pitch - cut.sync_zone) / limits.speed == pytest.approx(cut.return_zone / speed, rel=1e-12)


@pytest.mark.parametrize(("machine", "cut", "limits"), ALL)
def test_the_optimised_region_contains_the_quintic(machine: Machine, cut: Cut, limits: Limits) -> None:
    lengths = np.linspace(max(1.1 * cut.sync_zone, 0.4 * cut.length), 2.0 * cut.length, 4).tolist()
    speeds = (np.linspace(0.3, 2.0, 4) * cut.line_speed).tolist()
    found = envelope(Task(machine, cut, limits), "peak_acceleration", lengths, speeds)
    assert len(found.points) == 16
    assert any(point.optimised for point in found.points)
    for point in found.points:
        assert point.optimised or not point.quintic
        row = next(row for row in found.rows if row.length == point.length)
        assert point.optimised == (row.optimised is not None and point.line_speed <= row.optimised)
        assert point.binding


def test_an_envelope_that_begins_inside_the_sync_zone_is_refused() -> None:
    machine, cut, limits = KNIFE
    with pytest.raises(InputError, match=r"cut length of 0\.1 m: it must be above the sync zone, sync zone = 0\.1 m"):
        envelope(Task(machine, cut, limits), "peak_acceleration", [0.1, 0.2], [1.0])
