"""Families of cams: how many there are, what is proved of it, and what independent simulations make of each cam and each change.

Run it with ``python benchmarks/families.py``; it prints a table and ends with 1 where anything leaves the tolerance or a limit.
"""

from __future__ import annotations

import sys
import time
from dataclasses import replace

import numpy as np

from camwright.jobs.examples import example
from camwright.jobs.job import Job, parse_job
from camwright.jobs.servos import servos_of
from camwright.production.family_cams import family_cams
from camwright.production.switching import switchings
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
    (280, 0.05, False, "sync_error"),
)
"""Cut length and sync tolerance (mm), whether the command is shaped, and the objective."""

SPEEDS, PHASES = 40, 64


def job_of(length: float, tolerance: float, objective: ObjectiveName, *, shaped: bool) -> Job:
    """Give the bundled short cut, its servo known, at another length and tolerance."""
    job = parse_job(example("short-cut").text, "short-cut")
    cut = replace(job.cut, length=length * 1e-3, sync_tolerance=tolerance * 1e-3, shaped=shaped)
    return replace(job, cut=cut, objective=objective, servo_tolerance=None)


def main() -> int:
    """Print the table."""
    bad = 0
    print(
        "cut [mm]  tolerance [mm]  command  objective          cams  at least  bands [m/min]; error [mm]; changes  CPU [s]"
    )
    for length, tolerance, shaped, objective in CASES:
        begun = time.process_time()
        found = family_cams(job_of(length, tolerance, objective, shaped=shaped))
        between = switchings(found)
        took = time.process_time() - begun
        told = []
        for cam in found.cams:
            speeds = np.linspace(*cam.line_speeds, SPEEDS)
            error = line_speed_errors(cam.solution.profile, cam.job.task, servos_of(cam.job), speeds, PHASES).max()
            bad += not cam.passed or error > cam.job.cut.sync_tolerance * (1.0 + 1e-6)
            low, top = (60 * each for each in cam.line_speeds)
            told.append(f"{low:.2f}-{top:.2f} ({error * 1e3:.4f})")
        for each in between:
            worst = 0.0
            for change in each.changes:
                before, after = (found.cams[number - 1] for number in (change.before, change.after))
                zero = after.running.zero
                middle = ShiftCam(change.transitions[0].profile, zero) if change.transitions else None
                run = run_change(
                    CamChange(
                        ShiftCam(before.solution.profile, before.running.zero),
                        ShiftCam(after.solution.profile, zero),
                        (before.job.task, after.job.task),
                        middle,
                    ),
                    found.job.servo,
                    [each.down, each.up],
                    PHASES,
                )
                worst = max(worst, run.sync_error)
            bad += not each.passed or worst > found.job.cut.sync_tolerance
            told.append(f"{each.how} ({worst * 1e3:.4f})")
        command = "shaped" if shaped else "in_sync"
        print(
            f"{length:8g}  {tolerance:14g}  {command:7}  {objective:17}  {len(found.cams):4}  {found.at_least:8}  "
            f"{', '.join(told)}  {took:.1f}",
            flush=True,
        )
    return int(bad > 0)


if __name__ == "__main__":
    sys.exit(main())
