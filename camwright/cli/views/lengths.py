"""Minimum cut lengths."""

from __future__ import annotations

from typing import TYPE_CHECKING

from camwright.cli.views.numbers import millimetres
from camwright.cli.views.parts import new_table
from camwright.studies.cut_lengths import CutLengths

if TYPE_CHECKING:
    from rich.console import RenderableType


def lengths_view(lengths: CutLengths) -> RenderableType:
    """Show minimum cut lengths and what binds them."""
    table = new_table(title="Minimum cut length", title_justify="left")
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
