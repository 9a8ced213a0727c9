"""What the commands print for people: rich tables."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from camwright.cli.axis_views import axis_lengths_view, axis_views, lead_view
from camwright.jobs.job import Job
from camwright.jobs.wording import machine_words
from camwright.studies.comparison import Comparison
from camwright.studies.cut_lengths import CutLengths

if TYPE_CHECKING:
    from camwright.design.feasible.extremes import Extremes
    from camwright.studies.axis_lengths import AxisLengths
    from camwright.studies.design import Design
    from camwright.validation.check import Check
    from camwright.validation.report import ValidationReport


def design_view(design: Design, files: Sequence[Path]) -> RenderableType:
    """Show a design: objective, comparison, checks, minimum cut lengths, files."""
    lengths = [] if design.lengths is None else [lengths_view(design.lengths)]
    return Group(
        Text("\n".join(_head(design))),
        compare_view(design.comparison),
        checks_view(design.report.checks),
        *axis_views(design),
        lead_view(design.job, design.report.length_errors),
        *lengths,
        files_view(files),
    )


def _head(design: Design) -> list[str]:
    """Say how the design ended: objective and bound, what was chosen, how well several starts agree."""
    from camwright.answers.objective import objective_unit

    solution, unit = design.solution, objective_unit(design.job).replace("^2", "²").replace("^3", "³")
    bound = (
        "no lower bound is known"
        if design.gap is None
        else f"lower bound {_number(design.bound.value)} {unit} ({design.bound.method}), gap {design.gap:.1e}"
    )
    ending = f"{design.job.name}: {solution.status.value}, {design.job.objective} {_number(design.objective)} {unit}"
    lines = [f"{ending} in {design.profile.pieces} pieces; {bound}"]
    machine = solution.machine
    if machine.place_name:
        place = f"{math.degrees(machine.place):.5g}°" if machine.slave_unit == "rad" else f"{_mm(machine.place)} mm"
        lines.append(f"sync zone on the {machine.noun}: its middle at {place}")
    starts = solution.starts
    if starts is not None:
        lines.append(
            f"{starts.agreeing} of {starts.converged} starts agree, spread {starts.spread:.1e}, KKT residual "
            f"{starts.residual:.1e}; {starts.valleys} local minima over the place of the sync zone"
        )
    return [*lines, *machine.remarks(design.job.cut)]


def compare_view(comparison: Comparison) -> RenderableType:
    """Show profiles side by side, the least peak acceleration first."""
    table = Table(title="Profiles, by peak acceleration", title_justify="left")
    table.add_column("profile")
    unit = comparison.job.machine.slave_unit
    moved = comparison["optimised"].motor.rms_torque is not None
    for name, shown in (
        ("peak speed", f"{unit}/s"),
        ("peak acc.", f"{unit}/s²"),
        ("RMS acc.", f"{unit}/s²"),
        ("peak jerk", f"{unit}/s³"),
        *((("peak torque", "N m"), ("RMS torque", "N m"), ("energy", "J")) if moved else ()),
        ("crossing", "mm"),
        ("settling", "mm"),
        ("following", "mm"),
        ("shear zone", "mm"),
    ):
        table.add_column(f"{name}\n{shown}", justify="right")
    for row in comparison.rows:
        motion, motor, servo = row.motion, row.motor, row.response
        torques = (_number(value, "unbounded") for value in (motor.peak_torque, motor.rms_torque, motor.energy))
        table.add_row(
            row.name,
            _number(motion.peak_speed),
            _number(motion.peak_acceleration, "unbounded"),
            _number(motion.rms_acceleration, "unbounded"),
            _number(motion.peak_jerk, "unbounded"),
            *(torques if moved else ()),
            _mm(servo.crossing),
            _mm(servo.settling),
            _mm(servo.peak_following_error),
            _mm(servo.shear_zone_error),
            style="bold" if row.name == "optimised" else "",
        )
    return table if comparison.screw is None else Group(table, Text(comparison.screw.sentence))


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


def limits_view(job: Job, far: Extremes, lengths: CutLengths | None, axis: AxisLengths | None) -> RenderableType:
    """Show how fast and how short a job can be done, and what binds."""
    speed = f"{_number(far.max_line_speed * 60)} m/min" if far.max_line_speed else "none works"
    length = f"{_mm(far.min_cut_length)} mm" if far.min_cut_length else "none works"
    table = Table(title="How fast, how short", title_justify="left")
    for name in ("", "", "binds"):
        table.add_column(name)
    table.add_row(f"highest line speed at a cut length of {_mm(job.cut.length)} mm", speed, far.line_speed_binding)
    table.add_row(
        f"shortest cut length at {_number(job.cut.line_speed * 60)} m/min with a sync zone of {_mm(job.cut.sync_zone)} mm",
        length,
        far.cut_length_binding,
    )
    views: list[RenderableType] = [table]
    if lengths is not None:
        views.append(lengths_view(lengths))
    if axis is not None:
        views.append(axis_lengths_view(axis))
    return Group(*views)


def lengths_view(lengths: CutLengths) -> RenderableType:
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
        ("softest return, axis within the tolerance", lengths.optimised),
        ("physical bound, perfect axis", lengths.physical),
    ):
        table.add_row(name, _mm(least.length), _mm(least.transition), least.binding)
    return table


def validate_view(job: Job, file: Path, report: ValidationReport) -> RenderableType:
    """Show the checks on a file and the verdict."""
    failed = [check.name for check in report.checks if not check.passed]
    verdict = f"{len(failed)} checks failed: {', '.join(failed)}" if failed else "every check passed"
    return Group(checks_view(report.checks), lead_view(job, report.length_errors), Text(f"{file}: {verdict}"))


def check_view(job: Job) -> RenderableType:
    """Show what a job file says."""
    cut, limits, unit = job.cut, job.limits, job.machine.slave_unit
    speed = f"{_number(limits.speed * 60)} m/min" if unit == "m" else f"{_number(limits.speed * 30 / math.pi)} rpm"
    return Text(
        f"{job.name}: cut {_mm(cut.length)} mm at {_number(cut.line_speed * 60)} m/min, "
        f"{machine_words(job.machine)}, sync zone {_mm(cut.sync_zone)} mm, "
        f"shear zone {_mm(cut.shear_zone)} mm; at most {speed}, "
        f"{_number(limits.acceleration)} {unit}/s², {_number(limits.jerk)} {unit}/s³.\nThe job file has no faults."
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
