"""The tables of start, stop and one piece on demand that a recipe holds, and what is wrong with them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import partial

import numpy as np

from camwright.drives.export import Exported, Stretch, stored_count
from camwright.house.progress import Step, ignore
from camwright.production.ramp_tables import KINDS, RampKind, stretch_of, write_ramps
from camwright.production.ramps import Ramps, ramps
from camwright.profiles.errors import InfeasibleError
from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.profiles.tables.cam_table import Units
from camwright.profiles.tables.deviation import deviation
from camwright.profiles.tables.targets import TARGETS
from camwright.recipes.expected import recipe_checks
from camwright.recipes.manifest import sha256
from camwright.recipes.model import Points, Profile, RampTables, Recipe, RecipeTable, Refusal, TableFile, TableUnit
from camwright.recipes.recipe_file import RECIPE_FILE
from camwright.recipes.table_faults import Fault, check_faults, motion_faults, table_faults
from camwright.stored.design_file import StoredDesign

FOLDER = "ramps"
"""Folder of these tables inside a recipe."""

STEPS = len(KINDS)
"""Steps that `start_tables` tells."""

_SAME = 1e-9
"""Part of its travel by which a motion designed anew may be off the recorded one: another processor."""


def start_tables(
    design: StoredDesign, targets: Sequence[str], step: Step = ignore
) -> tuple[tuple[RampTables, ...], dict[str, str]]:
    """Write start, stop and one piece on demand for the targets of a recipe.

    Parameters
    ----------
    design
        A cam and its job.
    targets
        Names of targets.
    step
        Told what begins now.

    Returns
    -------
    (tables, texts)
        What the recipe holds, nothing where the machine cannot start and stop at its line speed; and the files' texts by path.
    """
    found = _found(design)
    if found is None:
        return (), {}
    written = write_ramps(found, targets, required=False, step=step)
    records = tuple(
        RampTables(
            kind,
            Profile(tuple(profile.breaks.tolist()), tuple(map(tuple, profile.coefficients.tolist()))),
            tuple(recipe_table(result, FOLDER) for result in written.results[kind]),
            tuple(Refusal(name, why) for name, why in written.refused[kind].items()),
        )
        for kind, profile in _motions(found).items()
    )
    return records, {f"{FOLDER}/{name}": text for name, text in written.files.items()}


def _found(design: StoredDesign) -> Ramps | None:
    try:
        return ramps(design.job, cam=design.profile)
    except InfeasibleError:
        return None


def _motions(found: Ramps) -> dict[RampKind, CamProfile]:
    return dict(zip(KINDS, (found.start_table, found.stop_table, found.one_shot), strict=True))


def start_faults(recipe: Recipe, design: StoredDesign, data: Mapping[str, bytes | None]) -> Iterator[Fault]:
    """Design start and stop anew, and judge their tables between the park and the cam.

    Parameters
    ----------
    recipe
        The recipe, of this version of camwright.
    design
        Its cam and job.
    data
        Contents of the folder's files by path.
    """
    if not recipe.start_tables:
        return  # the recipe was made before it held them, or the machine cannot start so
    found = _found(design)
    if found is None or [each.motion for each in recipe.start_tables] != list(KINDS):
        yield Fault(RECIPE_FILE, "start_tables are not those of this cam")
        return
    for record, (kind, profile) in zip(recipe.start_tables, _motions(found).items(), strict=True):
        recorded = CamProfile.from_arrays(record.profile.breaks, record.profile.coefficients)
        if not _is_same(profile, recorded):
            yield Fault(RECIPE_FILE, f"start_tables.{kind}.profile is not the motion designed anew")
        judged = partial(_judged, found, stretch_of(found, kind, profile), profile)
        for table in record.tables:
            yield from table_faults(table, recipe.slave_unit, data, judged)


def _is_same(profile: CamProfile, recorded: CamProfile) -> bool:
    size = float(np.ptp(profile(profile.breaks))) or 1.0
    return (
        abs(profile.length - recorded.length) <= _SAME * profile.length
        and deviation(profile, recorded).position <= _SAME * size
    )


def _judged(
    found: Ramps, stretch: Stretch, profile: CamProfile, table: RecipeTable, rebuilt: CamProfile, units: Units
) -> Iterator[str]:
    """Compare errors and checks of one table with the recorded ones."""
    yield from motion_faults(table, rebuilt, profile, found.job, stretch.slave_start)
    stored = stored_count(TARGETS[table.target], found.job, units.slave.size)
    yield from check_faults(table, stretch.judge(rebuilt, stored))


def recipe_table(result: Exported, folder: str) -> RecipeTable:
    """Write a table as a recipe holds it, its files in a folder."""
    table, target, units = result.table, result.target, result.units
    return RecipeTable(
        target=target.name,
        title=target.title,
        released=result.passed,
        files=tuple(TableFile(f"{folder}/{name}", sha256(text.encode())) for name, text in result.files.items()),
        master_unit=TableUnit(units.master.symbol, units.master.size),
        slave_unit=TableUnit(units.slave.symbol, units.slave.size),
        points=Points(
            tuple(table.x.tolist()), tuple(table.y.tolist()), _column(table.ratio), _column(table.ratio_slope)
        ),
        position_error=result.position_error,
        ratio_error=result.deviation.ratio,
        acceleration_error=result.deviation.acceleration,
        within_asked_error=result.accurate,
        wraps=result.judgement.wraps,
        checks=recipe_checks(result.judgement.checks),
        interpolation=target.interpolation,
        number_format=target.number_format,
        evidence=target.evidence,
        tested_on_controller=target.tested_on_controller,
        steps=target.steps,
    )


def _column(values: FloatArray) -> tuple[float | None, ...] | None:
    if np.isnan(values).all():
        return None
    return tuple(None if np.isnan(value) else value for value in values.tolist())
