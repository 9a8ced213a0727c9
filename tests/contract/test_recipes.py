"""What `verify` promises: a recorded value that is off by more than a millionth is found."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from camwright import load_job
from camwright.recipes.build import designed, make_recipe
from camwright.recipes.manifest import manifest_text
from camwright.recipes.recipe_file import canonical, parse_recipe
from camwright.recipes.verify import examine
from camwright.recipes.write import recipe_files, write_folder


@pytest.fixture(scope="module")
def files() -> dict[str, bytes]:
    return recipe_files(make_recipe(designed(load_job()), ["csv"]))


@pytest.mark.parametrize(("off", "found"), [(0.9e-6, False), (1.1e-6, True)])
def test_a_recorded_value_is_kept_to_a_millionth(
    files: dict[str, bytes], tmp_path: Path, off: float, found: bool
) -> None:
    write_folder(files, tmp_path / "recipe")
    file = tmp_path / "recipe" / "recipe.json"
    data = json.loads(file.read_text(encoding="utf-8"))
    (acceleration,) = (check for check in data["tables"][0]["checks"] if check["name"] == "acceleration")
    acceleration["value"] *= 1 + off
    # the manifest is made anew, so only the judgement of the table can tell
    whole = {
        path.relative_to(tmp_path / "recipe").as_posix(): path.read_bytes()
        for path in (tmp_path / "recipe").rglob("*")
        if path.is_file() and path.name != "manifest.json"
    } | {"recipe.json": canonical(data).encode()}
    file.write_bytes(whole["recipe.json"])
    origin = parse_recipe(whole["recipe.json"].decode(), "recipe.json").provenance
    (tmp_path / "recipe" / "manifest.json").write_bytes(manifest_text(whole, origin).encode())
    faults = [fault.what for fault in examine(tmp_path / "recipe").faults]
    assert any("check acceleration" in fault for fault in faults) is found
    assert len(faults) == found
