"""What is shown of the seams between tables."""

from __future__ import annotations

from collections.abc import Sequence

from camwright.cli.views.parts import View, new_table, new_text
from camwright.house.numbers import Units, converted, number, unit_shown
from camwright.production.tables import TargetSeams


def seams_view(tables: Sequence[TargetSeams], units: Units) -> View:
    """Show what was found at the seams of each target's tables."""
    speed, acceleration = (unit_shown(unit, units) for unit in ("m/s", "m/s^2"))
    seams = new_table(
        "Seams of the tables as read back",
        ("target", "numbers", f"velocity jump\n{speed}", f"acceleration jump\n{acceleration}", ""),
        left=("target", "numbers", ""),
    )
    for table in tables:
        told = [
            *(f"cam {cam} withheld: {why}" for cam, why in table.withheld.items()),
            *table.refused,
            *([] if table.within else ["more than two tables may be off"]),
        ]
        seams.add_row(
            table.name,
            table.number_format,
            number(converted(table.jump.velocity, "m/s", units)),
            number(converted(table.jump.acceleration, "m/s^2", units)),
            new_text("; ".join(told), "bold red") if told else new_text("passed", "green"),
        )
    return seams
