"""Auditing a cam that runs today: rebuilt as its drive does, judged, and set beside the optimum of the same job."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from camwright.answers import validate_answer
from camwright.job import Job
from camwright.progress import Step, ignore
from profiles.errors import InputError
from profiles.polynomial import CamProfile
from profiles.tables.cam_table import CamTable, Unit, Units
from profiles.tables.target import Target
from profiles.tables.targets import detect, read_table, target_of
from profiles.tables.text import read_text

if TYPE_CHECKING:
    from validation.report import ValidationReport
    from validation.tables import TableJudgement


@dataclass(frozen=True, eq=False)
class Audit:
    """A cam beside the optimum.

    Parameters
    ----------
    target
        The layout that the file has.
    table
        The points of the file.
    cycle
        One cycle as the drive runs it, SI units.
    judgement
        The checks on it over several wraps.
    report
        Its motion and servo response.
    optimum
        The optimal cycle of the job, and its report.
    """

    target: Target
    table: CamTable
    cycle: CamProfile
    judgement: TableJudgement
    report: ValidationReport
    optimum: CamProfile
    optimum_report: ValidationReport

    def saving(self, measure: str) -> float | None:
        """Part of a measure that the optimum saves; ``None`` where the cam's own is unbounded or zero."""
        own = getattr(self.report.motion, measure)
        best = getattr(self.optimum_report.motion, measure)
        return None if own is None or best is None or own == 0.0 else float(1.0 - best / own)


def audit(path: Path, job: Job, target: str | None = None, units: Units | None = None, step: Step = ignore) -> Audit:
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
        Units of the file, for layouts that hold none. Where master positions are mere steps, or nothing is known, the
        table's period is taken for the cut length and its advance for the pitch.

    Raises
    ------
    InputError
        The file is not read, or is no cam of this job.
    """
    from design.optimise import solve
    from validation.report import validate
    from validation.tables import judge_table, one_cycle

    step("reading")
    text = read_text(path)
    layout = detect(text, str(path)) if target is None else target_of(target)
    table = read_table(layout, text, str(path))
    found = table.units or units or _by_the_cycle(table, job, str(path))
    rebuilt = found.to_si(layout.rebuild(table))
    cycle = one_cycle(rebuilt, job.cut)
    offset = job.machine.pitch - float(cycle(cycle.end))  # the slave's zero is the user's affair
    cycle, rebuilt = cycle.shift(0.0, offset), rebuilt.shift(0.0, offset)
    step("judging")
    judgement = judge_table(rebuilt, job.machine, job.cut, job.limits, job.servo)
    report = validate(cycle, job.machine, job.cut, job.limits, job.servo)
    step("solving")
    optimum = solve(job.machine, job.cut, job.limits, job.objective).profile
    best = validate(optimum, job.machine, job.cut, job.limits, job.servo)
    return Audit(layout, table, cycle, judgement, report, optimum, best)


def _by_the_cycle(table: CamTable, job: Job, place: str) -> Units:
    """Give the units in which the table's cycle is the job's."""
    if not table.advance > 0:
        raise InputError(
            f"{place}: the slave advances by {table.advance!r} in a cycle, so its unit cannot be told from the pitch; "
            "say it with --units"
        )
    return Units(
        Unit("master unit", job.cut.length / table.period), Unit("slave unit", job.machine.pitch / table.advance)
    )


def audit_answer(result: Audit, job: Job, path: Path) -> dict[str, Any]:
    """Answer of ``camwright audit``."""
    return {
        "job": job.name,
        "file": str(path),
        "target": result.target.name,
        "knots": result.table.points,
        "notes": list(result.table.notes),
        "profile": validate_answer(job, path, result.report)["profile"],
        "optimum": validate_answer(job, path, result.optimum_report)["profile"],
        "saving": {
            "peak_acceleration_rel": result.saving("peak_acceleration"),
            "rms_acceleration_rel": result.saving("rms_acceleration"),
        },
        "checks": [asdict(check) for check in result.judgement.checks],
        "passed": result.judgement.passed,
    }
