"""What changes on the machine when one recipe takes the place of another."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from camwright.house.files import read_text
from camwright.house.numbers import SHOWN, Units, converted, unit_shown
from camwright.profiles.errors import InputError
from camwright.profiles.polynomial.profile import CamProfile
from camwright.recipes.catalogue import catalogue_of
from camwright.recipes.facts import AT_SPEED, GROUPS
from camwright.recipes.model import Recipe, RecipeCheck, RecipeTable
from camwright.recipes.recipe_file import RECIPE_FILE, parse_recipe
from camwright.stored.design_file import MOST_BYTES

_PLACES = 20_001

_ROUNDING = 1e-12

_CLOSING = ("position_closure", "position_joins", "ratio_joins", "ratio_slope_joins", "sync_ratio")
"""Checks whose values are rounding: only whether they passed is compared."""


@dataclass(frozen=True)
class RecipeChange:
    """One thing that differs.

    Parameters
    ----------
    group
        ``"recipe"``, ``"machine"``, ``"product"``, ``"limits"``, ``"servo"``, ``"cam"``, ``"reached"``, ``"range"``, ``"speeds"``,
        ``"production"`` or ``"tables"``.
    unit
        Unit of both values; ``""`` for words.
    before, after
        The values; ``None`` where there is none.
    """

    group: str
    name: str
    unit: str
    before: Any
    after: Any


def read_recipe(directory: Path) -> Recipe:
    """Read the recipe of a folder.

    Raises
    ------
    InputError
        The directory holds none.
    """
    if not directory.is_dir():
        raise InputError(f"{directory}: there is no such directory; name a recipe folder")
    file = directory / RECIPE_FILE
    if not file.is_file():
        raise InputError(f"{directory}: not a recipe: there is no {RECIPE_FILE} in it")
    return parse_recipe(read_text(file, "recipe", MOST_BYTES), str(file))


def compare_recipes(before: Recipe, after: Recipe) -> list[RecipeChange]:
    """List what differs between two recipes, grouped in a fixed order; numbers in the units in which a fitter reads them."""
    return [change for change in _pairs(before, after) if not _same(change)]


def _same(change: RecipeChange) -> bool:
    """Whether two values are the same, lengths and speeds to 1e-6: below that servo errors and a slave that stands are rounding."""
    before, after = change.before, change.after
    if isinstance(before, float) and isinstance(after, float):
        return abs(before - after) <= _ROUNDING * max(abs(before), abs(after)) + (
            1e-6 if change.unit in ("mm", "in", "m/min", "ft/min", "1/min") else 0.0
        )
    return bool(before == after)


def _pairs(before: Recipe, after: Recipe) -> Iterator[RecipeChange]:
    """Set side by side everything that can differ, in the units of the newer recipe."""
    shown = catalogue_of(after.language, after.job.toml).units
    yield RecipeChange("recipe", "name", "", before.name, after.name)
    yield RecipeChange("recipe", "note", "", before.note, after.note)
    after_given = asdict(after.particulars)
    for name, value in asdict(before.particulars).items():
        yield RecipeChange("recipe", name, "", value, after_given[name])
    yield RecipeChange("recipe", "released", "", before.released, after.released)
    yield RecipeChange("recipe", "objective", "", before.objective.name, after.objective.name)
    yield RecipeChange("recipe", "camwright", "", before.provenance.camwright, after.provenance.camwright)
    for heading, listed in GROUPS.items():
        group = heading.rpartition(".")[2]
        facts = [{fact.key: fact for fact in listed(recipe)} for recipe in (before, after)]
        for key in dict.fromkeys([*facts[0], *facts[1]]):
            units = [each[key].unit for each in facts if key in each]
            values = [each[key].value if key in each else None for each in facts]
            yield _change(group, key, units, values, shown)
    yield from _cam(before, after, shown)
    yield from _reached(before.checks, after.checks, shown)
    yield from _range(before, after, shown)
    yield from _speeds(before, after, shown)
    yield from _production(before, after, shown)
    yield from _tables(before, after)


def _change(group: str, name: str, units: list[str], values: list[Any], shown_in: Units) -> RecipeChange:
    """Make a change of a number in the unit in which a fitter reads it; of two kinds of slave both are told in SI."""
    unit = units[0]
    if len(set(units)) > 1:
        texts = [None if value is None else f"{value:.6g} {unit}" for value, unit in zip(values, units, strict=True)]
        return RecipeChange(group, name, "", *texts)
    if unit not in SHOWN or any(isinstance(value, str | bool) for value in values):
        return RecipeChange(group, name, "", *values)
    shown = [None if value is None else converted(value, unit, shown_in) for value in values]
    return RecipeChange(group, name, unit_shown(unit, shown_in), *shown)


def _cam(before: Recipe, after: Recipe, units: Units) -> Iterator[RecipeChange]:
    yield RecipeChange("cam", "pieces", "", len(before.profile.coefficients), len(after.profile.coefficients))
    if before.slave_unit == after.slave_unit:
        largest, at = position_difference(before, after)
        unit = before.slave_unit
        yield RecipeChange(
            "cam",
            "largest position difference over the master",
            unit_shown(unit, units),
            0.0,
            converted(largest, unit, units),
        )
        if largest > 0.0:
            yield RecipeChange("cam", "where it is, of the cycle", "%", None, 100.0 * at)


def position_difference(before: Recipe, after: Recipe) -> tuple[float, float]:
    """Greatest difference of the slave's position over the cycle, and where, as a part of the cycle.

    Both cycles are laid over each other from master zero to master zero, the slave counted from where it stands there.

    Returns
    -------
    (difference, part)
        In the slave's unit; from 0 to 1.
    """
    part = np.linspace(0.0, 1.0, _PLACES)
    places = []
    for recipe in (before, after):
        profile = CamProfile(np.array(recipe.profile.breaks), np.array(recipe.profile.coefficients))
        places.append(profile(profile.start + part * profile.length) - float(profile(profile.start)))
    off = np.abs(places[1] - places[0])
    return float(off.max()), float(part[off.argmax()])


def _reached(
    before: tuple[RecipeCheck, ...], after: tuple[RecipeCheck, ...], shown_in: Units
) -> Iterator[RecipeChange]:
    found = [{check.name: check for check in checks} for checks in (before, after)]
    for name in dict.fromkeys([*found[0], *found[1]]):
        checks = [each.get(name) for each in found]
        units = [check.unit for check in checks if check is not None]
        if name not in _CLOSING:
            yield _change("reached", name, units, [check.value if check else None for check in checks], shown_in)
        yield RecipeChange("reached", f"{name}: passed", "", *(check.passed if check else None for check in checks))


def _range(before: Recipe, after: Recipe, shown_in: Units) -> Iterator[RecipeChange]:
    for name, unit in (("min_length", "m"), ("max_length", "m"), ("min_line_speed", "m/s"), ("max_line_speed", "m/s")):
        ends = [getattr(recipe.working_range, name) for recipe in (before, after)]
        yield _change("range", name, [unit], [end.value for end in ends], shown_in)
        yield RecipeChange("range", f"{name}: binding", "", *(end.binding for end in ends))
    yield RecipeChange("range", "released at", "m/min", *(_released(recipe) for recipe in (before, after)))


def _production(before: Recipe, after: Recipe, shown_in: Units) -> Iterator[RecipeChange]:
    """Compare start and stop, and what print marks may ask at the line speed."""
    unit = before.slave_unit
    both = [recipe.start_stop for recipe in (before, after)]
    for name, of in (("standing_up_to", "m/s"), ("park", unit), ("one_shot_master", "m"), ("sensor_ahead", "m")):
        values = [None if found is None else getattr(found, name) for found in both]
        yield _change("production", name, [of], values, shown_in)
    for name in ("ramp_in", "ramp_out"):
        ramps = [None if found is None else getattr(found, name) for found in both]
        peaks = [None if ramp is None else ramp.peak_acceleration for ramp in ramps]
        yield _change("production", f"{name}: peak_acceleration", [f"{unit}/s^2"], peaks, shown_in)
    for end in ("earliest", "latest"):
        ends = [getattr(recipe.marks[-1].redesign, end) if recipe.marks else None for recipe in (before, after)]
        yield _change("production", f"mark_{end}", ["m"], ends, shown_in)


def _released(recipe: Recipe) -> str:
    """Write the line speeds at which a cam is released (m/min)."""
    return "; ".join(
        f"{converted(part.low, 'm/s'):.5g} to {converted(part.high, 'm/s'):.5g}" for part in recipe.speed_band
    )


def _speeds(before: Recipe, after: Recipe, shown_in: Units) -> Iterator[RecipeChange]:
    for rows in zip(before.speeds, after.speeds, strict=False):
        for name, unit in AT_SPEED.items():
            yield _change(
                "speeds", f"{name} at {100 * rows[0].share:g} %", [unit], [getattr(row, name) for row in rows], shown_in
            )


def _tables(before: Recipe, after: Recipe) -> Iterator[RecipeChange]:
    found = [{table.target: table for table in recipe.tables} for recipe in (before, after)]
    for target in dict.fromkeys([*found[0], *found[1]]):
        tables = [each.get(target) for each in found]
        yield RecipeChange(
            "tables", f"{target}: points", "", *(len(table.points.master) if table else None for table in tables)
        )
        yield RecipeChange("tables", f"{target}: files", "", *(_sums(table) for table in tables))


def _sums(table: RecipeTable | None) -> dict[str, str] | None:
    return None if table is None else {file.path: file.sha256 for file in table.files}


def compare_answer(before: Path, after: Path, changes: list[RecipeChange]) -> dict[str, Any]:
    """Answer of ``camwright recipe --compare``."""
    return {
        "before": str(before),
        "after": str(after),
        "same": not changes,
        "changes": [asdict(change) for change in changes],
    }
