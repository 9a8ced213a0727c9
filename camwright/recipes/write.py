"""Writing a recipe folder: every file made from the recipe, and the folder put in its place as a whole."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from pathlib import Path

from camwright.house.files import replaced, require_replaceable
from camwright.house.language import Language
from camwright.house.owned import Work, free_name, require_no_rival
from camwright.house.progress import Step, ignore
from camwright.profiles.errors import InputError
from camwright.recipes.build import NO_PARTICULARS, MadeRecipe, make_recipe
from camwright.recipes.html import recipe_html
from camwright.recipes.manifest import MANIFEST_FILE, job_of_manifest, manifest_text, read_manifest, sha256
from camwright.recipes.model import Particulars, Recipe
from camwright.recipes.pdf import recipe_pdf
from camwright.recipes.recipe_file import RECIPE_FILE, recipe_text
from camwright.recipes.signature import SIGNATURE_FILE
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
        The folder; the files of a recipe that stands there already are replaced.
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
    ['manifest.json', 'ramps', 'recipe.html', 'recipe.json', 'recipe.pdf', 'recipe.xlsx', 'tables']
    """
    require_replaceable(Path(directory), is_recipe)
    names = targets or design.job.output.targets or ("csv",)
    made = make_recipe(StoredDesign(design.profile, design.job), names, language, note, particulars)
    write_folder(recipe_files(made), Path(directory))
    return made.recipe


def write_folder(
    files: dict[str, bytes], directory: Path, work: Work | None = None, told: Callable[[str], None] = ignore
) -> None:
    """Write a recipe folder; of a recipe that stands there already all files are replaced, what others put beside them stays.

    A file of the older recipe that was changed since is kept under another name.

    Parameters
    ----------
    files
        Contents by path.
    work
        The job; the recipe of another one of this name is not replaced while that still lies beside it.
    told
        Told of what was kept, and of a recipe that was replaced and was of another job.

    Raises
    ------
    InputError
        Something else is in the way, or the folder cannot be written.
    """
    notes: list[str] = []

    def theirs(old: Path) -> dict[str, str]:
        return _theirs(old, set(files), work, notes)

    with replaced(directory, is_recipe, theirs) as aside:
        for path, data in files.items():
            file = aside / path
            file.parent.mkdir(exist_ok=True)
            file.write_bytes(data)
    for note in notes:
        told(note)


def _theirs(old: Path, taken: set[str], work: Work | None, notes: list[str]) -> dict[str, str]:
    """Find what of an older folder is not as the recipe wrote it, and where it stands in the new one."""
    if not any(old.iterdir()):
        return {}
    listed, faults = read_manifest((old / MANIFEST_FILE).read_bytes())
    if faults:
        raise InputError(
            f"{old / MANIFEST_FILE}: damaged ({faults[0]}), so nothing here is overwritten; move the folder away, or choose another --out"
        )
    before = job_of_manifest((old / MANIFEST_FILE).read_bytes())
    if work is not None and before != work.sha256:
        require_no_rival(old, before, work)
        notes.append(
            f"{old}: the recipe of another job, or of an earlier state of it (SHA-256 {before[:12]}), is replaced"
        )
    kept = {}
    for file in sorted(old.rglob("*")):
        path = file.relative_to(old).as_posix()
        linked = file.is_symlink()
        if path in (MANIFEST_FILE, SIGNATURE_FILE) or (file.is_dir() and not linked):
            continue
        if path in listed and file.is_file() and not linked:
            if sha256(file.read_bytes()) == listed[path][0]:
                continue
            kept[path] = free_name(path, lambda other: other in taken or os.path.lexists(old / other))
            notes.append(f"{file}: changed since camwright wrote it; kept as {kept[path]}")
        else:
            kept[path] = path
    return kept


def is_recipe(directory: Path) -> bool:
    """Whether a directory looks like a recipe folder."""
    return (directory / MANIFEST_FILE).is_file() and (directory / RECIPE_FILE).is_file()
