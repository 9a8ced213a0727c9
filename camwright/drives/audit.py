"""Auditing a cam that runs today: rebuilt as its drive does, judged, and set beside the optimum of the same job."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from camwright.answers.line_ramps import line_ramps_answer
from camwright.answers.measures import report_answer
from camwright.drives.running_cam import running_cam
from camwright.house.progress import Step, ignore
from camwright.jobs.job import Job
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.tables.cam_table import CamTable
from camwright.profiles.tables.target import Target
from camwright.profiles.tables.targets import TARGETS
from camwright.profiles.tables.text import read_text
from camwright.studies.line_ramps import line_ramps
from camwright.studies.remedies import solve_or_advise
from camwright.validation.differences import differences, sampled_peaks
from camwright.validation.rebuilt import TableJudgement
from camwright.validation.report import ValidationReport, judge

MEASURES: dict[str, str] = {
    "peak_speed": "peak speed",
    "peak_acceleration": "peak acceleration",
    "rms_acceleration": "RMS acceleration",
    "peak_jerk": "peak jerk",
    "rms_jerk": "RMS jerk",
}
"""Measures of the slave that the audit sets side by side."""


@dataclass(frozen=True)
class Sampled:
    """What a drive is commanded: second and third differences of the positions at the servo's sample time.

    Greatest magnitudes over all sampling phases and the whole cycle, root mean squares over the return zone and all
    phases, like those of `camwright.validation.motion.Motion` (slave unit over s², over s³).
    """

    peak_acceleration: float
    rms_acceleration: float
    peak_jerk: float
    rms_jerk: float


@dataclass(frozen=True, eq=False)
class Audit:
    """A cam beside the optimum.

    Parameters
    ----------
    target
        The layout that the file has.
    table
        The points of the file.
    notes
        What the reader and the alignment found worth telling.
    job
        The job, its machine placed as the cam has it.
    cycle
        One cycle as the drive runs it, SI units.
    judgement
        The checks on it over several wraps.
    report
        Its motion and servo response.
    sampled
        What the drive is commanded.
    optimum_job, optimum, optimum_report, optimum_sampled
        The optimal cycle of the job, alike.
    counted
        Whether the file's positions are counts whose rounding shows in the exact derivatives.
    """

    target: Target
    table: CamTable
    notes: tuple[str, ...]
    job: Job
    cycle: CamProfile
    judgement: TableJudgement
    report: ValidationReport
    sampled: Sampled
    optimum_job: Job
    optimum: CamProfile
    optimum_report: ValidationReport
    optimum_sampled: Sampled
    counted: bool = False

    def is_sampled(self, measure: str) -> bool:
        """Whether a measure is compared by differences: where straight lines, steps or counts leave the exact one unbounded."""
        return hasattr(self.sampled, measure) and (
            self.counted
            or any(getattr(report.motion, measure) is None for report in (self.report, self.optimum_report))
        )

    def pair(self, measure: str) -> tuple[float, float]:
        """Give a measure of the cam and of the optimum, both exact or both by differences."""
        sources = (
            (self.sampled, self.optimum_sampled)
            if self.is_sampled(measure)
            else (self.report.motion, self.optimum_report.motion)
        )
        return float(getattr(sources[0], measure)), float(getattr(sources[1], measure))

    def saving(self, measure: str) -> float | None:
        """Part of a measure that the optimum saves, negative where it takes more; ``None`` if the cam's own is zero."""
        own, best = self.pair(measure)
        return None if own == 0.0 else 1.0 - best / own


def audit(
    path: Path,
    job: Job,
    target: str | None = None,
    units: str | None = None,
    travel: str | None = None,
    slopes: str | None = None,
    step: Step = ignore,
) -> Audit:
    """Read a cam that runs today, rebuild it as its drive does, and compare it with the optimum of the job.

    Parameters
    ----------
    path
        The file.
    job
        The job that the cam is run for.
    target
        Name of the layout; found by its words if not given.
    units
        Units of the file, for layouts that hold none, as `camwright.jobs.table_units.parse_units` reads them. Where nothing
        is known, the table's period is taken for the cut length and its advance for the pitch.
    travel
        Slave's travel per cycle, for files that leave out where the cycle ends: ``400 mm``.
    slopes
        Ratios at the start and the end of the table, ``1,1``, for a CAM tag without those that MCCP is given.

    Notes
    -----
    The zeros of master and slave are the user's affair: if the cam is not in sync where the job's cycle is, it is begun
    where it fits the sync zone best, and a note says where.

    Raises
    ------
    InputError
        The file is not read, or is no cam of this job.

    Examples
    --------
    >>> import tempfile
    >>> from camwright import audit, export, load_job, optimise
    >>> job = load_job()
    >>> written = export(optimise(job), ["csv"], tempfile.mkdtemp())
    >>> found = audit(written.files[0], job)
    >>> found.judgement.passed, abs(found.saving("peak_acceleration")) < 1e-6     # the optimum itself leaves nothing to save
    (True, True)
    """
    step("reading")
    found = running_cam(read_text(path), str(path), job, target, units, travel, slopes, head=_head_beside(path))
    placed, cycle = found.job, found.cycle
    step("judging")
    judgement = found.judged()
    report = judge(cycle, placed.task, job.servo)
    step("solving")
    solution = solve_or_advise(job)
    best = replace(job, machine=solution.machine)
    best_report = judge(solution.profile, best.task, job.servo)
    return Audit(
        found.target,
        found.table,
        found.notes,
        placed,
        cycle,
        judgement,
        report,
        _sampled(cycle, job),
        best,
        solution.profile,
        best_report,
        _sampled(solution.profile, job),
        found.counted,
    )


def _head_beside(path: Path) -> str:
    """Read the text that camwright writes beside tables whose layout has no room for a head; nothing where there is none."""
    for target in TARGETS.values():
        for ending in target.endings[1:]:
            beside = path.with_name(path.name.removesuffix(target.endings[0]) + ending)
            if path.name.endswith(target.endings[0]) and beside.is_file():
                return read_text(beside)
    return ""


def _sampled(cycle: CamProfile, job: Job) -> Sampled:
    """Measure the differences of a cycle at the servo's sample time."""
    cut = job.cut
    (acceleration, _), (jerk, _) = sampled_peaks(cycle, cut, job.servo)
    x = cut.return_start + cut.return_zone * (np.arange(_RMS_PLACES) + 0.5) / _RMS_PLACES
    step = cut.line_speed * job.servo.sample_time
    rms = [
        float(np.sqrt(np.mean(differences(cycle, x - 0.5 * order * step + cut.length, order, cut, job.servo) ** 2)))
        for order in (2, 3)
    ]
    return Sampled(acceleration, rms[0], jerk, rms[1])


_RMS_PLACES = 20_000


def audit_answer(result: Audit, path: Path, files: Sequence[Path] = ()) -> dict[str, Any]:
    """Answer of ``camwright audit``."""
    job = result.job
    return {
        "job": job.name,
        "file": str(path),
        "target": result.target.name,
        "knots": result.table.points,
        "notes": list(result.notes),
        "profile": report_answer(result.report, job.machine.slave_unit),
        "optimum": report_answer(result.optimum_report, result.optimum_job.machine.slave_unit),
        "saving": {f"{name}_rel": result.saving(name) for name in ("peak_acceleration", "rms_acceleration")},
        "saving_by": "differences at the sample time" if result.is_sampled("peak_acceleration") else "exact",
        "sampled": {
            "sample_time_s": job.servo.sample_time,
            "slave_unit": job.machine.slave_unit,
            "profile": asdict(result.sampled),
            "optimum": asdict(result.optimum_sampled),
        },
        "line_ramp": line_ramps_answer(line_ramps(result.cycle, job)),
        "checks": [asdict(check) for check in result.judgement.checks],
        "passed": result.judgement.passed,
        "files": [str(file) for file in files],
    }
