"""`Expected`: what a sheet says of a cam, worked out from the cam and its job alone."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from camwright.house.progress import Step, ignore
from camwright.jobs.job import Job
from camwright.jobs.servos import servos_of
from camwright.production.ramps import Ramps
from camwright.profiles.cut import Cut
from camwright.profiles.objective import OBJECTIVES
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.servo import mean_lag, spectral_radius
from camwright.recipes.model import (
    AtSpeed,
    LineRampRecord,
    MarksAt,
    RecipeCheck,
    RecipeObjective,
    SpeedPart,
    StartStop,
    WorkingRange,
    Zones,
)
from camwright.recipes.production import marks_of, start_stop
from camwright.recipes.ramps import ramp_record
from camwright.recipes.working_range import working_range
from camwright.stored.design_file import StoredDesign
from camwright.studies.axis_study import greatest_sync_error
from camwright.studies.line_ramps import line_ramps
from camwright.studies.speed_band import job_band
from camwright.validation.check import Check
from camwright.validation.motion import measure_motion
from camwright.validation.motor import measure_motor
from camwright.validation.report import ValidationReport, judge
from camwright.validation.servo.line_speeds import line_speed_errors
from camwright.validation.servo.response import servo_response

STEPS = 5
"""Steps that `expected` tells."""


@dataclass(frozen=True)
class Expected:
    """Values of a sheet, under the names that they have in `camwright.recipes.model.Recipe`."""

    slave_start: float
    pitch: float
    objective: RecipeObjective
    zones: Zones
    checks: tuple[RecipeCheck, ...]
    speeds: tuple[AtSpeed, ...]
    lead_time: float
    speed_band: tuple[SpeedPart, ...]
    working_range: WorkingRange
    start_stop: StartStop
    marks: tuple[MarksAt, ...]
    line_ramp: LineRampRecord


def expected(design: StoredDesign, ramps: Ramps | None, step: Step = ignore) -> Expected:
    """Work out what a sheet says of a cam, and of the start and stop of its machine."""
    job, profile = design.job, design.profile
    step("checking")
    report = judge(profile, job.task, job.servo, servo_aware=job.servo_aware, slowest=job.slowest)
    step("simulating lower speeds")
    speeds = at_speeds(profile, job, report)
    step("finding its line speeds")
    band = job_band(profile, job, report)
    step("finding how hard the line may ramp")
    line_ramp = ramp_record(line_ramps(profile, job))
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
        start_stop=start_stop(design, ramps),
        marks=marks_of(design),
        line_ramp=line_ramp,
    )


def _objective(job: Job, profile: CamProfile, report: ValidationReport) -> RecipeObjective:
    """Give the value of the job's objective for a cam, whoever made it."""
    objective = OBJECTIVES[job.objective]
    if objective.of == "axis":
        value = greatest_sync_error(profile, job)
    else:
        value = getattr(report.motor if objective.of == "motor" else report.motion, objective.name)
    return RecipeObjective(objective.name, value, objective.unit(job.machine.slave_unit))


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


def at_speeds(profile: CamProfile, job: Job, report: ValidationReport) -> tuple[AtSpeed, ...]:
    """Measure a cam at 10, 25, 50 and 100 % of the line speed.

    Over time the speed goes with the line speed, the acceleration with its square, the jerk with its cube; what the servo makes of
    it follows no such law and is simulated.

    Parameters
    ----------
    job
        The job, its machine with everything that the design chose.
    report
        Its validation, which has the servo's response at full line speed and where the cut falls.
    """
    stable = spectral_radius(job.servo) < 1.0
    rows = []
    worst = _worst_errors(profile, job) if stable else {}
    errors = {error.share: error for error in report.length_errors}
    for share in SHARES:
        task = job.task.at_speed(share * job.cut.line_speed)
        motion, motor = measure_motion(profile, task), measure_motor(profile, task)
        response = report.servo if task == job.task or not stable else servo_response(profile, task, job.servo)
        error = errors.get(share)
        rows.append(
            AtSpeed(
                share=share,
                line_speed=task.cut.line_speed,
                speed=motion.peak_speed,
                acceleration=motion.peak_acceleration,
                jerk=motion.peak_jerk,
                motor_speed=motor.peak_speed,
                peak_torque=motor.peak_torque,
                rms_torque=motor.rms_torque,
                following_error=response.peak_following_error if response else None,
                sync_error=response.shear_zone_error if response else None,
                length_offset=error.offset if error else None,
                length_offset_with_lead=error.offset_with_lead if error else None,
                length_variation=error.variation if error else None,
                worst_sync_error=worst.get(share),
            )
        )
    return tuple(rows)


def _worst_errors(profile: CamProfile, job: Job) -> dict[float, float]:
    """Find the greatest sync error of all servos of a job's ranges (m) by share of the line speed; nothing where it gives none."""
    servos = servos_of(job)
    if len(servos) == 1:
        return {}
    speeds = job.cut.line_speed * np.array(SHARES)
    return dict(zip(SHARES, line_speed_errors(profile, job.task, servos, speeds).max(axis=0).tolist(), strict=True))


SHARES = (0.1, 0.25, 0.5, 1.0)
"""Shares of the line speed at which a machine is commissioned."""
