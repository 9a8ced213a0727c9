"""recipe.json: writing it, reading it, its JSON Schema."""

from __future__ import annotations

import json
from dataclasses import asdict
from typing import Any, TypeVar

from pydantic import TypeAdapter, ValidationError

from camwright.house.provenance import SCHEMA_VERSION
from camwright.profiles.errors import InputError
from camwright.recipes.model import Particulars, Recipe
from camwright.stored.design_file import StoredDesign, design_schema, parse_design

Record = TypeVar("Record")

RECIPE_FILE = "recipe.json"

_MOST_FAULTS = 20
"""Faults of a damaged file that are told."""


def canonical(data: dict[str, Any]) -> str:
    """Write an object the one way in which this program writes it; a file in another way was written by another hand."""
    return json.dumps(data, indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def recipe_text(recipe: Recipe) -> str:
    """Write a recipe as the text of a recipe.json."""
    data = asdict(recipe)
    if recipe.particulars == Particulars():
        del data["particulars"]  # recipes of versions that knew none read as they were written
    if not recipe.start_tables:
        del data["start_tables"]
    for row in data["speeds"]:
        if row["worst_sync_error"] is None:
            del row["worst_sync_error"]
    return canonical(data)


def parse_recipe(text: str, place: str) -> Recipe:
    """Read the text of a recipe.json.

    Parameters
    ----------
    place
        What messages begin with.

    Raises
    ------
    InputError
        It is not a recipe.json of this version: each fault with its place in the file.
    """
    try:
        return parse_record(Recipe, text, place)
    except RecursionError as error:
        raise InputError(f"{place}: not a recipe.json: nested too deeply") from error


def parse_record(model: type[Record], text: str | bytes, place: str) -> Record:
    """Read JSON by a model; `InputError` names each fault with its place in the file."""
    try:
        return TypeAdapter(model).validate_json(text, strict=True)
    except ValidationError as error:
        faults = [
            f"{place}: {'.'.join(map(str, entry['loc'])) or 'the file'}: {entry['msg']}"
            for entry in error.errors(include_url=False)[:_MOST_FAULTS]
        ]
        raise InputError(*faults) from error


def stored_design(recipe: Recipe) -> StoredDesign:
    """Read the design that a recipe holds: its profile, and its job from the stored text.

    Raises
    ------
    InputError
        The profile is none, or the job is not the one that was designed.
    """
    design = {
        "schema_version": SCHEMA_VERSION,
        "status": "",
        "objective": {},
        "profile": asdict(recipe.profile),
        "job": asdict(recipe.job),
        "provenance": asdict(recipe.provenance),
    }
    return parse_design(json.dumps(design), RECIPE_FILE)


def recipe_schema() -> dict[str, Any]:
    """Make the JSON Schema of a recipe.json: from the model, the job's numbers as in a design.json."""
    schema = TypeAdapter(Recipe).json_schema()
    for definition in (schema, *schema["$defs"].values()):
        definition["additionalProperties"] = False
        definition.pop("description", None)  # a docstring for programmers
    schema["$defs"]["JobRecord"]["properties"]["si"] = design_schema()["properties"]["job"]["properties"]["si"]
    digest = {"type": "string", "pattern": "^[0-9a-f]{64}$"}
    schema["$defs"]["TableFile"]["properties"]["sha256"] = digest
    schema["$defs"]["Origin"]["properties"]["job_sha256"] = digest
    head = {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "description": "SI units, angles in rad; values of a slave in m or rad, as slave_unit says",
    }
    return {**head, **schema, "title": "camwright recipe"}
