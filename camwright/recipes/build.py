"""Making a recipe of a design: judged, written for drives, looked at from every side that a fitter asks about."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from camwright.drives.export import export_possible
from camwright.house.language import Language
from camwright.house.progress import Step, ignore
from camwright.house.provenance import provenance
from camwright.jobs.job import Job
from camwright.jobs.numbers import job_numbers
from camwright.profiles.errors import InputError
from camwright.recipes.expected import STEPS as EXPECTED_STEPS
from camwright.recipes.expected import expected, sound
from camwright.recipes.model import (
    RECIPE_VERSION,
    JobRecord,
    Origin,
    Particulars,
    Profile,
    Recipe,
    Refusal,
)
from camwright.recipes.production import found_ramps
from camwright.recipes.ramp_tables import STEPS as START_STEPS
from camwright.recipes.ramp_tables import beside_cam, recipe_table, start_tables
from camwright.stored.design_file import StoredDesign
from camwright.studies.remedies import solve_or_advise

STEPS = 1 + EXPECTED_STEPS + START_STEPS
"""Steps that `make_recipe` tells beside one for each target."""

NO_PARTICULARS = Particulars()
"""A sheet that says nothing of who made it and when."""

TABLES = "tables"
"""Folder of the tables inside a recipe."""


@dataclass(frozen=True, eq=False)
class MadeRecipe:
    """A recipe, and the texts of its tables by their paths in the folder."""

    recipe: Recipe
    tables: dict[str, str]


def designed(job: Job) -> StoredDesign:
    """Find the optimal cam of a job, servo-aware if it says so.

    Raises
    ------
    InfeasibleError
        No motion keeps the limits of the job.
    SolverError
        The solver failed.
    """
    solution = solve_or_advise(job)
    return StoredDesign(solution.profile, replace(job, machine=solution.machine))


def make_recipe(
    design: StoredDesign,
    targets: Sequence[str],
    language: Language = "en",
    note: str = "",
    particulars: Particulars = NO_PARTICULARS,
    *,
    required: bool = True,
    step: Step = ignore,
) -> MadeRecipe:
    """Make the recipe of a design.

    Parameters
    ----------
    targets
        Names of the targets that tables are written for.
    language
        Language of what people read.
    note
        Any text that stands on the recipe.
    particulars
        Revision, customer, author and date that stand on it.
    required
        Whether a target that cannot take the cam is a fault; else the recipe names it.

    Raises
    ------
    InputError
        An unknown target, one that cannot take the cam, or none that can.
    """
    job, profile = design.job, design.profile
    ramps = found_ramps(design)
    values = expected(design, ramps, step)
    results, refused = export_possible(profile, job, targets, step=step)
    if refused and (required or not results):
        raise InputError(*(f"{name}: {fault}" for name, faults in refused.items() for fault in faults))
    origin = provenance(job.sha256)
    libraries = origin["libraries"]
    cams = [result.target.name for result in results if result.passed] if sound(values) else []
    results = [beside_cam(result, cams) for result in results]
    starts, start_texts = start_tables(ramps, targets, cams, step)
    recipe = Recipe(
        schema_version=RECIPE_VERSION,
        kind="camwright recipe",
        name=job.name,
        note=note,
        language=language,
        released=sound(values) and all(result.passed for result in results),
        job=JobRecord(job.text, job_numbers(job)),
        slave_unit=job.machine.slave_unit,
        profile=Profile(tuple(profile.breaks.tolist()), tuple(map(tuple, profile.coefficients.tolist()))),
        tables=tuple(recipe_table(result, TABLES) for result in results),
        refused=tuple(Refusal(name, faults) for name, faults in refused.items()),
        provenance=Origin(str(origin["camwright"]), job.sha256, libraries if isinstance(libraries, dict) else {}),
        particulars=particulars,
        start_tables=starts,
        **vars(values),
    )
    texts = {f"{TABLES}/{name}": text for result in results for name, text in result.files.items()}
    return MadeRecipe(recipe, {**texts, **start_texts})
