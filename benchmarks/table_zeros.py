"""Audits tables whose zero is moved, and tables of encoder counts: the same verdict and figures, and no saving that is not there.

``python benchmarks/table_zeros.py [COUNT]``; 1000 shifts of a table's zero if not given, then the counts of 36 000, 131 072 and
1 048 576 a turn at 361 to 3601 points. Ends with exit code 1 where a figure of a moved table differs by more than 1e-6, where a verdict
does, where a peak acceleration is further from the cam's own than allowed, or where a saving is claimed above that.
"""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from camwright import load_job, optimise
from camwright.drives.audit import audit
from camwright.drives.running_cam import running_cam
from camwright.jobs.job import Job
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.returns import baseline

SAME = 1e-6
"""Part by which figures of a moved table may differ."""

POINTS = 361

ALLOWED = {36_000: 0.15, 131_072: 0.05, 1_048_576: 0.01}
"""By counts of a turn: part by which the audited peak acceleration may miss the cam's own."""


def rows(x: np.ndarray, y: np.ndarray, pitch: float, kind: str) -> str:
    """Write a table in mm, as it is or with four digits, or with 36 000 counts of a turn of the pitch for the slave."""
    if kind == "counts":
        return "".join(
            f"{a!r};{round(b / pitch * 36_000)}\n" for a, b in zip((1e3 * x).tolist(), y.tolist(), strict=True)
        )
    written = repr if kind == "exact" else "{:.4f}".format
    body = (f"{a!r},{written(b)}\n" for a, b in zip((1e3 * x).tolist(), (1e3 * y).tolist(), strict=True))
    return "x [mm],y [mm]\n" + "".join(body)


def figures(text: str, job: Job) -> tuple[bool, dict[str, float]]:
    """Judge a table: whether it passes, and the value of every check."""
    judgement = running_cam(text, "table", job).judged()
    return judgement.passed, {check.name: float(check.value or 0.0) for check in judgement.checks}


def moved(profile: CamProfile, shift: float, kind: str) -> str:
    """Write the same points with the master's zero moved: those before it come at the end, one cycle on."""
    x = np.linspace(0.0, profile.length, POINTS)[:-1]
    advance = float(profile(profile.end, side="left") - profile(profile.start))
    y = profile(x)
    if (
        kind == "counts"
    ):  # rounded once: what lies half-way between counts must not fall to the other side when it is moved
        y = np.rint(y / advance * 36_000) * (advance / 36_000)
    at = (x + shift) % profile.length
    order = np.argsort(at)
    y = np.where(x + shift >= profile.length, y - advance, y)[order]
    first = order[0]
    return rows(np.append(at[order], at[first] + profile.length), np.append(y, y[0] + advance), advance, kind)


def shifts(count: int) -> bool:
    """Move the zero of two cams, written in three ways, so often in all, each time by a random amount."""
    job, dice, sound = load_job(), np.random.default_rng(17), True
    cases = [(law, kind) for law in ("double_s", "modified_sine") for kind in ("exact", "digits", "counts")]
    for case, (law, kind) in enumerate(cases):
        profile = baseline(law, job.task)
        passed, wanted = figures(moved(profile, 0.0, kind), job)
        worst, begin, part = 0.0, time.process_time(), count // len(cases) + (case < count % len(cases))
        for _ in range(part):
            again, found = figures(moved(profile, float(dice.uniform(0.0, profile.length)), kind), job)
            for name, value in found.items():
                scale = max(
                    abs(wanted[name]), SAME
                )  # below a micrometre, or a part of a million, only the digits differ
                worst = max(worst, abs(value - wanted[name]) / scale)
            sound &= again == passed
        sound &= worst <= SAME
        took = (time.process_time() - begin) / max(1, part)
        print(
            f"{law}, {kind}: {part} shifts, verdict {passed}, figures within {worst:.2g}; {took:.3f} s each", flush=True
        )
    return sound


def counts() -> bool:
    """Audit the optimum in counts of an encoder."""
    job, sound = load_job(), True
    best = optimise(job)
    own = best.report.motion.peak_acceleration
    profile = best.profile
    with tempfile.TemporaryDirectory() as folder:
        for turn, allowed in ALLOWED.items():
            for points in (361, 721, 1441, 1801, 3601):
                x = np.linspace(0.0, profile.length, points)
                path = Path(folder) / "table.csv"
                whole = np.rint(profile(x) / job.machine.pitch * turn).astype(int).tolist()
                path.write_text("".join(f"{a!r};{b}\n" for a, b in zip((1e3 * x).tolist(), whole, strict=True)))
                result = audit(path, job)
                found, _ = result.pair("peak_acceleration")
                saving = result.saving("peak_acceleration") or 0.0
                off = found / float(own) - 1.0
                good = abs(off) <= allowed and saving <= allowed
                sound &= good
                print(
                    f"{turn} counts, {points} points: peak {found:.4f} m/s² ({100 * off:+.2f} %), saving {100 * saving:.2f} %"
                    + ("" if good else " FAULT")
                )
    return sound


def main() -> int:
    """Run both."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 1000
    sound = shifts(count) & counts()
    return 0 if sound else 1


if __name__ == "__main__":
    sys.exit(main())
