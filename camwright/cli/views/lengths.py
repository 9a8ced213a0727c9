"""Minimum cut lengths."""

from __future__ import annotations

from typing import TYPE_CHECKING

from camwright.cli.views.parts import new_table
from camwright.house.numbers import shown
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
    table.add_row("eq. 9, crossing, no shear zone", shown(lengths.eq9, "m", 4), shown(lengths.crossing, "m", 4), "")
    table.add_row("eq. 10, crossing", shown(lengths.eq10, "m", 4), shown(lengths.crossing, "m", 4), "")
    table.add_row("eq. 10, settling", shown(lengths.eq10_settling, "m", 4), shown(lengths.settling, "m", 4), "")
    for name, least in (
        ("linear return, axis within the tolerance", lengths.linear_return),
        ("softest return, axis within the tolerance", lengths.optimised),
        ("physical bound, perfect axis", lengths.physical),
    ):
        table.add_row(name, shown(least.length, "m", 4), shown(least.transition, "m", 4), least.binding)
    return table
