"""The object that ``camwright design --json`` prints."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from camwright.answers.axis import (
    axis_answer,
    lead_answer,
    robust_answer,
)
from camwright.answers.measures import checks_answer, lengths_answer, profiles_answer
from camwright.answers.objective import agreement_answer, objective_answer
from camwright.answers.speed_band import band_answer
from camwright.studies.design import Design
from camwright.studies.remedies import Bands, Remedy


def design_answer(design: Design, ways: Sequence[Remedy], bands: Bands | None, files: Sequence[Path]) -> dict[str, Any]:
    """Answer of ``camwright design``."""
    return brief_answer(design, files) | {
        "profiles": profiles_answer(design.comparison),
        "remedies": [asdict(way) for way in ways],
        "family_bands_m_per_s": None if bands is None else [list(band) for band in bands],
        "minimum_cut_length_mm": lengths_answer(design.lengths),
        **lead_answer(design.job, design.report.length_errors),
    }


def brief_answer(design: Design, files: Sequence[Path]) -> dict[str, Any]:
    """Answer of ``camwright design --brief``: the cam, what proves it, and the line speeds that it is released for."""
    return {
        "job": design.job.name,
        "status": design.solution.status.value,
        "objective": objective_answer(design),
        "lower_bound_method": design.bound.method,
        "starts": agreement_answer(design),
        "pieces": design.profile.pieces,
        "checks": checks_answer(design.report.checks),
        "passed": design.passed,
        **band_answer(design.band),
        "servo_aware": axis_answer(design.axis),
        "robust": robust_answer(design.robust),
        "tangential_mismatch": design.report.tangential_mismatch,
        "files": [str(file) for file in files],
    }
