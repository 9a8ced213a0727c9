"""What ``camwright family --json`` prints, and the files for the controller."""

from __future__ import annotations

import math
from typing import Any

from camwright.answers.measures import band_answer, checks_answer, objective_unit
from camwright.house.provenance import camwright_version, provenance
from camwright.jobs.numbers import job_numbers
from camwright.production.changes import Change
from camwright.production.family import Family
from camwright.production.family_cams import FamilyCam
from camwright.production.list_answer import jump_answer, seams_answer, speed_text
from camwright.production.switching import Switching
from camwright.production.tables import transition_name
from camwright.stored.design_text import design_text
from camwright.studies.axis_study import axis_study
from camwright.studies.covering import FOUND_TO
from camwright.studies.design import Design
from camwright.validation.bounds.bound import Bound

CAMS_HEADER = "cam,name,from line speed [m/min],to line speed [m/min],greatest sync error [mm],checks"
SWITCHING_HEADER = "runs,line speed,[m/min],change to,through,line meanwhile"


def family_answer(family: Family) -> dict[str, Any]:
    """Answer of ``camwright family``."""
    found = family.found
    job = found.job
    return {
        "job": job.name,
        "line_speeds_m_per_s": list(job.line_speeds),
        "overlap": found.overlap.share,
        "cams": [_cam(cam) for cam in family.cams],
        "fewest": found.fewest,
        "at_least": found.at_least,
        "bands_found_to": FOUND_TO,
        "switching": [_switching(each, holds_line=found.holds_line) for each in family.switchings],
        "seams": seams_answer(family.tables),
        "passed": family.passed,
    }


def _cam(cam: FamilyCam) -> dict[str, Any]:
    axis = cam.solution.axis
    return {
        "cam": cam.number,
        "name": cam.job.name,
        "band_m_per_s": list(cam.line_speeds),
        "objective": {"name": cam.job.objective, "value": cam.objective, "unit": objective_unit(cam.job)},
        "worst_sync_error_m": cam.errors[0],
        "worst_of_all_servos_m": max(cam.errors),
        "designed_sync_error_m": None if axis is None else axis.error,
        "sync_tolerance_m": cam.job.cut.sync_tolerance,
        **band_answer(cam.band),
        "failed_checks": [check.name for check in cam.report.checks if not check.passed],
        "passed": cam.passed,
    }


def _switching(each: Switching, *, holds_line: bool) -> dict[str, Any]:
    up, down = each.changes
    return {
        "slower": up.before,
        "faster": up.after,
        "up_m_per_s": each.up,
        "down_m_per_s": each.down,
        "both_hold_m_per_s": list(each.line_speeds),
        "how": each.how,
        "hold_line_speed": holds_line,
        "transition": {
            name: {
                "how": change.how,
                "name": transition_name(change) if change.transitions else None,
                **jump_answer(change.jump),
                "checks": checks_answer(checks),
            }
            for name, change, checks in zip(("up", "down"), (up, down), each.checks, strict=True)
        },
        "passed": each.passed,
    }


def family_record(family: Family, language: str) -> dict[str, Any]:
    """Contents of ``family.json``: the answer, and all that its sheet and its proof are made of."""
    job = family.found.job
    changes = [change for each in family.switchings for change in each.changes]
    return {
        **family_answer(family),
        "hold_line_speed": family.found.holds_line,
        "language": language,
        "toml": job.text,
        "si": job_numbers(job),
        "provenance": provenance(job.sha256),
        "profiles": {
            "cams": {cam.job.name: cam.solution.profile.to_dict() for cam in family.cams},
            "transitions": [
                {"from": change.before, "to": change.after, "profile": each.profile.to_dict()}
                for change in changes
                for each in change.transitions
            ],
        },
    }


def family_files(family: Family) -> dict[str, str]:
    """Texts of the files for the controller by name."""
    job = family.found.job
    head = [
        f"# camwright {camwright_version()}: {job.name}",
        f"# job SHA-256: {job.sha256}",
        "# a cam begins at the end of the sync zone before it; change there, at the next one after the line speed is passed",
    ]
    return {
        "cams.csv": "\n".join([*head, CAMS_HEADER, *map(_cam_row, family.cams)]) + "\n",
        "switching.csv": "\n".join([*head, SWITCHING_HEADER, *_switching_rows(family)]) + "\n",
        **{f"cam-{cam.number}.design.json": design_text(_design(cam)) for cam in family.cams},
    }


def _design(cam: FamilyCam) -> Design:
    """Put a cam as a design of its own, of which recipes and tables are made; its servos were run over its band already."""
    return Design(
        cam.job, cam.solution, Bound(math.nan, "none"), cam.report, axis_study(cam.job, cam.solution), None, cam.band
    )


def _cam_row(cam: FamilyCam) -> str:
    low, top = cam.line_speeds
    verdict = "passed" if cam.passed else "FAILED"
    return f"{cam.number},{cam.job.name},{speed_text(low, up=True)},{speed_text(top)},{max(cam.errors) * 1e3:.6f},{verdict}"


def _switching_rows(family: Family) -> list[str]:
    """Rows of the table of switching speeds: what runs, what the line does, and what is to run then."""
    meanwhile = "keeps its speed" if family.found.holds_line else "may ramp"
    rows = []
    for each in family.switchings:
        up, down = each.changes
        rows.append(f"{up.before},rises above,{speed_text(each.up)},{up.after},{_through(up)},{meanwhile}")
        rows.append(
            f"{down.before},falls below,{speed_text(each.down, up=True)},{down.after},{_through(down)},{meanwhile}"
        )
    return rows


def _through(change: Change) -> str:
    return transition_name(change) if change.how == "transition" else change.how
