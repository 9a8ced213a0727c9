"""Minimum cut lengths."""

from __future__ import annotations

from rich.console import RenderableType
from rich.table import Table

from camwright.cli.views.numbers import millimetres
from camwright.studies.axis_lengths import AxisLengths
from camwright.studies.cut_lengths import CutLengths


def lengths_view(lengths: CutLengths) -> RenderableType:
    """Show minimum cut lengths and what binds them."""
    table = Table(title="Minimum cut length", title_justify="left")
    table.add_column("by")
    table.add_column("mm", justify="right")
    table.add_column("transition\nmm", justify="right")
    table.add_column("binds")
    table.add_row("eq. 9, crossing, no shear zone", millimetres(lengths.eq9), millimetres(lengths.crossing), "")
    table.add_row("eq. 10, crossing", millimetres(lengths.eq10), millimetres(lengths.crossing), "")
    table.add_row("eq. 10, settling", millimetres(lengths.eq10_settling), millimetres(lengths.settling), "")
    for name, least in (
        ("linear return, axis within the tolerance", lengths.linear_return),
        ("softest return, axis within the tolerance", lengths.optimised),
        ("physical bound, perfect axis", lengths.physical),
    ):
        table.add_row(name, millimetres(least.length), millimetres(least.transition), least.binding)
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
        ("servo-aware, command in sync", lengths.in_sync, _hundredths(lengths.in_sync_axis_limits)),
        ("servo-aware, command shaped", lengths.shaped, _hundredths(lengths.shaped_axis_limits)),
    ):
        table.add_row(name, _hundredths(value), strict)
    return table


def _hundredths(length: float | None) -> str:
    """Write a length in millimetres with two decimals."""
    return "none" if length is None else f"{length * 1e3:.2f}"
