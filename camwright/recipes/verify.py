"""Verifying a recipe folder: nothing changed, and the tables are still the motion that the recipe promises."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import Any

from camwright.drives.export import covering, stored_count
from camwright.house.provenance import camwright_version
from camwright.jobs.numbers import job_numbers
from camwright.profiles.errors import InputError
from camwright.profiles.polynomial.profile import CamProfile
from camwright.profiles.tables.cam_table import TableUnits
from camwright.profiles.tables.targets import TARGETS
from camwright.recipes.expected import expected
from camwright.recipes.family_verify import family_faults, is_family
from camwright.recipes.folder import contents, sum_faults
from camwright.recipes.html import recipe_html
from camwright.recipes.manifest import MANIFEST_FILE
from camwright.recipes.model import Recipe, RecipeTable
from camwright.recipes.pdf import recipe_pdf
from camwright.recipes.production import found_ramps
from camwright.recipes.ramp_faults import start_faults
from camwright.recipes.recipe_file import (
    RECIPE_FILE,
    parse_recipe,
    recipe_text,
    stored_design,
)
from camwright.recipes.sheet_faults import sheet_faults
from camwright.recipes.signature import SIGNATURE_FILE, is_signed
from camwright.recipes.table_faults import Fault, check_faults, motion_faults, table_faults, target_faults
from camwright.recipes.xlsx import recipe_xlsx
from camwright.stored.design_file import StoredDesign
from camwright.validation.rebuilt import RUN, judge_table

_PAGE = "recipe.html"
_SHEETS: dict[str, Callable[[Recipe], bytes]] = {
    _PAGE: lambda recipe: recipe_html(recipe).encode(),
    "recipe.pdf": recipe_pdf,
    "recipe.xlsx": recipe_xlsx,
}
"""What people read, made of recipe.json alone."""


@dataclass(frozen=True)
class Verified:
    """What was found in a recipe folder.

    Parameters
    ----------
    faults
        What is wrong; nothing for a recipe as it was written.
    notes
        What is no fault, and yet to be known.
    proved
        What was proved, in words; only where nothing is wrong.
    """

    faults: tuple[Fault, ...]
    notes: tuple[Fault, ...]
    proved: tuple[str, ...]


def examine(directory: Path, key: Path | None = None) -> Verified:
    """Check a recipe folder, or that of a family (`camwright.recipes.family_verify`).

    Checksums of all files, none missing and none added; recipe.json by its schema; every table read by its target's reader, rebuilt
    as the target does, and judged, against the numbers in recipe.json. Where all this agrees, the values of the sheet are computed anew
    of the cam and its job, and what people read is made anew of recipe.json.

    Parameters
    ----------
    key
        PEM file of the public key that it must be signed with; without one no signature is looked at.

    Raises
    ------
    InputError
        The directory is no recipe, or cannot be read; the key is none.
    """
    if is_family(directory):
        if key is not None:
            raise InputError(f"{directory}: a family of cams is not signed; verify it without --key")
        wrong, told, sure = family_faults(directory)
        return Verified(tuple(wrong), tuple(told), tuple(sure))
    data, notes = contents(directory)
    if MANIFEST_FILE not in data and RECIPE_FILE not in data:
        raise InputError(f"{directory}: not a recipe: neither {MANIFEST_FILE} nor {RECIPE_FILE} is in it")
    there = SIGNATURE_FILE in data
    signature = data.pop(SIGNATURE_FILE, None)
    faults = list(_signature_faults(data, signature, there, key))
    if there and key is None:
        notes.append(Fault(SIGNATURE_FILE, "signed, but the signature was not checked: name the public key with --key"))
    faults += sum_faults(data)
    faults += _contents(data)
    content = data.get(RECIPE_FILE)
    if faults or content is None:
        return Verified(tuple(faults), tuple(notes), ())
    recipe = parse_recipe(_text(content), RECIPE_FILE)
    made_by, own = recipe.provenance.camwright, camwright_version()
    if made_by != own:
        notes.append(
            Fault(RECIPE_FILE, f"made by camwright {made_by}: {own} does not compute the sheet anew; that version does")
        )
    else:
        design = stored_design(recipe)
        ramps = found_ramps(design)
        faults += [Fault(RECIPE_FILE, what) for what in sheet_faults(recipe, expected(design, ramps))]
        faults += start_faults(recipe, ramps, data)
        faults += target_faults((*recipe.tables, *(table for motion in recipe.start_tables for table in motion.tables)))
        remade = [] if faults else list(_remade(recipe, data))
        faults += [other for other in remade if other.file == _PAGE]
        notes += [other for other in remade if other.file != _PAGE]
    proved = () if faults else tuple(_proved(recipe, len(data), made_by == own, notes, key))
    return Verified(tuple(faults), tuple(notes), proved)


def _remade(recipe: Recipe, data: dict[str, bytes | None]) -> Iterator[Fault]:
    """Make what people read anew; the page depends on this program alone, the rest on libraries that other machines may not have."""
    for name, make in _SHEETS.items():
        if data.get(name) != make(recipe):
            libraries = "" if name == _PAGE else ", or was made with other versions of the typesetting libraries"
            yield Fault(name, f"is not what this camwright makes of {RECIPE_FILE}{libraries}")


def _proved(recipe: Recipe, files: int, anew: bool, notes: list[Fault], key: Path | None) -> Iterator[str]:
    """Say what was proved, and what was not."""
    yield f"{files} files have the checksums of the manifest, none is missing or added"
    released = [table for table in recipe.tables if table.files]
    yield f"{len(released)} tables, read and rebuilt as their drives do, have the recorded points, errors and checks"
    starts = sum(bool(table.files) for motion in recipe.start_tables for table in motion.tables)
    if starts and anew:
        yield f"{starts} tables of start, stop and one piece have so, between the park and the cam, as designed anew"
    if anew:
        sheets = [name for name in _SHEETS if name not in {note.file for note in notes}]
        yield f"{len(recipe.checks)} checks, expected values, speed band and working range are those computed anew of the cam and its job"
        yield f"{', '.join(sheets)} say what {RECIPE_FILE} says"
    yield f"signed by the owner of {key}" if key else "not proved: who wrote it (no signature was checked)"


def _signature_faults(
    data: dict[str, bytes | None], signature: bytes | None, there: bool, key: Path | None
) -> Iterator[Fault]:
    """Check the signature of the manifest, where a key is given."""
    manifest = data.get(MANIFEST_FILE)
    if key is None:
        return
    if not there:
        yield Fault(SIGNATURE_FILE, "missing: this recipe is not signed")
    elif signature is None or manifest is None or not is_signed(manifest, signature, key):
        yield Fault(SIGNATURE_FILE, f"not a signature of this {MANIFEST_FILE} by the owner of {key}")


def _contents(data: dict[str, bytes | None]) -> list[Fault]:
    """Check recipe.json in itself, and the tables against it."""
    content = data.get(RECIPE_FILE)
    if content is None:
        return []  # told with the checksums
    try:
        recipe = parse_recipe(_text(content), RECIPE_FILE)
        design = stored_design(recipe)
    except InputError as error:
        return [Fault(RECIPE_FILE, fault.removeprefix(f"{RECIPE_FILE}: ")) for fault in error.faults]
    faults = [Fault(RECIPE_FILE, what) for what in _own_faults(recipe, design, content)]
    judged = partial(_cam_faults, design)
    for table in recipe.tables:
        faults += table_faults(table, recipe.slave_unit, data, judged)
    for motion in recipe.start_tables:
        for table in motion.tables:
            faults += table_faults(table, recipe.slave_unit, data, _unjudged)
    return faults


def _cam_faults(design: StoredDesign, table: RecipeTable, rebuilt: CamProfile, units: TableUnits) -> Iterator[str]:
    """Compare errors and checks of the cam's own table with the recorded ones."""
    job = design.job
    yield from motion_faults(table, rebuilt, covering(design.profile, rebuilt, job), job, job.task.slave_at_start)
    stored = stored_count(TARGETS[table.target], job, units.slave.size)
    yield from check_faults(table, judge_table(rebuilt, job.task, job.servo, table.wraps, RUN, stored))


def _unjudged(_table: RecipeTable, _rebuilt: CamProfile, _units: TableUnits) -> Iterator[str]:
    """Judge nothing: starts and stops are judged where the sheet is computed anew, for their motions are found so."""
    yield from ()


def _text(content: bytes) -> str:
    try:
        return content.decode("utf-8")
    except UnicodeDecodeError as error:
        raise InputError(f"{RECIPE_FILE}: not UTF-8 text (byte {error.start})") from error


def _own_faults(recipe: Recipe, design: StoredDesign, content: bytes) -> Iterator[str]:
    """Compare what recipe.json says twice."""
    if recipe_text(recipe).encode() != content:
        yield "its bytes are not those that were written"
    numbers = job_numbers(design.job)
    for path, stored, again in _differences(recipe.job.si, json.loads(json.dumps(numbers))):
        yield f"job.si{path} is {stored!r}, the job's text says {again!r}"
    if recipe.provenance.camwright == camwright_version():
        for path in _missing(recipe.job.si, numbers):
            yield f"job.si{path} is missing; the job's text has it"
    if recipe.name != design.job.name:
        yield f"name is {recipe.name!r}, the job's text says {design.job.name!r}"
    if not recipe.tables and not recipe.refused:
        yield "tables and refused are empty: a recipe is for a target at least"
    sound = all(check.passed for check in recipe.checks) and all(table.released for table in recipe.tables)
    released = sound and bool(recipe.speed_band)
    if recipe.released is not released:
        yield f"released is {recipe.released}, its checks say {released}"


def _differences(stored: Any, again: Any, path: str = "") -> Iterator[tuple[str, Any, Any]]:
    """List where stored values differ from those read again; what a later version knows beside them does not matter."""
    if isinstance(stored, dict) and isinstance(again, dict):
        for key in sorted(stored):
            yield from _differences(stored.get(key), again.get(key), f"{path}.{key}")
    elif stored != again:
        yield path, stored, again


def _missing(stored: Any, again: Any, path: str = "") -> Iterator[str]:
    """List the keys that values read again have and stored ones lack."""
    if isinstance(stored, dict) and isinstance(again, dict):
        for key in sorted(again):
            if key in stored:
                yield from _missing(stored[key], again[key], f"{path}.{key}")
            else:
                yield f"{path}.{key}"


def verify_answer(found: Verified) -> dict[str, Any]:
    """Answer of ``camwright verify``."""
    answer: dict[str, Any] = {"ok": not found.faults, "faults": [asdict(fault) for fault in found.faults]}
    return {**answer, "notes": [asdict(note) for note in found.notes], "proved": list(found.proved)}
