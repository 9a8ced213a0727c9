"""What the commands print about the axis: servo-aware designs, robustness, lead, minimum cut lengths."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from camwright.jobs.job import Job
from camwright.profiles.servo import mean_lag

if TYPE_CHECKING:
    from camwright.studies.axis_lengths import AxisLengths
    from camwright.studies.design import Design
    from camwright.validation.servo.lead import LengthError


def axis_views(design: Design) -> list[RenderableType]:
    """Show what a servo-aware design promises of the axis, and the sync error over the servo's ranges."""
    lines = []
    axis, robust = design.axis, design.robust
    if axis is not None:
        held = (
            "holds the limits of speed and acceleration too"
            if axis.axis_limits
            else "does not hold all limits of the command"
        )
        lines.append(
            f"servo-aware, command {axis.mode}: sync error of the axis {_um(axis.designed_error)} µm designed, "
            f"{_um(axis.simulated_error)} µm simulated, over {axis.phases} sampling phases; the axis {held}"
        )
    if robust is not None:
        designed = (
            ""
            if robust.designed_worst is None
            else f"{_um(robust.designed_worst)} µm at the {robust.vertices} corners as designed, "
        )
        lines.append(
            f"over the ranges of the servo: sync error at most {designed}{_um(robust.worst)} µm in {robust.draws} random servos"
        )
    return [Text("\n".join(lines))] if lines else []


def lead_view(job: Job, errors: Sequence[LengthError]) -> RenderableType:
    """Show the lead time that makes up for the mean lag, and where the cut falls at shares of the line speed."""
    servo = job.servo
    table = Table(
        title=f"Where the cut falls; mean lag {mean_lag(servo) * 1e3:.4g} ms, lead time set {servo.lead_time * 1e3:.4g} ms",
        title_justify="left",
    )
    for name in ("line speed", "m/min", "fixed offset\nmm", "with that lead\nmm", "from cut to cut\nmm"):
        table.add_column(name, justify="right")
    for error in errors:
        table.add_row(
            f"{100 * error.share:g} %",
            f"{error.line_speed * 60:.4g}",
            *(f"{value * 1e3:z.4f}" for value in (error.offset, error.offset_with_lead, error.variation)),
        )
    return table


def axis_lengths_view(lengths: AxisLengths) -> RenderableType:
    """Show how short a piece can be cut with the axis within the tolerance, the sync zone chosen best each time."""
    table = Table(title="Minimum cut length with the axis in sync", title_justify="left")
    table.add_column("by")
    table.add_column("limits of the command\nmm", justify="right")
    table.add_column("of the axis too\nmm", justify="right")
    for name, value, strict in (
        ("linear return (limit of speed alone)", lengths.linear_return, ""),
        ("polynomial 3-4-5", lengths.poly_3_4_5, ""),
        ("servo-aware, command in sync", lengths.in_sync, _mm(lengths.in_sync_axis_limits)),
        ("servo-aware, command shaped", lengths.shaped, _mm(lengths.shaped_axis_limits)),
    ):
        table.add_row(name, _mm(value), strict)
    return table


def _um(length: float) -> str:
    return f"{length * 1e6:.4g}"


def _mm(length: float | None) -> str:
    return "none" if length is None else f"{length * 1e3:.2f}"
