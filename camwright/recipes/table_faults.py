"""A table of a recipe read again: its file, its points, and what the drive makes of them, against what the recipe holds."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import asdict, dataclass

import numpy as np

from camwright.drives.export import position_error
from camwright.jobs.job import Job
from camwright.profiles.errors import InputError
from camwright.profiles.machines.machine import SlaveUnit
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.tables.cam_table import CamTable, TableUnits, Unit
from camwright.profiles.tables.deviation import deviation
from camwright.profiles.tables.targets import TARGETS, read_table
from camwright.profiles.tables.text import decode
from camwright.recipes.manifest import sha256
from camwright.recipes.model import Points, RecipeTable
from camwright.recipes.recipe_file import RECIPE_FILE
from camwright.recipes.sheet_faults import differs
from camwright.validation.rebuilt import TableJudgement


@dataclass(frozen=True)
class Fault:
    """What is wrong with a recipe folder.

    Parameters
    ----------
    file
        Path inside the folder.
    what
        What is wrong: the value found, and the one recorded.
    """

    file: str
    what: str


_STATED = ("title", "interpolation", "number_format", "evidence", "tested_on_controller", "steps")
"""What a recipe holds of a target as the target states it."""

Judged = Callable[[RecipeTable, CamProfile, TableUnits], Iterator[str]]
"""Tells what is wrong with a rebuilt motion: the table, the motion in SI units, and the units of the table."""


def table_faults(
    table: RecipeTable, slave_unit: SlaveUnit, data: Mapping[str, bytes | None], judged: Judged
) -> list[Fault]:
    """Read one table again and judge it again.

    Parameters
    ----------
    table
        What the recipe holds of it.
    slave_unit
        SI unit that the slave is counted in.
    data
        Contents of the folder's files by path; ``None`` for what cannot be read.
    judged
        Tells what is wrong with the motion that the drive makes of it.
    """
    faults = [
        Fault(file.path, f"SHA-256 is {sha256(content)}, {RECIPE_FILE} has {file.sha256}")
        for file in table.files
        if (content := data.get(file.path)) is not None and sha256(content) != file.sha256
    ]
    faults += [
        Fault(file.path, f"missing, or not a readable file: {RECIPE_FILE} has it")
        for file in table.files
        if data.get(file.path) is None
    ]
    if table.released and not table.files:
        faults.append(Fault(RECIPE_FILE, f"the table for {table.target} is released and has no file"))
    target = TARGETS.get(table.target)
    if target is None:
        return [*faults, Fault(RECIPE_FILE, f"there is no target {table.target!r:.40}")]
    content = data.get(table.files[0].path) if table.files else None
    if content is None:
        return faults  # not released, or told with the checksums
    path = table.files[0].path
    try:
        read = read_table(target, decode(content, path), path)
        units = TableUnits(
            Unit(table.master_unit.symbol, table.master_unit.size),
            Unit(table.slave_unit.symbol, table.slave_unit.size, slave_unit),
        )
        return [*faults, *(Fault(path, what) for what in _read_faults(table, read, units, judged))]
    except InputError as error:
        return [*faults, *(Fault(path, fault.removeprefix(f"{path}: ")) for fault in error.faults)]


def _read_faults(table: RecipeTable, read: CamTable, units: TableUnits, judged: Judged) -> Iterator[str]:
    """Compare the points of a table with the recorded ones, and judge its motion."""
    yield from _point_faults(table.points, read)
    if read.units is not None and read.units != units:
        yield f"units are {_units(read.units)}, recorded {_units(units)}"
        units = read.units
    yield from judged(table, units.to_si(TARGETS[table.target].rebuild(read)), units)


def motion_faults(table: RecipeTable, rebuilt: CamProfile, meant: CamProfile, job: Job, begin: float) -> Iterator[str]:
    """Compare the errors of a rebuilt motion with the recorded ones.

    Parameters
    ----------
    table
        What the recipe holds of it.
    rebuilt, meant
        The motion that the drive makes of it, and the one that was designed.
    begin
        Slave coordinate of the machine at its start (slave unit).
    """
    off = deviation(meant, rebuilt)
    error = position_error(meant, rebuilt, off, job, begin)
    scale = float(np.ptp(meant(meant.breaks))) or 1.0
    yield from differs("position error (m)", error, table.position_error, scale)
    yield from differs("ratio error", off.ratio, table.ratio_error, float(np.abs(meant(meant.breaks, 1)).max()))
    yield from differs("acceleration error", off.acceleration, table.acceleration_error, 1.0)


def check_faults(table: RecipeTable, judgement: TableJudgement) -> Iterator[str]:
    """Compare the checks on a rebuilt motion with the recorded ones."""
    again = {check.name: check for check in judgement.checks}
    recorded = {check.name: check for check in table.checks}
    if again.keys() != recorded.keys():
        yield f"checks are {', '.join(again)}, recorded {', '.join(recorded)}"
    for name in again.keys() & recorded.keys():
        new, old = again[name], recorded[name]
        yield from differs(f"check {name}, {new.unit}", new.value, old.value, abs(old.limit or 1.0))
        if new.passed is not old.passed:
            yield f"check {name} {'passes' if new.passed else 'fails'}, recorded {'passed' if old.passed else 'failed'}"


def _point_faults(points: Points, read: CamTable) -> Iterator[str]:
    """Compare points bit by bit; the first that differs is told."""
    if read.points != len(points.master):
        yield f"{read.points} points, recorded {len(points.master)}"
        return
    columns = {"master": read.x, "slave": read.y, "ratio": read.ratio, "ratio slope": read.ratio_slope}
    for (name, values), stored in zip(columns.items(), asdict(points).values(), strict=True):
        recorded = np.array([math.nan] * len(values) if stored is None else stored, dtype=float)
        if len(recorded) != len(values):
            yield f"{len(values)} points, {len(recorded)} recorded of the {name}"
            continue
        same = (values == recorded) | (np.isnan(values) & np.isnan(recorded))
        if not same.all():
            i = int(np.argmin(same))
            yield f"point {i + 1}: {name} is {float(values[i])!r}, recorded {float(recorded[i])!r}"


def target_faults(tables: Iterable[RecipeTable]) -> Iterator[Fault]:
    """Compare what tables say of their targets with what this version states."""
    for table in tables:
        for name in _STATED:
            stated, recorded = getattr(TARGETS[table.target], name), getattr(table, name)
            if stated != recorded:
                yield Fault(RECIPE_FILE, f"{name} of {table.target}: {stated!r}, recorded {recorded!r}")


def _units(units: TableUnits) -> str:
    return ", ".join(f"{unit.symbol} ({unit.size!r} {unit.si})" for unit in (units.master, units.slave))
