"""Torque and energy of servo-aware commands: values against the validation's, optima against every convex mix with other commands."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from camwright.design.optimise import solve
from camwright.design.optimise_axis import solve_axis
from camwright.design.servo_aware.axis_problem import AxisProblem
from camwright.design.servo_aware.command_basis import Command, command_basis
from camwright.design.servo_aware.programme import AxisProgramme
from camwright.design.servo_aware.torque import AxisTorque
from camwright.profiles.cut import Cut
from camwright.profiles.errors import InputError, SolverError
from camwright.profiles.limits import Limits
from camwright.profiles.machines import (
    CrankSlider,
    LinearCarriage,
    Machine,
    RotaryKnife,
)
from camwright.profiles.objective import MotorObjective
from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.profiles.servo import Servo
from camwright.profiles.task import Task
from camwright.validation.motor import measure_motor
from camwright.validation.report import judge

STIFF = Servo(200.0, 0.8, 50.0, 0.002, 1.0)
CRANK = CrankSlider(0.15, 0.6, 0.02, crank_inertia=0.5, carriage_mass=40.0, sync_at=1.2)
CUT = Cut(0.9, 0.5, 0.15, 0.05, 0.08, 1e-4)
LIMITS = Limits(31.0, 400.0, 60_000.0)
SAW = LinearCarriage(1.2, mass=100.0, travel_per_turn=0.04)
SAW_CUT = Cut(2.0, 0.6, 0.4, 0.2, 0.2, 2e-4)
COSTS: tuple[MotorObjective, ...] = ("rms_torque", "peak_torque", "energy")


def at_the_motor(machine: Machine, cut: Cut, profile: CamProfile, cost: MotorObjective) -> float:
    return float(getattr(measure_motor(profile, Task(machine, cut, LIMITS)), cost))


@pytest.mark.parametrize("command", ["in_sync", "shaped"])
@pytest.mark.parametrize(("machine", "cut"), [(CRANK, CUT), (SAW, SAW_CUT)], ids=["crank", "carriage"])
def test_the_root_mean_square_is_that_of_the_validation(machine: Machine, cut: Cut, command: Command) -> None:
    cut = replace(cut, shaped=command == "shaped")
    basis = command_basis(Task(machine, cut, LIMITS), command)
    travel = machine.pitch or cut.sync_zone
    unknowns = np.random.default_rng(2).normal(0.0, 0.002, size=(basis.matrix.shape[1],))
    found = AxisTorque(Task(machine, cut, LIMITS), basis, travel).value(unknowns, "rms_torque") / machine.motor_ratio
    profile = basis.profile(unknowns * travel)
    whole = at_the_motor(machine, cut, profile, "rms_torque")
    if command == "shaped":
        assert found == pytest.approx(whole, rel=2e-3)
    else:  # in the sync zone the rest of it is needed
        assert found**2 * cut.return_zone <= whole**2 * cut.length * (1 + 2e-3)


@pytest.mark.parametrize("cost", COSTS)
def test_a_shaped_design_needs_less_than_designs_for_the_motion(cost: MotorObjective) -> None:
    cut = replace(CUT, shaped=True)
    found = solve_axis(Task(CRANK, cut, LIMITS), cost, "shaped", (STIFF,))
    others = [
        solve_axis(Task(CRANK, cut, LIMITS), name, "shaped", (STIFF,)) for name in ("rms_acceleration", "rms_jerk")
    ]
    least = at_the_motor(CRANK, cut, found.profile, cost)
    assert all(least <= at_the_motor(CRANK, cut, other.profile, cost) for other in others)
    # the constraints are convex, so a mix of two commands that keep them keeps them too: towards no other command does it fall
    x = np.linspace(0.0, cut.length, 4001)

    def mixed(share: float, other: FloatArray) -> float:
        path = np.stack([(1 - share) * found.profile(x, order) + share * other[order] for order in range(3)])
        return objective(path, cost)

    def objective(path: FloatArray, cost: MotorObjective) -> float:
        sync = CRANK.sync_profile(cut)
        place = CRANK.sync_start(cut) + float(sync(sync.end)) + path[0]
        velocity = cut.line_speed * path[1]
        force = CRANK.inertia(place) * cut.line_speed**2 * path[2] + CRANK.inertia_slope(place) * velocity**2 / 2
        if cost == "rms_torque":
            return float(np.sqrt(np.mean(force**2)))
        return float(np.abs(force).max()) if cost == "peak_torque" else float(np.mean(np.maximum(force * velocity, 0)))

    here = objective(np.stack([found.profile(x, order) for order in range(3)]), cost)
    for other in others:
        values = np.stack([other.profile(x, order) for order in range(3)])
        assert mixed(1e-3, values) >= here * (1 - (1e-5 if cost != "peak_torque" else 5e-3))
    report = judge(found.profile, Task(CRANK, cut, LIMITS), STIFF, servo_aware=True)
    assert [check.name for check in report.checks if not check.passed] == []


@pytest.mark.parametrize("cost", COSTS)
def test_in_sync_the_blind_optimum_is_kept_where_it_will_do(cost: MotorObjective) -> None:
    cut, slow = replace(CUT, sync_tolerance=1e-3), replace(CUT, sync_tolerance=1e-3, line_speed=0.3)
    for each in (cut, slow):
        blind = solve(Task(CRANK, each, LIMITS), cost)
        found = solve_axis(Task(CRANK, each, LIMITS), cost, "in_sync", (STIFF,))
        assert found.axis is not None
        assert found.axis.error <= each.sync_tolerance
        before = at_the_motor(CRANK, each, blind.profile, cost)
        assert at_the_motor(CRANK, each, found.profile, cost) == pytest.approx(before, rel=1e-2)


@pytest.mark.parametrize("cost", ["peak_torque", "energy"])
def test_a_knife_with_friction_is_designed_for_its_torque(cost: MotorObjective) -> None:
    knife = RotaryKnife(0.4, drum_inertia=0.02, drum_friction=2.0, gear_ratio=3.0)
    cut, limits = Cut(0.6, 80 / 60, 0.2, 0.04, 0.16, 1e-4, shaped=True), Limits(200 / 60, 100.0, 20_000.0)
    torque = solve_axis(Task(knife, cut, limits), cost, "shaped", (STIFF,))
    motion = solve_axis(Task(knife, cut, limits), "peak_acceleration", "shaped", (STIFF,))
    values = [at_the_motor(knife, cut, each.profile, cost) for each in (torque, motion)]
    assert values[0] <= values[1] * (1 + 1e-3)


def test_a_start_far_from_any_answer_ends_in_an_error_that_says_what_to_do(monkeypatch: pytest.MonkeyPatch) -> None:
    cut = replace(CUT, shaped=True)
    programme = AxisProgramme(AxisProblem(Task(CRANK, cut, LIMITS), "shaped", (STIFF,), axis_limits=False))
    monkeypatch.setattr(
        "camwright.design.servo_aware.torque._OPTIONS",
        {"ipopt.max_iter": 1, "print_time": False, "ipopt.print_level": 0},
    )
    with pytest.raises(SolverError, match="least energy with 'Maximum_Iterations_Exceeded'; minimise rms_acceleration"):
        programme.solve("energy", 1.0)


def test_what_stands_at_even_speed_needs_no_torque() -> None:
    knife = RotaryKnife(0.4, drum_inertia=0.02)
    cut = Cut(0.4, 1.0, 0.1, 0.04, 0.06, 1e-4, shaped=True)
    found = solve_axis(Task(knife, cut, Limits(3.0, 100.0, 20_000.0)), "energy", "shaped", (STIFF,))
    assert abs(at_the_motor(knife, cut, found.profile, "energy")) < 1e-9


def test_a_machine_that_moves_nothing_has_no_torque() -> None:
    cut = Cut(0.6, 80 / 60, 0.2, 0.04, 0.16, 1e-4, shaped=True)
    with pytest.raises(InputError, match="'energy' needs to know what the motor moves"):
        solve_axis(Task(RotaryKnife(0.4), cut, Limits(3.0, 100.0, 20_000.0)), "energy", "shaped", (STIFF,))
