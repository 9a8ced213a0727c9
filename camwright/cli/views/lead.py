"""The lead time, and where the cut falls at other line speeds."""

from __future__ import annotations

from collections.abc import Sequence

from camwright.cli.views.parts import View, new_table
from camwright.house.numbers import number, with_unit
from camwright.jobs.job import Job
from camwright.profiles.servo import mean_lag
from camwright.validation.servo.lead import LengthError


def lead_view(job: Job, errors: Sequence[LengthError]) -> View:
    """Show the lead time that makes up for the mean lag, and where the cut falls at shares of the line speed."""
    servo = job.servo
    speed, length = job.units.shown["m/s"], job.units.shown["m"]
    lengths = (f"{each}\n{length.printed}" for each in ("fixed offset", "with that lead", "from cut to cut"))
    table = new_table(
        f"Where the cut falls; mean lag {with_unit(mean_lag(servo), 's', 4)}, lead time set {with_unit(servo.lead_time, 's', 4)}",
        ("line speed", speed.printed, *lengths),
    )
    for error in errors:
        table.add_row(
            f"{100 * error.share:g} %",
            number(error.line_speed * speed.factor, 4),
            *(
                f"{value * length.factor:z.4f}".replace("-", "−")
                for value in (error.offset, error.offset_with_lead, error.variation)
            ),
        )
    return table
