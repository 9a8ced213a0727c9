"""Solvers that jobs share: kept by the form of a programme, whose numbers are parameters."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from camwright.design.returns.problem import return_problem
from camwright.design.torque import parts, programme
from camwright.design.torque.finish import finish
from camwright.design.torque.guesses import ANYHOW, from_profile, resting
from camwright.design.torque.numbers import TorqueForm, TorqueNumbers
from camwright.design.torque.placing import place_by_objective
from camwright.design.torque.programme import TorqueAnswer, TorqueProgramme
from camwright.design.torque.task import Aim, TorqueTask
from camwright.profiles.cut import Cut
from camwright.profiles.limits import Limits
from camwright.profiles.line import Line
from camwright.profiles.machines import CrankSlider, Machine, RotaryKnife
from camwright.profiles.motor import MotorCurve
from camwright.profiles.objective import CommandObjective
from camwright.profiles.returns import quintic_between
from camwright.profiles.task import Task

CURVE = MotorCurve(((0.0, 20.0), (100.0, 20.0), (400.0, 5.0)))
CRANK = CrankSlider(crank=0.15, rod=0.6, crank_inertia=0.6, carriage_mass=60.0, gear_ratio=10.0)
CUT = Cut(0.9, 0.5, 0.15, 0.04, 0.08, 2.5e-4)
OTHER_CUT = Cut(0.75, 0.6, 0.12, 0.04, 0.06, 2.5e-4, sync_ratio=1.02)
JOBS = (
    Task(replace(CRANK, sync_at=1.75), CUT, Limits(30.0, 400.0, 20_000.0, reversal=True)),
    Task(replace(CRANK, sync_at=1.9), OTHER_CUT, Limits(25.0, 500.0, 15_000.0, reversal=True)),
)
RAMPED = tuple(
    task.with_line(line)
    for task, line in zip(JOBS, (Line(acceleration=0.3, stop=0.5), Line(acceleration=0.1, stop=0.4)), strict=True)
)
KNIVES = tuple(
    Task(RotaryKnife(circumference=0.4, drum_inertia=0.02, drum_friction=1.0), cut, limits)
    for cut, limits in (
        (Cut(0.6, 1.2, 0.2, 0.04, 0.16, 1e-4), Limits(4.0, 60.0, 6000.0, reversal=True)),
        (Cut(0.8, 1.0, 0.15, 0.04, 0.12, 1e-4), Limits(5.0, 50.0, 5000.0, reversal=True)),
    )
)


def asked(task: Task, aim: Aim, curve: MotorCurve | None = None) -> TorqueTask:
    return TorqueTask(task, return_problem(task, "peak_acceleration"), aim, curve)


def answered(task: TorqueTask) -> TorqueAnswer:
    """Solve from the quintic, or with a stretch at rest where there is friction."""
    if task.machine.friction:
        pattern, guess = next(iter(resting(task, 20)))
        return TorqueProgramme(task, pattern, (20, 20)).solve(guess)
    back = quintic_between(task.task.sync, task.problem.length, task.problem.height)
    return TorqueProgramme(task, ANYHOW, (40,)).solve(from_profile(back, task, 40))


def forget() -> None:
    """Keep nothing of any programme, nor of its pieces."""
    for module in (parts, programme):
        for kept in vars(module).values():
            if hasattr(kept, "cache_clear"):
                kept.cache_clear()


def same(one: TorqueAnswer, other: TorqueAnswer) -> bool:
    """Whether two answers agree to the last bit."""
    names = ("acceleration", "velocity", "position", "lengths")
    parts = (np.array_equal(getattr(one.guess, name), getattr(other.guess, name)) for name in names)
    return all(parts) and one.value == other.value and one.iterations == other.iterations


@pytest.mark.parametrize("aim", ["rms_torque", "peak_torque", "energy", "rms_jerk", "peak_acceleration"])
@pytest.mark.parametrize("jobs", [JOBS, RAMPED, KNIVES], ids=["steady", "ramped", "knife"])
def test_a_solver_kept_for_another_job_answers_as_one_built_anew(jobs: tuple[Task, Task], aim: Aim) -> None:
    first, second = (asked(task, aim, CURVE) for task in jobs)
    forget()
    alone = answered(second)
    forget()
    before = answered(first)
    after = answered(second)
    assert programme._kept_solver.cache_info().misses == 1  # it was the same solver
    assert alone.success
    assert before.success
    assert same(alone, after)
    assert not same(before, after)


@pytest.mark.parametrize("jobs", [JOBS, RAMPED], ids=["steady", "ramped"])
def test_a_shared_solver_holds_each_job_to_its_own_limits_and_ends(jobs: tuple[Task, Task]) -> None:
    for job in (*jobs, jobs[0]):
        task = asked(job, "rms_torque")
        back, problem = finish(answered(task).guess, ANYHOW, task), task.problem
        assert float(back(back.end)) == pytest.approx(problem.height, rel=1e-9)
        assert float(back(0.0, 1)) == pytest.approx(problem.start_ratio, rel=1e-9)
        assert float(back(0.0, 2)) == pytest.approx(problem.start_slope, rel=1e-9)
        assert back.peak(2) <= problem.greatest_slope * (1 + 1e-9)
        assert back.peak(3) <= problem.greatest_jerk * (1 + 1e-9)


@pytest.mark.parametrize("aim", ["rms_torque", "energy"])
def test_a_place_found_after_another_jobs_is_the_one_found_alone(aim: CommandObjective) -> None:
    def place(task: Task) -> float:
        found = place_by_objective(task, aim)
        assert found is not None
        return found.task.machine.place

    forget()
    alone = place(JOBS[1])
    forget()
    other = place(JOBS[0])
    assert place(JOBS[1]) == alone
    assert abs(other - alone) > 1e-3


def test_what_is_in_the_formulas_is_in_the_form() -> None:
    one = asked(JOBS[0], "rms_torque")
    assert TorqueForm.of(one) == TorqueForm.of(asked(JOBS[1], "rms_torque"))
    heavier = JOBS[0].with_machine(replace(JOBS[0].machine, carriage_mass=61.0))
    for other in (
        asked(heavier, "rms_torque"),
        asked(JOBS[0], "energy"),
        asked(JOBS[0], "rms_torque", CURVE),
        asked(RAMPED[0], "rms_torque"),
    ):
        assert TorqueForm.of(other) != TorqueForm.of(one)


def test_every_number_has_a_symbol_of_its_own() -> None:
    form = TorqueForm.of(asked(RAMPED[0], "rms_torque"))
    names = [symbol.name() for symbol in form.numbers.flat]
    assert len(set(names)) == len(names) == form.count == len(TorqueNumbers.of(asked(RAMPED[0], "rms_torque")).flat)
    assert names[: names.index("of_jerk") + 1] == list(TorqueNumbers._fields[:-1])


@pytest.mark.parametrize("machine", [CRANK, replace(CRANK, offset=0.05)])
def test_formulas_of_a_machine_are_the_same_wherever_its_zone_lies(machine: Machine) -> None:
    y = np.linspace(0.0, 6.0, 101)
    for name in ("tool", "tool_ratio", "inertia", "inertia_slope"):
        values = [getattr(machine.placed_at(place), name)(y) for place in (0.0, 1.5, 2.0)]
        assert np.array_equal(values[0], values[1])
        assert np.array_equal(values[0], values[2])
    assert machine.placed_at(0.0).pitch == machine.placed_at(2.0).pitch
