"""Files that hold a profile: cam.csv with its head, and reading any of them."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

from camwright.house.files import read_bytes
from camwright.house.numbers import typed
from camwright.house.provenance import provenance
from camwright.jobs.job import Job
from camwright.jobs.place import not_placed, place_in
from camwright.jobs.table_cycle import whole_cycle
from camwright.profiles.errors import InputError
from camwright.profiles.machines import Machine
from camwright.profiles.machines.machine import SlaveUnit
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.tables import csv_target
from camwright.profiles.tables.cam_csv import rebuild, table_positions, write_cam_csv
from camwright.profiles.tables.count_grid import without_rounding
from camwright.profiles.tables.text import decode
from camwright.stored.design_file import MOST_BYTES, parse_design
from camwright.studies.design import Design
from camwright.validation.motion import sync_ratio_error
from camwright.validation.report import SYNC_RATIO

_MOST_ROWS = 100_000
_ROUNDING = 1e-6
"""What a table's ends may miss those of the cycle by, as a part of the cut length: tables are rounded."""


def cam_text(design: Design) -> str:
    """Write a design as the text of a cam.csv: its origin in comment lines, then the table.

    Raises
    ------
    InputError
        The job asks for fewer points than the profile has ends of pieces.
    """
    origin = provenance(design.job.sha256)
    libraries = origin.pop("libraries")
    entries = {"job": design.job.name, **origin, **(libraries if isinstance(libraries, dict) else {})}
    comments = [f"{name}: {value}" for name, value in entries.items()]
    machine = design.job.machine
    if machine.place_name:
        comments.append(f"{machine.place_name}: {machine.place!r} {machine.slave_unit}")
    return write_cam_csv(design.profile, design.job.output.points, comments, machine.slave_unit)


def rows_note(cycle: CamProfile, job: Job) -> str:
    """Say that the cam.csv of a cycle has too few rows for `camwright.validate`, and how many would do; nothing where it has enough.

    Between rows it is quintics, which a crank or a blade in horizontal sync does not follow over wide steps.
    """
    asked, task = job.output.points, job.task

    def error(rows: int) -> float:
        x = table_positions(cycle, rows)
        return sync_ratio_error(rebuild(x, cycle(x), cycle(x, 1), cycle(x, 2)), task).value

    found = 0.0 if task.cut.shaped else error(asked)
    if found <= SYNC_RATIO:
        return ""
    rows = next((n for k in range(1, 8) if error(n := min(2**k * (asked - 1) + 1, _MOST_ROWS)) <= SYNC_RATIO), None)
    way = f"write [output] points = {rows}" if rows else "validate design.json"
    return f"cam.csv: {asked} rows hold the ratio in the sync zone to {found:.2g}, of which validate allows {SYNC_RATIO:g}; {way}"


def read_cycle(
    path: Path, job: Job, units: str | None = None, travel: str | None = None
) -> tuple[CamProfile, Machine, tuple[str, ...]]:
    """Read one cycle from a design.json or a table, told apart by the first character, the machine to judge it by, and notes.

    The machine is the job's; where the job leaves the place of its sync zone free, it is that of the file.

    Parameters
    ----------
    path
        The file. A table has the columns that `camwright.profiles.tables.cam_rows.read_cam_csv` describes; it runs over one cycle
        of the job, from master position 0 to the cut length, both to a millionth of the cut length. The slave may begin
        anywhere.
    job
        The job that the cycle is judged by.
    units, travel
        What a table does not state, as `camwright.jobs.table_cycle.whole_cycle` reads them.

    Raises
    ------
    InputError
        The file cannot be read, holds no profile, or one of another cut length or slave unit.
    """
    text = decode(read_bytes(path, "profile file", MOST_BYTES), str(path))
    if text.lstrip().startswith("{"):
        if units is not None or travel is not None:
            raise InputError(f"{path}: a design states its units and its travel; leave --units and --travel out")
        stored = parse_design(text, str(path))
        unit = stored.job.machine.slave_unit
        _require_unit(unit, job, path)
        profile = _one_cycle(stored.profile, job.cut.length, str(path))
        return profile, _with_place(job, stored.job.machine.place, str(path)), ()
    machine = _with_place(job, _stated_place(job.machine, text), str(path))
    table = csv_target.read(text, str(path))
    if table.units is not None:
        _require_unit(table.units.slave.si, job, path)
    whole = whole_cycle(table, replace(job, machine=machine), str(path), units, travel)
    counted = without_rounding(whole.table)
    profile = whole.units.to_si(csv_target.rebuild(whole.table if counted is None else counted.table))
    notes = (*whole.table.notes, *whole.notes, *((counted.note,) if counted else ()))
    return _one_cycle(profile, job.cut.length, str(path)), machine, notes


def _require_unit(unit: SlaveUnit, job: Job, path: Path) -> None:
    """Refuse a slave counted in another unit than the job's."""
    if unit != job.machine.slave_unit:
        raise InputError(
            f"{path}: the slave is counted in {unit}, but that of the job's machine in {job.machine.slave_unit}; name the job that the "
            "file was made for"
        )


def _stated_place(machine: Machine, text: str) -> float:
    """Place of the sync zone that a cam.csv states; not a number if it states none."""
    try:
        return float(place_in(machine, text) or math.nan)
    except ValueError:
        return math.nan


def _with_place(job: Job, place: float, file: str) -> Machine:
    """Give the job's machine, a free sync zone placed where the file has it."""
    machine = job.machine
    if machine.placed:
        return machine
    if math.isnan(place):
        raise not_placed(machine, file)
    machine = machine.placed_at(place)
    machine.sync_start(job.cut)
    return machine


def _one_cycle(profile: CamProfile, length: float, place: str) -> CamProfile:
    """Put the ends of a cycle where they belong; refuse a profile that is not one cycle."""
    allowed = _ROUNDING * length
    if abs(profile.start) > allowed or abs(profile.end - length) > allowed:
        raise InputError(
            f"{place}: runs over the master from {typed(profile.start, 'm')} to {typed(profile.end, 'm')}, "
            f"but a cycle of the job from 0 mm to {typed(length, 'm')} ([cut] length); "
            "name the job that the file was made for"
        )
    return profile.over(0.0, length)
