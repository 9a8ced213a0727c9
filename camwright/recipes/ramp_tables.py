"""The tables of start, stop and one piece on demand that a recipe holds."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np

from camwright.drives.export import Exported
from camwright.house.progress import Step, ignore
from camwright.production.ramp_tables import KINDS, RampKind, write_ramps
from camwright.production.ramps import Ramps
from camwright.profiles.polynomial.profile import CamProfile, FloatArray
from camwright.recipes.expected import recipe_checks
from camwright.recipes.manifest import sha256
from camwright.recipes.model import Points, Profile, RampTables, RecipeTable, Refusal, TableFile, TableUnit

FOLDER = "ramps"
"""Folder of these tables inside a recipe."""

STEPS = len(KINDS)
"""Steps that `start_tables` tells."""


def start_tables(
    found: Ramps | None, targets: Sequence[str], cams: Collection[str], step: Step = ignore
) -> tuple[tuple[RampTables, ...], dict[str, str]]:
    """Write start, stop and one piece on demand for the targets of a recipe.

    Parameters
    ----------
    found
        Start and stop of the machine; ``None`` where it has none at its line speed.
    targets
        Names of targets.
    cams
        Those of them for which the cam itself is released; the others get no files, for a start leads into a cam.

    Returns
    -------
    (tables, texts)
        What the recipe holds, nothing where there are no start and stop; and the files' texts by path.
    """
    if found is None:
        return (), {}
    written = write_ramps(found, targets, required=False, step=step)
    results = {kind: tuple(beside_cam(result, cams) for result in made) for kind, made in written.results.items()}
    records = tuple(
        RampTables(
            kind,
            Profile(tuple(profile.breaks.tolist()), tuple(map(tuple, profile.coefficients.tolist()))),
            tuple(recipe_table(result, FOLDER) for result in results[kind]),
            tuple(Refusal(name, why) for name, why in written.refused[kind].items()),
        )
        for kind, profile in motions_of(found).items()
    )
    files = {name: text for made in results.values() for result in made for name, text in result.files.items()}
    return records, {f"{FOLDER}/{name}": text for name, text in files.items()}


def beside_cam(result: Exported, cams: Collection[str]) -> Exported:
    """Withhold a table where the cam is not released for its target."""
    return result if result.target.name in cams else replace(result, files={})


def motions_of(found: Ramps) -> dict[RampKind, CamProfile]:
    """Give the motions that are written, in the order of `KINDS`."""
    return dict(zip(KINDS, (found.start_table, found.stop_table, found.one_shot), strict=True))


def recipe_table(result: Exported, folder: str) -> RecipeTable:
    """Write a table as a recipe holds it, its files in a folder."""
    table, target, units = result.table, result.target, result.units
    return RecipeTable(
        target=target.name,
        title=target.title,
        released=result.passed and bool(result.files),
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
