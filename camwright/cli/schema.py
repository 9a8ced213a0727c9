"""The command ``camwright schema``."""

from __future__ import annotations

import sys
from enum import StrEnum
from typing import Annotated

import typer

from camwright.house.json_text import to_json
from camwright.jobs.structure import job_schema
from camwright.recipes.recipe_file import recipe_schema
from camwright.stored.design_file import design_schema


class Schema(StrEnum):
    """What a schema is of."""

    job = "job"
    design = "design"
    recipe = "recipe"


_SCHEMAS = {Schema.job: job_schema, Schema.design: design_schema, Schema.recipe: recipe_schema}


def run(
    of: Annotated[
        Schema, typer.Argument(metavar="[OF]", help="job, design or recipe.", case_sensitive=False)
    ] = Schema.job,
) -> int:
    """Print the JSON Schema of job files, of design.json or of recipe.json, for editors and other programs."""
    sys.stdout.write(to_json(_SCHEMAS[of]()))
    return 0
