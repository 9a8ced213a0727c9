"""Tables that are added by powers of the line speed, as people read them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from camwright.cli.views.files import files_view
from camwright.cli.views.parts import new_table, new_text, stacked
from camwright.drives.speed_tables import SpeedTables
from camwright.house.numbers import Units, shown, with_unit

if TYPE_CHECKING:
    from rich.console import RenderableType


def speed_tables_view(found: Sequence[SpeedTables], files: Sequence[Path], units: Units) -> RenderableType:
    """Show the sync error by line speed, of the sum and of the position table alone."""
    parts: list[RenderableType] = []
    speed, length = units.shown["m/s"], units.shown["m"]
    for each in found:
        count = len(each.cam.tables)
        table = new_table(
            title=f"{each.target.name}: {count} tables, added by powers of the line speed", title_justify="left"
        )
        headings = (
            f"line speed\n{speed.printed}",
            f"sync error\n{length.printed}",
            f"position table alone\n{length.printed}",
            "fails",
        )
        for heading in headings:
            table.add_column(heading, justify="left" if heading == "fails" else "right")
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
