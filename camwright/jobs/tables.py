"""The tables of a job file for numbers in SI units: what the reader turns into the same numbers, bit by bit."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from camwright.house.units import quantity_text
from camwright.profiles.cut import Cut
from camwright.profiles.limits import Limits
from camwright.profiles.line import Line
from camwright.profiles.machines import Machine
from camwright.profiles.machines.fields import Quantity, fields_of
from camwright.profiles.servo import Servo
from camwright.profiles.servo_tolerance import ServoTolerance

_SERVO = {
    "bandwidth": "angular rate",
    "position_gain": "gain",
    "sample_time": "time",
    "dead_time": "time",
    "lead_time": "time",
    "acceleration_feedforward": "time squared",
    "jerk_feedforward": "time cubed",
}
"""Keys of a servo that have units, and their kinds; the others are bare numbers."""

_FURTHER = ("acceleration_feedforward", "jerk_feedforward")
"""Keys of a servo that are left out where they are 0."""


def machine_table(machine: Machine) -> dict[str, Any]:
    """Write a machine as the table of a job file; the place of its sync zone is left out while it is free."""
    table: dict[str, Any] = {"kind": machine.kind}
    for each in fields_of(type(machine)):
        value, about = getattr(machine, each.name), each.about
        if each.name == machine.place_name and not machine.placed:
            continue
        table[each.key] = quantity_text(value, about.kind, about.example) if isinstance(about, Quantity) else value
    return table


def cut_table(cut: Cut) -> dict[str, Any]:
    """Write a cut as the table of a job file; a shear zone at the end of the sync zone is there by default."""
    at_end = cut.shear_zone_at == cut.sync_zone - cut.shear_zone
    at = {} if at_end else {"shear_zone_at": quantity_text(cut.shear_zone_at, "length")}
    return {
        "length": quantity_text(cut.length, "length"),
        "line_speed": quantity_text(cut.line_speed, "speed"),
        "sync_zone": _zone_text(cut.sync_zone, cut.sync_time),
        "shear_zone": _zone_text(cut.shear_zone, cut.shear_time),
        **at,
        "sync_tolerance": quantity_text(cut.sync_tolerance, "length"),
        "sync_ratio": cut.sync_ratio,
    }


def _zone_text(length: float, time: float | None) -> str:
    return quantity_text(length, "length") if time is None else quantity_text(time, "time")


def limits_table(limits: Limits, *, turning: bool) -> dict[str, Any]:
    """Write limits as the table of a job file; those of a slave that turns are angular."""
    table: dict[str, Any] = {
        "speed": quantity_text(limits.speed, "angular rate" if turning else "speed"),
        "acceleration": quantity_text(limits.acceleration, "angular acceleration" if turning else "acceleration"),
        "jerk": quantity_text(limits.jerk, "angular jerk" if turning else "jerk"),
        "reversal": limits.reversal,
    }
    if limits.motor is not None:
        table["motor"] = [
            [quantity_text(speed, "angular rate", "3000 rpm"), quantity_text(torque, "torque")]
            for speed, torque in limits.motor.points
        ]
    return table


def line_table(line: Line) -> dict[str, Any]:
    """Write how the line ramps as the table of a job file, with what is known of it."""
    kinds = {"acceleration": "acceleration", "stop": "acceleration", "jerk": "jerk"}
    return {key: quantity_text(value, kinds[key]) for key, value in asdict(line).items() if value is not None}


def servo_table(servo: Servo, tolerance: ServoTolerance | None) -> dict[str, Any]:
    """Write a servo and the ranges of its parameters as the table of a job file."""
    table: dict[str, Any] = {key: _servo_number(key, value) for key, value in servo_numbers(servo).items()}
    if tolerance is not None:
        table["tolerance"] = {
            key: [_servo_number(key, end) for end in ends]
            for key, ends in tolerance.ranges.items()
            if ends != (getattr(servo, key),) * 2
        }
    return table


def servo_numbers(servo: Servo) -> dict[str, float]:
    """Give the parameters of a servo by name (SI); feed-forward beyond that of the velocity only where there is some."""
    return {key: value for key, value in asdict(servo).items() if value or not key.startswith(_FURTHER)}


def _servo_number(key: str, value: float) -> str | float:
    return quantity_text(value, _SERVO[key]) if key in _SERVO else value
