"""Profiles side by side."""

from __future__ import annotations

from typing import TYPE_CHECKING

from camwright.cli.views.parts import new_table, new_text, stacked
from camwright.house.numbers import number, shown
from camwright.studies.comparison import Comparison

if TYPE_CHECKING:
    from rich.console import RenderableType


def profiles_view(comparison: Comparison) -> RenderableType:
    """Show profiles side by side, the least peak acceleration first."""
    table = new_table(title="Profiles, by peak acceleration", title_justify="left")
    table.add_column("profile")
    unit = comparison.job.machine.slave_unit
    moved = comparison["optimised"].motor.rms_torque is not None
    for name, below in (
        ("peak speed", f"{unit}/s"),
        ("peak acc.", f"{unit}/s²"),
        ("RMS acc.", f"{unit}/s²"),
        ("peak jerk", f"{unit}/s³"),
        *((("peak torque", "N m"), ("RMS torque", "N m"), ("energy", "J")) if moved else ()),
        ("crossing", "mm"),
        ("settling", "mm"),
        ("following", "mm"),
        ("shear zone", "mm"),
    ):
        table.add_column(f"{name}\n{below}", justify="right")
    for row in comparison.rows:
        motion, motor, servo = row.motion, row.motor, row.response
        torques = (number(value, without="unbounded") for value in (motor.peak_torque, motor.rms_torque, motor.energy))
        table.add_row(
            row.name,
            number(motion.peak_speed),
            number(motion.peak_acceleration, without="unbounded"),
            number(motion.rms_acceleration, without="unbounded"),
            number(motion.peak_jerk, without="unbounded"),
            *(torques if moved else ()),
            shown(servo.crossing, "m", 4),
            shown(servo.settling, "m", 4),
            shown(servo.peak_following_error, "m", 4),
            shown(servo.shear_zone_error, "m", 4),
            style="bold" if row.name == "optimised" else "",
        )
    return table if comparison.screw is None else stacked(table, new_text(comparison.screw.sentence))
