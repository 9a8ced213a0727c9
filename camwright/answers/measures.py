"""The parts of ``--json`` answers that several commands print: the objective, measures of profiles, checks, bands, lengths."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from camwright.jobs.job import Job
from camwright.profiles.machines.machine import SlaveUnit
from camwright.profiles.objective import OBJECTIVES
from camwright.studies.comparison import Comparison
from camwright.studies.cut_lengths import CutLengths
from camwright.studies.design import Design
from camwright.studies.measured import Measured
from camwright.studies.speed_band import SpeedBand
from camwright.validation.check import Check
from camwright.validation.motion import MotionMeasures
from camwright.validation.motor import MotorMeasures
from camwright.validation.report import ValidationReport
from camwright.validation.servo.response import ServoResponse


def millimetres(length: float | None) -> float | None:
    """Turn metres into millimetres."""
    return None if length is None else length * 1e3


def profiles_answer(comparison: Comparison) -> dict[str, Any]:
    """Measures of each profile by name."""
    profiles = {row.name: _row(row, comparison.job.machine.slave_unit) for row in comparison.rows}
    if comparison.screw is not None:
        profiles["screw_carriage"] = _row(comparison.screw.row, "m")
    return profiles


def _row(row: Measured, unit: SlaveUnit) -> dict[str, Any]:
    """Measures of one profile of a comparison."""
    worst = None if row.worst_error is None else row.worst_error * 1e3
    found = measures_answer(row.motion, row.tool, row.motor, row.response, unit)
    return {**found, "within_limits": row.within_limits, "worst_shear_zone_error_mm": worst}


def measures_answer(
    slave: MotionMeasures, tool: MotionMeasures, motor: MotorMeasures, response: ServoResponse | None, unit: SlaveUnit
) -> dict[str, Any]:
    """Measures of a profile; null where a value is unbounded or does not exist. A slave that turns has its own measures."""
    measures: dict[str, Any] = {
        "peak_speed_m_per_s": tool.peak_speed,
        "min_speed_m_per_s": tool.min_speed,
        "peak_acceleration_m_per_s2": tool.peak_acceleration,
        "rms_acceleration_m_per_s2": tool.rms_acceleration,
        "peak_jerk_m_per_s3": tool.peak_jerk,
        "rms_jerk_m_per_s3": tool.rms_jerk,
        "sync_ratio_error": slave.sync_ratio_error,
        "motor": {
            "peak_torque_N_m": motor.peak_torque,
            "rms_torque_N_m": motor.rms_torque,
            "peak_speed_rad_per_s": motor.peak_speed,
            "min_velocity_rad_per_s": motor.min_velocity,
            "energy_J": motor.energy,
            "regenerated_J": motor.regenerated,
        },
        "servo": None
        if response is None
        else {
            "crossing_mm": millimetres(response.crossing),
            "settling_mm": millimetres(response.settling),
            "overshoot_mm": millimetres(response.overshoot),
            "peak_following_error_mm": millimetres(response.peak_following_error),
            "shear_zone_error_mm": millimetres(response.shear_zone_error),
        },
    }
    if unit == "rad":
        own = asdict(slave)
        del own["sync_ratio_error"]
        measures["slave"] = {"unit": "rad", **own}
    return measures


def report_answer(report: ValidationReport, unit: SlaveUnit) -> dict[str, Any]:
    """Measures of the profile that was judged."""
    return measures_answer(report.motion, report.tool, report.motor, report.servo, unit)


def with_files(answer: dict[str, Any], files: Sequence[Path]) -> dict[str, Any]:
    """Add the paths of the files that were written."""
    return {**answer, "files": [str(file) for file in files]}


def checks_answer(checks: Sequence[Check]) -> list[dict[str, Any]]:
    """List the checks in their order; values in the SI unit that each one names, master positions in m."""
    return [asdict(check) for check in checks]


def lengths_answer(lengths: CutLengths | None) -> dict[str, float | None]:
    """Minimum cut lengths in mm; null for machines that the published equations are not about."""
    if lengths is None:
        return dict.fromkeys(("eq9", "eq10", "physical", "linear_return_to_tolerance", "optimised_to_tolerance"))
    return {
        "eq9": millimetres(lengths.eq9),
        "eq10": millimetres(lengths.eq10),
        "physical": millimetres(lengths.physical.length),
        "linear_return_to_tolerance": millimetres(lengths.linear_return.length),
        "optimised_to_tolerance": millimetres(lengths.optimised.length),
    }


def band_answer(band: SpeedBand) -> dict[str, Any]:
    """Write a band: its parts in m/s, and what binds at the lower and the upper end of each in turn; of no band what forbids it."""
    binds = [name for pair in band.binds for name in pair] if band.parts else list(band.forbids)
    return {"speed_band": [list(part) for part in band.parts], "speed_band_binds": binds}


def objective_unit(job: Job) -> str:
    """Name the unit of a job's objective."""
    return OBJECTIVES[job.objective].unit(job.machine.slave_unit)


def objective_answer(design: Design) -> dict[str, Any]:
    """Write the objective of a design: name, value, unit, lower bound and gap, null where there is no bound."""
    return {
        "name": design.job.objective,
        "value": design.objective,
        "unit": objective_unit(design.job),
        "lower_bound": None if math.isnan(design.bound.value) else design.bound.value,
        "gap": design.gap,
    }


def agreement_answer(design: Design) -> dict[str, Any] | None:
    """Write what several starts agree on; null where one was enough because the problem is convex."""
    return None if design.solution.agreement is None else asdict(design.solution.agreement)
