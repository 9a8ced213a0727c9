"""Ways out of an infeasible job, for every machine: what is offered works, and what is nearer to the job does not."""

from __future__ import annotations

from dataclasses import replace

import pytest

from camwright.design.feasible.feasibility import (
    edge,
    is_feasible,
    least_factor,
    needed_limits,
)
from camwright.design.feasible.refusal import infeasible, require_feasible
from camwright.design.optimise import solve
from camwright.profiles.cut import Cut
from camwright.profiles.errors import InfeasibleError, Suggestion
from camwright.profiles.limits import Limits
from camwright.profiles.machines import (
    CrankSlider,
    LinearCarriage,
    Machine,
    RotaryKnife,
)
from camwright.profiles.message import rounded_to
from camwright.profiles.motor import MotorCurve
from camwright.profiles.task import Task

CARRIAGE = LinearCarriage(1.0, mass=50.0, travel_per_turn=0.02)
SAW = Cut(1.5, 1.0, 0.3, 0.1, 0.2, 1e-4)
THICK = RotaryKnife(0.4, sync="horizontal")
CRANK = CrankSlider(0.15, 0.6, 0.0, 0.5, 20.0, 5.0, 1.75)
SHEAR = Cut(0.9, 1.0, 0.1, 0.04, 0.06, 1e-4)
RPM = 0.10471975511965977


def offers(machine: Machine, cut: Cut, limits: Limits) -> tuple[InfeasibleError, dict[str, Suggestion]]:
    with pytest.raises(InfeasibleError) as raised:
        require_feasible(Task(machine, cut, limits))
    return raised.value, {suggestion.change: suggestion for suggestion in raised.value.suggestions}


def test_a_stroke_that_is_too_short_is_named_with_the_one_that_is_needed() -> None:
    short, limits = replace(CARRIAGE, stroke=0.38), Limits(2.0, 12.0, 300.0)
    error, found = offers(short, SAW, limits)
    assert (error.binding, error.unit) == ("stroke", "mm")
    assert error.excess is not None
    needed = 0.38 + error.excess / 1e3
    assert is_feasible(Task(replace(short, stroke=needed * (1 + 1e-9)), SAW, limits))
    assert not is_feasible(Task(replace(short, stroke=needed * (1 - 1e-9)), SAW, limits))
    assert "stroke binds" in str(error)
    assert found["stroke"].value == pytest.approx(needed * 1e3, rel=2.1e-3)
    assert found["stroke"].value > needed * 1e3
    assert (
        solve(Task(replace(short, stroke=found["stroke"].value / 1e3), SAW, limits), "rms_acceleration").profile
        is not None
    )
    slower = found["line_speed"].value / 60
    assert is_feasible(Task(short, replace(SAW, line_speed=slower), limits))
    assert not is_feasible(Task(short, replace(SAW, line_speed=slower * 1.003), limits))


@pytest.mark.parametrize(
    ("machine", "cut", "limits", "binding"),
    [
        pytest.param(CARRIAGE, SAW, Limits(2.0, 4.0, 300.0), "acceleration", id="carriage"),
        pytest.param(THICK, Cut(0.2, 1.0, 0.08, 0.04, 0.04, 1e-4), Limits(8.0, 900.0, 1800.0), "jerk", id="thick"),
        pytest.param(CRANK, replace(SHEAR, length=0.4), Limits(30.0, 80.0, 40000.0), "acceleration", id="crank"),
        pytest.param(CRANK, replace(SHEAR, length=0.4), Limits(18.0, 200.0, 20000.0), "speed", id="crank-speed"),
    ],
)
def test_each_limit_offered_is_the_least_that_works(machine: Machine, cut: Cut, limits: Limits, binding: str) -> None:
    error, found = offers(machine, cut, limits)
    assert error.binding == binding
    need = needed_limits(Task(machine, cut, limits))
    for name in ("speed", "acceleration", "jerk"):
        if name not in found:
            continue
        factor = RPM if found[name].unit == "rpm" else 1 / 60 if found[name].unit == "m/min" else 1.0
        value = found[name].value * factor
        assert need[name] <= value <= need[name] * 1.003
        assert is_feasible(Task(machine, cut, replace(limits, **{name: value})))
        assert not is_feasible(Task(machine, cut, replace(limits, **{name: need[name] * (1 - 1e-6)})))
    assert binding in found
    assert {"line_speed", "length"} <= set(found)
    for change, applied in (("line_speed", found["line_speed"].value / 60), ("length", found["length"].value / 1e3)):
        solution = solve(Task(machine, replace(cut, **{change: applied}), limits), "peak_jerk")
        assert solution.profile.pieces > 0


def test_no_ways_out_are_looked_for_if_none_are_asked_for() -> None:
    error = infeasible(Task(CARRIAGE, SAW, Limits(2.0, 4.0, 300.0)), suggest=False)
    assert error.suggestions == ()
    assert "What works" not in str(error)
    assert error.binding == "acceleration"


def test_a_motor_that_is_too_weak_says_how_much_torque_is_needed() -> None:
    limits = Limits(30.0, 200.0, 20000.0, motor=MotorCurve(((0.0, 1.5), (100.0, 1.5), (150.0, 0.8))))
    with pytest.raises(InfeasibleError, match=r"motor binds, .* % more torque is needed") as raised:
        solve(Task(CRANK, SHEAR, limits), "rms_torque")
    assert (raised.value.binding, raised.value.unit) == ("motor", "%")
    found = {suggestion.change: suggestion for suggestion in raised.value.suggestions}
    share = found["motor"].value / 100
    assert raised.value.excess is not None
    assert share == pytest.approx(1 + raised.value.excess / 100, rel=2.1e-3)
    assert f"motor with {found['motor'].value:.15g} % of its torque" in str(raised.value)
    assert limits.motor is not None
    stronger = MotorCurve(tuple((speed, torque * share) for speed, torque in limits.motor.points))
    assert solve(Task(CRANK, SHEAR, replace(limits, motor=stronger)), "rms_torque").minimised > 0


def test_the_least_factor_is_found_on_either_side_of_one() -> None:
    for threshold in (1e-4, 0.3, 1.0, 2.5, 7e4):
        assert least_factor(lambda f, t=threshold: f >= t) == pytest.approx(threshold, rel=1e-11)  # type: ignore[misc]
    assert least_factor(lambda f: f >= 1e9) == float("inf")


def test_edge_keeps_to_its_tolerance() -> None:
    found = edge(lambda x: x <= 2.0, 1.0, 3.0, 1e-3)
    assert found is not None
    assert 2.0 * (1 - 3e-3) <= found <= 2.0
    assert rounded_to(found, 4, up=False) <= found


@pytest.mark.parametrize(("acceleration", "told"), [(8.0, r"% too little"), (1e-3, r"times as much")])
def test_what_is_needed_is_told_in_per_cent_or_as_a_multiple_never_as_a_power_of_ten(
    acceleration: float, told: str
) -> None:
    cut = Cut(0.6, 80 / 60, 0.2, 0.04, 0.16, 1e-4)
    task = Task(RotaryKnife(0.4), cut, Limits(200 / 60, acceleration, 3000.0))
    with pytest.raises(InfeasibleError, match=told) as raised:
        solve(task, "peak_acceleration", suggest=False)
    assert "e+" not in str(raised.value)
