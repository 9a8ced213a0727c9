"""`Expected`: what a sheet says of a cam, worked out from the cam and its job alone."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from camwright.house.progress import Step, ignore
from camwright.jobs.job import Job
from camwright.profiles.cut import Cut
from camwright.profiles.objective import OBJECTIVES
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.servo import mean_lag
from camwright.recipes.model import (
    AtSpeed,
    LineRampRecord,
    MarksAt,
    Objective,
    RecipeCheck,
    SpeedPart,
    StartStop,
    WorkingRange,
    Zones,
)
from camwright.recipes.production import marks_of, start_stop
from camwright.recipes.ramps import ramp_record
from camwright.recipes.speeds import at_speeds
from camwright.recipes.working_range import working_range
from camwright.stored.design_file import StoredDesign
from camwright.studies.axis_study import sync_error
from camwright.studies.line_ramps import line_ramps
from camwright.studies.speed_band import job_band
from camwright.validation.check import Check
from camwright.validation.report import ValidationReport, judge

STEPS = 5
"""Steps that `expected` tells."""


@dataclass(frozen=True)
class Expected:
    """Values of a sheet, under the names that they have in `camwright.recipes.model.Recipe`."""

    slave_start: float
    pitch: float
    objective: Objective
    zones: Zones
    checks: tuple[RecipeCheck, ...]
    speeds: tuple[AtSpeed, ...]
    lead_time: float
    speed_band: tuple[SpeedPart, ...]
    working_range: WorkingRange
    start_stop: StartStop
    marks: tuple[MarksAt, ...]
    line_ramp: LineRampRecord


def expected(design: StoredDesign, step: Step = ignore) -> Expected:
    """Work out what a sheet says of a cam."""
    job, profile = design.job, design.profile
    step("checking")
    report = judge(profile, job.task, job.servo, servo_aware=job.servo_aware, slowest=job.slowest)
    step("simulating lower speeds")
    speeds = at_speeds(profile, job, report)
    step("finding its line speeds")
    band = job_band(profile, job, report)
    step("finding how hard the line may ramp")
    ramps = ramp_record(line_ramps(profile, job))
    step("finding the working range")
    return Expected(
        slave_start=job.task.slave_at_start,
        pitch=float(job.machine.pitch),
        objective=_objective(job, profile, report),
        zones=zones(job.cut),
        checks=recipe_checks(report.checks),
        speeds=speeds,
        lead_time=mean_lag(job.servo),
        speed_band=tuple(SpeedPart(*part, *binds) for part, binds in zip(band.parts, band.binds, strict=True)),
        working_range=working_range(job),
        start_stop=start_stop(design),
        marks=marks_of(design),
        line_ramp=ramps,
    )


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


def recipe_checks(checks: Sequence[Check]) -> tuple[RecipeCheck, ...]:
    """Write checks as a recipe holds them."""
    return tuple(RecipeCheck(**_plain(asdict(check))) for check in checks)


def _plain(values: dict[str, Any]) -> dict[str, Any]:
    """Turn numpy's numbers into Python's."""
    return {key: value.item() if isinstance(value, np.generic) else value for key, value in values.items()}


def sound(values: Expected) -> bool:
    """Whether a cam is released, as far as its own values say: every check passed, and there are line speeds for it."""
    return all(check.passed for check in values.checks) and bool(values.speed_band)
