"""Minimum cut lengths."""

from __future__ import annotations

from camwright.cli.views.parts import View, new_table
from camwright.house.numbers import Units, shown, unit_shown
from camwright.studies.cut_lengths import CutLengths


def lengths_view(lengths: CutLengths, units: Units) -> View:
    """Show minimum cut lengths and what binds them."""
    unit = unit_shown("m", units)
    table = new_table("Minimum cut length", ("by", unit, f"transition\n{unit}", "binds"), left=("by", "binds"))
    table.add_row(
        "eq. 9, crossing, no shear zone", shown(lengths.eq9, "m", 4, units), shown(lengths.crossing, "m", 4, units), ""
    )
    table.add_row("eq. 10, crossing", shown(lengths.eq10, "m", 4, units), shown(lengths.crossing, "m", 4, units), "")
    table.add_row(
        "eq. 10, settling", shown(lengths.eq10_settling, "m", 4, units), shown(lengths.settling, "m", 4, units), ""
    )
    for name, least in (
        ("linear return, axis within the tolerance", lengths.linear_return),
        ("softest return, axis within the tolerance", lengths.optimised),
        ("physical bound, perfect axis", lengths.physical),
    ):
        table.add_row(name, shown(least.length, "m", 4, units), shown(least.transition, "m", 4, units), least.binding)
    return table
