"""`TradeOff`: the optimum of every objective and every baseline by the same measures, and what each costs in the others."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any, Literal

from camwright.design.optimise import solve
from camwright.house.progress import Step, ignore
from camwright.jobs.job import Job
from camwright.profiles.errors import InfeasibleError, SolverError
from camwright.profiles.objective import COMMAND_OBJECTIVES, OBJECTIVES, CommandObjective, of_command
from camwright.profiles.polynomial.profile import CamProfile
from camwright.studies.comparison import law_names, law_profile
from camwright.studies.remedies import solve_or_advise
from camwright.studies.within_limits import keeps_limits
from camwright.validation.motion import measure_motion
from camwright.validation.motor import measure_motor

Kind = Literal["objective", "baseline"]

_COLUMNS = (2, 0, 3)
"""Measures, which are the objectives of the command too, stand in the order of these orders: acceleration, motor, jerk."""


@dataclass(frozen=True, eq=False)
class Row:
    """One profile of a trade-off.

    Parameters
    ----------
    name
        The objective that it is the optimum of, or the name of a baseline.
    kind
        Which of the two.
    values
        Its measures by name, of the slave (its unit over s², s³) and at the motor (N·m, J per cycle); ``None`` stands for unbounded.
    within_limits
        Whether it keeps the limits of the job.
    """

    name: str
    kind: Kind
    profile: CamProfile
    values: dict[CommandObjective, float | None]
    within_limits: bool


@dataclass(frozen=True)
class Failure:
    """An objective that the solver found no optimum of, and why."""

    name: str
    reason: str


@dataclass(frozen=True, eq=False)
class TradeOff:
    """All objectives and baselines of a job.

    Parameters
    ----------
    measures
        What was measured, in the order of the tables.
    rows
        The profiles by the measure that the job minimises, unbounded ones last.
    failures
        The objectives without an optimum.
    """

    job: Job
    measures: tuple[CommandObjective, ...]
    rows: tuple[Row, ...]
    failures: tuple[Failure, ...] = ()

    def best(self, measure: CommandObjective) -> Row | None:
        """Profile of the least value of a measure among those that keep the limits; none where it is unbounded in all of them."""
        able = [row for row in self.rows if row.within_limits and row.values[measure] is not None]
        return min(able, key=lambda row: _order(row.values[measure]), default=None)

    def cost(self, row: Row, measure: CommandObjective) -> float | None:
        """Give a measure of a profile as a multiple of the best; below 1 only where the profile breaks a limit.

        None where it is unbounded, or where the best is zero.
        """
        value, best = row.values[measure], self.best(measure)
        least = None if best is None else best.values[measure]
        return value / least if value is not None and least else None

    def unit(self, measure: CommandObjective) -> str:
        """Give the unit of a measure in ASCII, as JSON has it."""
        return OBJECTIVES[measure].unit(self.job.machine.slave_unit)

    @property
    def sorted_by(self) -> CommandObjective:
        """The measure that sorts the profiles: the job's objective, or where that is the sync error the one that stands for it."""
        return of_command(self.job.objective)


def step_count(job: Job) -> int:
    """Count the steps that `trade_off` tells."""
    return len(_objectives(job)) + len(law_names(job.task))


def trade_off(job: Job, step: Step = ignore) -> TradeOff:
    """Solve a job for every objective and measure the optima and all baselines.

    A crank whose sync zone is free has it where each objective wants it; the baselines have it where the job's own objective does, or, if
    the solver failed on that, the first one that it solved.

    Raises
    ------
    InfeasibleError
        No motion keeps the limits of the job.
    SolverError
        The solver failed on all of the objectives.
    """
    objectives = _objectives(job)
    measures = tuple(name for order in _COLUMNS for name in objectives if OBJECTIVES[name].order == order)
    rows: list[Row] = []
    failures: list[Failure] = []
    placed = job
    for objective in objectives:
        step(f"solving for the least {measure_words(objective)}")
        try:
            solution = solve(job.task, objective, suggest=False)
        except InfeasibleError:
            solve_or_advise(job)  # it refuses with changes that were tried
            raise
        except SolverError as error:
            failures.append(Failure(objective, str(error)))
            continue
        here = replace(job, machine=solution.machine)
        placed = here if objective == of_command(job.objective) or not rows else placed
        rows.append(_row(objective, "objective", solution.profile, here, measures))
    if not rows:
        raise SolverError(f"no objective was solved; the first, {failures[0].name}: {failures[0].reason}")
    for name in law_names(placed.task):
        step(f"measuring {name}")
        rows.append(_row(name, "baseline", law_profile(name, placed.task), placed, measures))
    rows.sort(key=lambda row: _order(row.values[of_command(job.objective)]))
    return TradeOff(placed, measures, tuple(rows), tuple(failures))


def measure_words(name: str) -> str:
    """Write the name of an objective or measure in words."""
    return name.replace("_", " ").replace("rms", "RMS")


def tradeoff_answer(result: TradeOff, files: Sequence[Path]) -> dict[str, Any]:
    """Answer of ``camwright compare --objectives --json``; null where a value is unbounded, or a ratio has no meaning."""
    best = {measure: result.best(measure) for measure in result.measures}
    return {
        "job": result.job.name,
        "sorted_by": result.sorted_by,
        "measures": {
            name: {"unit": result.unit(name), "best": row and row.values[name], "best_of": row and row.name}
            for name, row in best.items()
        },
        "profiles": [
            {
                "name": row.name,
                "kind": row.kind,
                "within_limits": row.within_limits,
                "values": row.values,
                "cost": {measure: result.cost(row, measure) for measure in result.measures},
            }
            for row in result.rows
        ],
        "failed": [asdict(failure) for failure in result.failures],
        "files": [str(file) for file in files],
    }


def _objectives(job: Job) -> tuple[CommandObjective, ...]:
    """Objectives that have a meaning for a job."""
    moved = job.machine.moves_something
    return tuple(name for name in COMMAND_OBJECTIVES if moved or OBJECTIVES[name].of != "motor")


def _row(name: str, kind: Kind, profile: CamProfile, job: Job, measures: Sequence[CommandObjective]) -> Row:
    """Measure one profile."""
    motion = measure_motion(profile, job.task)
    motor = measure_motor(profile, job.task)
    values = {measure: getattr(motor if OBJECTIVES[measure].of == "motor" else motion, measure) for measure in measures}
    return Row(name, kind, profile, values, keeps_limits(profile, motion, job))


def _order(value: float | None) -> float:
    """Sort unbounded values last."""
    return math.inf if value is None else value
