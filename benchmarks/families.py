"""Families of cams: how many there are, what is proved of it, and what independent simulations make of each cam and each change.

Run it with ``python benchmarks/families.py``; it writes ``results/families.csv`` row by row and ends with 1 where anything leaves the
tolerance or a limit, or a family is refused.
"""

from __future__ import annotations

import csv
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np

from camwright.jobs.examples import example
from camwright.jobs.job import Job, parse_job
from camwright.jobs.servos import servos_of
from camwright.production.family_cams import FamilyCams, family_cams
from camwright.production.switching import Switching, switchings
from camwright.profiles.objective import ObjectiveName
from camwright.validation.production.cam_change import CamChange, run_change
from camwright.validation.production.motion_table import ShiftCam
from camwright.validation.servo.line_speeds import line_speed_errors

CASES: tuple[tuple[float, float, bool, ObjectiveName], ...] = (
    (290, 0.008, True, "sync_error"),
    (280, 0.02, True, "sync_error"),
    (266, 0.05, True, "sync_error"),
    (263, 0.06, True, "sync_error"),
    (260, 0.1, True, "sync_error"),
    (266, 0.08, True, "peak_acceleration"),
    (290, 0.03, False, "sync_error"),
    (290, 0.02, False, "sync_error"),
)
"""Cut length and sync tolerance (mm), whether the command is shaped, and the objective."""

SPEEDS, PHASES = 40, 64
RESULTS = Path(__file__).parent / "results" / "families.csv"


def job_of(length: float, tolerance: float, objective: ObjectiveName, *, shaped: bool) -> Job:
    """Give the bundled short cut, its servo known, at another length and tolerance."""
    job = parse_job(example("short-cut").text, "short-cut")
    cut = replace(job.cut, length=length * 1e-3, sync_tolerance=tolerance * 1e-3, shaped=shaped)
    return replace(job, cut=cut, objective=objective, servo_tolerance=None)


def simulated_cams(found: FamilyCams) -> list[float]:
    """Greatest sync error of each cam over its band (m)."""
    return [
        float(
            line_speed_errors(
                cam.solution.profile,
                cam.job.task,
                servos_of(cam.job),
                np.linspace(*cam.line_speeds, SPEEDS),
                PHASES,
            ).max()
        )
        for cam in found.cams
    ]


def simulated_changes(found: FamilyCams, between: tuple[Switching, ...]) -> list[float]:
    """Greatest sync error of each pair of changes at both switching speeds (m)."""
    errors = []
    for each in between:
        worst = 0.0
        for change in each.changes:
            before, after = (found.cams[number - 1] for number in (change.before, change.after))
            zero = after.running.zero
            middle = ShiftCam(change.transitions[0].profile, zero) if change.transitions else None
            cams = ShiftCam(before.solution.profile, before.running.zero), ShiftCam(after.solution.profile, zero)
            run = run_change(
                CamChange(*cams, (before.job.task, after.job.task), middle),
                found.job.servo,
                [each.down, each.up],
                PHASES,
            )
            worst = max(worst, run.sync_error)
        errors.append(worst)
    return errors


def row_of(length: float, tolerance: float, objective: ObjectiveName, *, shaped: bool) -> dict[str, object]:
    """Find a family and simulate it."""
    begun = time.process_time()
    found = family_cams(job_of(length, tolerance, objective, shaped=shaped))
    between = switchings(found)
    took = time.process_time() - begun
    cams, changes = simulated_cams(found), simulated_changes(found, between)
    held = all(each.passed for each in (*found.cams, *between))
    kept = max([*cams, *changes]) <= found.job.cut.sync_tolerance * (1.0 + 1e-6)
    bands = [f"{60 * low:.2f}-{60 * top:.2f}" for low, top in (cam.line_speeds for cam in found.cams)]
    return {
        "cut_mm": length,
        "tolerance_mm": tolerance,
        "command": "shaped" if shaped else "in_sync",
        "objective": objective,
        "cams": len(found.cams),
        "at_least": found.at_least,
        "bands_m_per_min": " ".join(bands),
        "errors_mm": " ".join(f"{error * 1e3:.4f}" for error in cams),
        "changes": " ".join(each.how for each in between),
        "change_errors_mm": " ".join(f"{error * 1e3:.4f}" for error in changes),
        "passed": int(held and kept),
        "cpu_s": f"{took:.1f}",
    }


def main() -> int:
    """Write the table."""
    passed = True
    with RESULTS.open("w", encoding="utf-8", newline="") as file:
        table: csv.DictWriter[str] | None = None
        for length, tolerance, shaped, objective in CASES:
            row = row_of(length, tolerance, objective, shaped=shaped)
            passed = passed and bool(row["passed"])
            if table is None:
                table = csv.DictWriter(file, list(row), lineterminator="\n")
                table.writeheader()
            table.writerow(row)
            file.flush()
            print(*(f"{name} {value}" for name, value in row.items()), sep=", ", flush=True)
    return 0 if passed else 1


if __name__ == "__main__":
    sys.exit(main())
