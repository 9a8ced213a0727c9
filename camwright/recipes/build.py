"""Making a recipe of a design: judged, written for drives, looked at from every side that a fitter asks about."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from camwright.drives.export import Exported, export_possible
from camwright.house.progress import Step, ignore
from camwright.house.provenance import provenance
from camwright.jobs.job import Job
from camwright.jobs.numbers import job_numbers
from camwright.profiles.cut import Cut
from camwright.profiles.errors import InputError
from camwright.profiles.objective import OBJECTIVES
from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.profiles.servo import mean_lag
from camwright.recipes.manifest import sha256
from camwright.recipes.model import (
    RECIPE_VERSION,
    JobRecord,
    Language,
    Objective,
    Origin,
    Particulars,
    Points,
    Profile,
    Recipe,
    RecipeCheck,
    RecipeTable,
    Refusal,
    SpeedPart,
    TableFile,
    TableUnit,
    Zones,
)
from camwright.recipes.speeds import at_speeds
from camwright.recipes.working_range import working_range
from camwright.stored.design_file import StoredDesign
from camwright.studies.axis_study import sync_error
from camwright.studies.remedies import solve_or_advise
from camwright.studies.speed_band import job_band
from camwright.validation.check import Check
from camwright.validation.report import ValidationReport, judge

STEPS = 5
"""Steps that `make_recipe` tells beside one for each target."""

NO_PARTICULARS = Particulars()
"""A sheet that says nothing of who made it and when."""

TABLES = "tables"
"""Folder of the tables inside a recipe."""


@dataclass(frozen=True, eq=False)
class MadeRecipe:
    """A recipe, and the texts of its tables by their paths in the folder."""

    recipe: Recipe
    tables: dict[str, str]


def designed(job: Job) -> StoredDesign:
    """Find the optimal cam of a job, servo-aware if it says so.

    Raises
    ------
    InfeasibleError
        No motion keeps the limits of the job.
    SolverError
        The solver failed.
    """
    solution = solve_or_advise(job)
    return StoredDesign(solution.profile, replace(job, machine=solution.machine))


def make_recipe(
    design: StoredDesign,
    targets: Sequence[str],
    language: Language = "en",
    note: str = "",
    particulars: Particulars = NO_PARTICULARS,
    *,
    required: bool = True,
    step: Step = ignore,
) -> MadeRecipe:
    """Make the recipe of a design.

    Parameters
    ----------
    design
        A cam and its job.
    targets
        Names of the targets that tables are written for.
    language
        Language of what people read.
    note
        Any text that stands on the recipe.
    particulars
        Revision, customer, author and date that stand on it.
    required
        Whether a target that cannot take the cam is a fault; else the recipe names it.
    step
        Told what begins now.

    Raises
    ------
    InputError
        An unknown target, one that cannot take the cam, or none that can.
    """
    job, profile = design.job, design.profile
    step("checking")
    report = judge(profile, job.task, job.servo, servo_aware=job.servo_aware, slowest=job.slowest)
    step("simulating lower speeds")
    speeds = at_speeds(profile, job, report)
    step("finding its line speeds")
    band = job_band(profile, job, report)
    step("finding the working range")
    far = working_range(job)
    results, refused = export_possible(profile, job, targets, step=step)
    if refused and (required or not results):
        raise InputError(*(f"{name}: {fault}" for name, faults in refused.items() for fault in faults))
    origin = provenance(job.sha256)
    libraries = origin["libraries"]
    recipe = Recipe(
        schema_version=RECIPE_VERSION,
        kind="camwright recipe",
        name=job.name,
        note=note,
        language=language,
        released=report.passed and bool(band.parts) and all(result.passed for result in results),
        job=JobRecord(job.text, job_numbers(job)),
        slave_unit=job.machine.slave_unit,
        slave_start=job.task.slave_at_start,
        pitch=float(job.machine.pitch),
        objective=_objective(job, profile, report),
        profile=Profile(tuple(profile.breaks.tolist()), tuple(map(tuple, profile.coefficients.tolist()))),
        zones=zones(job.cut),
        checks=_checks(report.checks),
        speeds=speeds,
        lead_time=mean_lag(job.servo),
        speed_band=tuple(SpeedPart(*part, *binds) for part, binds in zip(band.parts, band.binds, strict=True)),
        working_range=far,
        tables=tuple(_table(result) for result in results),
        refused=tuple(Refusal(name, faults) for name, faults in refused.items()),
        provenance=Origin(str(origin["camwright"]), job.sha256, libraries if isinstance(libraries, dict) else {}),
        particulars=particulars,
    )
    return MadeRecipe(recipe, {_path(name): text for result in results for name, text in result.files.items()})


def _path(name: str) -> str:
    return f"{TABLES}/{name}"


def _objective(job: Job, profile: CamProfile, report: ValidationReport) -> Objective:
    """Give the value of the job's objective for a cam, whoever made it."""
    objective = OBJECTIVES[job.objective]
    if objective.of == "axis":
        value = sync_error(profile, job)
    else:
        value = getattr(report.motor if objective.of == "motor" else report.motion, objective.name)
    return Objective(objective.name, value, objective.unit(job.machine.slave_unit))


def zones(cut: Cut) -> Zones:
    """Place sync zone and shear zone on the period ``[0, x_c]``."""
    start = cut.shear_start if cut.origin == "return" else cut.shear_start % cut.length
    end = start + cut.shear_zone
    over = end - cut.length
    shear = ((start, end),) if over <= 1e-12 * cut.length else ((start, cut.length), (0.0, over))
    return Zones(cut.sync_parts, shear)


def _checks(checks: Sequence[Check]) -> tuple[RecipeCheck, ...]:
    return tuple(RecipeCheck(**_plain(asdict(check))) for check in checks)


def _plain(values: dict[str, Any]) -> dict[str, Any]:
    """Turn numpy's numbers into Python's."""
    return {key: value.item() if isinstance(value, np.generic) else value for key, value in values.items()}


def _table(result: Exported) -> RecipeTable:
    table, target, units = result.table, result.target, result.units
    return RecipeTable(
        target=target.name,
        title=target.title,
        released=result.passed,
        files=tuple(TableFile(_path(name), sha256(text.encode())) for name, text in result.files.items()),
        master_unit=TableUnit(units.master.symbol, units.master.size),
        slave_unit=TableUnit(units.slave.symbol, units.slave.size),
        points=Points(
            tuple(table.x.tolist()), tuple(table.y.tolist()), _column(table.ratio), _column(table.ratio_slope)
        ),
        position_error=result.position_error,
        ratio_error=result.deviation.ratio,
        acceleration_error=result.deviation.acceleration,
        within_asked_error=result.accurate,
        wraps=result.judgement.wraps,
        checks=_checks(result.judgement.checks),
        interpolation=target.interpolation,
        number_format=target.number_format,
        evidence=target.evidence,
        tested_on_controller=target.tested_on_controller,
        steps=target.steps,
    )


def _column(values: FloatArray) -> tuple[float | None, ...] | None:
    if np.isnan(values).all():
        return None
    return tuple(None if np.isnan(value) else value for value in values.tolist())
