"""Tables that are added by powers of the line speed, as people read them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from camwright.cli.views.parts import View, files_view, new_table, new_text, stacked
from camwright.drives.speed_tables import SpeedTables
from camwright.house.numbers import Units, shown, with_unit


def speed_tables_view(found: Sequence[SpeedTables], files: Sequence[Path], units: Units) -> View:
    """Show the sync error by line speed, of the sum and of the position table alone."""
    parts: list[View] = []
    speed, length = units.shown["m/s"], units.shown["m"]
    for each in found:
        errors = (f"{what}\n{length.printed}" for what in ("sync error", "position table alone"))
        heads = (f"line speed\n{speed.printed}", *errors, "fails")
        title = f"{each.target.name}: {len(each.cam.tables)} tables, added by powers of the line speed"
        table = new_table(title, heads, left=("fails",))
        for at in each.judged:
            table.add_row(
                shown(at.line_speed, "m/s", units=units),
                shown(at.error, "m", 3, units),
                shown(at.alone, "m", 3, units),
                ", ".join(at.failed) or "–",
            )
        parts.append(table)
        if not each.passed:
            most = "" if each.up_to is None else f"; all pass up to {with_unit(each.up_to, 'm/s', units=units)}"
            parts.append(new_text(f"{each.target.name}: not released, a line speed fails{most}", "bold red"))
    note = "No table was tested on a controller. Check the integrity of the data after every import."
    return stacked(*parts, *([files_view(files)] if files else []), new_text(note))
