"""The objects that ``--json`` prints."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from camwright.answers.axis import (
    axis_answer,
    axis_lengths_answer,
    lead_answer,
    robust_answer,
)
from camwright.answers.objective import agreement_answer, objective_answer
from camwright.design.feasible.extremes import Extremes
from camwright.jobs.job import Job
from camwright.profiles.machines.machine import SlaveUnit
from camwright.studies.axis_lengths import AxisLengths
from camwright.studies.comparison import Comparison
from camwright.studies.cut_lengths import CutLengths
from camwright.studies.design import Design
from camwright.studies.measured import Measured
from camwright.validation.check import Check
from camwright.validation.motion import MotionMeasures
from camwright.validation.motor import MotorMeasures
from camwright.validation.report import ValidationReport
from camwright.validation.servo.response import ServoResponse


def millimetres(length: float | None) -> float | None:
    """Turn metres into millimetres."""
    return None if length is None else length * 1e3


def design_answer(design: Design, files: Sequence[Path]) -> dict[str, Any]:
    """Answer of ``camwright design``."""
    return {
        "job": design.job.name,
        "status": design.solution.status.value,
        "objective": objective_answer(design),
        "lower_bound_method": design.bound.method,
        "starts": agreement_answer(design),
        "pieces": design.profile.pieces,
        "profiles": _profiles(design.comparison),
        "checks": _checks(design.report.checks),
        "passed": design.passed,
        "minimum_cut_length_mm": _lengths(design.lengths),
        "servo_aware": axis_answer(design.axis),
        "robust": robust_answer(design.robust),
        **lead_answer(design.job, design.report.length_errors),
        "tangential_mismatch": design.report.tangential_mismatch,
        "files": [str(file) for file in files],
    }


def compare_answer(comparison: Comparison, files: Sequence[Path]) -> dict[str, Any]:
    """Answer of ``camwright compare``: the profiles sorted by peak acceleration."""
    return {
        "job": comparison.job.name,
        "profiles": _profiles(comparison),
        "files": [str(file) for file in files],
    }


def limits_answer(job: Job, far: Extremes, lengths: CutLengths | None, axis: AxisLengths | None) -> dict[str, Any]:
    """Answer of ``camwright limits``; null where nothing works, or where the published equations are not about the machine."""
    return {
        "job": job.name,
        "max_line_speed_m_per_min": None if far.max_line_speed is None else far.max_line_speed * 60,
        "min_cut_length_mm": millimetres(far.min_cut_length),
        "binding": {"line_speed": far.line_speed_binding, "cut_length": far.cut_length_binding},
        "minimum_cut_length_mm": _lengths(lengths),
        "physical_bound_binding": lengths.binding if lengths else None,
        "eq10_with_settling_mm": millimetres(lengths.eq10_settling) if lengths else None,
        "transition_length_mm": {
            "crossing": millimetres(lengths.crossing) if lengths else None,
            "settling": millimetres(lengths.settling) if lengths else None,
        },
        **axis_lengths_answer(axis),
    }


def validate_answer(job: Job, file: Path, report: ValidationReport) -> dict[str, Any]:
    """Answer of ``camwright validate``."""
    return {
        "job": job.name,
        "file": str(file),
        "profile": _measures(report.motion, report.tool, report.motor, report.servo, job.machine.slave_unit),
        "checks": _checks(report.checks),
        "passed": report.passed,
        **lead_answer(job, report.length_errors),
    }


def _profiles(comparison: Comparison) -> dict[str, Any]:
    """Measures of each profile by name."""
    profiles = {row.name: _row(row, comparison.job.machine.slave_unit) for row in comparison.rows}
    if comparison.screw is not None:
        profiles["screw_carriage"] = _row(comparison.screw.row, "m")
    return profiles


def _row(row: Measured, unit: SlaveUnit) -> dict[str, Any]:
    """Measures of one profile of a comparison."""
    return _measures(row.motion, row.tool, row.motor, row.response, unit)


def _measures(
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


def _checks(checks: Sequence[Check]) -> list[dict[str, Any]]:
    """List the checks in their order; values in the SI unit that each one names, master positions in m."""
    return [asdict(check) for check in checks]


def _lengths(lengths: CutLengths | None) -> dict[str, float | None]:
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
