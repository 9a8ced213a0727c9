"""Writing a recipe folder: every file made from the recipe, and the folder put in its place as a whole."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from camwright.house.files import replaced, require_replaceable
from camwright.house.progress import Step, ignore
from camwright.recipes.build import NO_PARTICULARS, MadeRecipe, make_recipe
from camwright.recipes.html import recipe_html
from camwright.recipes.manifest import MANIFEST_FILE, manifest_text
from camwright.recipes.model import Language, Particulars, Recipe
from camwright.recipes.pdf import recipe_pdf
from camwright.recipes.recipe_file import RECIPE_FILE, recipe_text
from camwright.recipes.xlsx import recipe_xlsx
from camwright.stored.design_file import StoredDesign
from camwright.studies.design import Design

WRITE_STEPS = 2
"""Steps that `recipe_files` tells."""


def recipe_files(made: MadeRecipe, step: Step = ignore) -> dict[str, bytes]:
    """Make the bytes of every file of a recipe folder, by path.

    Parameters
    ----------
    made
        The recipe and the texts of its tables.
    step
        Told what begins now.
    """
    content = made.recipe
    files = {RECIPE_FILE: recipe_text(content).encode()}
    files |= {path: text.encode() for path, text in made.tables.items()}
    step("typesetting")
    files["recipe.pdf"] = recipe_pdf(content)
    files["recipe.html"] = recipe_html(content).encode()
    step("writing the workbook")
    files["recipe.xlsx"] = recipe_xlsx(content)
    return {**files, MANIFEST_FILE: manifest_text(files, content.provenance).encode()}


def recipe(
    design: StoredDesign | Design,
    directory: str | Path,
    targets: Sequence[str] = (),
    language: Language = "en",
    note: str = "",
    particulars: Particulars = NO_PARTICULARS,
) -> Recipe:
    """Write all that one product needs on one machine into a folder: PDF, HTML, workbook, tables and a manifest.

    Parameters
    ----------
    design
        What `camwright.optimise` or `camwright.read_design` gives.
    directory
        The folder; a recipe that stands there already is replaced as a whole.
    targets
        Names of the targets that tables are written for; those of the job, else CSV, if none are named.
    language
        Language of what people read: ``"en"``, ``"de"`` or ``"zh"``.
    note
        Any text that stands on the recipe.
    particulars
        Revision, customer, author and date that stand on it.

    Returns
    -------
    Recipe
        What was written; `Recipe.released` says whether every check passed.

    Raises
    ------
    InputError
        An unknown target, one that cannot take the cam, or something else is in the way.

    Examples
    --------
    >>> import tempfile
    >>> from camwright import load_job, optimise, recipe
    >>> folder = Path(tempfile.mkdtemp()) / "paper-600"
    >>> recipe(optimise(load_job()), folder, ["csv"], language="de").released
    True
    >>> sorted(file.name for file in folder.iterdir())
    ['manifest.json', 'recipe.html', 'recipe.json', 'recipe.pdf', 'recipe.xlsx', 'tables']
    """
    require_replaceable(Path(directory), is_recipe)
    names = targets or design.job.output.targets or ("csv",)
    made = make_recipe(StoredDesign(design.profile, design.job), names, language, note, particulars)
    write_folder(recipe_files(made), Path(directory))
    return made.recipe


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
