"""`BenderJob`: the machine, the rule and how drawings become bends, read from a TOML file."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

import numpy as np

from camwright.bender.springback_file import EXAMPLE, find_table, load_springback
from camwright.bender.toml_table import TomlTable, read_toml
from camwright.design.bender.moves import BenderDrive
from camwright.profiles.bender.division import (
    DivisionRule,
    EqualSides,
    EqualSteps,
    FewestBends,
)
from camwright.profiles.bender.nc_code import Flavour, Numbering
from camwright.profiles.bender.springback import Interpolation, Springback
from camwright.profiles.errors import InputError
from camwright.profiles.limits import Limits
from camwright.profiles.servo import Servo
from camwright.validation.bender.collision import MouldEnvelope

Made = TypeVar("Made")

BUNDLED_BENDER = Path(__file__).parent / "bender.toml"
"""The bender of drawings for which no job file is named."""

UNITS = {"mm": 1e-3, "cm": 1e-2, "m": 1.0, "in": 0.0254, "ft": 0.3048}
"""Units of drawings (m)."""


@dataclass(frozen=True)
class BenderJob:
    """One bender and one rule; all numbers in SI units.

    Parameters
    ----------
    name
        What the bender is called.
    thickness, height, least_radius
        The rule (m).
    hardness
        The rule's hardness, in the words of the springback table.
    divide
        How arcs become bends.
    springback
        The table of the rule.
    greatest_angle
        Greatest mould angle to either side (rad).
    least_turn
        Workpiece angle below which a joint is smooth (rad).
    least_step
        Least feed (m).
    drive
        Feed and mould axis.
    envelope
        The mould seen from above.
    servo
        The servo of either axis.
    feed_window, mould_window
        How near an axis is when it has arrived (m, rad).
    gap
        Distance within which ends of entities are joined (m).
    flattening
        Largest distance of a curve from its polyline (m).
    units
        Unit of drawings that do not say theirs; ``None`` refuses them.
    flavour, numbering
        How programs are written.
    warnings
        What is doubtful about the job, row by row.
    sha256
        SHA-256 of the job file, in hexadecimal.
    """

    name: str
    thickness: float
    height: float
    least_radius: float
    hardness: str
    divide: DivisionRule
    springback: Springback
    greatest_angle: float
    least_turn: float
    least_step: float
    drive: BenderDrive
    envelope: MouldEnvelope
    servo: Servo
    feed_window: float
    mould_window: float
    gap: float
    flattening: float
    units: str | None
    flavour: Flavour
    numbering: Numbering
    warnings: tuple[str, ...]
    sha256: str


def load_bender(path: Path | None = None) -> BenderJob:
    """Read a bender job; the bundled one if no file is named.

    Raises
    ------
    InputError
        All faults of the file, each with its place.
    """
    place = BUNDLED_BENDER if path is None else path
    data, text = read_toml(place, "bender job")
    faults: list[str] = []
    file = TomlTable(data, str(place), faults)
    name = file.text("name")
    rule = file.table("rule")
    thickness, height = rule.quantity("thickness", "length"), rule.quantity("height", "length")
    hardness, least_radius = rule.text("hardness"), rule.quantity("least_radius", "length")
    divide = _division(file.table("arcs"))
    back = file.table("springback")
    table = back.text("table")
    interpolation: Interpolation = back.option("interpolation", ("linear", "cubic"), "linear")
    mould, feed = file.table("mould"), file.table("feed")
    greatest, least_turn = mould.quantity("greatest_angle", "angle"), mould.quantity("least_turn", "angle")
    finger, play = mould.quantity("finger_radius", "length"), mould.quantity("play", "angle", zero=True)
    shape = np.array(mould.rows("envelope", ("length", "length"))).reshape(-1, 2)
    mould_limits, mould_window = _limits(mould, "angular "), mould.quantity("window", "angle")
    least_step = feed.quantity("least_step", "length")
    feed_limits, feed_window = _limits(feed, ""), feed.quantity("window", "length")
    servo = _servo(file.table("servo"))
    drawing = file.table("drawing")
    gap, flattening = drawing.quantity("gap", "length"), drawing.quantity("flattening", "length")
    units = drawing.option("units", ("none", *UNITS), "none")
    program = file.table("program")
    flavour: Flavour = program.option("flavour", ("fagor", "iso"), "fagor")
    first, last = program.integer("first_line", 4, 99_999_999, 10), program.integer("last_line", 4, 99_999_999, 9999)
    for part in (rule, back, mould, feed, drawing, program, file):
        part.close()
    shown = f"{place}: "
    envelope = _made(lambda: MouldEnvelope(shape[:, 0], shape[:, 1], thickness), shown + "[mould] envelope: ", faults)
    numbering = _made(lambda: Numbering(first, last), shown + "[program]: ", faults)
    springback = None
    if table and hardness:
        where = find_table(table, place.parent)
        springback = _made(lambda: load_springback(where, thickness, hardness, interpolation), "", faults)
    if not greatest < np.pi:
        faults.append(
            f"{place} [mould] greatest_angle: {np.degrees(greatest):g}°; the mould turns by less than 180° to a side"
        )
    if faults or envelope is None or numbering is None or springback is None:
        raise InputError(*faults)
    warnings = springback.warnings()
    if table == EXAMPLE:
        warnings += (
            f"{springback.name}: this springback table is an example, not measured on your rule; calibrate one",
        )
    drive = BenderDrive(feed_limits, mould_limits, finger, play)
    return BenderJob(
        name, thickness, height, least_radius, hardness, divide, springback, greatest, least_turn, least_step, drive,
        envelope, servo, feed_window, mould_window, gap, flattening, None if units == "none" else units, flavour,
        numbering, warnings, hashlib.sha256(text.encode()).hexdigest(),
    )  # fmt: skip


def _made(make: Callable[[], Made], place: str, faults: list[str]) -> Made | None:
    """Make a part of the job; on failure gather its faults instead."""
    try:
        return make()
    except InputError as error:
        faults += [place + fault for fault in error.faults]
        return None


def _division(table: TomlTable) -> DivisionRule:
    rule = table.option("rule", ("chord_error", "sides", "step"))
    if rule == "sides":
        divide: DivisionRule = EqualSides(table.integer("sides", 3, 100_000, 25))
    elif rule == "step":
        divide = EqualSteps(table.quantity("step", "length"))
    else:
        divide = FewestBends(table.quantity("chord_error", "length"))
    table.close()
    return divide


def _limits(table: TomlTable, prefix: str) -> Limits:
    speed = table.quantity("speed", "angular rate" if prefix else "speed")
    acceleration = table.quantity("acceleration", f"{prefix}acceleration")
    return Limits(speed, acceleration, table.quantity("jerk", f"{prefix}jerk"), reversal=True)


def _servo(table: TomlTable) -> Servo:
    bandwidth, damping = table.quantity("bandwidth", "angular rate"), table.number("damping", 0.0, 100.0, above=True)
    gain, sample = table.quantity("position_gain", "gain"), table.quantity("sample_time", "time")
    ahead = table.number("velocity_feedforward", 0.0, 1.0)
    table.close()
    return Servo(bandwidth, damping, gain, sample, ahead)
