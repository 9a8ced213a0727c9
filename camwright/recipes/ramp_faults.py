"""What is wrong with the tables of start, stop and one piece on demand that a recipe holds."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import partial

import numpy as np

from camwright.drives.export import Stretch, stored_count
from camwright.production.ramp_tables import KINDS, stretch_of
from camwright.production.ramps import Ramps
from camwright.profiles.errors import InputError
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.tables.cam_table import TableUnits
from camwright.profiles.tables.deviation import deviation
from camwright.profiles.tables.targets import TARGETS
from camwright.recipes.model import Profile, RampTables, Recipe, RecipeTable
from camwright.recipes.ramp_tables import motions_of
from camwright.recipes.recipe_file import RECIPE_FILE
from camwright.recipes.table_faults import Fault, check_faults, motion_faults, table_faults

_SAME = 1e-9
"""Part of its travel by which a motion designed anew may be off the recorded one: another processor."""


def start_faults(recipe: Recipe, found: Ramps | None, data: Mapping[str, bytes | None]) -> Iterator[Fault]:
    """Compare the recorded motions with those designed anew, and judge their tables between the park and the cam.

    Parameters
    ----------
    recipe
        The recipe, of this version of camwright.
    found
        Start and stop of its machine, designed anew.
    data
        Contents of the folder's files by path.
    """
    wanted = [] if found is None else list(KINDS)
    if [each.motion for each in recipe.start_tables] != wanted:
        yield Fault(RECIPE_FILE, "start_tables are not those of this cam")
    if found is None or len(recipe.start_tables) != len(wanted):
        return
    targets = _targets(recipe)
    for record, (kind, profile) in zip(recipe.start_tables, motions_of(found).items(), strict=True):
        if _targets(record) != targets:
            yield Fault(RECIPE_FILE, f"start_tables.{kind} is not for the targets of the cam's own tables")
        if not _is_same(profile, record.profile):
            yield Fault(RECIPE_FILE, f"start_tables.{kind}.profile is not the motion designed anew")
        judged = partial(_judged, found, stretch_of(found, kind, profile), profile)
        for table in record.tables:
            yield from table_faults(table, recipe.slave_unit, data, judged)


def _targets(of: Recipe | RampTables) -> list[str]:
    """Targets that have a table or cannot take it."""
    return sorted([*(each.target for each in of.tables), *(each.target for each in of.refused)])


def _is_same(profile: CamProfile, record: Profile) -> bool:
    try:
        recorded = CamProfile.from_arrays(record.breaks, record.coefficients)
    except (InputError, ValueError):  # no profile at all
        return False
    size = float(np.ptp(profile(profile.breaks))) or 1.0
    return (
        abs(profile.length - recorded.length) <= _SAME * profile.length
        and deviation(profile, recorded).position <= _SAME * size
    )


def _judged(
    found: Ramps, stretch: Stretch, profile: CamProfile, table: RecipeTable, rebuilt: CamProfile, units: TableUnits
) -> Iterator[str]:
    """Compare errors and checks of one table with the recorded ones."""
    yield from motion_faults(table, rebuilt, profile, found.job, stretch.slave_start)
    stored = stored_count(TARGETS[table.target], found.job, units.slave.size)
    yield from check_faults(table, stretch.judge(rebuilt, stored))
