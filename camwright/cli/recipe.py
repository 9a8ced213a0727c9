"""The command ``camwright recipe``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from camwright.cli.options import Json, Quiet
from camwright.cli.views.parts import View, new_table, new_text, stacked
from camwright.house.files import read_text, require_replaceable
from camwright.house.language import Language
from camwright.house.numbers import Units, number, with_unit
from camwright.house.output import Voice, complain
from camwright.house.owned import Work
from camwright.jobs.job import Job, parse_job
from camwright.profiles.errors import InputError
from camwright.profiles.tables.targets import TARGETS, target_of
from camwright.recipes.build import STEPS, designed, make_recipe
from camwright.recipes.compare import RecipeChange, compare_answer, compare_recipes, read_recipe
from camwright.recipes.judgements import SHORT
from camwright.recipes.manifest import MANIFEST_FILE, sha256
from camwright.recipes.model import Particulars, Recipe, RecipeCheck
from camwright.recipes.signature import SIGNATURE_FILE, require_private_key, signed
from camwright.recipes.write import WRITE_STEPS, is_recipe, recipe_files, write_folder
from camwright.stored.design_file import MOST_BYTES, StoredDesign, parse_design

_LONGEST_NOTE = 2000
_LONGEST_PARTICULAR = 100


def _text(option: str, words: str) -> Any:
    return typer.Option(option, metavar="TEXT", help=words)


def run(
    file: Annotated[
        Path | None, typer.Argument(metavar="[JOB|DESIGN]", help="A job file (TOML) or a design.json.")
    ] = None,
    targets: Annotated[
        str | None,
        typer.Option(
            "--targets", metavar="NAMES", help="Targets, separated by commas, or all; else the job's, else csv."
        ),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            metavar="DIR",
            help="The folder, replaced if it holds a recipe; out/<name>-recipe if left out.",
        ),
    ] = None,
    language: Annotated[Language, typer.Option("--language", help="Language of what people read.")] = "en",
    note: Annotated[str, _text("--note", "Text that stands on the recipe.")] = "",
    revision: Annotated[str, _text("--revision", "Revision that stands on the sheet.")] = "",
    customer: Annotated[str, _text("--customer", "Customer that stands on the sheet.")] = "",
    author: Annotated[str, _text("--author", "Who made it, as it stands on the sheet.")] = "",
    date: Annotated[str, _text("--date", "Date that stands on the sheet, in any form.")] = "",
    sign: Annotated[
        Path | None,
        typer.Option("--sign", metavar="KEY", help="Sign it with this private Ed25519 key (PEM): manifest.json.sig."),
    ] = None,
    compare: Annotated[
        tuple[Path, Path] | None,
        typer.Option("--compare", metavar="DIR1 DIR2", help="Show what changes between two recipes instead."),
    ] = None,
    as_json: Json = False,
    quiet: Quiet = False,
) -> int:
    """Make the recipe of a product: a folder with all that is needed at the machine."""
    voice = Voice(as_json, quiet)
    if compare is not None:
        if file is not None or targets is not None or out is not None or sign is not None:
            raise InputError("--compare takes two recipe folders and nothing else")
        return _compare(*compare, voice)
    if file is None:
        raise InputError("no job or design is named; write e.g. camwright recipe JOB")
    given = {"revision": revision, "customer": customer, "author": author, "date": date}
    particulars = Particulars(
        **{name: _given(f"--{name}", value, _LONGEST_PARTICULAR) for name, value in given.items()}
    )
    if sign is not None:
        require_private_key(sign)
    return _make(file, targets, out, language, _given("--note", note, _LONGEST_NOTE), particulars, sign, voice)


def _make(
    file: Path,
    targets: str | None,
    out: Path | None,
    language: Language,
    note: str,
    particulars: Particulars,
    sign: Path | None,
    voice: Voice,
) -> int:
    """Make and write the recipe of a file."""
    wanted = None if targets is None else _targets(targets)
    if out is not None:
        require_replaceable(out, is_recipe)
    job, stored = _read(file)
    names = wanted or list(job.output.targets) or ["csv"]
    folder = Path("out") / f"{job.name}-recipe" if out is None else out
    require_replaceable(folder, is_recipe)
    with voice.progress(STEPS + len(names) + WRITE_STEPS) as step:
        if stored is None:
            step("solving")
        design = designed(job) if stored is None else stored
        required = targets is None or targets.strip() != "all"
        made = make_recipe(design, names, language, note, particulars, required=required, step=step)
        files = recipe_files(made, step)
        if sign is not None:
            files[SIGNATURE_FILE] = signed(files[MANIFEST_FILE], sign)
        work = Work(
            "recipe", job.name, made.recipe.provenance.job_sha256, file if out is None and stored is None else None
        )
        write_folder(files, folder, work, complain)
    answer = {
        "released": made.recipe.released,
        "failed_checks": _failed(made.recipe),
        "files": [{"path": path, "sha256": sha256(data)} for path, data in sorted(files.items())],
    }
    further = "" if made.recipe.released else _way_out(made.recipe, file, stored is not None)
    voice.answer(lambda: answer, lambda: _recipe_view(made.recipe, answer, folder, job.units, further))
    return 0 if made.recipe.released else 1


def _read(file: Path) -> tuple[Job, StoredDesign | None]:
    """Read a job file, or a design with its job."""
    text = read_text(file, "job or design file", MOST_BYTES)
    if text.removeprefix("\ufeff").lstrip().startswith("{"):
        stored = parse_design(text, str(file))
        return stored.job, stored
    return parse_job(text, str(file)), None


def _failed(recipe: Recipe) -> list[str]:
    """Name the checks that failed: of the cam, and of each table after its target."""
    own = [check.name for check in recipe.checks if not check.passed]
    return own + [
        f"{table.target}: {check.name}" for table in recipe.tables for check in table.checks if not check.passed
    ]


def _way_out(recipe: Recipe, file: Path, designed_before: bool) -> str:
    """Say who tells what makes the cam pass, or without which tables it would be released."""
    failed = {table.target for table in recipe.tables if not table.released}
    if not recipe.speed_band or any(not check.passed for check in recipe.checks):
        return "" if designed_before else f"camwright design {file} says what makes it pass"
    if len(failed) < len(recipe.tables):
        return f"without {', '.join(sorted(failed))} in --targets it is released: the cam and its other tables pass"
    return "the cam passes; none of its tables does: name another target in --targets"


def _targets(text: str) -> list[str]:
    """Read the names of targets."""
    if text.strip() == "all":
        return list(TARGETS)
    names = list(dict.fromkeys(name.strip() for name in text.split(",") if name.strip()))
    if not names:
        raise InputError(f"--targets names no target; the targets are {', '.join(TARGETS)}, or all")
    return [target_of(name).name for name in names]


def _given(option: str, text: str, most: int) -> str:
    """Take a text of the user as it is, but for bytes that are no text."""
    if len(text) > most:
        raise InputError(f"{option} has {len(text)} characters; it may have {most}")
    return text.encode("utf-8", "surrogateescape").decode("utf-8", "replace")


def _compare(before: Path, after: Path, voice: Voice) -> int:
    changes = compare_recipes(read_recipe(before), read_recipe(after))
    voice.answer(lambda: compare_answer(before, after, changes), lambda: _compare_view(before, after, changes))
    return 0


def _recipe_view(recipe: Recipe, answer: dict[str, Any], out: Path, units: Units, further: str) -> View:
    """Show whether the cam is released and what failed, then the files."""
    heads = ("file", f"SHA-256, first {SHORT} digits")
    table = new_table(str(out), heads, heads)
    for file in answer["files"]:
        table.add_row(new_text(file["path"]), file["sha256"][:SHORT])
    notes = [
        new_text(f"{refusal.target} cannot take this cam: {'; '.join(refusal.reasons)}") for refusal in recipe.refused
    ]
    state = new_text(f"{recipe.name}: released")
    if not recipe.released:
        failed = [_told(check, units) for check in recipe.checks if not check.passed]
        failed += [name for name in answer["failed_checks"] if ": " in name]
        state = new_text(f"{recipe.name}: NOT RELEASED: {'; '.join(failed) or 'no line speed passes'}", "bold red")
    return stacked(state, table, *notes, *([new_text(further)] if further else []))


def _told(check: RecipeCheck, units: Units) -> str:
    """Say what a check that failed found, and its limit."""
    value, limit = (
        "–" if each is None else with_unit(each, check.unit, units=units) for each in (check.value, check.limit)
    )
    return f"{check.name} {value} (limit {limit})"


def _compare_view(before: Path, after: Path, changes: list[RecipeChange]) -> View:
    if not changes:
        return new_text(f"nothing changes from {before} to {after}")
    heads = ("", "what", "unit")
    table = new_table("What changes on the machine", heads, heads)
    table.add_column(new_text(str(before)), justify="right")
    table.add_column(new_text(str(after)), justify="right")
    last = ""
    for change in changes:
        values = [new_text(_short(value)) for value in (change.before, change.after)]
        table.add_row(
            change.group if change.group != last else "", new_text(change.name.replace("_", " ")), change.unit, *values
        )
        last = change.group
    return table


def _short(value: Any) -> str:
    """Write a value for the terminal; of checksums the first digits."""
    if value is None or isinstance(value, float):
        return number(value, 6)
    if isinstance(value, dict):
        return "\n".join(f"{path} {digest[:12]}" for path, digest in value.items()) or "not released"
    return str(value).replace("_", " ")
