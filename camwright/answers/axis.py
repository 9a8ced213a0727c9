"""The parts of ``--json`` answers that are about the axis: servo-aware designs, robustness, lead."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from camwright.jobs.job import Job
from camwright.profiles.servo import mean_lag
from camwright.studies.axis_study import AxisStudy, Robustness
from camwright.validation.servo.lead import LengthError


def axis_answer(axis: AxisStudy | None) -> dict[str, Any] | None:
    """Say what a servo-aware design promises of the axis; null for a servo-blind one."""
    if axis is None:
        return None
    return {
        "mode": axis.mode,
        "designed_error_mm": axis.designed_error * 1e3,
        "simulated_error_mm": axis.simulated_error * 1e3,
        "phases": axis.phases,
        "axis_limits": axis.axis_limits,
        "line_speeds_m_per_s": list(axis.line_speeds),
        "line_speeds_used_m_per_s": list(axis.used),
    }


def robust_answer(robust: Robustness | None) -> dict[str, Any] | None:
    """Say what the sync error is over the servo's ranges; null where the job gives none."""
    if robust is None:
        return None
    designed = robust.designed_worst
    return {
        "worst_error_mm": robust.worst * 1e3,
        "draws": robust.draws,
        "designed_worst_error_mm": None if designed is None else designed * 1e3,
        "vertices": robust.vertices,
    }


def lead_answer(job: Job, errors: Sequence[LengthError]) -> dict[str, Any]:
    """Say which lead time makes up for the mean lag, and where the cut falls by share of the line speed in per cent."""
    shares = {f"{100 * error.share:g}": error for error in errors}
    return {
        "lead_time_ms": mean_lag(job.servo) * 1e3,
        "length_error_mm": {share: error.offset * 1e3 for share, error in shares.items()},
        "length_error_with_lead_mm": {share: error.offset_with_lead * 1e3 for share, error in shares.items()},
        "length_variation_mm": {share: error.variation * 1e3 for share, error in shares.items()},
    }
