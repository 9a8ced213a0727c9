"""What ``camwright cutlist --json`` prints, and the files for the controller."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from camwright.house.provenance import camwright_version
from camwright.production.changes import Change
from camwright.production.cut_list import ListPlan, ListStudy
from camwright.production.list_file import line_run_text
from camwright.production.tables import TargetSeams, transition_name
from camwright.validation.production.seams import NO_JUMP, SeamJump

PLC_HEADER = "piece,length [mm],kind,cam,run first,highest line speed [m/min]"
CAMS_HEADER = "cam,length [mm],highest line speed [m/min],perfect axis at most [m/min],bears the line's ramp,checks"
CHANGES_HEADER = "from cam,to cam,how,highest line speed [m/min],times in the list"

_DECIMALS = 6
"""Decimals of a line speed in a table for a controller (m/min), rounded down: never faster than what was computed."""


def list_answer(study: ListStudy) -> dict[str, Any]:
    """Answer of ``camwright cutlist``."""
    planned = study.planned
    job, asked, line = planned.job, planned.asked, planned.line
    jump = NO_JUMP
    for table in study.tables:
        jump = jump.worst(table.jump)
    return {
        "job": job.name,
        "pieces": asked.pieces,
        "cams": len(planned.cams),
        "transitions": len(planned.transitions),
        "time_s": line.time,
        "time_at_slowest_s": planned.time_at_slowest,
        "scrap_mm": asked.scrap * 1e3,
        "matrix": [_change(change) for change in planned.changes.values()],
        "seams": {
            **jump_answer(jump),
            "by_target": seams_answer(study.tables),
        },
        "crops": int(asked.crops.sum()),
        "material_m": float(asked.gaps.sum()),
        "line_acceleration_m_per_s2": job.line.acceleration,
        "line_jerk_m_per_s3": job.line.jerk,
        "cam_list": [
            {
                "cam": cam.number,
                "length_mm": cam.length * 1e3,
                "pieces": int((planned.of == cam.number - 1).sum()),
                "line_speed_m_per_s": cam.line_speed,
                "highest_line_speed_m_per_s": cam.perfect,
                "bears_ramps": cam.bears_ramps,
                "failed_checks": [check.name for check in cam.report.checks if not check.passed],
            }
            for cam in planned.cams
        ],
        "servo": {
            "greatest_sync_error_m": float(study.run.sync_errors.max()),
            "greatest_length_error_m": float(np.abs(study.run.lengths - asked.gaps).max()),
            "pieces_outside_tolerance": study.off,
            "sync_tolerance_m": job.cut.sync_tolerance,
        },
        "passed": study.passed,
    }


def _change(change: Change) -> dict[str, Any]:
    return {
        "from": change.before,
        "to": change.after,
        "how": change.how,
        "line_speed_m_per_s": change.line_speed,
        "times": change.times,
        **jump_answer(change.jump),
    }


def list_files(study: ListStudy) -> dict[str, str]:
    """Texts of the files for the controller by name."""
    head = [
        f"# camwright {camwright_version()}: {study.planned.job.name}",
        f"# job SHA-256: {study.planned.job.sha256}",
        "# highest line speeds are rounded down; a cam begins at the end of the sync zone before it",
    ]
    line = study.planned.job.line
    ramp = f"the line's ramp: {line.acceleration:.9g} m/s^2"
    if line.jerk is not None:
        ramp += f", its jerk: {line.jerk:.9g} m/s^3; the acceleration is straight between the rows"
    return {
        "cut-list.csv": "\n".join([*head, PLC_HEADER, *_pieces(study.planned)]) + "\n",
        "cams.csv": "\n".join([*head, CAMS_HEADER, *_cams(study.planned)]) + "\n",
        "changes.csv": "\n".join([*head, CHANGES_HEADER, *_changes(study.planned)]) + "\n",
        "line-speed.csv": line_run_text(study.planned.line, [line.removeprefix("# ") for line in head[:2]] + [ramp]),
    }


def speed_text(value: float, *, up: bool = False) -> str:
    """Write a line speed in m/min, rounded down or up."""
    scaled = value * 60 * 10**_DECIMALS
    return f"{(math.ceil(scaled) if up else math.floor(scaled)) / 10**_DECIMALS:.{_DECIMALS}f}"


def _pieces(planned: ListPlan) -> list[str]:
    """Rows of the table of pieces."""
    first: dict[int, str] = {}
    for change in planned.transitions:
        for number in range(len(change.transitions)):
            name = transition_name(change, number)
            first |= dict.fromkeys((change.first_pieces(planned.of) + number).tolist(), name)
    rows = []
    crops = planned.asked.crops.tolist()
    numbers = zip((planned.of + 1).tolist(), planned.asked.gaps.tolist(), planned.highest.tolist(), strict=True)
    for piece, (cam, length, highest) in enumerate(numbers):
        kind = "crop" if crops[piece] else "cut"
        rows.append(f"{piece + 1},{length * 1e3:.10g},{kind},{cam},{first.get(piece, '')},{speed_text(highest)}")
    return rows


def _cams(planned: ListPlan) -> list[str]:
    """Rows of the table of cams."""
    return [
        f"{cam.number},{cam.length * 1e3:.10g},{speed_text(cam.line_speed)},{speed_text(cam.perfect)},"
        f"{'yes' if cam.bears_ramps else 'no'},{'passed' if cam.report.passed else 'FAILED'}"
        for cam in planned.cams
    ]


def _changes(planned: ListPlan) -> list[str]:
    """Rows of the table of changes."""
    return [
        f"{change.before},{change.after},{change.how},{speed_text(change.line_speed)},{change.times}"
        for change in planned.changes.values()
    ]


def jump_answer(jump: SeamJump) -> dict[str, float]:
    """Answer of a jump at a seam."""
    return {
        "velocity_jump_m_per_s": jump.velocity,
        "acceleration_jump_m_per_s2": jump.acceleration,
        "position_jump_m": jump.position,
    }


def seams_answer(tables: tuple[TargetSeams, ...]) -> dict[str, Any]:
    """Tell the steps at the seams of the tables of each target, which tables were withheld and why, and what it refused."""
    return {
        table.name: {
            "number_format": table.number_format,
            **jump_answer(table.jump),
            "passed": table.passed,
            "withheld": {str(number): why for number, why in table.withheld.items()},
            "refused": list(table.refused),
        }
        for table in tables
    }
