"""Writing a recipe folder: every file made from the recipe, and the folder put in its place as a whole."""

from __future__ import annotations

from pathlib import Path

from camwright.house.files import replaced
from camwright.house.progress import Step, ignore
from camwright.recipe.build import MadeRecipe
from camwright.recipe.fonts import font_files, require
from camwright.recipe.html import recipe_html
from camwright.recipe.manifest import MANIFEST_FILE, manifest_text
from camwright.recipe.pdf import recipe_pdf
from camwright.recipe.recipe_file import RECIPE_FILE, recipe_text
from camwright.recipe.xlsx import recipe_xlsx

WRITE_STEPS = 2
"""Steps that `recipe_files` tells."""


def require_extra() -> None:
    """Refuse to begin without what the files of a recipe need.

    Raises
    ------
    MissingExtraError
        A library or a font of the extra ``recipe`` is not installed.
    """
    require("jinja2", "typst", "xlsxwriter")
    font_files()


def recipe_files(made: MadeRecipe, step: Step = ignore) -> dict[str, bytes]:
    """Make the bytes of every file of a recipe folder, by path.

    Parameters
    ----------
    made
        The recipe and the texts of its tables.
    step
        Told what begins now.
    """
    recipe = made.recipe
    files = {RECIPE_FILE: recipe_text(recipe).encode()}
    files |= {path: text.encode() for path, text in made.tables.items()}
    step("typesetting")
    files["recipe.pdf"] = recipe_pdf(recipe)
    files["recipe.html"] = recipe_html(recipe).encode()
    step("writing the workbook")
    files["recipe.xlsx"] = recipe_xlsx(recipe)
    return {**files, MANIFEST_FILE: manifest_text(files, recipe.provenance).encode()}


def write_folder(files: dict[str, bytes], directory: Path) -> None:
    """Write a recipe folder; a recipe that stands there already is replaced as a whole.

    Raises
    ------
    InputError
        Something else is in the way, or the folder cannot be written.
    """
    with replaced(directory, is_recipe) as aside:
        for path, data in files.items():
            file = aside / path
            file.parent.mkdir(exist_ok=True)
            file.write_bytes(data)


def is_recipe(directory: Path) -> bool:
    """Whether a directory looks like a recipe folder."""
    return (directory / MANIFEST_FILE).is_file() and (directory / RECIPE_FILE).is_file()
