"""The objects that ``--json`` prints."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

from camwright.comparison import Comparison, Measured
from camwright.cut_lengths import CutLengths
from camwright.design_file import job_numbers, objective_answer
from camwright.job import Job
from profiles.errors import CamwrightError, InfeasibleError

if TYPE_CHECKING:
    from camwright.results import Design
    from validation.checks import Check
    from validation.motion import Motion
    from validation.report import ValidationReport
    from validation.response import ServoResponse


def to_json(answer: dict[str, Any]) -> str:
    """Write an answer as one JSON object on one line; NaN and infinity are refused, they must be null before."""
    return json.dumps(answer, allow_nan=False) + "\n"


def millimetres(length: float | None) -> float | None:
    """Turn metres into millimetres."""
    return None if length is None else length * 1e3


def design_answer(design: Design, files: Sequence[Path]) -> dict[str, Any]:
    """Answer of ``camwright design``."""
    return {
        "job": design.job.name,
        "status": design.solution.status.value,
        "objective": objective_answer(design),
        "pieces": design.profile.pieces,
        "profiles": _profiles(design.comparison),
        "checks": _checks(design.report.checks),
        "passed": design.passed,
        "minimum_cut_length_mm": _lengths(design.lengths),
        "files": [str(file) for file in files],
    }


def compare_answer(comparison: Comparison, files: Sequence[Path]) -> dict[str, Any]:
    """Answer of ``camwright compare``: the profiles sorted by peak acceleration."""
    return {
        "job": comparison.job.name,
        "profiles": _profiles(comparison),
        "files": [str(file) for file in files],
    }


def limits_answer(job: Job, lengths: CutLengths) -> dict[str, Any]:
    """Answer of ``camwright limits``."""
    return {
        "job": job.name,
        "minimum_cut_length_mm": _lengths(lengths),
        "binding": lengths.binding,
        "eq10_with_settling_mm": millimetres(lengths.eq10_settling),
        "transition_length_mm": {
            "crossing": millimetres(lengths.crossing),
            "settling": millimetres(lengths.settling),
        },
    }


def validate_answer(job: Job, file: Path, report: ValidationReport) -> dict[str, Any]:
    """Answer of ``camwright validate``."""
    return {
        "job": job.name,
        "file": str(file),
        "profile": _measures(report.motion, report.servo),
        "checks": _checks(report.checks),
        "passed": report.passed,
    }


def check_answer(job: Job) -> dict[str, Any]:
    """Answer of ``camwright check``: the job in SI numbers."""
    return {"job": job.name, "sha256": job.sha256, "si": job_numbers(job)}


def error_answer(exit_code: int, message: str, failure: CamwrightError | None) -> dict[str, Any]:
    """Answer of a command that failed; what is infeasible says what binds, by how much, and what would work."""
    answer: dict[str, Any] = {"status": "error", "exit_code": exit_code, "message": message}
    if isinstance(failure, InfeasibleError):
        answer["status"] = "infeasible"
        answer |= {"binding": failure.binding, "excess": failure.excess, "unit": failure.unit}
        answer["suggestions"] = [asdict(suggestion) for suggestion in failure.suggestions]
    return answer


def _profiles(comparison: Comparison) -> dict[str, Any]:
    """Measures of each profile by name."""
    return {row.name: _row(row) for row in comparison.rows}


def _row(row: Measured) -> dict[str, Any]:
    """Measures of one profile of a comparison."""
    return _measures(row.motion, row.response)


def _measures(motion: Motion, response: ServoResponse | None) -> dict[str, Any]:
    """Measures of a profile; null where a value is unbounded or does not exist."""
    return {
        "peak_speed_m_per_s": motion.peak_speed,
        "min_speed_m_per_s": motion.min_speed,
        "peak_acceleration_m_per_s2": motion.peak_acceleration,
        "rms_acceleration_m_per_s2": motion.rms_acceleration,
        "peak_jerk_m_per_s3": motion.peak_jerk,
        "rms_jerk_m_per_s3": motion.rms_jerk,
        "sync_ratio_error": motion.sync_ratio_error,
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


def _checks(checks: Sequence[Check]) -> list[dict[str, Any]]:
    """List the checks in their order; values in the SI unit that each one names, master positions in m."""
    return [asdict(check) for check in checks]


def _lengths(lengths: CutLengths) -> dict[str, float | None]:
    """Minimum cut lengths in mm."""
    return {
        "eq9": millimetres(lengths.eq9),
        "eq10": millimetres(lengths.eq10),
        "physical": millimetres(lengths.physical.length),
        "linear_return_to_tolerance": millimetres(lengths.linear_return.length),
        "optimised_to_tolerance": millimetres(lengths.optimised.length),
    }
