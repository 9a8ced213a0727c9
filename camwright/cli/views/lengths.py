"""Minimum cut lengths."""

from __future__ import annotations

from camwright.cli.views.parts import View, new_table
from camwright.house.numbers import Units, shown, unit_shown
from camwright.studies.cut_lengths import CutLengths


def lengths_view(lengths: CutLengths, units: Units) -> View:
    """Show minimum cut lengths and what binds them."""
    unit = unit_shown("m", units)
    table = new_table("Minimum cut length", ("by", unit, f"transition\n{unit}", "binds"), left=("by", "binds"))
    for name, length, transition in (
        ("eq. 9, crossing, no shear zone", lengths.eq9, lengths.crossing),
        ("eq. 10, crossing", lengths.eq10, lengths.crossing),
        ("eq. 10, settling", lengths.eq10_settling, lengths.settling),
    ):
        table.add_row(name, shown(length, "m", 4, units), shown(transition, "m", 4, units), "")
    for name, least in (
        ("linear return, axis within the tolerance", lengths.linear_return),
        ("softest return, axis within the tolerance", lengths.optimised),
        ("physical bound, perfect axis", lengths.physical),
    ):
        table.add_row(name, shown(least.length, "m", 4, units), shown(least.transition, "m", 4, units), least.binding)
    return table
