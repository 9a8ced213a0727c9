"""Profiles side by side."""

from __future__ import annotations

from typing import TYPE_CHECKING

from camwright.cli.views.parts import new_table, new_text, stacked
from camwright.house.numbers import Shown, number, shown, unit_shown
from camwright.studies.comparison import Comparison

if TYPE_CHECKING:
    from rich.console import RenderableType


def profiles_view(comparison: Comparison) -> RenderableType:
    """Show profiles side by side, the least peak acceleration first."""
    table = new_table(title="Profiles, by peak acceleration", title_justify="left")
    table.add_column("profile")
    unit, units = comparison.job.machine.slave_unit, comparison.job.units
    speed, acceleration, jerk = (units.measure(unit + power) for power in ("/s", "/s^2", "/s^3"))
    moved = comparison["optimised"].motor.rms_torque is not None
    for name, below in (
        ("peak speed", speed.printed),
        ("peak acc.", acceleration.printed),
        ("RMS acc.", acceleration.printed),
        ("peak jerk", jerk.printed),
        *((("peak torque", "N m"), ("RMS torque", "N m"), ("energy", "J")) if moved else ()),
        ("crossing", unit_shown("m", units)),
        ("settling", unit_shown("m", units)),
        ("following", unit_shown("m", units)),
        ("shear zone", unit_shown("m", units)),
    ):
        table.add_column(f"{name}\n{below}", justify="right")
    for row in comparison.rows:
        motion, motor, servo = row.motion, row.motor, row.response
        torques = (number(value, without="unbounded") for value in (motor.peak_torque, motor.rms_torque, motor.energy))
        table.add_row(
            row.name,
            _in(motion.peak_speed, speed),
            _in(motion.peak_acceleration, acceleration),
            _in(motion.rms_acceleration, acceleration),
            _in(motion.peak_jerk, jerk),
            *(torques if moved else ()),
            shown(servo.crossing, "m", 4, units),
            shown(servo.settling, "m", 4, units),
            shown(servo.peak_following_error, "m", 4, units),
            shown(servo.shear_zone_error, "m", 4, units),
            style="bold" if row.name == "optimised" else "",
        )
    return table if comparison.screw is None else stacked(table, new_text(comparison.screw.sentence))


def _in(value: float | None, unit: Shown) -> str:
    """Write a measure in a unit."""
    return number(None if value is None else value * unit.factor, without="unbounded")
