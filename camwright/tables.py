"""What the commands print for people: rich tables."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from camwright.comparison import Comparison
from camwright.cut_lengths import CutLengths
from camwright.job import Job

if TYPE_CHECKING:
    from camwright.results import Design
    from validation.checks import Check
    from validation.report import ValidationReport


def design_view(design: Design, files: Sequence[Path]) -> RenderableType:
    """Show a design: objective, comparison, checks, minimum cut lengths, files."""
    solution = design.solution
    unit = "m/s²" if solution.objective_name.endswith("acceleration") else "m/s³"
    head = Text(
        f"{design.job.name}: {solution.status.value}, {solution.objective_name} {_number(solution.objective)} {unit} "
        f"in {design.profile.pieces} pieces; lower bound {_number(design.bound.value)} {unit} "
        f"({design.bound.method}), gap {design.gap:.1e}"
    )
    return Group(
        head,
        compare_view(design.comparison),
        checks_view(design.report.checks),
        limits_view(design.lengths),
        files_view(files),
    )


def compare_view(comparison: Comparison) -> RenderableType:
    """Show profiles side by side, the least peak acceleration first."""
    table = Table(title="Profiles, by peak acceleration", title_justify="left")
    table.add_column("profile")
    for name, unit in (
        ("peak speed", "m/s"),
        ("peak acc.", "m/s²"),
        ("RMS acc.", "m/s²"),
        ("peak jerk", "m/s³"),
        ("crossing", "mm"),
        ("settling", "mm"),
        ("following", "mm"),
        ("shear zone", "mm"),
    ):
        table.add_column(f"{name}\n{unit}", justify="right")
    for row in comparison.rows:
        motion, servo = row.motion, row.response
        table.add_row(
            row.name,
            _number(motion.peak_speed),
            _number(motion.peak_acceleration, "unbounded"),
            _number(motion.rms_acceleration, "unbounded"),
            _number(motion.peak_jerk, "unbounded"),
            _mm(servo.crossing),
            _mm(servo.settling),
            _mm(servo.peak_following_error),
            _mm(servo.shear_zone_error),
            style="bold" if row.name == "optimised" else "",
        )
    return table


def checks_view(checks: Sequence[Check]) -> RenderableType:
    """Show checks with values, limits and the master position of the worst value."""
    table = Table(title="Checks", title_justify="left")
    for name in ("check", "", "value", "limit", "unit", "at", "source"):
        table.add_column(name, justify="right" if name in ("value", "limit", "at") else "left")
    for check in checks:
        table.add_row(
            check.name,
            Text("passed", "green") if check.passed else Text("FAILED", "bold red"),
            _number(check.value, "none"),
            _number(check.limit, ""),
            check.unit,
            "" if check.at is None else f"{_mm(check.at)} mm",
            Text(check.source),
        )
    return table


def limits_view(lengths: CutLengths) -> RenderableType:
    """Show minimum cut lengths and what binds them."""
    table = Table(title="Minimum cut length", title_justify="left")
    table.add_column("by")
    table.add_column("mm", justify="right")
    table.add_column("transition\nmm", justify="right")
    table.add_column("binds")
    table.add_row("eq. 9, crossing, no shear zone", _mm(lengths.eq9), _mm(lengths.crossing), "")
    table.add_row("eq. 10, crossing", _mm(lengths.eq10), _mm(lengths.crossing), "")
    table.add_row("eq. 10, settling", _mm(lengths.eq10_settling), _mm(lengths.settling), "")
    for name, least in (
        ("linear return, axis within the tolerance", lengths.linear_return),
        ("fastest return, axis within the tolerance", lengths.optimised),
        ("physical bound, perfect axis", lengths.physical),
    ):
        table.add_row(name, _mm(least.length), _mm(least.transition), least.binding)
    return table


def validate_view(file: Path, report: ValidationReport) -> RenderableType:
    """Show the checks on a file and the verdict."""
    failed = [check.name for check in report.checks if not check.passed]
    verdict = f"{len(failed)} checks failed: {', '.join(failed)}" if failed else "every check passed"
    return Group(checks_view(report.checks), Text(f"{file}: {verdict}"))


def check_view(job: Job) -> RenderableType:
    """Show what a job file says."""
    cut, limits = job.cut, job.limits
    return Text(
        f"{job.name}: cut {_mm(cut.length)} mm at {_number(cut.line_speed * 60)} m/min, "
        f"circumference {_mm(job.machine.circumference)} mm, sync zone {_mm(cut.sync_zone)} mm, "
        f"shear zone {_mm(cut.shear_zone)} mm; at most {_number(limits.speed * 60)} m/min, "
        f"{_number(limits.acceleration)} m/s², {_number(limits.jerk)} m/s³. The job file has no faults."
    )


def files_view(files: Sequence[Path]) -> RenderableType:
    """Show the files that were written, one a line."""
    return Text("\n".join(f"wrote {file}" for file in files))


def _number(value: float | None, without: str = "–") -> str:
    """Write a number with five digits."""
    return without if value is None else f"{value:.5g}"


def _mm(length: float | None) -> str:
    """Write a length in millimetres."""
    return "–" if length is None else f"{length * 1e3:.4g}"
