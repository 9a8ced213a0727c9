"""`BenderJob`: the machine, the rule and how drawings become bends, read from a TOML file."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

import numpy as np

from camwright.bender.springback_file import EXAMPLE, find_table, load_springback
from camwright.bender.structure import BenderFile, DrawingTable, FeedTable, MouldTable, RuleTable, limits_of
from camwright.design.bender.moves import BenderDrive
from camwright.house.files import read_text
from camwright.house.setting_fields import Settings
from camwright.house.settings import read_settings
from camwright.house.toml_file import MOST_BYTES, toml_data
from camwright.profiles.bender.bridges import BridgeRule
from camwright.profiles.bender.division import DivisionRule
from camwright.profiles.bender.nc_code import Flavour, Numbering
from camwright.profiles.bender.springback import Springback
from camwright.profiles.errors import InputError
from camwright.profiles.notice import Notice
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
    rule, mould, feed, drawing
        What its file says of them.
    divide
        How arcs become bends.
    springback
        The table of the rule.
    drive
        Feed and mould axis.
    envelope
        The mould seen from above.
    servo
        The servo of either axis.
    units
        Unit of drawings, whatever their headers say; ``None`` for the headers'.
    greatest_size
        Greatest width or height of a drawing that the machine is made for (m); infinite if it is not stated.
    flavour, numbering
        How programs are written.
    bridges
        Which bridges the rule gets.
    warnings
        What is doubtful about the job, row by row.
    sha256
        SHA-256 of the job file, in hexadecimal.
    """

    name: str
    rule: RuleTable
    mould: MouldTable
    feed: FeedTable
    drawing: DrawingTable
    divide: DivisionRule
    springback: Springback
    drive: BenderDrive
    envelope: MouldEnvelope
    servo: Servo
    units: str | None
    greatest_size: float
    flavour: Flavour
    numbering: Numbering
    bridges: BridgeRule
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
    text = read_text(place, "bender job", MOST_BYTES)
    known = Settings()
    file, faults = read_settings(BenderFile, toml_data(text, str(place), "bender job"), known)
    faults = [f"{place}: {fault}" for fault in faults]
    greatest = known.numbers.get("mould.greatest_angle", 0.0)
    if not greatest < np.pi:
        faults.append(
            f"{place}: [mould] greatest_angle = {np.degrees(greatest):g}°: the mould turns by less than 180° to a side"
        )
    if file is None:
        raise InputError(*faults)
    rule, mould, feed, drawing, program = file.rule, file.mould, file.feed, file.drawing, file.program
    shape = np.array(mould.envelope).reshape(-1, 2)
    envelope = _made(
        lambda: MouldEnvelope(shape[:, 0], shape[:, 1], rule.thickness), f"{place}: [mould] envelope: ", faults
    )
    numbering = _made(lambda: Numbering(program.first_line, program.last_line), f"{place}: [program]: ", faults)
    where = find_table(file.springback.table, place.parent)
    springback = _made(
        lambda: load_springback(where, rule.thickness, rule.hardness, file.springback.interpolation), "", faults
    )
    if faults or envelope is None or numbering is None or springback is None:
        raise InputError(*faults)
    warnings = springback.warnings()
    if file.springback.table == EXAMPLE:
        warnings += (
            Notice(
                "{table}: this springback table is an example, not measured on your rule; calibrate one",
                table=springback.name,
            ),
        )
    return BenderJob(
        name=file.name,
        rule=rule,
        mould=mould,
        feed=feed,
        drawing=drawing,
        divide=file.arcs.division,
        springback=springback,
        drive=BenderDrive(limits_of(feed), limits_of(mould), mould.finger_radius, mould.play),
        envelope=envelope,
        servo=Servo(**file.servo.model_dump()),
        units=None if drawing.units == "none" else drawing.units,
        greatest_size=np.inf if drawing.greatest_size is None else drawing.greatest_size,
        flavour=program.flavour,
        numbering=numbering,
        bridges=file.bridges.rule,
        warnings=warnings,
        sha256=hashlib.sha256(text.encode()).hexdigest(),
    )


def _made(make: Callable[[], Made], place: str, faults: list[str]) -> Made | None:
    """Make a part of the job; on failure gather its faults instead."""
    try:
        return make()
    except InputError as error:
        faults += [place + fault for fault in error.faults]
        return None
